// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/low_orders/unscattered_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"

namespace lamina::detail {
namespace {

using std::numbers::pi;

constexpr double least_path = 1e-7;

/// The widest p that is in every medium, under a rough top in every one below.
double widest(const GridStack& stack) {
  return *std::min_element(stack.ior.begin() + (has_rough_top(stack) ? 1 : 0), stack.ior.end());
}

/// A rough top's reflections inside are no mirror's: light that meets them is none of these paths.
bool is_under_rough_top(const GridStack& stack, const UnscatteredPath& path) {
  return has_rough_top(stack) && path.mirrors[0] > 0;
}

/// What the interfaces leave, a rough top apart.
double fresnel_factor(const GridStack& stack, const UnscatteredPath& path, double p) {
  double factor = path.count;
  for (std::size_t q = has_rough_top(stack) ? 1 : 0; q < path.crossings.size(); ++q) {
    const double r = interface_reflectance(stack, q, p);
    factor *= std::pow(1.0 - r, path.crossings[q]) * std::pow(r, path.mirrors[q]);
  }
  return factor;
}

double depth_along(const GridStack& stack, const UnscatteredPath& path, double p) {
  double depth = 0.0;
  for (std::size_t l = 0; l < stack.layers.size(); ++l)
    if (path.passes[l] > 0 && stack.layers[l].sigma_t > 0.0)
      depth += path.passes[l] * stack.layers[l].sigma_t * stack.layers[l].thickness /
               ray_cos(p, stack.layers[l].ior);
  return depth;
}

double aside(const GridStack& stack, const UnscatteredPath& path, double p) {
  double x = 0.0;
  for (std::size_t l = 0; l < stack.layers.size(); ++l)
    if (path.passes[l] > 0)
      x += path.passes[l] * stack.layers[l].thickness * p /
           (stack.layers[l].ior * ray_cos(p, stack.layers[l].ior));
  return x;
}

/// p in [0, highest] at which a growing distance(p) reaches x, which it does.
template <class Distance>
double p_where(const Distance& distance, double highest, double x) {
  double low = 0.0, high = 0.5 * pi;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    (distance(highest * std::sin(middle)) > x ? high : low) = middle;
  }
  return highest * std::sin(0.5 * (low + high));
}

/// Flux per p of light that goes along a path.
double flux_per_p(const FrequencySolver& solver, const UnscatteredPath& path, double p) {
  const GridStack& stack = solver.stack;
  double flux = fresnel_factor(stack, path, p) * std::exp(-depth_along(stack, path, p));
  if (solver.top.is_rough)
    flux *= solver.top.in_at(p) * (path.crossings[0] > 1 ? solver.top.out_at(p) : 1.0);
  return flux * 2.0 * p / (stack.ior[0] * stack.ior[0]);
}

/// Mean density between two radii.
double unscattered_mean(const FrequencySolver& solver, const UnscatteredPath& path, double begin,
                        double end) {
  static const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
  const GridStack& stack = solver.stack;
  const double highest = widest(stack);
  const auto angle_at = [&](double r) {
    const auto distance = [&](double p) { return aside(stack, path, p); };
    return distance(highest) <= r
               ? 0.5 * pi
               : std::asin(std::min(1.0, p_where(distance, highest, r) / highest));
  };
  const double from = angle_at(begin), to = angle_at(end);
  if (!(to > from)) return 0.0;
  double flux = 0.0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double angle = from + (to - from) * rule.nodes[i];
    flux += rule.weights[i] * (to - from) * highest * std::cos(angle) *
            flux_per_p(solver, path, highest * std::sin(angle));
  }
  return flux / (pi * (end - begin) * (end + begin));
}

}  // namespace

