// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_layer.h"

#include <algorithm>
#include <cmath>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_rough.h"

namespace lamina::detail {
namespace {

constexpr double negligible_moment = 1e-15;

/// Layers that scatter without absorbing and have no bottom never end: this many doublings stop at
/// an optical thickness of some 1e13, where 1e-13 of the light would still come through.
constexpr int most_doublings = 64;
constexpr double opaque_transmission = 1e-13;

LayerOperators clear_layer_operators(const GridLayer& layer) {
  const std::size_t n = layer.cos.size();
  LayerOperators operators{Matrix(n, n), Matrix(n, n)};
  for (std::size_t i = 0; i < std::min(n, layer.reach); ++i) {
    const double tau = layer.sigma_t > 0.0 ? layer.sigma_t * layer.thickness / layer.cos[i] : 0.0;
    operators.transmission(i, i) = std::exp(-tau);
  }
  return operators;
}

/// Below this fraction of the scattering, absorption may be less than what rounding makes of light;
/// what such a layer absorbs of it is 1e-5 at most.
constexpr double least_absorption = 1e-11;

/// Whether more light leaves a layer than enters, or what is no number.
bool makes_light(const LayerOperators& operators, const std::vector<double>& roots) {
  const std::size_t n = roots.size();
  for (std::size_t i = 0; i < n; ++i) {
    double leaves = 0.0;
    for (std::size_t j = 0; j < n; ++j)
      leaves += (operators.reflection(i, j) + operators.transmission(i, j)) * roots[j];
    if (!(leaves <= roots[i] * (1.0 + 1e-9))) return true;
  }
  return false;
}

}  // namespace

TruncatedPhase truncate(const PhaseFunction& phase, int count) {
  TruncatedPhase truncated;
  int kept = 0;
  for (int l = 0; l < count; ++l) {
    truncated.moments.push_back(legendre_moment(phase, l));
    if (std::abs(truncated.moments.back()) > negligible_moment) kept = l + 1;
  }
  truncated.moments.resize(static_cast<std::size_t>(kept));
  const double peak = legendre_moment(phase, count);
  if (kept < count - 1 || std::abs(peak) < negligible_moment) return truncated;
  const bool is_backward = legendre_moment(phase, count - 1) < 0.0;
  const double sign = is_backward ? -1.0 : 1.0;
  (is_backward ? truncated.backward_peak : truncated.forward_peak) = peak;
  double sign_l = 1.0;
  for (double& moment : truncated.moments) {
    moment = (moment - peak * sign_l) / (1.0 - peak);
    sign_l *= sign;
  }
  return truncated;
}

int carried_moments(const DirectionGrid& grid, double ior) {
  const std::size_t n = active_count(grid, ior);
  std::size_t regular = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (grid.etendue[i] > extra_node_etendue) ++regular;
  // A rule of n nodes carries 2 n moments; pieced together of segments, somewhat less (measured).
  const bool is_one_piece = grid.segment_ior.front() == grid.segment_ior[n - 1];
  return 2 *
         static_cast<int>(std::floor((is_one_piece ? 1.0 : 0.85) * static_cast<double>(regular)));
}

GridLayer make_grid_layer(const Layer& layer, double ior, double reach, const DirectionGrid& grid) {
  const std::size_t n = active_count(grid, ior);
  GridLayer made;
  for (std::size_t i = 0; i < n; ++i) {
    made.cos.push_back(cosine(grid, i, ior));
    made.weight.push_back(std::sqrt(grid.etendue[i]) / (ior * made.cos[i]));
  }
  const TruncatedPhase phase = truncate(phase_function(layer), carried_moments(grid, ior));
  const double sigma_s = layer.medium.sigma_s;
  made.sigma_t = layer.medium.sigma_a + sigma_s * (1.0 - phase.forward_peak);
  made.sigma_s = sigma_s * (1.0 - phase.forward_peak - phase.backward_peak);
  made.backward = sigma_s * phase.backward_peak;
  made.sigma_a = layer.medium.sigma_a;
  made.extinction = sigma_t(layer.medium);
  made.thickness = layer.thickness;
  made.ior = ior;
  made.reach = active_count(grid, reach);
  made.moments = phase.moments;
  made.defect.assign(n, 0.0);
  if (sigma_s == 0.0) return made;
  const PhaseMode mode = phase_mode(made.moments, made.cos, 0);
  for (std::size_t j = 0; j < n; ++j) {
    double scattered = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      scattered += made.cos[i] * made.weight[i] * made.weight[i] *
                   (mode.forward(i, j) + mode.backward(i, j));
    made.defect[j] = 1.0 - 0.25 * scattered;
  }
  return made;
}

std::vector<double> legendre_functions(int count, int m, const std::vector<double>& x) {
  if (m >= count) return {};
  const auto orders = static_cast<std::size_t>(count - m);
  std::vector<double> table(orders * x.size());
  for (std::size_t row = 0; row < x.size(); ++row) {
    double* q = &table[row * orders];
    const double sin = std::sqrt((1.0 - x[row]) * (1.0 + x[row]));
    double start = 1.0;
    for (int j = 1; j <= m; ++j) start *= sin * std::sqrt((2.0 * j - 1.0) / (2.0 * j));
    q[0] = start;
    if (orders > 1) q[1] = std::sqrt(2.0 * m + 1.0) * x[row] * start;
    for (std::size_t k = 1; k + 1 < orders; ++k) {
      const double l = m + static_cast<double>(k), mm = static_cast<double>(m) * m;
      q[k + 1] = ((2.0 * l + 1.0) * x[row] * q[k] - std::sqrt(l * l - mm) * q[k - 1]) /
                 std::sqrt((l + 1.0) * (l + 1.0) - mm);
    }
  }
  return table;
}

PhaseMode phase_mode(const std::vector<double>& moments, const std::vector<double>& cos, int m) {
  const std::size_t n = cos.size();
  PhaseMode mode{Matrix(n, n), Matrix(n, n)};
  const int count = static_cast<int>(moments.size());
  const std::vector<double> table = legendre_functions(count, m, cos);
  if (table.empty()) return mode;
  const auto orders = static_cast<std::size_t>(count - m);
  std::vector<double> weighted(orders);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < orders; ++k) {
      const std::size_t l = k + static_cast<std::size_t>(m);
      weighted[k] = (2.0 * static_cast<double>(l) + 1.0) * moments[l] * table[i * orders + k];
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const double* q = &table[j * orders];
      double even = 0.0, odd = 0.0;  // P_l^m(-x) = (-1)^(l + m) P_l^m(x)
      for (std::size_t k = 0; k + 1 < orders; k += 2) {
        even += weighted[k] * q[k];
        odd += weighted[k + 1] * q[k + 1];
      }
      if (orders % 2 == 1) even += weighted[orders - 1] * q[orders - 1];
      mode.forward(i, j) = mode.forward(j, i) = even + odd;
      mode.backward(i, j) = mode.backward(j, i) = even - odd;
    }
  }
  return mode;
}

