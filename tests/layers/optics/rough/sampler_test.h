// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/vec.h"

namespace lamina {

/// How well samples on the sphere follow their density: chi-square over cells in (theta, phi), as
/// standard deviations from its mean. Counts are compared with draws * integral of the density, so
/// a density that is not normalized fails too.
///
/// @param draw     returns a direction or nothing (a sample without weight); called `draws` times.
/// @param density  [1/sr] of the directions drawn; the missing ones make it integrate to below 1.
///
/// The cells divide the samples found evenly, however narrow the lobe; the outermost 0.5 % of theta
/// and 3 % of phi, whose cells would be too large for the quadrature, are not compared.
template <class Draw, class Density>
double chi_square_deviation(const Draw& draw, const Density& density, int draws) {
  constexpr std::size_t n = 10;  // cells along each angle
  const auto phi_of = [](const Vec3& w) { return std::atan2(w.y, w.x); };
  const auto theta_of = [](const Vec3& w) { return std::atan2(std::hypot(w.x, w.y), w.z); };
  std::vector<double> theta, phi;
  for (int i = 0; i < draws; ++i)
    if (const std::optional<Vec3> w = draw()) {
      theta.push_back(theta_of(*w));
      phi.push_back(phi_of(*w));
    }
  if (theta.size() < 1000) return 1e9;  // nothing to compare

  const auto edges_of = [](std::vector<double> values, double left_out) {
    std::ranges::sort(values);
    std::array<double, n + 1> edges;
    for (std::size_t i = 0; i <= n; ++i) {
      const double quantile = left_out + (1.0 - 2.0 * left_out) * static_cast<double>(i) / n;
      edges[i] = values[static_cast<std::size_t>(quantile * static_cast<double>(values.size()))];
    }
    return edges;
  };
  const auto cell_of = [](const std::array<double, n + 1>& edges, double value) {
    const auto i = std::ranges::upper_bound(edges, value) - edges.begin() - 1;
    return i < 0 ? n : static_cast<std::size_t>(i);  // n: outside
  };
  const auto theta_edges = edges_of(theta, 0.005);
  std::array<std::vector<double>, n> phi_in_row;
  for (std::size_t k = 0; k < theta.size(); ++k)
    if (const std::size_t i = cell_of(theta_edges, theta[k]); i < n)
      phi_in_row[i].push_back(phi[k]);

  const Quadrature rule = gauss_legendre(4, 0.0, 1.0);
  constexpr int parts = 6;
  const auto nodes = [&](double from, double to) {
    Quadrature all;
    for (int p = 0; p < parts; ++p)
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        all.nodes.push_back(from + (to - from) * (p + rule.nodes[k]) / parts);
        all.weights.push_back((to - from) * rule.weights[k] / parts);
      }
    return all;
  };
  double chi2 = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto phi_edges = edges_of(phi_in_row[i], 0.03);
    std::array<double, n + 1> count{};
    for (const double value : phi_in_row[i]) count[cell_of(phi_edges, value)] += 1.0;
    for (std::size_t j = 0; j < n; ++j) {
      const Quadrature t = nodes(theta_edges[i], theta_edges[i + 1]);
      const Quadrature p = nodes(phi_edges[j], phi_edges[j + 1]);
      double expected = 0.0;
      for (std::size_t a = 0; a < t.nodes.size(); ++a)
        for (std::size_t b = 0; b < p.nodes.size(); ++b) {
          const double s = std::sin(t.nodes[a]), c = std::cos(t.nodes[a]);
          const Vec3 w = {s * std::cos(p.nodes[b]), s * std::sin(p.nodes[b]), c};
          expected += t.weights[a] * p.weights[b] * s * density(w);
        }
      expected *= draws;
      if (expected < 8.0) continue;
      chi2 += (count[j] - expected) * (count[j] - expected) / expected;
      ++cells;
    }
  }
  return (chi2 - cells) / std::sqrt(2.0 * std::max(cells, 1));
}

}  // namespace lamina
