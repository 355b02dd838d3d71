// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/radiance/radiance_field.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/parallel.h"

namespace lamina {
namespace {

// Noise over time: benchmarks/subsurface_methods; no mean depends on it.
constexpr double most_field_nodes = 4e4;
constexpr double most_links = 8e6;  // over lanes
constexpr std::size_t most_links_of_node = 32, least_links_of_node = 16;
constexpr std::size_t nodes_at_once = 64;  // nodes that one thread takes at a time
constexpr int most_sweeps = 60;
constexpr float over_relaxation = 1.4f;
constexpr float sweep_tolerance = 2e-3f;  // of a sweep's change, over the brightest node

/// Isotropic scattering in place of anisotropic, by similarity.
template <int N>
WalkMedium<N> make_reduced_medium(const WalkMedium<N>& medium, const BandValues<N>& mean_cosine,
                                  int bands) {
  const BandValues<N> sigma_s = medium.sigma_s - mean_cosine * medium.sigma_s;
  return make_walk_medium(sigma_s, sigma_s + (medium.sigma_t - medium.sigma_s), bands);
}

template <int N>
float shortest_free_path(const BandValues<N>& extinction) {
  return 1.0f / std::max(largest(extinction), 1e-6f);
}

/// Points inside from where the segments of a node start.
struct StartPoints {
  std::array<Vec3f, 8> at;
  std::size_t count = 0;
};

template <int N>
StartPoints points_around(const BodyInterior<N>& interior, const NodeLattice& lattice,
                          std::size_t node, Random& random) {
  const Vec3f middle = lattice.position(node);
  const float spacing = lattice.spacing();
  StartPoints points;
  const bool is_deep = interior.distance().at(middle) > 0.87f * spacing;  // half a diagonal
  if (is_deep && !interior.is_inside(middle)) return points;
  for (std::size_t i = 0; i < points.at.size(); ++i) {
    const auto offset = [&](std::size_t bit) {  // one point in each eighth of the cell
      return 0.5f * spacing * (random.uniform_float() - static_cast<float>(i >> bit & 1u));
    };
    const Vec3f point = middle + Vec3f{offset(0), offset(1), offset(2)};
    if (is_deep || interior.is_inside(point)) points.at[points.count++] = point;
  }
  return points;
}

/// Segments from nodes as a linear system: they end at other nodes, whose light arrives by a
/// weight, beside some that is given.
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

/// Scales the throughput of the segments of a node so that each band has as much as their mixture,
/// which never grows. By chance a band has more in few segments, most where bands differ much; and
/// where nodes send on more light than they get, it grows without end.
///
/// @param total  throughput of each band at the ends of the segments, before it scatters
template <int N>
void balance_bands(Links<N>& links, std::size_t node, const BandValues<N>& total, int bands) {
  float mixture = 0.0f;
  for (int b = 0; b < bands; ++b) mixture += total[b] / static_cast<float>(bands);
  auto scale = BandValues<N>::filled(1.0f);
  for (int b = 0; b < N; ++b)
    if (total[b] > 0.0f) scale[b] = mixture / total[b];
  for (std::size_t k = node * links.of_node; k < (node + 1) * links.of_node; ++k) {
    links.weight[k] *= scale;
    links.given[k] *= scale;
  }
}

constexpr float isotropic = 0.25f / float_pi;

/// As they are stored: to_light, deviation, direct_deviation, net_flux.
template <int N>
BandValues<8> moments_of(const FieldRadiance<N>& value) {
  BandValues<8> moments;
  for (int axis = 0; axis < 3; ++axis) {
    moments[axis] = value.to_light[axis];
    moments[5 + axis] = value.net_flux[axis];
  }
  moments[3] = value.deviation;
  moments[4] = value.direct_deviation;
  return moments;
}

template <int N>
FieldRadiance<N> with_moments(const BandValues<N>& direct_fluence, const BandValues<N>& scattered,
                              const BandValues<8>& moments) {
  return {.direct_fluence = direct_fluence,
          .scattered = scattered,
          .to_light = {moments[0], moments[1], moments[2]},
          .deviation = moments[3],
          .direct_deviation = moments[4],
          .net_flux = {moments[5], moments[6], moments[7]}};
}

/// The field at a node outside: that at the nodes next to it, so that points between them need no
/// other rule.
template <int N, class IsInside>
FieldRadiance<N> mean_around(const std::vector<FieldRadiance<N>>& field, const NodeLattice& lattice,
                             std::size_t node, const IsInside& is_inside) {
  BandValues<N> direct, scattered;
  BandValues<8> moments;
  float count = 0.0f;
  for (int i = 0; i < 27; ++i) {
    const Vec3f step{static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                     static_cast<float>(i / 9 - 1)};
    const std::size_t n = lattice.nearest(lattice.position(node) + lattice.spacing() * step).node;
    if (!is_inside(n)) continue;
    const float weight = 1.0f / dot(step, step);
    scattered += weight * field[n].scattered;
    direct += weight * field[n].direct_fluence;
    moments += weight * moments_of(field[n]);
    count += weight;
  }
  if (!(count > 0.0f)) return {};
  const float scale = 1.0f / count;
  return with_moments(scale * direct, scale * scattered, scale * moments);
}

/// Adds the mean direct light of the points of a node.
/// @param reduced  its mean radiance, attenuated by the reduced extinction
template <int N>
void add_direct(const DirectLightField<N>& direct_light, const StartPoints& points,
                const LightGatherer<N>& light, FieldRadiance<N>& field, BandValues<N>& reduced) {
  const float fraction = 1.0f / static_cast<float>(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    const DirectFluence<N> direct = direct_light.at(points.at[i], light);
    field.direct_fluence += fraction * direct.fluence;
    reduced += (isotropic * fraction) * direct.reduced_fluence;
    field.to_light += fraction * direct.to_light;
    field.direct_deviation += fraction * direct.deviation;
  }
}

/// Extinction over scattering; 0 where nothing is scattered.
template <int N>
BandValues<N> inverse_albedo(const WalkMedium<N>& medium) {
  BandValues<N> per_albedo;
  for (int b = 0; b < N; ++b)
    if (medium.sigma_s[b] > 0.0f) per_albedo[b] = medium.sigma_t[b] / medium.sigma_s[b];
  return per_albedo;
}

/// Scattered light of the nodes by the system of their links.
template <int N>
class FieldSweeps {
 public:
  FieldSweeps(const Links<N>& links, std::vector<FieldRadiance<N>>& field)
      : links_(links), field_(field), fraction_(1.0f / static_cast<float>(links.of_node)) {}

