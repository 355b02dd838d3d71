// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/higher_orders.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/layered_bsdf/internal/rough_top_orders.h"

namespace lamina {
namespace {

using std::numbers::pi;
constexpr double grazing = 1e-3;  // stands in for a cosine of 0, where beams have no limit

double cosine_at(int i) {
  const double x = static_cast<double>(i) / (HigherOrders::angles - 1);
  return std::max(x * x, grazing);
}

double at(const HigherOrders::Row& row, double mu) {
  const double x = std::sqrt(std::clamp(mu, 0.0, 1.0)) * (HigherOrders::angles - 1);
  const int i = std::min(static_cast<int>(x), HigherOrders::angles - 2);
  const auto k = static_cast<std::size_t>(i);
  return row[k] + (x - i) * (row[k + 1] - row[k]);
}

Vec3 direction_of(double mu) { return {std::sqrt(1.0 - mu * mu), 0.0, mu}; }

LayerStack with_smooth_top(const LayerStack& stack) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  layers.front().top.roughness = 0.0;
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_below(), stack.ground());
}

struct Fluxes {
  HigherOrders::Row back{}, through{};
};

/// All scattered light at the table's angles, for light from above; what a rough top reflects is
/// not of it.
Fluxes scattered_flux(const LayerStack& stack, int nodes) {
  std::vector<GridDirection> beams;
  for (int i = 0; i < HigherOrders::angles; ++i) {
    const double mu = cosine_at(i);
    beams.push_back({stack.ior_above(), std::sqrt(1.0 - mu * mu), mu});
  }
  const detail::GridStack on_grid = detail::make_grid_stack(stack, nodes, beams);
  const detail::StackOperators operators = detail::stack_operators(on_grid, 0);
  const bool is_rough = detail::has_rough_top(stack);
  const auto& etendue = on_grid.grid.etendue;
  const auto flux = [&](const std::vector<double>& state) {
    double sum = 0.0;
    for (std::size_t i = 0; i < state.size(); ++i) sum += std::sqrt(etendue[i]) * state[i];
    return sum;
  };
  Fluxes result;
  for (std::size_t k = 0; k < result.back.size(); ++k) {
    const std::size_t beam = on_grid.grid.extra[k];
    std::vector<double> down(active_count(on_grid.grid, on_grid.ior.front()), 0.0);
    down[beam] = 1.0 / std::sqrt(etendue[beam]);
    const auto unscattered =
        detail::unscattered_flux(on_grid, beam, detail::Unscattered::by_medium);
    const double not_scattered = is_rough ? flux(detail::product(operators.first_reflection, down))
                                          : unscattered.reflectance;
    result.back[k] = flux(detail::product(operators.reflection, down)) - not_scattered;
    if (on_grid.is_semi_infinite || on_grid.ground_reflectance > 0.0) continue;
    for (const detail::Crossing& crossing : operators.crossings)
      down = detail::product(crossing.pass, down);
    result.through[k] = flux(down) - unscattered.down.back();
  }
  return result;
}

double largest_difference(const Fluxes& a, const Fluxes& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.back.size(); ++k)
    largest =
        std::max({largest, std::abs(a.back[k] - b.back[k]), std::abs(a.through[k] - b.through[k])});
  return largest;
}

struct Solved {
  Fluxes fluxes;
  double estimated_error = 1.0;
};

Solved solve(const LayerStack& stack, double accuracy) {
  constexpr int coarsest = 8, finest = 96;
  Solved result{scattered_flux(stack, coarsest)};
  for (int nodes = coarsest * 3 / 2; nodes <= finest && result.estimated_error > accuracy;
       nodes = nodes * 3 / 2) {
    const Fluxes finer = scattered_flux(stack, nodes);
    result = {finer, largest_difference(finer, result.fluxes)};
  }
  return result;
}

/// All scattered light, and what is left of it without the first order, over the boundary's share.
/// The first order has no noise, but both are quadratures: a rest below 0 is their error.
struct Split {
  Fluxes all, rest;
};

void split_angle(const Fluxes& fluxes, std::size_t k, double first_back, double first_through,
                 double surface, Split& split) {
  const double entered = std::max(1.0 - surface, 1e-12);
  split.all.back[k] = fluxes.back[k] / entered;
  split.all.through[k] = fluxes.through[k] / entered;
  split.rest.back[k] = std::max(fluxes.back[k] - first_back, 0.0) / entered;
  split.rest.through[k] = std::max(fluxes.through[k] - first_through, 0.0) / entered;
}

Split split_first_order(const LayerStack& stack, const Fluxes& fluxes) {
  const FirstOrderStack<double> first = make_first_order(stack);
  Split split;
  for (int i = 0; i < HigherOrders::angles; ++i) {
    const StackBeam<double> beam = make_beam(first, direction_of(cosine_at(i)));
    split_angle(fluxes, static_cast<std::size_t>(i), first_order_flux(first, beam, true),
                first_order_flux(first, beam, false), beam.surface, split);
  }
  return split;
}

