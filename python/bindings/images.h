// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/image.h"

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

/// An image of one channel as an array (height, width).
[[nodiscard]] inline py::array_t<float> plane_array(const Image& image) {
  assert(image.channel_count() == 1);
  return to_array(std::vector<float>(image.pixels), Shape{image.height, image.width});
}

/// An array (height, width) as an image of one channel.
[[nodiscard]] inline Image plane_image(const Floats& array) {
  return {static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)),
          {"Y"},
          std::vector<float>(array.data(), array.data() + array.size())};
}

/// Files of images, what they look like on screens, and their comparison.
void bind_images(py::module_& module);

}  // namespace lamina::python