  /// Gauss and Seidel's iteration, to and fro, over-relaxed.
  template <class IsInside>
  void iterate(const IsInside& is_inside) {
    const std::size_t nodes = field_.size();
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      float change = 0.0f, brightest = 0.0f;
      for (std::size_t i = 0; i < nodes; ++i) {
        const std::size_t n = sweep % 2 ? nodes - 1 - i : i;
        change = std::max(change, is_inside(n) ? renew(n) : 0.0f);
        brightest = std::max(brightest, largest(field_[n].scattered));
      }
      if (!(change > sweep_tolerance * brightest)) break;
    }
  }

  /// Net flux of the light that arrives at a node, and how far it is from its P1 moment.
  void find_moments(std::size_t n) {
    const float mean = sum(field_[n].scattered);
    Vec3f moment;
    for (std::size_t k = n * links_.of_node; k < (n + 1) * links_.of_node; ++k)
      moment += (sum(arriving(k)) - mean) * links_.direction[k];
    const Vec3f net_flux = mean > 0.0f ? (3.0f * fraction_ / mean) * moment : Vec3f{};
    BandValues<N> squares;
    for (std::size_t k = n * links_.of_node; k < (n + 1) * links_.of_node; ++k) {
      const BandValues<N> d =
          arriving(k) - (1.0f + dot(net_flux, links_.direction[k])) * field_[n].scattered;
      squares += d * d;
    }
    field_[n].deviation = std::sqrt(fraction_ * largest(squares));
    field_[n].net_flux = net_flux;
  }

