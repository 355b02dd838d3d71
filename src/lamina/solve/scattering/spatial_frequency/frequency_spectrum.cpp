// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/layers/optics/absorbing_sheet.h"

namespace lamina::detail {
namespace {

constexpr double beam_per_sigma_t = 8.0;
constexpr double highest_by_thickness = 12.0;  ///< times the thickness of a scattering slab
constexpr double most_per_sigma_t = 250.0;
constexpr double least_per_sigma_t = 8e-4;  ///< of the grid's scale, by the layer's own sigma_t
constexpr double tail_start = 0.35;         ///< fraction of the highest frequency from which to fit
constexpr double handover = 0.6;            ///< where both forms count alike
constexpr double bend = 0.25;               ///< k0 over the highest frequency

double inner(const Spectrum& spectrum, double k) {
  const FrequencyGrid& grid = spectrum.grid;
  const double x = std::asinh(k / grid.scale) / std::asinh(grid.highest / grid.scale);
  const double y = 2.0 * (2.0 * x * x - 1.0);  // T_2j(x) = T_j(2 x^2 - 1), by Clenshaw's recurrence
  double b1 = 0.0, b2 = 0.0;
  for (std::size_t j = spectrum.series.size(); j-- > 1;) {
    const double b0 = y * b1 - b2 + spectrum.series[j];
    b2 = b1;
    b1 = b0;
  }
  const double k0 = bend * grid.highest;
  return (0.5 * y * b1 - b2 + spectrum.series[0]) / (1.0 + (k / k0) * (k / k0));
}

double tail(const Spectrum& spectrum, double k) {
  const double relative = k / spectrum.grid.highest;
  return (spectrum.a + spectrum.b * std::log(relative) + spectrum.c / relative) / (k * k);
}

/// Least squares of three functions by the normal equations, Cholesky's way.
std::array<double, 3> least_squares(const std::vector<std::array<double, 3>>& rows,
                                    const std::vector<double>& values) {
  double m[3][4] = {};
  for (std::size_t q = 0; q < rows.size(); ++q)
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) m[i][j] += rows[q][i] * rows[q][j];
      m[i][3] += rows[q][i] * values[q];
    }
  for (int i = 0; i < 3; ++i)
    for (int q = i + 1; q < 3; ++q) {
      const double factor = m[q][i] / m[i][i];
      for (int j = i; j < 4; ++j) m[q][j] -= factor * m[i][j];
    }
  std::array<double, 3> x{};
  for (int i = 2; i >= 0; --i) {
    double sum = m[i][3];
    for (int j = i + 1; j < 3; ++j) sum -= m[i][j] * x[static_cast<std::size_t>(j)];
    x[static_cast<std::size_t>(i)] = sum / m[i][i];
  }
  return x;
}

/// Of those that light goes any way in: a sheet has none.
double densest_layer(const GridStack& stack) {
  double densest = 0.0;
  for (const GridLayer& layer : stack.layers)
    if (layer.sigma_s > 0.0 || layer.thickness > sheet_thickness)
      densest = std::max(densest, layer.sigma_t);
  return densest;
}

/// Whether a layer scatters less than once across and touches one that is denser by half or more:
/// light of that one then falls with frequency by the thickness of this one, as exp(-k thickness).
bool is_thin_before_denser(const GridStack& stack, std::size_t l) {
  const GridLayer& layer = stack.layers[l];
  const auto is_denser = [&](std::size_t other) {
    return stack.layers[other].sigma_s > 0.0 && stack.layers[other].sigma_t > 1.5 * layer.sigma_t;
  };
  return layer.sigma_t * layer.thickness < 1.0 &&
         ((l > 0 && is_denser(l - 1)) || (l + 1 < stack.layers.size() && is_denser(l + 1)));
}

void place_frequencies(FrequencyGrid& grid, int count) {
  grid.k.clear();
  const double widest = std::asinh(grid.highest / grid.scale);
  for (int i = 0; i < count; ++i)
    grid.k.push_back(grid.scale *
                     std::sinh(widest * std::cos((i + 0.5) * std::numbers::pi / (2 * count))));
}

}  // namespace

