// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/top_passage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lamina/solve/scattering/spatial_frequency/ray_fresnel.h"

namespace lamina::detail {
namespace {

/// The fraction of each node's light inside that leaves, and what diffuse light has there: the same
/// by reciprocity.
double leaving_fraction(const GridStack& stack, const RoughBoundary& top, std::size_t node) {
  double flux = 0.0;
  for (std::size_t o = 0; o < top.transmission_up.rows; ++o)
    flux += std::sqrt(stack.grid.etendue[o]) * top.transmission_up(o, node);
  return flux / std::sqrt(stack.grid.etendue[node]);
}

/// Linear between values over a rising coordinate.
double interpolate(const std::vector<double>& x, const std::vector<double>& values, double at) {
  const auto after = std::ranges::upper_bound(x, at);
  if (after == x.begin()) return values.front();
  if (after == x.end()) return values.back();
  const auto k = static_cast<std::size_t>(after - x.begin());
  const double t = (at - x[k - 1]) / (x[k] - x[k - 1]);
  return (1.0 - t) * values[k - 1] + t * values[k];
}

/// x of m x = b by elimination; m is symmetric and positive definite.
template <std::size_t N>
std::array<double, N> solve(std::array<std::array<double, N>, N> m, std::array<double, N> b) {
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t k = i + 1; k < N; ++k) {
      const double factor = m[k][i] / m[i][i];
      for (std::size_t j = i; j < N; ++j) m[k][j] -= factor * m[i][j];
      b[k] -= factor * b[i];
    }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t j = i + 1; j < N; ++j) b[i] -= m[i][j] * b[j];
    b[i] /= m[i][i];
  }
  return b;
}

/// What one facet passes on of the beam is known; what the others do makes up the nodes' moments of
/// the cosine. Those hold for narrow lobes, too, which the nodes do not show.
void set_beam(const GridStack& stack, TopPassage& top) {
  const double ratio = stack.ior[0] / stack.ior[1];
  top.of_beam = std::numbers::pi * ratio * ratio;
  constexpr std::size_t count = std::tuple_size_v<decltype(top.by_several)>;
  std::array<double, count> missing{};
  const auto add = [&](double light, double cos) {
    for (double& moment : missing) {
      moment += light;
      light *= cos;
    }
  };
  for (std::size_t i = 0; i < top.in.size(); ++i)
    add(top.in[i] * stack.grid.etendue[i], cosine(stack.grid, i, top.ior));
  constexpr int steps = 4000;
  for (int k = 0; k < steps; ++k) {
    const double p = top.ior * (k + 0.5) / steps;
    add(-top.in_at(p) * 2.0 * p * top.ior / steps, ray_cos(p, top.ior));  // etendue is p^2
  }
  std::array<std::array<double, count>, count> gram{};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      gram[i][j] = 2.0 * top.ior * top.ior / static_cast<double>(i + j + 2);
  top.by_several = solve(gram, missing);
}

}  // namespace

bool has_rough_top(const GridStack& stack) {
  return is_rough(stack.interfaces[0], stack.ior[0], stack.ior[1]);
}

double TopPassage::in_at(double p) const {
  if (of_beam == 0.0) return out_at(p);
  const double along = ray_cos(p, ior);
  double several = 0.0;
  for (std::size_t j = by_several.size(); j-- > 0;) several = several * along + by_several[j];
  return of_beam * btdf(boundary, Vec3{0.0, 0.0, 1.0}, Vec3{p / ior, 0.0, -along}) + several;
}

double TopPassage::out_at(double p) const { return interpolate(cos, leaving, ray_cos(p, ior)); }

TopPassage make_top_passage(const GridStack& stack, const RoughBoundaries& first_mode,
                            Illumination illumination) {
  const std::size_t nodes = active_count(stack.grid, stack.ior[1]);
  TopPassage top{.in = std::vector<double>(nodes),
                 .out = std::vector<double>(nodes),
                 .is_rough = has_rough_top(stack),
                 .ior = stack.ior[1]};
  const std::size_t beam = stack.grid.extra[0];
  const bool spreads_beam = top.is_rough && illumination == Illumination::normal_beam;
  for (std::size_t i = 0; i < nodes; ++i) {
    if (!top.is_rough) {
      top.in[i] = top.out[i] = 1.0 - interface_reflectance(stack, 0, stack.grid.p[i]);
      continue;
    }
    if (std::ranges::find(stack.grid.extra, i) != stack.grid.extra.end()) continue;
    const RoughBoundary& boundary = first_mode[0];
    const double etendue = stack.grid.etendue[i];
    top.out[i] = leaving_fraction(stack, boundary, i);
    top.in[i] = spreads_beam ? stack.ior[0] * stack.ior[0] * boundary.transmission_down(i, beam) /
                                   std::sqrt(etendue * stack.grid.etendue[beam])
                             : top.out[i];
  }
  if (!top.is_rough) return top;
  top.boundary = make_rough_interface<double>(stack.interfaces[0], stack.ior[0], stack.ior[1]);
  std::vector<std::size_t> by_cos;
  for (std::size_t i = 0; i < nodes; ++i)
    if (std::ranges::find(stack.grid.extra, i) == stack.grid.extra.end()) by_cos.push_back(i);
  const auto cos_of_node = [&](std::size_t i) { return cosine(stack.grid, i, top.ior); };
  std::ranges::sort(by_cos, {}, cos_of_node);
  for (const std::size_t i : by_cos) {
    top.cos.push_back(cos_of_node(i));
    top.leaving.push_back(top.out[i]);
  }
  if (spreads_beam) set_beam(stack, top);
  return top;
}

}  // namespace lamina::detail
