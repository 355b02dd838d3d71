// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/acquired_skin.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/skin/fit/skin/skin_fit.h"

namespace lamina {
int picture_step(int width, int height) {
  constexpr int side = 320;
  return std::max(1, (std::max(width, height) + side - 1) / side);
}

double median_over_skin(std::span<const float> values, const std::vector<PixelKind>& kinds) {
  constexpr std::size_t most = 1'000'000;
  const auto skin = static_cast<std::size_t>(std::ranges::count(kinds, PixelKind::skin));
  const std::size_t step = skin / most + 1;
  std::vector<float> of_skin;
  std::size_t left_out = step - 1;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] != PixelKind::skin || ++left_out < step) continue;
    of_skin.push_back(values[i]);
    left_out = 0;
  }
  if (of_skin.empty()) return 1.0;
  const auto middle = of_skin.begin() + static_cast<std::ptrdiff_t>(of_skin.size() / 2);
  std::ranges::nth_element(of_skin, middle);
  return static_cast<double>(*middle);
}

namespace {

void require_population(const Capture& capture) {
  if (!capture.population)
    throw InvalidInput("capture: a table of colors needs a \"population\", but there is none");
}

ColorMeasurement measurement_of(const Capture& capture, std::span<const double> growth) {
  return {.sensor = capture.sensor,
          .errors = capture.errors,
          .has_specular = capture.has_specular,
          .error_growth = {growth.begin(), growth.end()}};
}

}  // namespace

std::vector<BandMisfit> misfit_of_pixels(const Capture& capture,
                                         const SkinReflectanceTable& table) {
  require_population(capture);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < capture.mask.faults.size(); ++i)
    if (capture.mask.faults[i] == 0) used.push_back(i);
  const std::size_t samples = std::min(used.size(), misfit_colors);
  std::vector<std::array<float, 3>> colors(samples);
  for (std::size_t s = 0; s < samples; ++s)
    std::copy_n(capture.reflectance.pixels.data() + 3 * used[s * used.size() / samples], 3,
                colors[s].begin());
  return misfit_of_colors(table, measurement_of(capture, {}), capture.skin.skin, capture.numbers,
                          *capture.population, colors);
}

SkinLookup lookup_of(const Capture& capture, const SkinReflectanceTable& table,
                     std::span<const double> growth, const Progress& progress) {
  require_population(capture);
  return {table,
          measurement_of(capture, growth),
          capture.skin.skin,
          capture.numbers,
          *capture.population,
          SkinLookup::usual_fits,
          progress};
}

AcquiredSkin acquire_pixels(const Capture& capture, const SkinLookup& lookup,
                            const Progress& progress) {
  if (capture.reflectance.channel_count() != 3)
    throw InvalidInput("capture: pixel by pixel needs three bands, but has " +
                       std::to_string(capture.reflectance.channel_count()));
  if (!capture.lights.empty())
    throw InvalidInput("capture: pixel by pixel needs even light, but there is a pattern of it");
  AcquiredSkin skin{.width = capture.reflectance.width, .height = capture.reflectance.height};
  const std::size_t count = lookup.numbers().size();
  for (std::size_t n = 0; n < count; ++n)
    skin.numbers.push_back({.number = lookup.numbers()[n],
                            .prior_deviation = lookup.prior_deviations()[n],
                            .values = make_image(skin.width, skin.height, {"Y"}),
                            .deviations = make_image(skin.width, skin.height, {"Y"})});
  const auto width = static_cast<std::size_t>(skin.width);
  const auto height = static_cast<std::size_t>(skin.height);
  skin.kinds.resize(width * height);
  std::vector<std::array<std::size_t, color_sides>> sides(height);
  const auto row = [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      const float* bands = capture.reflectance.pixels.data() + 3 * i;
      const ColorFit fit = lookup.at({bands[0], bands[1], bands[2]});
      PixelKind kind = capture.mask.faults[i] == 0 ? PixelKind::skin : PixelKind::unused;
      if (kind == PixelKind::skin && !(fit.distance <= static_cast<float>(farthest_skin))) {
        kind = PixelKind::not_skin;
        ++sides[y][static_cast<std::size_t>(fit.side)];
      }
      skin.kinds[i] = kind;
      for (std::size_t n = 0; n < count; ++n) {
        skin.numbers[n].values.pixels[i] = fit.values[n];
        skin.numbers[n].deviations.pixels[i] =
            kind == PixelKind::skin ? fit.deviations[n]
                                    : static_cast<float>(skin.numbers[n].prior_deviation);
      }
    }
  };
  parallel_for(height, row, progress);
  for (const auto& of_row : sides)
    for (std::size_t side = 0; side < color_sides; ++side) skin.sides[side] += of_row[side];
  for (const PixelKind kind : skin.kinds) ++skin.counts[static_cast<std::size_t>(kind)];
  if (skin.counts[0] == 0)
    throw InvalidInput("capture: no pixel has a color of skin: of " +
                       std::to_string(skin.kinds.size()) + ", " + std::to_string(skin.counts[1]) +
                       " are not used, " + std::to_string(skin.counts[2]) + " no skin");
  for (AcquiredNumber& number : skin.numbers)
    number.prior_share = number.within_share =
        median_over_skin(number.deviations.pixels, skin.kinds) / number.prior_deviation;
  return skin;
}

}  // namespace lamina
