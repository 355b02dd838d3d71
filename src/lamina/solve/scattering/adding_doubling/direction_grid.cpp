// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/direction_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lamina/base/core/quadrature.h"

namespace lamina {

GridDirection direction_in(double ior, double theta) {
  assert(0.0 <= theta);
  constexpr double least_cos = 1e-10;
  return {ior, std::sin(theta), std::max(std::cos(theta), least_cos)};
}

DirectionGrid make_direction_grid(std::span<const double> indices, int nodes,
                                  std::span<const GridDirection> extra) {
  assert(!indices.empty() && nodes >= 2);
  std::vector<double> cuts(indices.begin(), indices.end());
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());

  DirectionGrid grid;
  grid.extra.resize(extra.size());
  for (std::size_t segment = 0; segment < cuts.size(); ++segment) {
    const double ior = cuts[segment], below = segment > 0 ? cuts[segment - 1] : 0.0;
    const double cos_widest = std::sqrt((1.0 - below / ior) * (1.0 + below / ior));
    const auto add_node = [&](double p, double cos, double etendue) {
      grid.p.push_back(p);
      grid.etendue.push_back(etendue);
      grid.segment_ior.push_back(ior);
      grid.segment_cos.push_back(cos);
    };
    // Narrow segments hold little light and little structure.
    const int count =
        segment == 0 ? nodes : std::max(2, static_cast<int>(std::ceil(nodes * cos_widest)));
    const Quadrature rule = gauss_legendre(count, 0.0, cos_widest);
    for (std::size_t i = rule.nodes.size(); i-- > 0;) {
      const double cos = rule.nodes[i];
      add_node(ior * std::sqrt((1.0 - cos) * (1.0 + cos)), cos,
               2.0 * ior * ior * cos * rule.weights[i]);
    }
    for (std::size_t i = 0; i < extra.size(); ++i) {
      // In its own medium the cosine is known: p has lost it near grazing.
      const bool is_own = std::abs(ior - extra[i].ior) <= 1e-9 * ior;
      const double p = (is_own ? ior : extra[i].ior) * extra[i].sin;
      if (p < below || (!is_own && (p >= ior || ior > extra[i].ior))) continue;
      grid.extra[i] = grid.size();
      add_node(p, is_own ? extra[i].cos : std::sqrt((1.0 - p / ior) * (1.0 + p / ior)),
               extra_node_etendue);
    }
  }
  return grid;
}

std::size_t active_count(const DirectionGrid& grid, double ior) {
  return static_cast<std::size_t>(
      std::upper_bound(grid.segment_ior.begin(), grid.segment_ior.end(), ior) -
      grid.segment_ior.begin());
}

double cosine(const DirectionGrid& grid, std::size_t node, double ior) {
  const double own_ior = grid.segment_ior[node], own_cos = grid.segment_cos[node];
  assert(own_ior <= ior);
  if (own_ior == ior) return own_cos;
  const double ratio = own_ior / ior;
  return std::sqrt((1.0 - ratio) * (1.0 + ratio) + ratio * ratio * own_cos * own_cos);
}

}  // namespace lamina
