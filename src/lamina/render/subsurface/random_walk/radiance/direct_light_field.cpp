// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/radiance/direct_light_field.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamina {
namespace {

// Noise over time: benchmarks/subsurface_methods; no mean depends on it.
constexpr int samples_of_node = 8;
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
DirectLightField<N>::DirectLightField(const BodyInterior<N>& interior,
                                      const ManifoldNextEvent<N>& next_event, const Bands& sigma_t,
                                      const Bands& reduced_sigma_t, float free_path)
    : interior_(interior),
      next_event_(next_event),
      sigma_t_(sigma_t),
      reduced_sigma_t_(reduced_sigma_t),
      is_reduced_(largest(abs(sigma_t - reduced_sigma_t)) > 1e-6f * largest(sigma_t)),
      lattice_(interior.lattice(free_path, most_nodes)),
      nodes_(lattice_.count()) {}

/// The mean of next-event estimates at points inside, each moved to their middle along its beam.
template <int N>
DirectLightField<N>::Node DirectLightField<N>::compute_node(std::size_t node,
                                                            const LightGatherer<N>& light) const {
  Random random = make_random(interior_.scene().settings.seed, node);
  std::array<Vec3f, samples_of_node> points;
  std::size_t count = 0;
  Node result;
  for (int i = 0; i < samples_of_node; ++i) {
    const auto offset = [&] { return lattice_.spacing() * (random.uniform_float() - 0.5f); };
    const Vec3f point = lattice_.position(node) + Vec3f{offset(), offset(), offset()};
    if (!interior_.is_inside(point)) continue;
    points[count++] = point;
    result.position += point;
  }
  if (count == 0) return {};
  const float fraction = 1.0f / static_cast<float>(count);
  result.position *= fraction;
  std::array<float, samples_of_node> found{};
  DirectFluence<N>& sum = result.light;
  float brightness = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float u_light = (static_cast<float>(i) + random.uniform_float()) * fraction;
    const Vec2f u{random.uniform_float(), random.uniform_float()};
    next_event_.sample_light(points[i], u_light, u, light, [&](const RefractedLight<N>& sample) {
      const Vec3f& direction = sample.entry.to_surface;
      const float length =
          std::max(sample.entry.length - dot(result.position - points[i], direction), 0.0f);
      const Bands fluence = exp_minus(length * sigma_t_) * sample.unattenuated;
      const float here = largest(fluence);
      sum.fluence += fraction * fluence;
      sum.reduced_fluence += fraction * exp_minus(length * reduced_sigma_t_) * sample.unattenuated;
      sum.to_light += here * direction;
      brightness += here;
      found[i] += here;
    });
  }
  // Deep inside nothing arrives but what floats hold no inverse of.
  constexpr float least_brightness = 1e-30f;
  sum.to_light *= brightness > least_brightness ? 1.0f / brightness : 0.0f;
  for (std::size_t i = 0; i < count; ++i)
    sum.deviation = std::max(sum.deviation, std::abs(found[i] - fraction * brightness));
  sum.weight = 1.0f;
  return result;
}

template <int N>
DirectFluence<N> DirectLightField<N>::at(const Vec3f& p, const LightGatherer<N>& light) const {
  const NodeLattice::Corners corners = lattice_.corners(p);
  DirectFluence<N> sum;
  for (std::size_t i = 0; i < 8; ++i) {
    const Node& node =
        nodes_.at(corners.node[i], [&](std::size_t k) { return compute_node(k, light); });
    const float weight = corners.weight[i] * node.light.weight;
    const float nearer = dot(p - node.position, node.light.to_light);
    sum.fluence += weight * near_exponential(nearer * sigma_t_) * node.light.fluence;
    if (is_reduced_)
      sum.reduced_fluence +=
          weight * near_exponential(nearer * reduced_sigma_t_) * node.light.reduced_fluence;
    sum.to_light += weight * node.light.to_light;
    sum.deviation += weight * node.light.deviation;
    sum.weight += weight;
  }
  if (!(sum.weight > 0.0f)) return {};
  const float scale = 1.0f / sum.weight;
  sum.fluence *= scale;
  sum.reduced_fluence *= scale;
  if (!is_reduced_) sum.reduced_fluence = sum.fluence;
  sum.to_light *= scale;
  sum.deviation *= scale;
  return sum;
}

template class DirectLightField<4>;
template class DirectLightField<8>;
template class DirectLightField<16>;

}  // namespace lamina
