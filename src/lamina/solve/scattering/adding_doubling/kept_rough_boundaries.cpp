// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/kept_rough_boundaries.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <mutex>
#include <utility>

namespace lamina::detail {
namespace {

constexpr std::size_t most_kept = 24;  // of some MiB at most
constexpr int usual_modes = 9;         // cost hardly more than one, and serve who wants fewer

struct Kept {
  std::vector<double> ior, p;
  std::vector<Interface> interfaces;
  std::vector<RoughBoundaries> modes;
};

bool has_rough(const GridStack& stack) {
  for (std::size_t k = 0; k < stack.interfaces.size(); ++k)
    if (is_rough(stack.interfaces[k], stack.ior[k], stack.ior[k + 1])) return true;
  return false;
}

}  // namespace

std::vector<RoughBoundaries> kept_rough_boundaries(const GridStack& stack, int count,
                                                   const Progress& progress) {
  if (!has_rough(stack)) return rough_boundaries(stack, 0, count, progress);
  const auto wanted = static_cast<std::size_t>(count);
  const auto first_of = [&](const std::vector<RoughBoundaries>& modes) {
    return std::vector(modes.begin(), modes.begin() + count);
  };
  static std::mutex mutex;
  static std::deque<Kept> all;  // the newest first
  {
    const std::scoped_lock lock(mutex);
    const auto found = std::ranges::find_if(all, [&](const Kept& kept) {
      return kept.modes.size() >= wanted && kept.ior == stack.ior && kept.p == stack.grid.p &&
             kept.interfaces == stack.interfaces;
    });
    if (found != all.end()) return first_of(found->modes);
  }
  std::vector<RoughBoundaries> modes =
      rough_boundaries(stack, 0, count > 1 ? std::max(count, usual_modes) : 1, progress);
  const std::scoped_lock lock(mutex);
  all.push_front({stack.ior, stack.grid.p, stack.interfaces, modes});
  if (all.size() > most_kept) all.pop_back();
  return first_of(modes);
}

}  // namespace lamina::detail
