// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/manifold_next_event.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "lamina/optics/fresnel.h"

namespace lamina {
namespace {

constexpr float same_way = 0.02f;  // distance of two exits that are one, over the path to them
constexpr int searches_of_node = 8;
constexpr double most_nodes = 2e5;

/// exp(x) where |x| is below about 1: what is far from there is not far from the truth.
template <int N>
[[gnu::always_inline]] inline BandValues<N> near_exponential(const BandValues<N>& x) {
  const BandValues<N> one = BandValues<N>::filled(1.0f);
  const BandValues<N> y = min(max(x, BandValues<N>::filled(-1.5f)), BandValues<N>::filled(2.0f));
  return one + y * (one + 0.5f * y * (one + (1.0f / 3.0f) * y));
}

}  // namespace

template <int N>
WalkLamps<N>::WalkLamps(const WalkSpace<N>& space, const Bands& sigma_t,
                        const Bands& reduced_sigma_t, float free_path)
    : space_(space),
      sigma_t_(sigma_t),
      reduced_sigma_t_(reduced_sigma_t),
      are_there_(space.scene().lights.has_next_event_light()),
      lattice_(space.lattice(free_path, most_nodes)),
      nodes_(lattice_.count()) {
  is_reduced_ = largest(abs(sigma_t - reduced_sigma_t)) > 1e-6f * largest(sigma_t);
}

/// The mean of searches from places inside, each carried to their middle along its beam.
template <int N>
WalkLamps<N>::Node WalkLamps<N>::search_around(std::size_t node,
                                               const LightGatherer<N>& light) const {
  Random random = make_random(space_.scene().scene->render.seed, node);
  std::array<Vec3f, searches_of_node> places;
  std::size_t count = 0;
  Node result;
  for (int i = 0; i < searches_of_node; ++i) {
    const auto offset = [&] { return lattice_.spacing() * (random.uniform_float() - 0.5f); };
    const Vec3f place = lattice_.position(node) + Vec3f{offset(), offset(), offset()};
    if (!space_.is_inside(place)) continue;
    places[count++] = place;
    result.place += place;
  }
  if (count == 0) return {};
  const float share = 1.0f / static_cast<float>(count);
  result.place *= share;
  std::array<float, searches_of_node> found{};
  LampLight<N>& sum = result.light;
  float brightness = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float u_light = (static_cast<float>(i) + random.uniform_float()) * share;
    const Vec2f u{random.uniform_float(), random.uniform_float()};
    search(places[i], u_light, u, light, [&](const FoundLamp<N>& lamp) {
      const Vec3f& direction = lamp.entry.to_surface;
      const float length =
          std::max(lamp.entry.length - dot(result.place - places[i], direction), 0.0f);
      const Bands fluence = exp_minus(length * sigma_t_) * lamp.unweakened;
      const float here = largest(fluence);
      sum.fluence += share * fluence;
      sum.reduced += share * exp_minus(length * reduced_sigma_t_) * lamp.unweakened;
      sum.direction += here * direction;
      brightness += here;
      found[i] += here;
    });
  }
  if (brightness > 0.0f) sum.direction *= 1.0f / brightness;
  for (std::size_t i = 0; i < count; ++i)
    sum.spread = std::max(sum.spread, std::abs(found[i] - share * brightness));
  sum.weight = 1.0f;
  return result;
}

template <int N>
LampLight<N> WalkLamps<N>::known(const Vec3f& p, const LightGatherer<N>& light) const {
  const NodeLattice::Corners corners = lattice_.corners(p);
  LampLight<N> sum;
  for (std::size_t i = 0; i < 8; ++i) {
    const Node& node =
        nodes_.at(corners.node[i], [&](std::size_t k) { return search_around(k, light); });
    const float weight = corners.weight[i] * node.light.weight;
    const float nearer = dot(p - node.place, node.light.direction);
    sum.fluence += weight * near_exponential(nearer * sigma_t_) * node.light.fluence;
    if (is_reduced_)
      sum.reduced += weight * near_exponential(nearer * reduced_sigma_t_) * node.light.reduced;
    sum.direction += weight * node.light.direction;
    sum.spread += weight * node.light.spread;
    sum.weight += weight;
  }
  if (!(sum.weight > 0.0f)) return {};
  const float scale = 1.0f / sum.weight;
  sum.fluence *= scale;
  sum.reduced *= scale;
  if (!is_reduced_) sum.reduced = sum.fluence;
  sum.direction *= scale;
  sum.spread *= scale;
  return sum;
}

template <int N>
std::optional<typename WalkLamps<N>::SameWay> WalkLamps<N>::find_same_way(
    const WalkPath<N>& path, const SurfacePoint& exit, const Ray& outside, const LightSeen& lamp,
    const FindBoundary* find_boundary) const {
  if (!path.has_scattered) return std::nullopt;
  LightSample sample{.direction = outside.direction, .distance = lamp.distance, .pdf = lamp.pdf};
  if (std::isfinite(lamp.distance)) {  // which the last event sees in another direction
    const Vec3f offset = outside.origin + lamp.distance * outside.direction - path.ray.origin;
    const float distance = length(offset);
    sample = {.direction = offset / distance, .distance = distance, .pdf = 0.0f};
    space_.scene().lights.for_lights_seen({path.ray.origin, sample.direction}, 0.0f,
                                          1.001f * distance, false, [&](const LightSeen& seen) {
                                            if (seen.distance > 0.999f * distance)
                                              sample.pdf = seen.pdf;
                                          });
  }
  std::optional<SameWay> found;
  for_ways_in(path.ray.origin, sample, find_boundary, [&](const RefractedEntry& entry) {
    if (length(entry.point.position - exit.position) <
        same_way * entry.length + least_distance(space_.scene()))
      found = {entry, sample.pdf * space_.ior() * space_.ior() / entry.geometry_term};
  });
  return found;
}

template class WalkLamps<4>;
template class WalkLamps<8>;
template class WalkLamps<16>;

}  // namespace lamina
