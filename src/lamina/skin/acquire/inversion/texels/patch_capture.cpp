// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/texels/patch_capture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

void require(bool holds, const std::string& where, const std::string& rule, double given) {
  if (!holds) throw InvalidInput(where + ": " + rule + ", but is " + number_text(given));
}

/// @param part  where the capture lies in a larger one
std::string place(const std::string& plane, const TexelRectangle& part, std::size_t texel) {
  const auto row = static_cast<std::size_t>(part.width);
  return plane + " at texel (" + std::to_string(static_cast<std::size_t>(part.x) + texel % row) +
         ", " + std::to_string(static_cast<std::size_t>(part.y) + texel / row) + ")";
}

void check_size(const Plane& plane, const PatchCapture& capture, const std::string& name) {
  const auto texels =
      static_cast<std::size_t>(capture.width) * static_cast<std::size_t>(capture.height);
  if (plane.width != capture.width || plane.height != capture.height ||
      plane.values.size() != texels)
    throw InvalidInput(name + ": must be " + std::to_string(capture.width) + " x " +
                       std::to_string(capture.height) + " texels, but is " +
                       std::to_string(plane.width) + " x " + std::to_string(plane.height));
}

/// How many texels are lit and known.
std::size_t check_image(const PatchCapture& capture, std::size_t i, const TexelRectangle& part) {
  const PatchImage& image = capture.images[i];
  const std::string name = "image " + std::to_string(i);
  check_size(image.reflected, capture, name);
  check_size(image.deviation, capture, name + ": deviation");
  require(image.light < capture.lights.size(), name,
          "light must be one of " + std::to_string(capture.lights.size()),
          static_cast<double>(image.light));
  if (image.sensor.size() != capture.wavelengths.size())
    throw InvalidInput(name + ": sensor must have a weight for each of " +
                       std::to_string(capture.wavelengths.size()) + " wavelengths, but has " +
                       std::to_string(image.sensor.size()));
  double sum = 0.0;
  for (const double weight : image.sensor) {
    require(std::isfinite(weight), name, "weights of the sensor must be finite", weight);
    sum += weight;
  }
  require(std::abs(sum - 1.0) < 1e-3, name, "weights of the sensor must sum to 1", sum);
  const Plane& light = capture.lights[image.light];
  constexpr float far_below = 10.0f;  // in standard deviations
  std::size_t known = 0;
  for (std::size_t t = 0; t < image.reflected.values.size(); ++t) {
    const float value = image.reflected.values[t], deviation = image.deviation.values[t];
    if (!(deviation > 0.0f))
      require(false, place(name, part, t), "deviation must be > 0", static_cast<double>(deviation));
    if (std::isinf(deviation)) continue;
    if (!(std::isfinite(value) && value > -far_below * deviation))
      require(false, place(name, part, t), "reflected light must be finite, and >= 0 but for noise",
              static_cast<double>(value));
    known += light.values[t] > 0.0f ? 1 : 0;
  }
  return known;
}

}  // namespace

std::size_t check_part(const PatchCapture& capture, int left, int top) {
  require(capture.width > 0, "capture", "width must be > 0", capture.width);
  require(capture.height > 0, "capture", "height must be > 0", capture.height);
  require(std::isfinite(capture.mm_per_texel) && capture.mm_per_texel > 0.0, "capture",
          "mm_per_texel must be > 0", capture.mm_per_texel);
  require(0.0 <= capture.theta && capture.theta < std::numbers::pi / 2.0, "capture",
          "theta must lie in [0, pi/2)", capture.theta);
  if (capture.images.empty()) throw InvalidInput("capture: must have images");
  if (capture.wavelengths.empty()) throw InvalidInput("capture: must have wavelengths");
  const TexelRectangle part{left, top, capture.width, capture.height};
  for (std::size_t l = 0; l < capture.lights.size(); ++l) {
    const std::string name = "light " + std::to_string(l);
    check_size(capture.lights[l], capture, name);
    for (std::size_t t = 0; t < capture.lights[l].values.size(); ++t) {
      const float value = capture.lights[l].values[t];
      if (!(std::isfinite(value) && value >= 0.0f))
        require(false, place(name, part, t), "must be finite and >= 0", static_cast<double>(value));
    }
  }
  std::size_t known = 0;
  for (std::size_t i = 0; i < capture.images.size(); ++i) known += check_image(capture, i, part);
  return known;
}

void check_capture(const PatchCapture& capture) {
  if (check_part(capture, 0, 0) == 0)
    throw InvalidInput("capture: must have a texel that is lit and known");
}

}  // namespace lamina
