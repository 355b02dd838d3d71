// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/radiance_field.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>

#include "lamina/core/parallel.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr double most_nodes = 4e4;
constexpr double most_links = 8e6;  // over lanes
constexpr std::size_t most_links_of_node = 32, least_links_of_node = 16;
constexpr std::size_t chunk = 64;  // nodes that one thread takes at a time
constexpr int most_sweeps = 60;
constexpr float over_relaxation = 1.4f;
constexpr float tolerance = 2e-3f;  // of a sweep's change, over the brightest node

/// Places inside from where the segments of a node start.
struct Places {
  std::array<Vec3f, 8> at;
  std::size_t count = 0;
};

template <int N>
Places places_around(const WalkSpace<N>& space, const NodeLattice& lattice, std::size_t node,
                     Random& random) {
  const Vec3f middle = lattice.position(node);
  const float spacing = lattice.spacing();
  Places places;
  const bool is_deep = space.safe().at(middle) > 0.87f * spacing;  // half a diagonal
  if (is_deep && !space.is_inside(middle)) return places;
  for (std::size_t i = 0; i < places.at.size(); ++i) {
    const auto offset = [&](std::size_t bit) {  // one place in each eighth of the cell
      return 0.5f * spacing * (random.uniform_float() - static_cast<float>(i >> bit & 1u));
    };
    const Vec3f place = middle + Vec3f{offset(0), offset(1), offset(2)};
    if (is_deep || space.is_inside(place)) places.at[places.count++] = place;
  }
  return places;
}

/// Where segments from a node end: at other nodes, whose light they bring by a weight, and some
/// that is brought anyway.
template <int N>
struct Links {
  std::size_t of_node;
  std::vector<std::uint32_t> node;
  std::vector<Vec3f> direction;
  std::vector<BandValues<N>> weight, given;

  Links(std::size_t nodes, std::size_t each)
      : of_node(each),
        node(nodes * each),
        direction(nodes * each),
        weight(nodes * each),
        given(nodes * each) {}
};

/// What is known at the nodes next to one outside, so that places between them need no other rule.
template <class Known, class IsInside>
Known mean_around(const std::vector<Known>& known, const NodeLattice& lattice, std::size_t node,
                  const IsInside& is_inside) {
  Known total;
  float count = 0.0f;
  for (int i = 0; i < 27; ++i) {
    const Vec3f step{static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                     static_cast<float>(i / 9 - 1)};
    const std::size_t n = lattice.nearest(lattice.position(node) + lattice.spacing() * step).node;
    if (!is_inside(n)) continue;
    const float weight = 1.0f / dot(step, step);
    total.scattered += weight * known[n].scattered;
    total.lamps += weight * known[n].lamps;
    total.others += weight * known[n].others;
    count += weight;
  }
  if (!(count > 0.0f)) return {};
  return {(1.0f / count) * total.scattered, (1.0f / count) * total.lamps,
          (1.0f / count) * total.others};
}

}  // namespace