double beam_frequencies_per_sigma_t(const GridStack& stack) {
  const double all = densest_layer(stack);
  double highest = beam_per_sigma_t * all, thickness = 0.0, densest = 0.0;
  for (std::size_t l = 0; l < stack.layers.size(); ++l) {
    const GridLayer& layer = stack.layers[l];
    // Layers that scatter and touch are one slab.
    const bool goes_on = layer.sigma_s > 0.0;
    if (goes_on) {
      thickness += layer.thickness;
      densest = std::max(densest, layer.sigma_t);
    }
    // One that lets through what a denser one under or over it scatters parts that from its face.
    if (goes_on && is_thin_before_denser(stack, l))
      highest = std::max(highest,
                         std::min(highest_by_thickness / layer.thickness, most_per_sigma_t * all));
    if (densest > 0.0 && (!goes_on || l + 1 == stack.layers.size())) {
      highest =
          std::max(highest, std::min(highest_by_thickness / thickness, most_per_sigma_t * densest));
      thickness = densest = 0.0;
    }
  }
  return highest / all;
}

FrequencyGrid make_frequency_grid(const GridStack& stack, int count, double highest_per_sigma_t) {
  double scale = std::numeric_limits<double>::infinity();
  for (const GridLayer& layer : stack.layers) {
    const double mean_cosine = layer.moments.size() > 1 ? layer.moments[1] : 0.0;
    const double transport = layer.sigma_a + layer.sigma_s * (1.0 - mean_cosine);
    if (!(transport > 0.0)) continue;
    double rate = 3.0 * layer.sigma_a * transport;
    if (std::isfinite(layer.thickness)) {
      const double depth = layer.thickness + 2.0 / transport;
      rate += 1.0 / (depth * depth);
    }
    // Without any absorption and bottom the light spreads without limit: a thousandth is the start.
    scale = std::min(scale, std::max(0.5 * std::sqrt(rate), least_per_sigma_t * layer.sigma_t));
  }
  FrequencyGrid grid;
  grid.highest = highest_per_sigma_t * densest_layer(stack);
  grid.scale = std::isfinite(scale) ? scale : 0.1 * grid.highest;
  place_frequencies(grid, count);
  return grid;
}

Spectrum make_spectrum(const FrequencyGrid& grid, std::span<const double> values) {
  Spectrum spectrum{.grid = grid};
  const std::size_t n = values.size();
  const double k0 = bend * grid.highest;
  for (std::size_t j = 0; j < n; ++j) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle =
          (static_cast<double>(i) + 0.5) * std::numbers::pi / (2.0 * static_cast<double>(n));
      sum += std::cos(2.0 * static_cast<double>(j) * angle) * values[i] *
             (1.0 + (grid.k[i] / k0) * (grid.k[i] / k0));
    }
    spectrum.series.push_back(sum * (j == 0 ? 1.0 : 2.0) / static_cast<double>(n));
  }
  constexpr int samples = 12;
  std::vector<std::array<double, 3>> rows;
  std::vector<double> targets;
  for (int q = 0; q < samples; ++q) {
    const double relative = std::pow(tail_start, 1.0 - q / (samples - 1.0));
    const double k = relative * grid.highest;
    rows.push_back({1.0, std::log(relative), 1.0 / relative});
    targets.push_back(inner(spectrum, k) * k * k);
  }
  const auto [a, b, c] = least_squares(rows, targets);
  spectrum.a = a;
  spectrum.b = b;
  spectrum.c = c;
  return spectrum;
}

Spectrum resampled(const Spectrum& spectrum, int count) {
  FrequencyGrid grid = spectrum.grid;
  place_frequencies(grid, count);
  std::vector<double> values;
  for (const double k : grid.k) values.push_back(inner(spectrum, k));
  return make_spectrum(grid, values);
}

Spectrum ended_at(const Spectrum& spectrum, double share) {
  FrequencyGrid grid = spectrum.grid;
  grid.highest *= share;
  place_frequencies(grid, static_cast<int>(spectrum.series.size()));
  std::vector<double> values;
  for (const double k : grid.k) values.push_back(inner(spectrum, k));
  return make_spectrum(grid, values);
}

double evaluate(const Spectrum& spectrum, double k) {
  const double highest = spectrum.grid.highest;
  if (k >= highest) return tail(spectrum, k);
  if (k < 0.1 * highest) return inner(spectrum, k);
  const double share =
      0.5 * std::erfc(4.0 * std::log(k / (handover * highest)) / std::log(1.0 / handover));
  return share * inner(spectrum, k) + (1.0 - share) * tail(spectrum, k);
}

}  // namespace lamina::detail
