// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "lamina/core/error.h"
#include "lamina/image/image.h"

namespace lamina::python {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// An image as an array (height, width, channel), not copied.
[[nodiscard]] inline py::array_t<float> image_array(Image image) {
  const Shape shape = {image.height, image.width, static_cast<py::ssize_t>(image.channel_count())};
  return to_array(std::move(image.pixels), shape);
}

/// An array (height, width, channel) as an image.
[[nodiscard]] inline Image image_of(const Floats& array, std::vector<std::string> channels) {
  if (array.ndim() != 3 || array.shape(2) != static_cast<py::ssize_t>(channels.size()) ||
      array.shape(0) > 1 << 20 || array.shape(1) > 1 << 20)
    throw InvalidInput("image: must have the axes (height, width, channel)");
  return {static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)), std::move(channels),
          std::vector<float>(array.data(), array.data() + array.size())};
}

}  // namespace lamina::python