/// Under a rough top the light that is not scattered at all has directions, too, and counts here.
Split split_first_order(const detail::RoughTop& top, const Fluxes& fluxes) {
  const detail::Hemispheres directions = detail::make_hemispheres(top);
  Split split;
  for (int i = 0; i < HigherOrders::angles; ++i) {
    const auto in = detail::cross_facets(top, direction_of(cosine_at(i)), detail::OfPair::first);
    const detail::VolumeFlux first = detail::volume_flux(top, in, directions);
    split_angle(fluxes, static_cast<std::size_t>(i), first.back, first.through, in.reflected,
                split);
  }
  return split;
}

/// Integral of 2 mu row(mu) (1 - surface(mu)) over the side's hemisphere.
template <class Surface>
double diffuse_mean(const HigherOrders::Row& row, const Surface& surface) {
  const Quadrature rule = gauss_legendre(4, 0.0, 1.0);
  constexpr int pieces = HigherOrders::angles - 1;
  double sum = 0.0;
  for (int piece = 0; piece < pieces; ++piece)
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
      const double x = (piece + rule.nodes[q]) / pieces, mu = x * x;
      sum += rule.weights[q] / pieces * 2.0 * x * 2.0 * mu * at(row, mu) * (1.0 - surface(mu));
    }
  return sum;
}

double diffuse_mean(const LayerStack& stack, const HigherOrders::Row& row) {
  const FirstOrderStack<double> first = make_first_order(stack);
  return diffuse_mean(row, [&](double mu) { return make_beam(first, direction_of(mu)).surface; });
}

}  // namespace

HigherOrders make_higher_orders(const LayerStack& given, double accuracy) {
  const LayerStack stack = with_smooth_top(given);
  detail::require_smooth(stack, "the term of higher orders");
  const Solved from_above = solve(stack, accuracy);
  const Split above = split_first_order(stack, from_above.fluxes);
  HigherOrders orders{.above = above.rest.back,
                      .down = above.rest.through,
                      .reflected = above.all.back,
                      .transmitted = above.all.through,
                      .mean_above = diffuse_mean(stack, above.rest.back),
                      .estimated_error = from_above.estimated_error};
  if (is_semi_infinite(stack) || stack.ground().reflectance > 0.0) return orders;
  const LayerStack turned = flipped(stack);
  const Solved from_below = solve(turned, accuracy);
  const Split below = split_first_order(turned, from_below.fluxes);
  orders.below = below.rest.back;
  orders.up = below.rest.through;
  orders.mean_below = diffuse_mean(turned, below.rest.back);
  orders.estimated_error = std::max(orders.estimated_error, from_below.estimated_error);
  // Equal by reciprocity, up to the errors of both.
  const double n_above = stack.ior_above(), n_below = stack.ior_below();
  orders.mean_through = 0.5 * (n_above * n_above * diffuse_mean(stack, orders.down) +
                               n_below * n_below * diffuse_mean(turned, orders.up));
  return orders;
}

HigherOrders detail::make_higher_orders(const LayerStack& stack, const RoughTop& top,
                                        double accuracy) {
  const Solved from_above = solve(stack, std::max(accuracy, rough_boundary_error));
  const Split above = split_first_order(top, from_above.fluxes);
  HigherOrders orders{.above = above.rest.back,
                      .down = above.rest.through,
                      .reflected = above.all.back,
                      .transmitted = above.all.through,
                      .mean_above = diffuse_mean(
                          above.rest.back, [&](double mu) { return reflectance(top.outside, mu); }),
                      .estimated_error = from_above.estimated_error};
  if (!top.below.is_transmissive()) return orders;
  // The shape over the angle below is that of the stack under a smooth top.
  const LayerStack turned = flipped(with_smooth_top(stack));
  orders.up = split_first_order(turned, solve(turned, accuracy).fluxes).rest.through;
  orders.mean_through = stack.ior_below() * stack.ior_below() * diffuse_mean(turned, orders.up);
  return orders;
}

double higher_orders_bsdf(const HigherOrders& orders, const StackBeam<double>& in,
                          const StackBeam<double>& out) {
  const bool from_above = in.toward.z >= 0.0, to_above = out.toward.z >= 0.0;
  const double entered = (1.0 - in.surface) * (1.0 - out.surface) / pi;
  const auto over = [&](double value, double mean) {
    return mean > 0.0 ? entered * value / mean : 0.0;
  };
  if (from_above && to_above)
    return over(at(orders.above, in.mu) * at(orders.above, out.mu), orders.mean_above);
  if (!from_above && !to_above)
    return over(at(orders.below, in.mu) * at(orders.below, out.mu), orders.mean_below);
  const double mu_above = from_above ? in.mu : out.mu, mu_below = from_above ? out.mu : in.mu;
  return out.ior * out.ior *
         over(at(orders.down, mu_above) * at(orders.up, mu_below), orders.mean_through);
}

}  // namespace lamina