std::vector<UnscatteredPath> unscattered_paths(const GridStack& stack, int most_mirrors) {
  struct Ray {
    UnscatteredPath path;
    std::size_t medium;  ///< 0 is above
    bool is_down;
  };
  const std::size_t layers = stack.layers.size();
  const double highest = widest(stack);
  const auto strength = [&](const UnscatteredPath& path) {
    double most = 0.0;
    for (const double share : {0.0, 0.5, 0.8, 0.95, 0.995})
      most = std::max(most, fresnel_factor(stack, path, share * highest) *
                                std::exp(-depth_along(stack, path, share * highest)));
    return most;
  };
  Ray start{.path = {.passes = std::vector<int>(layers),
                     .crossings = std::vector<int>(layers + 1),
                     .mirrors = std::vector<int>(layers + 1)},
            .medium = 1,
            .is_down = true};
  start.path.crossings[0] = 1;
  std::vector<Ray> going{start};
  std::vector<UnscatteredPath> found;
  const auto add = [&](UnscatteredPath path, bool is_up) {
    path.is_up = is_up;
    for (UnscatteredPath& other : found)
      if (other.passes == path.passes && other.crossings == path.crossings &&
          other.mirrors == path.mirrors && other.is_up == is_up) {
        other.count += path.count;
        return;
      }
    found.push_back(std::move(path));
  };
  int mirrors = 0;
  while (!going.empty()) {
    Ray ray = std::move(going.back());
    going.pop_back();
    ++ray.path.passes[ray.medium - 1];
    if (!std::isfinite(stack.layers[ray.medium - 1].thickness)) continue;
    const std::size_t interface = ray.is_down ? ray.medium : ray.medium - 1;
    Ray mirrored = ray;
    ++mirrored.path.mirrors[interface];
    mirrored.is_down = !ray.is_down;
    mirrors = 0;
    for (const int m : mirrored.path.mirrors) mirrors += m;
    if (mirrors <= most_mirrors && !is_under_rough_top(stack, mirrored.path) &&
        strength(mirrored.path) > least_path)
      going.push_back(mirrored);
    ++ray.path.crossings[interface];
    if (strength(ray.path) <= least_path) continue;
    ray.medium = ray.is_down ? ray.medium + 1 : ray.medium - 1;
    if (ray.medium == 0)
      add(std::move(ray.path), true);
    else if (ray.medium <= layers)
      going.push_back(std::move(ray));
    else if (has_open_bottom(stack))
      add(std::move(ray.path), false);
  }
  return found;
}

FrequencyResponse unscattered_response(const FrequencySolver& solver,
                                       const std::vector<UnscatteredPath>& paths, double k) {
  const auto& [stack, waves, top] = std::tie(solver.stack, solver.waves, solver.top);
  const double above2 = stack.ior[0] * stack.ior[0];
  FrequencyResponse result;
  for (const UnscatteredPath& path : paths) {
    double sum = 0.0;
    for (std::size_t i = 0; i < active_count(stack.grid, widest(stack)); ++i) {
      if (i == stack.grid.extra[0]) continue;
      const double p = stack.grid.p[i];
      double depth = 0.0;
      for (std::size_t l = 0; l < stack.layers.size(); ++l)
        if (path.passes[l] > 0)
          depth += path.passes[l] * node_extinction(stack.layers[l], i) *
                   stack.layers[l].thickness / stack.layers[l].cos[i];
      const double c = k * aside(stack, path, p);
      double mean = 0.0;
      for (std::size_t q = 0; q < waves.rate.size(); ++q)
        mean += (waves.weight[0][q] * std::exp(waves.rate[q] * c)).real();
      double light =
          stack.grid.etendue[i] / above2 * fresnel_factor(stack, path, p) * std::exp(-depth) * mean;
      if (top.is_rough) light *= top.in[i] * (path.crossings[0] > 1 ? top.out[i] : 1.0);
      sum += light;
    }
    (path.is_up ? result.reflectance : result.transmittance) += sum;
  }
  return result;
}

SingleScatteringProfile unscattered_ring(const FrequencySolver& solver,
                                         const std::vector<UnscatteredPath>& paths, double begin,
                                         double end) {
  SingleScatteringProfile profile;
  for (const UnscatteredPath& path : paths)
    (path.is_up ? profile.reflectance : profile.transmittance) +=
        unscattered_mean(solver, path, begin, end);
  return profile;
}

}  // namespace lamina::detail
