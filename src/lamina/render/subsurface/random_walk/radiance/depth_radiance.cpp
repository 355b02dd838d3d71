// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/radiance/depth_radiance.h"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

// Noise over time: benchmarks/subsurface_methods; no mean depends on it.
constexpr int estimates_of_node = 16;
constexpr double most_nodes_entering = 2e5;
constexpr float spacing_in_free_paths = 1.5f;
constexpr float rows_per_octave = 2.0f;
constexpr std::size_t rows = 25;
/// Of a node, in its spacings: how far the surface may be.
constexpr float reach = 1.8f;
/// Below the surface, in shortest free paths: where light that enters is looked for.
constexpr float right_below = 0.05f;

/// Applies to all arrays of two sums.
template <class Sums, class Function>
void for_arrays(Sums& a, const Sums& b, const Function& function) {
  function(a.vv, b.vv), function(a.vt, b.vt), function(a.vtc, b.vtc);
  function(a.tt, b.tt), function(a.ttc, b.ttc), function(a.ttcc, b.ttcc);
}

}  // namespace

template <int N>
DepthRadiance<N>::DepthRadiance(const BodyInterior<N>& interior,
                                const ManifoldNextEvent<N>& next_event, const WalkLayers<N>& layers,
                                const Box& region)
    : interior_(interior),
      next_event_(next_event),
      layers_(layers),
      lattice_(region.low, region.high, spacing_in_free_paths * layers.shortest_reduced_free_path(),
               most_nodes_entering),
      nodes_(lattice_.count()),
      unit_depth_(0.5f * layers.shortest_free_path()) {}

template <int N>
auto DepthRadiance<N>::compute_node(std::size_t node, const LightGatherer<N>& light) const
    -> Entering {
  const RenderScene& scene = interior_.scene();
  Random random = make_random(scene.settings.seed + 5, node);
  const Vec3f middle = lattice_.position(node);
  const float spacing = lattice_.spacing();
  Entering result;
  if (!scene.geometry.closest_point(middle, reach * spacing, interior_.material(), 0.01f).is_hit())
    return result;
  std::array<float, estimates_of_node> found{};
  float brightness = 0.0f;
  std::size_t count = 0;
  for (std::size_t i = 0; i < estimates_of_node; ++i) {
    const auto offset = [&] { return spacing * (random.uniform_float() - 0.5f); };
    const Vec3f near = middle + Vec3f{offset(), offset(), offset()};
    const float u_light = (static_cast<float>(i) + random.uniform_float()) / estimates_of_node;
    const Vec2f u{random.uniform_float(), random.uniform_float()};
    const Hit hit =
        scene.geometry.closest_point(near, reach * spacing, interior_.material(), 0.01f);
    if (!hit.is_hit()) continue;
    ++count;
    const SurfacePoint entry = make_surface_point(scene.scene->meshes, hit, 0.3f * spacing);
    PixelSamples samples(scene.settings.seed + 6, static_cast<std::uint32_t>(node),
                         static_cast<std::uint32_t>(i));
    result.irradiance += light.entering_irradiance(entry, samples);
    if (!next_event_.has_lights()) continue;
    const float below =
        std::max(right_below * layers_.shortest_free_path(), 2.0f * least_distance(scene));
    const Vec3f inside = entry.position - below * entry.geometric_normal;
    next_event_.sample_light(inside, u_light, u, light, [&](const RefractedLight<N>& sample) {
      const float here = largest(sample.unattenuated);
      result.fluence += sample.unattenuated;
      result.to_light += here * sample.entry.to_surface;
      brightness += here;
      found[i] += here;
    });
  }
  if (count == 0) return result;
  const float fraction = 1.0f / static_cast<float>(count);
  result.irradiance *= fraction;
  result.fluence *= fraction;
  constexpr float least_brightness = 1e-30f;  // that has an inverse
  result.to_light *= brightness > least_brightness ? 1.0f / brightness : 0.0f;
  for (const float one : found)
    result.deviation = std::max(result.deviation, std::abs(one - fraction * brightness));
  result.weight = 1.0f;
  return result;
}

template <int N>
auto DepthRadiance<N>::entering_around(const DepthLayers::Place& place,
                                       const LightGatherer<N>& light) const -> Entering {
  const NodeLattice::Corners corners = lattice_.corners(
      make_bare_surface_point(interior_.scene().scene->meshes, place.nearest).position);
  Entering sum;
  for (std::size_t i = 0; i < 8; ++i) {
    const Entering node =
        nodes_.at(corners.node[i], [&](std::size_t k) { return compute_node(k, light); });
    const float weight = corners.weight[i] * node.weight;
    sum.irradiance += weight * node.irradiance;
    sum.fluence += weight * node.fluence;
    sum.to_light += weight * node.to_light;
    sum.deviation += weight * node.deviation;
    sum.weight += weight;
  }
  if (!(sum.weight > 0.0f)) return {};
  const float scale = 1.0f / sum.weight;
  sum.irradiance *= scale;
  sum.fluence *= scale;
  sum.to_light *= scale;
  sum.deviation *= scale;
  return sum;
}

