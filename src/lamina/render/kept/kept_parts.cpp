// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/kept/kept_parts.h"

#include <utility>

#include "lamina/base/core/hash.h"

namespace lamina {
namespace {

/// Parts that so many pictures have not asked for are forgotten:
/// test KeptParts.ForgetsPartsThatNoPictureAsksFor.
constexpr std::uint64_t most_pictures_unused = 16;

}  // namespace

void KeptParts::begin_picture(const AspectHashes& aspects, int size, bool is_first_look) {
  aspects_ = aspects;
  size_ = size;
  is_first_look_ = is_first_look;
  has_stand_ins_ = false;
  ++picture_;
  std::erase_if(entries_, [&](const auto& entry) {
    return entry.second.used + most_pictures_unused < picture_;
  });
}

KeptParts::Place KeptParts::place_of(KeptPart kind, std::uint64_t place) const {
  // A part that does not need the film is that of all sizes.
  const bool is_of_size = need_of(kind, SceneAspect::film) != Need::no;
  return {kind, place * 64 + static_cast<std::uint64_t>(is_of_size ? size_ : 0)};
}

KeptParts::Keys KeptParts::keys_of(KeptPart kind, std::uint64_t more) const {
  Hash all, least;
  for (std::size_t aspect = 0; aspect < scene_aspect_count; ++aspect) {
    const Need need = need_of(kind, static_cast<SceneAspect>(aspect));
    if (need != Need::no) all.add(aspects_[aspect]);
    if (need == Need::yes) least.add(aspects_[aspect]);
  }
  all.add(more);
  return {all.value(), least.value()};
}

KeptParts::Found KeptParts::find_any(KeptPart kind, std::uint64_t place, std::uint64_t more,
                                     const std::function<bool(const void*)>& serves) {
  const auto found = entries_.find(place_of(kind, place));
  if (found == entries_.end()) return {};
  const auto [all, least] = keys_of(kind, more);
  Entry& entry = found->second;
  const bool is_same = entry.key == all;
  if (!is_same && !(is_first_look_ && entry.least_key == least && serves(entry.part.get())))
    return {};
  has_stand_ins_ = has_stand_ins_ || !is_same;
  entry.used = picture_;
  return {entry.part, entry.key};
}

std::uint64_t KeptParts::put(KeptPart kind, std::uint64_t place, std::uint64_t more,
                             std::shared_ptr<const void> part) {
  auto [all, least] = keys_of(kind, more);
  if (has_stand_ins_) {
    Hash hash;
    hash.add(all);
    hash.add(picture_);
    all = hash.value();
  }
  ++made_[static_cast<std::size_t>(kind)];
  entries_[place_of(kind, place)] = {all, least, picture_, std::move(part)};
  return all;
}

}  // namespace lamina