 private:
  [[nodiscard]] BandValues<N> arriving(std::size_t k) const {
    return links_.given[k] + links_.weight[k] * field_[links_.node[k]].scattered;
  }
  /// @return the change
  float renew(std::size_t n) {
    BandValues<N> arrived;
    for (std::size_t k = n * links_.of_node; k < (n + 1) * links_.of_node; ++k)
      arrived += arriving(k);
    arrived *= fraction_;
    const BandValues<N> change = arrived - field_[n].scattered;
    field_[n].scattered += over_relaxation * change;
    return largest(abs(change));
  }

  const Links<N>& links_;
  std::vector<FieldRadiance<N>>& field_;
  float fraction_;
};

/// Direction on a spiral, evenly over the sphere.
Vec3f spiral_direction(std::size_t i, std::size_t count, const Vec2f& shift) {
  const float z = 1.0f - 2.0f * (static_cast<float>(i) + shift.x) / static_cast<float>(count);
  const float phi = 2.0f * float_pi * (shift.y + 0.618034f * static_cast<float>(i));
  const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Ends a segment at one of the nodes around a point, drawn by their weights.
/// @return whether there is one
template <int N, class IsInside>
bool end_segment(Links<N>& links, std::size_t k, const NodeLattice::Corners& corners,
                 const BandValues<N>& throughput, float u, const IsInside& is_inside) {
  float around = 0.0f;
  for (std::size_t c = 0; c < 8; ++c)
    if (is_inside(corners.node[c])) around += corners.weight[c];
  float left = around * u;
  for (std::size_t c = 0; c < 8 && around > 0.0f; ++c) {
    if (!is_inside(corners.node[c])) continue;
    links.node[k] = static_cast<std::uint32_t>(corners.node[c]);
    links.weight[k] = throughput;
    left -= corners.weight[c];
    if (left < 0.0f) break;
  }
  return around > 0.0f;
}

}  // namespace

template <int N>
RadianceField<N>::RadianceField(const BodyInterior<N>& interior,
                                const ManifoldNextEvent<N>& next_event, const WalkMedium<N>& medium,
                                const Bands& mean_cosine)
    : interior_(interior),
      next_event_(next_event),
      reduced_(make_reduced_medium(medium, mean_cosine, interior.bands())),
      reduced_free_path_(shortest_free_path(reduced_.sigma_t)),
      direct_(interior, next_event, medium.sigma_t, reduced_.sigma_t,
              shortest_free_path(medium.sigma_t)) {
  for (int b = 0; b < N; ++b)
    reduction_[b] = medium.sigma_t[b] > 0.0f ? reduced_.sigma_t[b] / medium.sigma_t[b] : 1.0f;
}

template <int N>
bool RadianceField<N>::solve(const LightGatherer<N>& light, const Progress& progress) {
  const NodeLattice lattice = interior_.lattice(reduced_free_path_, most_field_nodes);
  const std::size_t nodes = lattice.count();
  const std::uint64_t seed = interior_.scene().settings.seed;
  std::vector<FieldRadiance<N>> field(nodes);
  std::vector<StartPoints> points(nodes);
  const auto is_inside = [&](std::size_t n) { return points[n].count > 0; };
  std::vector<Bands> reduced_direct(nodes);  // its mean radiance
  std::atomic<bool> is_stopped = false;
  const auto for_nodes = [&](const auto& body) {
    parallel_for((nodes + nodes_at_once - 1) / nodes_at_once, [&](std::size_t c) {
      if (!is_stopped && !report_progress(progress, 0.0)) is_stopped = true;
      if (is_stopped) return;
      for (std::size_t n = c * nodes_at_once; n < std::min((c + 1) * nodes_at_once, nodes); ++n)
        body(n);
    });
  };
  for_nodes([&](std::size_t n) {
    Random random = make_random(seed + 1, n);
    points[n] = points_around(interior_, lattice, n, random);
    if (points[n].count > 0 && next_event_.has_lights())
      add_direct(direct_, points[n], light, field[n], reduced_direct[n]);
  });

  const Bands per_albedo = inverse_albedo(reduced_);
  Links<N> links(nodes, std::clamp(static_cast<std::size_t>(most_links / N) / nodes,
                                   least_links_of_node, most_links_of_node));
  for_nodes([&](std::size_t n) {
    if (!is_inside(n)) return;
    WalkNumbers numbers(make_random(seed + 2, n));
    const Vec2f shift = numbers.pair();
    Bands total;
    for (std::size_t i = 0; i < links.of_node; ++i) {
      const std::size_t k = n * links.of_node + i;
      links.node[k] = static_cast<std::uint32_t>(n);
      links.direction[k] = spiral_direction(i, links.of_node, shift);
      const Vec3f start = points[n].at[i % points[n].count];
      WalkPath<N> path{.ray = {start, links.direction[k]},
                       .throughput = Bands::filled(1.0f),
                       .events = 2,  // leaves by chance: all that it finds is one value
                       .has_scattered = true,
                       .clearance = std::max(interior_.distance().at(start), 0.0f)};
      path.last.ray = path.ray;
      const auto add_escaping = [&](const WalkPath<N>& leaving, const WalkExit& exit) {
        PixelSamples samples(seed, static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(i));
        total += leaving.throughput;
        links.given[k] += leaving.throughput * next_event_.escaping_radiance(
                                                   leaving, exit, light, samples,
                                                   [](const auto&, float) { return 1.0f; },
                                                   [](const LightSeen&) { return 1.0f; });
      };
      if (!interior_.advance(path, reduced_, numbers, std::ref(add_escaping))) continue;
      total += per_albedo * path.throughput;
      if (end_segment(links, k, lattice.corners(path.ray.origin), path.throughput,
                      numbers.stream().uniform_float(), is_inside))
        links.given[k] += path.throughput * reduced_direct[links.node[k]];
    }
    balance_bands(links, n, total, interior_.bands());
  });
  if (is_stopped) return false;
  FieldSweeps<N> sweeps(links, field);
  sweeps.iterate(is_inside);
  for_nodes([&](std::size_t n) {
    if (is_inside(n)) sweeps.find_moments(n);
  });
  for_nodes([&](std::size_t n) {
    // Direct light is attenuated by the reduced extinction here. What passes that beside the true
    // direct light has been scattered forward.
    field[n].scattered += reduced_direct[n] - isotropic * field[n].direct_fluence;
  });
  nodes_.resize(nodes);
  for_nodes([&](std::size_t n) {
    const FieldRadiance<N> node =
        is_inside(n) ? field[n] : mean_around(field, lattice, n, is_inside);
    nodes_[n] = {brief(node.scattered), brief(node.direct_fluence), brief(moments_of(node))};
  });
  if (!is_stopped) lattice_ = lattice;
  return !is_stopped;
}

template <int N>
FieldRadiance<N> RadianceField<N>::at(const Vec3f& p, bool in_detail,
                                      const LightGatherer<N>& light) const {
  FieldRadiance<N> here;
  if (lattice_) {
    const NodeLattice::Corners corners = lattice_->corners(p);
    Bands direct, scattered;
    BandValues<8> moments;
    for (std::size_t i = 0; i < 8; ++i) {
      const Node& node = nodes_[corners.node[i]];
      scattered += corners.weight[i] * in_full(node.scattered);
      direct += corners.weight[i] * in_full(node.direct_fluence);
      moments += corners.weight[i] * in_full(node.moments);
    }
    here = with_moments(direct, scattered, moments);
    here.directed = reduction_ * scattered;
  }
  if (next_event_.has_lights() && (in_detail || !here.is_solved())) {
    const DirectFluence<N> direct = direct_.at(p, light);
    here.direct_fluence = direct.fluence;
    here.to_light = direct.to_light;
    here.direct_deviation = direct.deviation;
  }
  return here;
}

template <int N>
void RadianceField<N>::scale(float factor) {
  for (Node& node : nodes_) {
    node.scattered = brief(factor * in_full(node.scattered));
    node.direct_fluence = brief(factor * in_full(node.direct_fluence));
  }
}

template class RadianceField<4>;
template class RadianceField<8>;
template class RadianceField<16>;

}  // namespace lamina