template <int N>
bool WalkLight<N>::find_out(const WalkSpace<N>& space, const WalkMedium<N>& reduced,
                            float free_path, const WalkLamps<N>& lamps,
                            const LightGatherer<N>& light, const Progress& progress) {
  const NodeLattice lattice = space.lattice(free_path, most_nodes);
  const std::size_t nodes = lattice.count();
  const std::uint64_t seed = space.scene().scene->render.seed;
  std::vector<Known> known(nodes);
  std::vector<Places> places(nodes);
  const auto is_inside = [&](std::size_t n) { return places[n].count > 0; };
  std::vector<Bands> reduced_lamps(nodes);  // scattered into any direction
  std::atomic<bool> is_stopped = false;
  const auto for_nodes = [&](const auto& body) {
    parallel_for((nodes + chunk - 1) / chunk, [&](std::size_t c) {
      if (!is_stopped && !report_progress(progress, 0.0)) is_stopped = true;
      if (is_stopped) return;
      for (std::size_t n = c * chunk; n < std::min((c + 1) * chunk, nodes); ++n) body(n);
    });
  };
  for_nodes([&](std::size_t n) {
    Random random = make_random(seed + 1, n);
    places[n] = places_around(space, lattice, n, random);
    const std::size_t count = places[n].count;
    if (count == 0) return;
    if (!lamps.are_there()) return;
    for (std::size_t i = 0; i < count; ++i) {
      const LampLight<N> lamp = lamps.known(places[n].at[i], light);
      const float share = 1.0f / static_cast<float>(count);
      known[n].lamps += share * lamp.fluence;
      reduced_lamps[n] += (0.25f / pi * share) * lamp.reduced;
      for (int axis = 0; axis < 3; ++axis) known[n].others[axis] += share * lamp.direction[axis];
      known[n].others[4] += share * lamp.spread;
    }
  });

  Links<N> links(nodes, std::clamp(static_cast<std::size_t>(most_links / N) / nodes,
                                   least_links_of_node, most_links_of_node));
  for_nodes([&](std::size_t n) {
    if (!is_inside(n)) return;
    WalkNumbers numbers(make_random(seed + 2, n));
    const Vec2f shift = numbers.pair();
    for (std::size_t i = 0; i < links.of_node; ++i) {
      const std::size_t k = n * links.of_node + i;
      links.node[k] = static_cast<std::uint32_t>(n);
      // Directions on a spiral, evenly over the sphere.
      const float z =
          1.0f - 2.0f * (static_cast<float>(i) + shift.x) / static_cast<float>(links.of_node);
      const float phi = 2.0f * pi * (shift.y + 0.618034f * static_cast<float>(i));
      const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
      links.direction[k] = {r * std::cos(phi), r * std::sin(phi), z};
      const Vec3f place = places[n].at[i % places[n].count];
      WalkPath<N> path{.ray = {place, links.direction[k]},
                       .carried = Bands::filled(1.0f),
                       .has_scattered = true,
                       .safe = std::max(space.safe().at(place), 0.0f)};
      const auto add_from_outside = [&](const WalkPath<N>& leaving, const WalkExit& exit) {
        PixelSamples samples(seed, static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(i));
        links.given[k] +=
            leaving.carried * lamps.light_from_outside(leaving, exit, light, samples,
                                                       [](const auto&, float) { return 1.0f; });
      };
      if (!space.advance(path, reduced, numbers, std::ref(add_from_outside))) continue;
      // One of the nodes around, by their weights.
      const NodeLattice::Corners corners = lattice.corners(path.ray.origin);
      float total = 0.0f;
      for (std::size_t c = 0; c < 8; ++c)
        if (is_inside(corners.node[c])) total += corners.weight[c];
      float left = total * numbers.stream().uniform_float();
      for (std::size_t c = 0; c < 8 && total > 0.0f; ++c) {
        if (!is_inside(corners.node[c])) continue;
        links.node[k] = static_cast<std::uint32_t>(corners.node[c]);
        links.weight[k] = path.carried;
        left -= corners.weight[c];
        if (left < 0.0f) break;
      }
      if (total > 0.0f) links.given[k] += path.carried * reduced_lamps[links.node[k]];
    }
  });

  if (is_stopped) return false;

  const float share = 1.0f / static_cast<float>(links.of_node);
  const auto brought = [&](std::size_t k) {
    return links.given[k] + links.weight[k] * known[links.node[k]].scattered;
  };
  const auto renew = [&](std::size_t n) {  // returns the change
    if (!is_inside(n)) return 0.0f;
    Bands sum;
    for (std::size_t k = n * links.of_node; k < (n + 1) * links.of_node; ++k) sum += brought(k);
    sum *= share;
    const Bands change = sum - known[n].scattered;
    known[n].scattered += over_relaxation * change;
    return largest(abs(change));
  };
  // Gauss and Seidel's iteration, to and fro, over-relaxed.
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    float change = 0.0f, brightest = 0.0f;
    for (std::size_t i = 0; i < nodes; ++i) {
      const std::size_t n = sweep % 2 ? nodes - 1 - i : i;
      change = std::max(change, renew(n));
      brightest = std::max(brightest, largest(known[n].scattered));
    }
    if (!(change > tolerance * brightest)) break;
  }
  for_nodes([&](std::size_t n) {
    if (!is_inside(n)) return;
    // What depends on the direction, to the first order.
    const float mean = sum(known[n].scattered);
    Vec3f moment;
    for (std::size_t k = n * links.of_node; k < (n + 1) * links.of_node; ++k)
      moment += (sum(brought(k)) - mean) * links.direction[k];
    const Vec3f flow = mean > 0.0f ? (3.0f * share / mean) * moment : Vec3f{};
    Bands squares;
    for (std::size_t k = n * links.of_node; k < (n + 1) * links.of_node; ++k) {
      const Bands d = brought(k) - (1.0f + dot(flow, links.direction[k])) * known[n].scattered;
      squares += d * d;
    }
    known[n].others[3] = std::sqrt(share * largest(squares));
    for (int axis = 0; axis < 3; ++axis) known[n].others[5 + axis] = flow[axis];
  });
  for_nodes([&](std::size_t n) {
    // Unlike in reality, lamps are weakened by the reduced extinction here. What that lets pass is
    // not straight any more.
    known[n].scattered += reduced_lamps[n] - (0.25f / pi) * known[n].lamps;
  });
  nodes_.resize(nodes);
  for_nodes([&](std::size_t n) {
    const Known node = is_inside(n) ? known[n] : mean_around(known, lattice, n, is_inside);
    nodes_[n] = {brief(node.scattered), brief(node.lamps), brief(node.others)};
  });
  if (!is_stopped) lattice_.push_back(lattice);
  return !is_stopped;
}

template <int N>
WalkLight<N>::Known WalkLight<N>::at(const Vec3f& p) const {
  if (lattice_.empty()) return {};
  const NodeLattice::Corners corners = lattice_[0].corners(p);
  Known sum;
  for (std::size_t i = 0; i < 8; ++i) {
    const Node& node = nodes_[corners.node[i]];
    sum.scattered += corners.weight[i] * in_full(node.scattered);
    sum.lamps += corners.weight[i] * in_full(node.lamps);
    sum.others += corners.weight[i] * in_full(node.others);
  }
  return sum;
}

template <int N>
void WalkLight<N>::scale(float factor) {
  for (Node& node : nodes_) {
    node.scattered = brief(factor * in_full(node.scattered));
    node.lamps = brief(factor * in_full(node.lamps));
  }
}

template class WalkLight<4>;
template class WalkLight<8>;
template class WalkLight<16>;

}  // namespace lamina
