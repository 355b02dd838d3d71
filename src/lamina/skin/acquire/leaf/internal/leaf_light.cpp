// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf/internal/leaf_light.h"

#include <algorithm>
#include <cmath>

#include "lamina/solve/reflectance/leaf_totals_table.h"

namespace lamina::detail {
namespace {

constexpr double absorption_scale = 0.1;      // less is nearly none
constexpr double sampled_wavelength = 440.0;  // [nm]: chlorophyll stands for all that absorbs
const double low_structure = std::log(LeafLight::least_structure);
const double structure_range = std::log(LeafLight::most_structure / LeafLight::least_structure);

/// Where a coordinate lies in a row of nodes: the first of four, and the weights of these.
struct Cubic {
  std::size_t first;
  std::array<double, 4> weights, derivatives;  ///< by the distance of nodes
};

/// Catmull and Rom's spline: through the nodes, with the slopes of their neighbors.
Cubic cubic(double place, std::size_t nodes) {
  const double last = static_cast<double>(nodes) - 2.0;
  const bool is_inside = place >= 1.0 && place <= last;
  const double at = std::clamp(place, 1.0, last);
  const auto cell = std::min(static_cast<std::size_t>(at), nodes - 3);
  const double t = at - static_cast<double>(cell), t2 = t * t, t3 = t2 * t;
  Cubic result{cell - 1,
               {0.5 * (-t + 2 * t2 - t3), 0.5 * (2 - 5 * t2 + 3 * t3), 0.5 * (t + 4 * t2 - 3 * t3),
                0.5 * (t3 - t2)},
               {}};
  if (is_inside)
    result.derivatives = {0.5 * (-1 + 4 * t - 3 * t2), 0.5 * (-10 * t + 9 * t2),
                          0.5 * (1 + 8 * t - 9 * t2), 0.5 * (3 * t2 - 2 * t)};
  return result;
}

}  // namespace

LeafLight::LeafLight(const LeafParameters& leaf, double most_absorption, const Incidence& incidence,
                     const Progress& progress)
    : low_(std::log(absorption_scale)),
      step_((std::log(most_absorption + absorption_scale) - low_) /
            static_cast<double>(columns - 3)) {
  // One node beyond each end. Those below none are mirrored: their slope there is hardly used.
  const double absorption_of_unit = leaf_spectrum(sampled_wavelength).chlorophyll;
  LeafRange range = leaf_fit_range(leaf);
  range.high.chlorophyll =
      std::clamp(most_absorption * std::exp(step_) / absorption_of_unit, 1.0, 200.0);
  const LeafTotalsTable table({sampled_wavelength}, incidence, range, progress);
  values_.resize(rows * columns);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      LeafParameters sample{.chlorophyll = 0.0,
                            .carotenoids = 0.0,
                            .anthocyanins = 0.0,
                            .brown_pigments = 0.0,
                            .water = 0.0,
                            .dry_matter = 0.0,
                            .palisade_share = leaf.palisade_share};
      const double u = low_ + step_ * (static_cast<double>(column) - 1.0);
      const double v = low_structure + structure_range / static_cast<double>(rows - 3) *
                                           (static_cast<double>(row) - 1.0);
      sample.chlorophyll = std::max(0.0, std::exp(u) - absorption_scale) / absorption_of_unit;
      sample.structure = std::exp(v);
      const LeafTotalsTable::Totals totals = table.totals(sample, 0);
      values_[row * columns + column] = {totals.reflectance, totals.transmittance};
    }
  // Beyond the ends the table is flat: straight lines go on there instead.
  const auto extend = [&](std::size_t end, std::size_t by, std::size_t count, std::size_t stride) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 2; ++k) {
        std::array<double, 2>* node = &values_[end + i * stride];
        const bool is_first = end == 0;
        const std::array<double, 2>& next = is_first ? node[by] : *(node - by);
        const std::array<double, 2>& second = is_first ? node[2 * by] : *(node - 2 * by);
        const std::array<double, 2>& third = is_first ? node[3 * by] : *(node - 3 * by);
        (*node)[k] = 3.0 * next[k] - 3.0 * second[k] + third[k];
      }
  };
  extend(0, 1, rows, columns);
  extend(columns - 1, 1, rows, columns);
  extend(0, columns, columns, 1);
  extend((rows - 1) * columns, columns, columns, 1);
}

LeafLight::Value LeafLight::at(double absorption, double structure) const {
  const Cubic u = cubic((std::log(absorption + absorption_scale) - low_) / step_ + 1.0, columns);
  const double per_row = static_cast<double>(rows - 3) / structure_range;
  const Cubic v = cubic((std::log(structure) - low_structure) * per_row + 1.0, rows);
  std::array<double, 2> value = {}, by_u = {}, by_v = {};
  for (std::size_t j = 0; j < 4; ++j) {
    const std::array<double, 2>* node = &values_[(v.first + j) * columns + u.first];
    for (std::size_t k = 0; k < 2; ++k) {
      double along = 0.0, slope = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        along += u.weights[i] * node[i][k];
        slope += u.derivatives[i] * node[i][k];
      }
      value[k] += v.weights[j] * along;
      by_u[k] += v.weights[j] * slope;
      by_v[k] += v.derivatives[j] * along;
    }
  }
  const double u_chain = 1.0 / (step_ * (absorption + absorption_scale));
  const double v_chain = per_row / structure;
  return {value[0],
          std::max(0.0, value[1]),
          {by_u[0] * u_chain, by_u[1] * u_chain},
          {by_v[0] * v_chain, by_v[1] * v_chain}};
}

}  // namespace lamina::detail
