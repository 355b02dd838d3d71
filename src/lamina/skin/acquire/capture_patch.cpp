// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/capture_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {
namespace {

/// Where as much light enters skin as of light from all sides.
constexpr double angle_of_diffuse_light = 57.0 * std::numbers::pi / 180.0;
/// Noise of no number is known better, of white.
constexpr float least_deviation = 1e-5f;

/// What the surface mirrors of the light, if that is in the capture.
float mirrored_in(const Capture& capture) {
  if (!capture.has_specular) return 0.0f;
  return static_cast<float>(skin_specular_reflectance(capture.skin.skin, capture.incidence));
}

/// A patch of some of the pixels.
/// @param pixel_at  pixel of the capture that texel i of the patch is
template <class PixelAt>
PatchCapture patch_of_pixels(const Capture& capture, float mirrored, int width, int height,
                             const PixelAt& pixel_at) {
  PatchCapture patch{
      .width = width,
      .height = height,
      .mm_per_texel = capture.mm_per_pixel.value_or(1.0),
      .theta = capture.incidence.is_diffuse ? angle_of_diffuse_light : capture.incidence.theta,
      .wavelengths = capture.wavelengths};
  const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (const Image& light : capture.lights) {
    Plane& plane = patch.lights.emplace_back(make_plane(width, height));
    for (std::size_t i = 0; i < texels; ++i) plane.values[i] = light.pixels[pixel_at(i)];
  }
  if (patch.lights.empty()) patch.lights.push_back(make_plane(width, height, 1.0f));
  const std::size_t bands = capture.reflectance.channel_count();
  for (std::size_t b = 0; b < bands; ++b) {
    PatchImage image{.reflected = make_plane(width, height),
                     .deviation = make_plane(width, height),
                     .light = capture.band_lights.empty() ? 0 : capture.band_lights[b]};
    const auto weights = capture.sensor.row(b);
    image.sensor.assign(weights.begin(), weights.end());
    const Plane& light = patch.lights[image.light];
    for (std::size_t i = 0; i < texels; ++i) {
      const std::size_t pixel = pixel_at(i);
      const float value = capture.reflectance.pixels[pixel * bands + b];
      const float noise =
          capture.deviation.pixels.empty() ? 0.0f : capture.deviation.pixels[pixel * bands + b];
      image.reflected.values[i] = value - mirrored * light.values[i];
      image.deviation.values[i] =
          capture.mask.faults[pixel] != 0
              ? std::numeric_limits<float>::infinity()
              : std::max({least_deviation, noise,
                          static_cast<float>(capture.errors[b]) * std::abs(value)});
    }
    patch.images.push_back(std::move(image));
  }
  return patch;
}

bool is_lit(const Capture& capture, std::size_t pixel) {
  return capture.lights.empty() || std::ranges::any_of(capture.lights, [&](const Image& light) {
           return light.pixels[pixel] > 0.0f;
         });
}

}  // namespace

LargePatch patch_of(const Capture& capture) {
  LargePatch patch{.width = capture.reflectance.width,
                   .height = capture.reflectance.height,
                   .mm_per_texel = capture.mm_per_pixel.value_or(1.0)};
  patch.part = [&capture, mirrored = mirrored_in(capture)](const TexelRectangle& part) {
    const auto width = static_cast<std::size_t>(part.width);
    return patch_of_pixels(capture, mirrored, part.width, part.height, [&](std::size_t i) {
      return capture.mask.index(part.x + static_cast<int>(i % width),
                                part.y + static_cast<int>(i / width));
    });
  };
  return patch;
}

PatchCapture sampled_patch(const Capture& capture, std::size_t most) {
  const std::size_t pixels = capture.mask.faults.size();
  const auto is_known = [&](std::size_t pixel) {
    return capture.mask.faults[pixel] == 0 && is_lit(capture, pixel);
  };
  std::size_t known = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) known += is_known(pixel) ? 1 : 0;
  if (known == 0) throw InvalidInput("capture: must have a texel that is lit and known");
  const std::size_t step = (known + most - 1) / most;
  std::vector<std::size_t> samples;
  for (std::size_t pixel = 0, at = 0; pixel < pixels; ++pixel)
    if (is_known(pixel) && at++ % step == 0) samples.push_back(pixel);
  return patch_of_pixels(capture, mirrored_in(capture), static_cast<int>(samples.size()), 1,
                         [&](std::size_t i) { return samples[i]; });
}

}  // namespace lamina
