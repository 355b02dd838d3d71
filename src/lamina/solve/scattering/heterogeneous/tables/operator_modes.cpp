// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/operator_modes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lamina::detail {
namespace {

/// Transforms of all operators at a node over their largest totals, one after the other.
ValuesOfRows compared_transforms(const std::array<ValuesOfRows, 4>& at_nodes,
                                 const std::vector<double>& variances) {
  ValuesOfRows all;
  for (const ValuesOfRows& weights : at_nodes) {
    all.resize(std::max(all.size(), weights.size()));
    double largest = 0.0;
    for (std::size_t node = 0; node < weights.size(); ++node)
      for (const double k : compared_frequencies) {
        all[node].push_back(transform(weights[node], variances, k));
        largest = std::max(largest, std::abs(all[node].back()));
      }
    if (largest > 0.0)
      for (auto& row : all)
        for (std::size_t k = row.size() - compared_frequencies.size(); k < row.size(); ++k)
          row[k] /= largest;
  }
  return all;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

void subtract(std::vector<double>& from, double factor, const std::vector<double>& values) {
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= factor * values[i];
}

}  // namespace

double transform(const std::vector<double>& weights, const std::vector<double>& variances,
                 double k) {
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    sum += weights[i] * std::exp(-0.5 * k * k * variances[i]);
  return sum;
}

OperatorModes find_modes(const std::array<ValuesOfRows, 4>& at_nodes,
                         const std::vector<double>& variances, double tolerance) {
  constexpr std::size_t most_modes = 40;
  ValuesOfRows missed = compared_transforms(at_nodes, variances);
  OperatorModes modes;
  while (modes.at_nodes.size() < most_modes) {
    const auto worst = std::ranges::max_element(missed, {}, largest_of);
    if (largest_of(*worst) <= tolerance) break;
    const auto node = static_cast<std::size_t>(worst - missed.begin());
    std::vector<double> direction = *worst;
    const double length =
        std::sqrt(std::inner_product(direction.begin(), direction.end(), direction.begin(), 0.0));
    for (double& value : direction) value /= length;
    // What of the node's operators the modes before do not hold is the new mode.
    for (std::size_t o = 0; o < 4; ++o) {
      if (at_nodes[o].empty()) continue;
      std::vector<double> weights = at_nodes[o][node];
      for (std::size_t m = 0; m < modes.at_nodes.size(); ++m)
        subtract(weights, modes.at_nodes[m][node], modes.weights[o][m]);
      for (double& weight : weights) weight /= length;
      modes.weights[o].push_back(std::move(weights));
    }
    std::vector<double>& mode = modes.at_nodes.emplace_back();
    for (std::vector<double>& rest : missed) {
      mode.push_back(std::inner_product(rest.begin(), rest.end(), direction.begin(), 0.0));
      subtract(rest, mode.back(), direction);
    }
  }
  return modes;
}

}  // namespace lamina::detail
