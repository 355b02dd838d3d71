// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/internal/way_out.h"

namespace lamina::detail {
namespace {

constexpr double negligible_way = 1e-5;  ///< of the light that a layer scatters once
constexpr std::size_t most_ways = 1000;  ///< of one layer, going on at the same time

// ------------------------------------------------------------------------------ finding the ways

constexpr std::size_t samples = 24;
using Amplitude = std::array<double, samples>;  ///< at some p from 0 to the widest that gets out

/// Ways that are still inside: before a face, alike in all that they have met.
struct Inside {
  WayOut way;
  Amplitude amplitude;
};

struct Sampling {
  Amplitude p, weight;  ///< weight of each in etendue, their sum 1
};

Sampling make_sampling(double widest) {
  const Quadrature rule = gauss_legendre(samples, 0.0, 0.5 * std::numbers::pi);
  Sampling sampling{};
  for (std::size_t i = 0; i < samples; ++i) {
    sampling.p[i] = widest * std::sin(rule.nodes[i]);
    sampling.weight[i] = rule.weights[i] * std::sin(2.0 * rule.nodes[i]);
  }
  return sampling;
}

/// All ways from one layer, starting up or down.
void find_ways(const GridStack& stack, std::size_t source, bool starts_up, double threshold,
               std::vector<WayOut>& found) {
  const std::size_t layers = stack.layers.size();
  const bool has_below = !stack.is_semi_infinite && stack.ground_reflectance == 0.0;
  const Sampling sampling = make_sampling(std::max(
      widest_out(stack, source, true), has_below ? widest_out(stack, source, false) : 0.0));
  using Key = std::tuple<std::size_t, bool, std::vector<int>, std::vector<int>, std::vector<int>>;
  std::map<Key, Inside> going;  // by the interface before them, their direction, what they met
  WayOut start{.source = source, .starts_up = starts_up};
  start.crossings.assign(layers, 0);
  start.reflections.assign(layers + 1, 0);
  start.passages.assign(layers + 1, 0);
  Amplitude ones{};
  ones.fill(1.0);
  const auto join = [&](std::map<Key, Inside>& to, std::size_t face, bool is_up, Inside inside) {
    const WayOut& way = inside.way;
    const Key key{face, is_up, way.crossings, way.reflections, way.passages};
    const auto [place, is_new] = to.try_emplace(key, inside);
    if (is_new) return;
    place->second.way.count += way.count;
    for (std::size_t i = 0; i < samples; ++i) place->second.amplitude[i] += inside.amplitude[i];
  };
  join(going, starts_up ? source : source + 1, starts_up, {start, ones});
  while (!going.empty() && going.size() < most_ways) {
    std::map<Key, Inside> next;
    for (const auto& [key, inside] : going) {
      const std::size_t face = std::get<0>(key);
      const bool is_up = std::get<1>(key);
      for (const bool is_reflected : {false, true}) {
        Inside after = inside;
        (is_reflected ? after.way.reflections : after.way.passages)[face] += 1;
        const bool goes_up = is_up != is_reflected;
        const bool leaves = goes_up ? face == 0 : face == layers;
        const std::size_t layer = goes_up ? face - 1 : face;  // the one to cross next
        const bool ends = !leaves && !std::isfinite(stack.layers[layer].thickness);
        if (ends || (leaves && !goes_up && !has_below)) continue;
        double total = 0.0;
        for (std::size_t i = 0; i < samples; ++i) {
          const double p = sampling.p[i], r = face_reflectance(stack, face, p);
          after.amplitude[i] *= is_reflected ? r : 1.0 - r;
          if (!leaves && p >= stack.layers[layer].ior) after.amplitude[i] = 0.0;
          if (!leaves && after.amplitude[i] > 0.0)
            after.amplitude[i] *=
                std::exp(-stack.layers[layer].sigma_t * stack.layers[layer].thickness /
                         cos_of(p, stack.layers[layer].ior));
          total += sampling.weight[i] * after.amplitude[i];
        }
        if (total < threshold) continue;
        if (leaves) {
          after.way.ends_above = goes_up;
          found.push_back(after.way);
          continue;
        }
        after.way.crossings[layer] += 1;
        join(next, goes_up ? layer : layer + 1, goes_up, std::move(after));
      }
    }
    going = std::move(next);
  }
}

// ------------------------------------------------------------------------------ light of one way

/// Angle theta, p = widest sin(theta), at which a distance that grows with p reaches r.
template <class Distance>
double angle_where(const Distance& distance, double widest, double r) {
  double low = 0.0, high = 0.5 * std::numbers::pi;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    (distance(widest * std::sin(middle)) > r ? high : low) = middle;
  }
  return high;
}

const Quadrature& panel_rule() {
  static const Quadrature rule = gauss_legendre(12, 0.0, 1.0);
  return rule;
}

/// Light of one way that leaves at distance r: one integral over the angle, whose every angle has
/// one depth from which it arrives at r.
double from_way(const OnceScattered& light, const WayOut& way, double r) {
  const GridStack& stack = light.stack;
  const GridLayer& layer = stack.layers[way.source];
  const double widest = widest_out(stack, way.source, way.ends_above), d = layer.thickness;
  const double down = light.beam.down[2 * way.source], up = light.beam.up[2 * way.source + 1];
  const double beam_near = way.starts_up ? down : up, beam_far = way.starts_up ? up : down;
  const auto near_edge = [&](double p) { return aside(stack, way, p); };
  const auto far_edge = [&](double p) { return near_edge(p) + d * tangent(p, layer.ior); };
  const bool is_straight = std::ranges::all_of(way.reflections, [](int n) { return n == 0; });
  const double from = std::isfinite(d) ? angle_where(far_edge, widest, r) : 0.0;
  if (!(from < 0.5 * std::numbers::pi)) return 0.0;
  const double to = angle_where(near_edge, widest, r);
  if (!(to > from)) return 0.0;
  const auto density = [&](double theta) {
    const double p = widest * std::sin(theta), cos = cos_of(p, layer.ior);
    const double tan = tangent(p, layer.ior);
    if (!(tan > 0.0) || !(cos > 0.0)) return 0.0;
    const double z = std::clamp((r - aside(stack, way, p)) / tan, 0.0, d);  // from the near face
    const double sigma = layer.sigma_t;
    const PhaseFunction& phase = light.phase[way.source];
    double source = beam_near * std::exp(-sigma * z) * evaluate(phase, -cos);
    if (beam_far > 0.0) source += beam_far * std::exp(-sigma * (d - z)) * evaluate(phase, cos);
    return source * std::exp(-sigma * z / cos) * through(stack, way, p) * widest * std::cos(theta) *
           p / (layer.ior * layer.ior * cos * tan);
  };
  double sum = 0.0;
  const auto add_panel = [&](double low, double high, bool is_clustered) {
    for (std::size_t i = 0; i < panel_rule().nodes.size(); ++i) {
      const double t = panel_rule().nodes[i];
      const double share = is_clustered ? t * t * (3.0 - 2.0 * t) : t;
      const double slope = is_clustered ? 6.0 * t * (1.0 - t) : 1.0;
      sum += (high - low) * slope * panel_rule().weights[i] * density(low + (high - low) * share);
    }
  };
  std::vector<double> cuts{from, to};
  if (is_straight) {
    // The light of small r comes from small angles: panels in a geometric series from the first.
    constexpr int panels = 16;
    for (int panel = 0; panel + 1 < panels; ++panel)
      cuts.push_back(from +
                     (to - from) * std::pow(10.0, -5.0 * (panels - 1 - panel) / (panels - 1)));
  } else {
    // Cut at the critical angles that it meets.
    for (const double ior : stack.ior)
      if (ior < widest) cuts.push_back(std::asin(ior / widest));
  }
  // Cut where the light from deep inside is gone: below other layers it all comes in within a
  // narrow range of angles.
  const bool is_buried = std::ranges::any_of(way.crossings, [](int n) { return n > 0; });
  if (is_buried || !is_straight)
    for (const double depth : {0.75, 3.0, 9.0, 27.0})
      if (d * layer.sigma_t > depth)
        cuts.push_back(angle_where(
            [&](double p) { return near_edge(p) + depth / layer.sigma_t * tangent(p, layer.ior); },
            widest, r));
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t c = 1; c < cuts.size(); ++c)
    if (cuts[c - 1] >= from && cuts[c] <= to && cuts[c] > cuts[c - 1])
      add_panel(cuts[c - 1], cuts[c], !is_straight);
  // Over azimuth the phase function, a density over the sphere, counts 2 pi times.
  return sum * light.sigma_s[way.source] * 2.0 * std::numbers::pi / (2.0 * std::numbers::pi * r);
}

}  // namespace