template <int N>
auto DepthRadiance<N>::between(float depth, bool is_even) const -> Between {
  const float at = rows_per_octave * std::log2(1.0f + std::max(depth, 0.0f) / unit_depth_);
  const auto row = static_cast<std::size_t>(std::min(at, static_cast<float>(rows) - 1.001f));
  return {(is_even ? rows : 0) + row, std::min(at - static_cast<float>(row), 1.0f)};
}

template <int N>
FieldRadiance<N> DepthRadiance<N>::at(const DepthLayers::Place& place, const WalkLayers<N>& onward,
                                      bool is_even, const LightGatherer<N>& light) const {
  if (!place.is_exact || table_.empty()) return {};
  const Entering entering = entering_around(place, light);
  if (!(entering.weight > 0.0f)) return {};
  FieldRadiance<N> here{.to_light = entering.to_light, .net_flux = place.outward};
  const auto [row, fraction] = between(place.depth, is_even);
  const Row &a = table_[row], &b = table_[row + 1];
  here.scattered = entering.irradiance * ((1.0f - fraction) * a.mean + fraction * b.mean);
  here.directed = entering.irradiance * ((1.0f - fraction) * a.slope + fraction * b.slope);
  here.deviation =
      largest(entering.irradiance * ((1.0f - fraction) * a.deviation + fraction * b.deviation));
  const float r = length(entering.to_light);
  const float cosine = r > 0.0f ? dot(entering.to_light, place.outward) / r : 0.0f;
  if (cosine > 0.05f && layers_.sees_out(place.layer)) {
    here.direct_fluence =
        exp_minus((1.0f / cosine) * onward.optical_depth(place)) * entering.fluence;
    const float most = largest(entering.fluence);
    here.direct_deviation =
        most > 0.0f ? entering.deviation * largest(here.direct_fluence) / most : 0.0f;
  }
  return here;
}

template <int N>
auto DepthRadiance<N>::make_lessons() const -> Lessons {
  Lessons lessons;
  lessons.rows_.resize(2 * rows);
  return lessons;
}

template <int N>
void DepthRadiance<N>::Lessons::add(const Lessons& other) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    for_arrays(rows_[i], other.rows_[i], [](auto& a, const auto& b) {
      for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
    });
}

template <int N>
void DepthRadiance<N>::add(const WalkRecord<N>& record, const Bands& found,
                           const LightGatherer<N>& light, Lessons& lessons) const {
  for (const auto& event : record.events) {
    if (!event.place.is_exact) continue;
    const Entering entering = entering_around(event.place, light);
    if (!(entering.weight > 0.0f)) continue;
    const Bands scale = event.throughput * entering.irradiance;
    const Bands later = found - event.radiance_found;
    const auto c = static_cast<double>(dot(event.direction, event.place.outward));
    const auto [row, fraction] = between(event.place.depth, event.is_even);
    for (std::size_t i = 0; i < 2; ++i) {
      auto& sums = lessons.rows_[row + i];
      const auto w = static_cast<double>(i == 0 ? 1.0f - fraction : fraction);
      for (std::size_t b = 0; b < N; ++b) {
        const auto t = static_cast<double>(scale[static_cast<int>(b)]);
        const auto v = static_cast<double>(later[static_cast<int>(b)]);
        sums.vv[b] += w * v * v;
        sums.vt[b] += w * v * t;
        sums.vtc[b] += w * v * t * c;
        sums.tt[b] += w * t * t;
        sums.ttc[b] += w * t * t * c;
        sums.ttcc[b] += w * t * t * c * c;
      }
    }
  }
}

template <int N>
void DepthRadiance<N>::learn(const Lessons& lessons) {
  table_.assign(2 * rows, {});
  for (std::size_t i = 0; i < 2 * rows; ++i) {
    const auto& s = lessons.rows_[i];
    for (std::size_t b = 0; b < N; ++b) {
      if (!(s.tt[b] > 0.0)) continue;
      double mean = s.vt[b] / s.tt[b], slope = 0.0;
      const double determinant = s.tt[b] * s.ttcc[b] - s.ttc[b] * s.ttc[b];
      if (determinant > 1e-3 * s.tt[b] * s.tt[b]) {
        slope = (s.tt[b] * s.vtc[b] - s.ttc[b] * s.vt[b]) / determinant;
        slope = std::clamp(slope, -std::abs(mean), std::abs(mean));
        mean = (s.vt[b] - slope * s.ttc[b]) / s.tt[b];
      }
      mean = std::max(mean, 0.0);
      const double squares = s.vv[b] - 2.0 * (mean * s.vt[b] + slope * s.vtc[b]) +
                             mean * mean * s.tt[b] + 2.0 * mean * slope * s.ttc[b] +
                             slope * slope * s.ttcc[b];
      const int band = static_cast<int>(b);
      table_[i].mean[band] = static_cast<float>(mean);
      table_[i].slope[band] = static_cast<float>(slope);
      table_[i].deviation[band] = static_cast<float>(std::sqrt(std::max(squares, 0.0) / s.tt[b]));
    }
  }
}

template <int N>
void DepthRadiance<N>::scale(float factor) {
  for (Row& row : table_) {
    row.mean *= factor;
    row.slope *= factor;
  }
}

template class DepthRadiance<4>;
template class DepthRadiance<8>;
template class DepthRadiance<16>;

}  // namespace lamina
