// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/internal/operator_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/scattering/transport_profile/transfer_profile.h"

namespace lamina::detail {
namespace {

constexpr std::size_t nodes = 8, frequencies = 12;
constexpr double lowest_sigma_a = 0.02, highest_sigma_a = 40.0, lowest_frequency = 0.08;

}  // namespace

FourRows four_rows(double place, std::size_t rows) {
  const double last = static_cast<double>(rows - 1);
  place = std::clamp(place, 0.0, last);
  const double first = std::clamp(std::floor(place) - 1.0, 0.0, last - 3.0), u = place - first;
  return {static_cast<std::size_t>(first),
          {(u - 1) * (u - 2) * (u - 3) / -6, u * (u - 2) * (u - 3) / 2, u * (u - 1) * (u - 3) / -2,
           u * (u - 1) * (u - 2) / 6}};
}

std::vector<std::vector<double>> transfer_stack_shapes(const MappedStack& stack,
                                                       std::span<const double> reference_sigma_a,
                                                       const GaussianTableGrid& grid,
                                                       std::span<const double> k) {
  const double ratio =
      std::pow(highest_transfer_frequency / lowest_frequency, 1.0 / (frequencies - 1));
  std::vector<double> solved_k = {0.0};
  for (std::size_t j = 0; j < frequencies; ++j)
    solved_k.push_back(lowest_frequency * std::pow(ratio, static_cast<double>(j)));

  // Logarithms of the shapes at Chebyshev points of the logarithm of absorption, [node][frequency].
  const double middle = 0.5 * std::log(lowest_sigma_a * highest_sigma_a);
  const double half_width = 0.5 * std::log(highest_sigma_a / lowest_sigma_a);
  std::vector<std::vector<double>> at_nodes;
  const auto point = [](std::size_t i) {
    return std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / nodes);
  };
  for (std::size_t i = 0; i < nodes; ++i) {
    std::vector<Layer> layers;
    for (std::size_t l = 0; l < stack.layers.size(); ++l) {
      const MappedLayer& from = stack.layers[l];
      const double sigma_a =
          l == 0 ? std::exp(middle + half_width * point(i)) : reference_sigma_a[l];
      layers.push_back(
          {.medium = {sigma_a, from.sigma_s, from.g, from.ior}, .thickness = from.thickness});
    }
    const LayerStack solid(std::move(layers), stack.ior_above, stack.ior_below);
    const std::vector<double> reflectance =
        spatial_frequency_response(std::span(&solid, 1), solved_k, {.accuracy = 0.1}).reflectance;
    std::vector<double> logarithms;
    for (std::size_t j = 1; j < reflectance.size(); ++j)
      logarithms.push_back(std::log(std::max(1e-4, reflectance[j] / reflectance[0])));
    at_nodes.push_back(std::move(logarithms));
  }

  std::vector<std::vector<double>> shapes;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    const double sigma_a =
        std::clamp(row_absorption(grid, static_cast<double>(row)), lowest_sigma_a, highest_sigma_a);
    const double x = (std::log(sigma_a) - middle) / half_width;
    std::vector<double> logarithms(frequencies, 0.0);
    for (std::size_t i = 0; i < nodes; ++i) {  // Lagrange's polynomial through the nodes
      double share = 1.0;
      for (std::size_t other = 0; other < nodes; ++other)
        if (other != i) share *= (x - point(other)) / (point(i) - point(other));
      for (std::size_t j = 0; j < frequencies; ++j) logarithms[j] += share * at_nodes[i][j];
    }
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