TransferMatrices transfer_matrices(const GridLayer& layer, int m) {
  const std::size_t n = layer.cos.size();
  const PhaseMode mode = phase_mode(layer.moments, layer.cos, m);
  TransferMatrices transfer{Matrix(n, n), Matrix(n, n)};
  auto& [A, B] = transfer;
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      const double scattering = 0.25 * layer.sigma_s * layer.weight[i] * layer.weight[j];
      A(i, j) = scattering * mode.forward(i, j);
      B(i, j) = scattering * mode.backward(i, j);
    }
    A(j, j) -= node_extinction(layer, j) / layer.cos[j];
    B(j, j) += (m % 2 == 0 ? 1.0 : -1.0) * layer.backward / layer.cos[j];
  }
  return transfer;
}

SlabProblem slab_problem(const GridLayer& layer, const TransferMatrices& transfer) {
  const int n = static_cast<int>(layer.cos.size());
  double fastest = 0.0;
  for (const double cos : layer.cos) fastest = std::max(fastest, layer.sigma_t / cos);
  SlabProblem problem{.size = n,
                      .even = n,
                      .forward = transfer.forward.values.data(),
                      .backward = transfer.backward.values.data()};
  if (std::isfinite(layer.thickness)) {
    problem.doublings =
        static_cast<int>(std::ceil(std::max(0.0, std::log2(layer.thickness * fastest))));
    problem.step = std::ldexp(layer.thickness, -problem.doublings);
  } else {
    problem.doublings = most_doublings;
    problem.step = 1.0 / fastest;
    problem.opaque = opaque_transmission;
  }
  return problem;
}

std::vector<double> root_etendues(const GridLayer& layer) {
  std::vector<double> roots;
  for (std::size_t i = 0; i < layer.cos.size(); ++i)
    roots.push_back(layer.weight[i] * layer.ior * layer.cos[i]);
  return roots;
}

LayerOperators layer_operators(const GridLayer& layer, int m) {
  if (layer.sigma_s == 0.0 && layer.backward == 0.0) return clear_layer_operators(layer);
  const std::size_t n = layer.cos.size();
  const TransferMatrices transfer = transfer_matrices(layer, m);
  SlabProblem problem = slab_problem(layer, transfer);
  std::vector<double> roots;
  if (m == 0 && layer.sigma_a <= least_absorption * (layer.sigma_s + layer.backward))
    roots = root_etendues(layer);
  if (layer.sigma_a == 0.0 && !roots.empty()) problem.conserved = roots.data();
  LayerOperators operators{Matrix(n, n), Matrix(n, n)};
  const auto solve = [&] {
    double_slab(problem, operators.reflection.values.data(), operators.transmission.values.data());
  };
  solve();
  if (problem.conserved == nullptr && !roots.empty() && makes_light(operators, roots)) {
    problem.conserved = roots.data();
    solve();
  }
  if (!std::isfinite(layer.thickness))
    std::fill(operators.transmission.values.begin(), operators.transmission.values.end(), 0.0);
  return operators;
}

std::vector<double> reach_of_layers(std::span<const Layer> layers,
                                    std::span<const Interface> interfaces,
                                    const std::vector<double>& ior, bool from_ground) {
  const auto touches_facets = [&](std::size_t medium) {
    return (medium > 0 && is_rough(interfaces[medium - 1], ior[medium - 1], ior[medium])) ||
           (medium <= layers.size() && is_rough(interfaces[medium], ior[medium], ior[medium + 1]));
  };
  const auto brings_light = [&](std::size_t medium) {
    if (medium == 0 || touches_facets(medium)) return true;
    return medium <= layers.size() ? layers[medium - 1].medium.sigma_s > 0.0 : from_ground;
  };
  std::vector<double> reach;
  for (std::size_t k = 1; k <= layers.size(); ++k) {
    double largest = touches_facets(k) ? ior[k] : 0.0;
    for (std::size_t j = 0; j < ior.size(); ++j) {
      if (!brings_light(j) || j == k) continue;
      const auto from = static_cast<std::ptrdiff_t>(std::min(j, k));
      const auto to = static_cast<std::ptrdiff_t>(std::max(j, k) + 1);
      largest = std::max(largest, *std::min_element(ior.begin() + from, ior.begin() + to));
    }
    reach.push_back(largest);
  }
  return reach;
}

}  // namespace lamina::detail
