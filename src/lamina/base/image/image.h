// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/checked_size.h"

namespace lamina {

/// Pixels with named channels, linear unless a loader says otherwise. Row 0 is the top row.
/// Channel names are those of OpenEXR: "R", "G", "B", "A", "normal.X", "540nm", ...
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> pixels;  ///< [y][x][channel]

  [[nodiscard]] std::size_t channel_count() const { return channels.size(); }
  [[nodiscard]] float* at(int x, int y) {
    return pixels.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(x)) *
                               channel_count();
  }
  [[nodiscard]] const float* at(int x, int y) const { return const_cast<Image*>(this)->at(x, y); }
};

/// A black image.
[[nodiscard]] inline Image make_image(int width, int height, std::vector<std::string> channels) {
  const std::size_t size = checked_product(
      "an image",
      {static_cast<std::size_t>(width), static_cast<std::size_t>(height), channels.size()});
  return {width, height, std::move(channels), std::vector<float>(size)};
}

/// Where a channel stands in a pixel; absent if the image has none of that name.
[[nodiscard]] std::optional<std::size_t> channel_index(const Image& image, std::string_view name);

/// The channels of those names, in that order. @throws InvalidInput naming one that is missing.
[[nodiscard]] Image select_channels(const Image& image, const std::vector<std::string>& names);

/// Colors over A where an image has it, for files whose colors do not count what is not covered;
/// where A is 0 they stay.
[[nodiscard]] Image unpremultiplied(Image image);

/// "R", "G", "B" of an image that has them; of any other its "Y" or only channel, three times.
/// @throws InvalidInput if it has neither.
[[nodiscard]] Image rgb_image(const Image& image);

/// Note in an EXR file, as an attribute.
struct ImageNote {
  std::string name;  ///< of the attribute: ASCII, not one that OpenEXR has a meaning for
  std::string text;
};

}  // namespace lamina
