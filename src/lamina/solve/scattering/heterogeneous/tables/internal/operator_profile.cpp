// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/internal/operator_profile.h"

#include <algorithm>
#include <cmath>

#include "lamina/solve/scattering/heterogeneous/tables/internal/chebyshev_box.h"
#include "lamina/solve/scattering/heterogeneous/tables/operator_totals.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"

namespace lamina::detail {
namespace {

constexpr std::size_t frequencies = 16;
constexpr double lowest_sigma_a = 0.02, highest_sigma_a = 40.0, lowest_frequency = 0.08;

/// The part of a lattice that is solved: of absorption alone what matters.
StateLattice solved_part(StateLattice lattice) {
  if (lattice.axes.size() != 1 || lattice.axes[0].direction[0] != 1.0) return lattice;
  StateAxis& axis = lattice.axes[0];
  const double low = std::log(lowest_sigma_a) - lattice.origin[0];
  const double high = std::log(highest_sigma_a) - lattice.origin[0];
  if (axis.high > low && axis.low < high)
    axis.low = std::max(axis.low, low), axis.high = std::min(axis.high, high);
  return lattice;
}

}  // namespace

std::vector<std::vector<double>> transfer_stack_shapes(const MappedStack& stack,
                                                       std::span<const LayerState> reference,
                                                       const StateLattice& lattice,
                                                       std::span<const double> k,
                                                       const Progress& progress) {
  const double ratio =
      std::pow(highest_transfer_frequency / lowest_frequency, 1.0 / (frequencies - 1));
  std::vector<double> solved_k = {0.0};
  for (std::size_t j = 0; j < frequencies; ++j)
    solved_k.push_back(lowest_frequency * std::pow(ratio, static_cast<double>(j)));

  // Logarithms of the shapes at Chebyshev points of the states, [point][frequency].
  const std::size_t axes = lattice.axes.size();
  const ChebyshevBox box(solved_part(lattice), 2.0, axes == 1 ? 8 : axes == 2 ? 4 : 3);
  std::vector<std::vector<double>> at_points;
  for (std::size_t point = 0; point < box.size(); ++point) {
    std::vector<Layer> layers;
    for (std::size_t l = 0; l < stack.layers.size(); ++l)
      layers.push_back(solid_layer(stack, l, l == 0 ? box.state(point) : reference[l]));
    const LayerStack solid(std::move(layers), stack.ior_above, stack.ior_below);
    const std::vector<double> reflectance =
        spatial_frequency_response(std::span(&solid, 1), solved_k, {.accuracy = 0.1}).reflectance;
    std::vector<double> logarithms;
    for (std::size_t j = 1; j < reflectance.size(); ++j)
      logarithms.push_back(std::log(std::max(1e-4, reflectance[j] / reflectance[0])));
    at_points.push_back(std::move(logarithms));
    report_or_throw(progress, static_cast<double>(point + 1) / static_cast<double>(box.size()));
  }

  std::vector<std::vector<double>> shapes;
  for (std::size_t node = 0; node < node_count(lattice); ++node) {
    const std::vector<double> shares = box.shares(node_state(lattice, node));
    std::vector<double> logarithms(frequencies, 0.0);
    for (std::size_t i = 0; i < shares.size(); ++i)
      for (std::size_t j = 0; j < frequencies; ++j) logarithms[j] += shares[i] * at_points[i][j];
    std::vector<double> shape;
    for (const double at : k) {
      if (at <= lowest_frequency) {  // as 1 - c k², which every smooth profile has there
        const double low = at / lowest_frequency;
        shape.push_back(1.0 - low * low * (1.0 - std::exp(logarithms[0])));
        continue;
      }
      const FourRows near =
          four_rows(std::log(at / lowest_frequency) / std::log(ratio), frequencies);
      double sum = 0.0;
      for (std::size_t r = 0; r < 4; ++r) sum += near.share[r] * logarithms[near.first + r];
      shape.push_back(std::exp(sum));
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace lamina::detail
