// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/acquire/patch_acquisition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "lamina/acquire/inversion/inversion_tables.h"
#include "lamina/acquire/inversion/patch_tiles.h"
#include "lamina/core/error.h"
#include "lamina/reflectance/skin_reflectance_table.h"

namespace lamina {
namespace {

/// Where as much light enters skin as of light from all sides.
constexpr double angle_of_diffuse_light = 57.0 * std::numbers::pi / 180.0;
/// Beyond so many pixels along a side captures are solved in tiles.
constexpr int largest_side_at_once = 768;
/// Noise of no number is known better, of white.
constexpr float least_deviation = 1e-5f;

Plane plane_of(const Image& image) {
  return {.width = image.width, .height = image.height, .values = image.pixels};
}
Image image_of(const Plane& plane) {
  return {.width = plane.width, .height = plane.height, .channels = {"Y"}, .pixels = plane.values};
}

PatchCapture patch_of(const Capture& capture) {
  const Image& seen = capture.reflectance;
  PatchCapture patch{
      .width = seen.width,
      .height = seen.height,
      .mm_per_texel = capture.mm_per_pixel.value_or(1.0),
      .theta = capture.incidence.is_diffuse ? angle_of_diffuse_light : capture.incidence.theta,
      .wavelengths = capture.wavelengths};
  for (const Image& light : capture.lights) patch.lights.push_back(plane_of(light));
  if (patch.lights.empty()) patch.lights.push_back(make_plane(seen.width, seen.height, 1.0f));
  const double mirrored =
      capture.has_specular
          ? SkinReflectanceTable({550.0}, capture.incidence, skin_fit_range(capture.skin.skin))
                .specular_reflectance()
          : 0.0;
  const std::size_t bands = seen.channel_count();
  for (std::size_t b = 0; b < bands; ++b) {
    PatchImage image{.reflected = make_plane(seen.width, seen.height),
                     .deviation = make_plane(seen.width, seen.height),
                     .light = capture.band_lights.empty() ? 0 : capture.band_lights[b]};
    const Plane& light = patch.lights[image.light];
    const auto weights = capture.sensor.row(b);
    image.sensor.assign(weights.begin(), weights.end());
    for (std::size_t i = 0; i < image.reflected.values.size(); ++i) {
      const float value = seen.pixels[i * bands + b];
      image.reflected.values[i] = value - static_cast<float>(mirrored) * light.values[i];
      image.deviation.values[i] =
          capture.mask.faults[i] != 0
              ? std::numeric_limits<float>::infinity()
              : std::max({least_deviation, capture.deviation.pixels[i * bands + b],
                          static_cast<float>(capture.errors[b]) * std::abs(value)});
    }
    patch.images.push_back(std::move(image));
  }
  return patch;
}

void require_enough(const Capture& capture, const PatchAcquisitionOptions& options) {
  if (options.has_transport && !capture.mm_per_pixel)
    throw InvalidInput(
        "capture: light that travels sideways needs \"mm_per_pixel\", which is missing");
  const std::size_t bands = capture.reflectance.channel_count();
  if (!capture.population && bands < capture.numbers.size())
    throw InvalidInput("capture: " + std::to_string(bands) + " bands cannot tell " +
                       std::to_string(capture.numbers.size()) +
                       " numbers; give a \"population\", or fewer \"numbers\"");
}

}  // namespace

AcquiredSkin acquire_patch(const Capture& capture, const PatchAcquisitionOptions& options,
                           const std::optional<DiskCache>& cache, const Progress& progress) {
  require_enough(capture, options);
  InversionModel model{.numbers = {},
                       .skin = capture.skin.skin,
                       .population = capture.population,
                       .has_transport = options.has_transport,
                       .totals = options.totals};
  for (const SkinFitNumber& number : capture.numbers)
    model.numbers.push_back(number.parameter.name);
  const PatchCapture patch = patch_of(capture);
  const InversionTables tables = make_inversion_tables(patch, model, cache);
  InversionOptions inversion = options.inversion;
  if (!options.has_transport) inversion.method = InversionMethod::per_pixel;
  for (const Image& start : options.start) inversion.start.push_back(plane_of(start));
  const bool is_large = std::max(patch.width, patch.height) > largest_side_at_once;
  const InversionResult result = is_large && options.has_transport
                                     ? invert_tiles(patch, tables, {}, inversion, progress)
                                     : invert_patch(patch, tables, inversion, progress);

  AcquiredSkin skin{.width = patch.width, .height = patch.height};
  skin.kinds.reserve(capture.mask.faults.size());
  for (const std::uint8_t faults : capture.mask.faults) {
    skin.kinds.push_back(faults == 0 ? PixelKind::skin : PixelKind::unused);
    ++skin.counts[static_cast<std::size_t>(skin.kinds.back())];
  }
  for (std::size_t n = 0; n < result.numbers.size(); ++n) {
    const NumberMap& map = result.numbers[n];
    double prior = wide_deviation;
    if (capture.population) {
      const auto& names = capture.population->names;
      prior =
          capture.population
              ->priors[static_cast<std::size_t>(std::ranges::find(names, map.name) - names.begin())]
              .standard_deviation;
    }
    AcquiredNumber number{.number = tables.numbers[n],
                          .prior_deviation = prior,
                          .values = image_of(map.value),
                          .deviations = map.deviation.values.empty()
                                            ? image_of(make_plane(patch.width, patch.height,
                                                                  static_cast<float>(prior)))
                                            : image_of(map.deviation)};
    if (!map.prior_share.values.empty())
      number.prior_share = number.within_share =
          median_over_skin(map.prior_share.values, skin.kinds);
    skin.numbers.push_back(std::move(number));
  }
  skin.predicted = capture.reflectance;
  const std::size_t bands = patch.images.size();
  for (std::size_t b = 0; b < bands; ++b)
    for (std::size_t i = 0; i < skin.kinds.size(); ++i)
      skin.predicted.pixels[i * bands + b] -= result.residual[b].values[i];
  skin.inversion = {.has_transport = options.has_transport,
                    .smoothness = result.smoothness,
                    .history = result.history,
                    .stop = result.stop};
  return skin;
}

}  // namespace lamina
