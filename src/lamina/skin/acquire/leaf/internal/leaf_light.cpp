// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf/internal/leaf_light.h"

#include <algorithm>
#include <cmath>

#include "lamina/solve/reflectance/leaf_totals_table.h"

namespace lamina::detail {
namespace {

constexpr double absorption_scale = 0.1;      // less is nearly none
constexpr double sampled_wavelength = 440.0;  // [nm]: chlorophyll stands for all that absorbs
constexpr std::size_t absorptions = 78, structures = 38;

double coordinate(double absorption) { return std::log(absorption + absorption_scale); }

CubicTable<2> draw_table(const LeafParameters& leaf, double most_absorption,
                         const Incidence& incidence, const Progress& progress) {
  const double absorption_of_unit = leaf_spectrum(sampled_wavelength).chlorophyll;
  LeafRange range = leaf_fit_range(leaf);
  // A step further than is asked for.
  const double step =
      (coordinate(most_absorption) - coordinate(0.0)) / static_cast<double>(absorptions - 1);
  range.high.chlorophyll =
      std::clamp(most_absorption * std::exp(step) / absorption_of_unit, 1.0, 200.0);
  const LeafTotalsTable table({sampled_wavelength}, incidence, range, progress);
  LeafParameters sample{.chlorophyll = 0.0,
                        .carotenoids = 0.0,
                        .anthocyanins = 0.0,
                        .brown_pigments = 0.0,
                        .water = 0.0,
                        .dry_matter = 0.0,
                        .palisade_share = leaf.palisade_share};
  return {{coordinate(0.0), coordinate(most_absorption), absorptions},
          {std::log(LeafLight::least_structure), std::log(LeafLight::most_structure), structures},
          [&](double u, double v) -> std::array<double, 2> {
            sample.chlorophyll = std::max(0.0, std::exp(u) - absorption_scale) / absorption_of_unit;
            sample.structure = std::exp(v);
            const LeafTotalsTable::Totals totals = table.totals(sample, 0);
            return {totals.reflectance, totals.transmittance};
          }};
}

}  // namespace

LeafLight::LeafLight(const LeafParameters& leaf, double most_absorption, const Incidence& incidence,
                     const Progress& progress)
    : table_(draw_table(leaf, most_absorption, incidence, progress)) {}

LeafLight::Value LeafLight::at(double absorption, double structure) const {
  const auto [value, by] = table_.at(coordinate(absorption), std::log(structure));
  const double per_absorption = 1.0 / (absorption + absorption_scale),
               per_structure = 1.0 / structure;
  return {value[0],
          std::max(0.0, value[1]),
          {by[0][0] * per_absorption, by[0][1] * per_absorption},
          {by[1][0] * per_structure, by[1][1] * per_structure}};
}

}  // namespace lamina::detail
