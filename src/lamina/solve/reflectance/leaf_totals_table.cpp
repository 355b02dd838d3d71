// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/reflectance/leaf_totals_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

using Point = ChebyshevTable::Point;

constexpr ChebyshevTable::Counts counts_of_any = {30, 12, 10};
constexpr int leaf_grid_nodes = 12;  // of the first segment: totals to 2e-4 of themselves

// Coordinates in which logarithms of totals are nearly polynomials. Light that is hardly
// transmitted counts by its difference from none.
constexpr double absorption_scale = 0.1, transmittance_scale = 1e-3;
Point leaf_coordinates(const Point& place) {
  return {std::log(place[0] + absorption_scale), place[1], std::log(place[2])};
}
Point leaf_place(const Point& coordinate) {
  return {std::max(0.0, std::exp(coordinate[0]) - absorption_scale), coordinate[1],
          std::exp(coordinate[2])};
}

void check(const LeafRange& range) {
  for (const LeafParameterRange& each : leaf_parameter_ranges()) {
    const double low = range.low.*each.value, high = range.high.*each.value;
    if (!(each.low <= low && low <= high && high <= each.high))
      throw InvalidInput("range of " + std::string(each.name) + ": must lie within [" +
                         number_text(each.low) + ", " + number_text(each.high) + "], but is [" +
                         number_text(low) + ", " + number_text(high) + "]");
  }
}

/// The leaf at a place, as leaf_layers makes it.
LayerStack leaf_at(const Point& place) {
  const auto [absorption, share, structure] = leaf_place(place);
  const std::array<Layer, 2> layers = leaf_layers({.chlorophyll = absorption,
                                                   .carotenoids = 0.0,
                                                   .anthocyanins = 0.0,
                                                   .brown_pigments = 0.0,
                                                   .water = 0.0,
                                                   .dry_matter = 0.0,
                                                   .structure = structure,
                                                   .palisade_share = std::clamp(share, 0.0, 1.0),
                                                   .thickness = 1.0},
                                                  {.chlorophyll = 1.0});
  return LayerStack({layers.begin(), layers.end()});
}

}  // namespace

LeafTotalsTable::LeafTotalsTable(const std::vector<double>& wavelengths, Incidence incidence,
                                 const LeafRange& range, const Progress& progress) {
  check(range);
  for (const double nm : wavelengths) {
    if (!(shortest_leaf_wavelength <= nm && nm <= longest_leaf_wavelength))
      throw InvalidInput("wavelength: must lie in [" + number_text(shortest_leaf_wavelength) +
                         ", " + number_text(longest_leaf_wavelength) + "] nm, but is " +
                         number_text(nm));
    spectra_.push_back(leaf_spectrum(nm));
  }
  if (spectra_.empty()) throw InvalidInput("wavelengths: must be given");
  ChebyshevTable::Box box{leaf_coordinates(place(range.low, 0)),
                          leaf_coordinates(place(range.high, 0))};
  for (std::size_t w = 0; w < spectra_.size(); ++w) {
    box.low[0] = std::min(box.low[0], leaf_coordinates(place(range.low, w))[0]);
    box.high[0] = std::max(box.high[0], leaf_coordinates(place(range.high, w))[0]);
  }
  ChebyshevTable::Counts counts = counts_of_any;
  std::array<std::vector<double>, 3> points;
  for (std::size_t d = 0; d < counts.size(); ++d) {
    if (box.low[d] == box.high[d]) counts[d] = 1;
    points[d] = ChebyshevTable::points(box.low[d], box.high[d], counts[d]);
  }
  const std::size_t columns = points[0].size(), rows = points[1].size() * points[2].size();
  std::vector<double> reflected(rows * columns), transmitted(rows * columns);
  parallel_for(
      rows,
      [&](std::size_t row) {
        for (std::size_t i = 0; i < columns; ++i) {
          const LayerStack leaf = leaf_at(
              {points[0][i], points[1][row % points[1].size()], points[2][row / points[1].size()]});
          const SlabTotals totals =
              adding_doubling_on_grid(leaf, incidence, leaf_grid_nodes).totals;
          reflected[row * columns + i] = std::log(totals.diffuse_reflectance);
          transmitted[row * columns + i] = std::log(totals.transmittance + transmittance_scale);
        }
      },
      progress);
  reflectance_ = {box, counts, std::move(reflected)};
  transmittance_ = {box, counts, std::move(transmitted)};
  specular_ = adding_doubling_on_grid(leaf_at(box.low), incidence, leaf_grid_nodes)
                  .totals.specular_reflectance;
}

LeafTotalsTable::Place LeafTotalsTable::place(const LeafParameters& leaf,
                                              std::size_t wavelength) const {
  return {leaf_absorption(leaf, spectra_[wavelength]), leaf.palisade_share, leaf.structure};
}

LeafTotalsTable::Totals LeafTotalsTable::totals(const LeafParameters& leaf,
                                                std::size_t wavelength) const {
  const Point at = leaf_coordinates(place(leaf, wavelength));
  return {std::exp(reflectance_.at(at)),
          std::max(0.0, std::exp(transmittance_.at(at)) - transmittance_scale)};
}

LeafTotalsTable::Totals LeafTotalsTable::totals(const LeafParameters& leaf, std::size_t wavelength,
                                                std::span<double LeafParameters::*const> numbers,
                                                std::span<Totals> derivatives) const {
  const Place here = place(leaf, wavelength);
  const Point at = leaf_coordinates(here);
  Point reflectance_by, transmittance_by;
  const double reflected = std::exp(reflectance_.at(at, &reflectance_by));
  const double transmitted = std::exp(transmittance_.at(at, &transmittance_by));
  const Point chain = {1.0 / (here[0] + absorption_scale), 1.0, 1.0 / here[2]};
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    // The place is linear in each number: its difference is exact.
    LeafParameters more = leaf;
    const double step = std::max(std::abs(leaf.*numbers[n]), 1e-3);
    more.*numbers[n] += step;
    const Place above = place(more, wavelength);
    derivatives[n] = {};
    for (std::size_t d = 0; d < at.size(); ++d) {
      const double by_number = (above[d] - here[d]) / step * chain[d];
      derivatives[n].reflectance += reflected * reflectance_by[d] * by_number;
      derivatives[n].transmittance += transmitted * transmittance_by[d] * by_number;
    }
  }
  return {reflected, std::max(0.0, transmitted - transmittance_scale)};
}

LeafRange leaf_fit_range(const LeafParameters& leaf) {
  LeafRange range{.low = leaf, .high = leaf};
  const auto set = [&](double LeafParameters::*number, double low, double high) {
    range.low.*number = low;
    range.high.*number = high;
  };
  set(&LeafParameters::chlorophyll, 0.0, 120.0);
  set(&LeafParameters::carotenoids, 0.0, 40.0);
  set(&LeafParameters::anthocyanins, 0.0, 40.0);
  set(&LeafParameters::brown_pigments, 0.0, 5.0);
  set(&LeafParameters::water, 0.0, 0.1);
  set(&LeafParameters::dry_matter, 0.0, 0.03);
  set(&LeafParameters::structure, 0.3, 10.0);
  return range;
}

}  // namespace lamina