OnceScattered make_once_scattered(const LayerStack& stack, GridStack on_grid) {
  OnceScattered light{.stack = std::move(on_grid)};
  light.beam = unscattered_flux(light.stack, light.stack.grid.extra[0], Unscattered::scaled);
  std::vector<double> scattered;  // [layer]
  for (std::size_t l = 0; l < light.stack.layers.size(); ++l) {
    light.phase.push_back(phase_function(stack.layers()[l]));
    light.sigma_s.push_back(stack.layers()[l].medium.sigma_s);
    const GridLayer& layer = light.stack.layers[l];
    const double stopped = -std::expm1(-layer.sigma_t * layer.thickness);
    scattered.push_back(layer.sigma_s > 0.0
                            ? light.beam.down[2 * l] * stopped * layer.sigma_s / layer.sigma_t
                            : 0.0);
  }
  const double most = *std::max_element(scattered.begin(), scattered.end());
  for (std::size_t l = 0; l < scattered.size(); ++l)
    for (const bool starts_up : {true, false})
      if (scattered[l] > 0.0 && (starts_up || std::isfinite(light.stack.layers[l].thickness)))
        find_ways(light.stack, l, starts_up, negligible_way * std::min(1.0, most / scattered[l]),
                  light.ways);
  return light;
}

SingleScatteringProfile single_scattering_profile(const OnceScattered& light, double r) {
  SingleScatteringProfile profile;
  for (const WayOut& way : light.ways)
    (way.ends_above ? profile.reflectance : profile.transmittance) += from_way(light, way, r);
  return profile;
}

}  // namespace lamina::detail
