// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/pixel_mask.h"

#include <algorithm>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"

namespace lamina {
namespace {

bool has_fault(std::uint8_t faults, PixelFault fault) {
  return (faults & static_cast<unsigned>(fault)) != 0;
}

/// What lies within `reach` of something set, along lines of `length` places that are `stride`
/// apart and begin `next` apart.
std::vector<bool> widened(const std::vector<bool>& set, std::size_t length, std::size_t lines,
                          std::size_t stride, std::size_t next, std::size_t reach) {
  std::vector<bool> wide = set;
  for (std::size_t line = 0; line < lines; ++line)
    for (const bool is_forward : {true, false}) {
      std::size_t since = reach + 1;  // the last one that is set
      for (std::size_t i = 0; i < length; ++i) {
        const std::size_t at = line * next + (is_forward ? i : length - 1 - i) * stride;
        since = set[at] ? 0 : std::min(since + 1, reach + 1);
        if (since <= reach) wide[at] = true;
      }
    }
  return wide;
}

}  // namespace

PixelMask make_pixel_mask(int width, int height) {
  const std::size_t pixels = checked_product(
      "a mask", {static_cast<std::size_t>(width), static_cast<std::size_t>(height)});
  return {width, height, std::vector<std::uint8_t>(pixels)};
}

PixelMask mask_from_image(const Image& image) {
  PixelMask mask = make_pixel_mask(image.width, image.height);
  const std::size_t channel = channel_index(image, "Y").value_or(0);
  for (std::size_t i = 0; i < mask.faults.size(); ++i)
    if (!(image.pixels[i * image.channel_count() + channel] >= 0.5f))
      mask.mark(i, PixelFault::excluded);
  return mask;
}

PixelMask combined(const PixelMask& a, const PixelMask& b) {
  if (a.width != b.width || a.height != b.height)
    throw InvalidInput("masks must be of one size, but are " + std::to_string(a.width) + " x " +
                       std::to_string(a.height) + " and " + std::to_string(b.width) + " x " +
                       std::to_string(b.height) + " pixels");
  PixelMask both = a;
  for (std::size_t i = 0; i < both.faults.size(); ++i)
    both.faults[i] = static_cast<std::uint8_t>(both.faults[i] | b.faults[i]);
  return both;
}

PixelMask eroded(PixelMask mask, int pixels) {
  if (pixels < 0)
    throw InvalidInput("the pixels to leave out at the edge must be >= 0, but are " +
                       std::to_string(pixels));
  std::vector<bool> near(mask.faults.size());
  for (std::size_t i = 0; i < near.size(); ++i)
    near[i] = has_fault(mask.faults[i], PixelFault::excluded);
  const auto width = static_cast<std::size_t>(mask.width);
  const auto height = static_cast<std::size_t>(mask.height);
  const auto reach = static_cast<std::size_t>(pixels);
  near = widened(widened(near, width, height, 1, width, reach), height, width, width, 1, reach);
  for (std::size_t i = 0; i < near.size(); ++i)
    if (near[i] && !has_fault(mask.faults[i], PixelFault::excluded)) mask.mark(i, PixelFault::edge);
  return mask;
}

MaskCounts count_pixels(const PixelMask& mask) {
  MaskCounts counts;
  for (const std::uint8_t faults : mask.faults) {
    if (faults == 0) ++counts.used;
    for (std::size_t i = 0; i < counts.faults.size(); ++i)
      if (has_fault(faults, enum_names<PixelFault>[i].value)) ++counts.faults[i];
  }
  return counts;
}

std::string counts_text(const MaskCounts& counts) {
  std::string text = std::to_string(counts.used) + " pixels used";
  const char* separator = "; ";
  for (std::size_t i = 0; i < counts.faults.size(); ++i) {
    if (counts.faults[i] == 0) continue;
    std::string name(enum_names<PixelFault>[i].name);
    std::ranges::replace(name, '_', ' ');
    text += separator + std::to_string(counts.faults[i]) + " " + name;
    separator = ", ";
  }
  return text;
}

void require_used_pixels(const PixelMask& mask, const std::string& what) {
  const MaskCounts counts = count_pixels(mask);
  if (counts.used == 0) throw InvalidInput(what + " leaves nothing: " + counts_text(counts));
}

}  // namespace lamina
