// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/channel_values.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

std::string names_text(const Image& image) {
  std::string text;
  for (const std::string& name : image.channels) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void require_size(const PixelMask& mask, const Image& image, const std::string& what) {
  if (mask.width != image.width || mask.height != image.height)
    throw InvalidInput(what + " must have " + size_text(image.width, image.height) + ", but has " +
                       size_text(mask.width, mask.height));
}

void require_like(const Image& image, const Image& other, const std::string& what) {
  if (image.width != other.width || image.height != other.height)
    throw InvalidInput(what + " must have " + size_text(other.width, other.height) + ", but has " +
                       size_text(image.width, image.height));
  if (image.channels != other.channels)
    throw InvalidInput(what + " must have the channels " + names_text(other) + ", but has " +
                       names_text(image));
}

void require_one_or_each(const std::vector<double>& numbers, const Image& image,
                         const std::string& what) {
  if (numbers.size() != 1 && numbers.size() != image.channel_count())
    throw InvalidInput(what + " must be one number or one for each of the " +
                       std::to_string(image.channel_count()) + " channels, but has " +
                       std::to_string(numbers.size()));
  for (const double number : numbers)
    if (!std::isfinite(number))
      throw InvalidInput(what + " must be finite, but is " + number_text(number));
}

void mark_not_finite(PixelMask& mask, const Image& image) {
  const std::size_t channels = image.channel_count();
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (!std::isfinite(image.pixels[i])) mask.mark(i / channels, PixelFault::not_finite);
}

}  // namespace lamina
