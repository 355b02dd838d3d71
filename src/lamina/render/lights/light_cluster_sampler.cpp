// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/light_cluster_sampler.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace lamina {
namespace {

constexpr float by_flux_alone = 0.1f;

/// A lobe without what is the same for all directions of light. In place of the facets'
/// distribution stands that of [Walter2007] Eq. 33, which takes no exponential.
struct Lobe {
  float alpha2, normal_reflectance, share;
};

// By value: choices between references are branches, which keep a loop from vectors.
float greater(float a, float b) { return a > b ? a : b; }
float lesser(float a, float b) { return a < b ? a : b; }

/// Adds flux times the lobe. A plain loop, for vectors of any width.
void add_lobe(const LightClusters& clusters, Lobe lobe, Vec3f n, Vec3f o,
              float* __restrict weights) {
  const float no = dot(n, o);
  const LightClusters c = clusters;  // a copy, which no store to the weights can change
  for (std::size_t i = 0; i < c.count; ++i) {
    const float ni = n.x * c.x[i] + n.y * c.y[i] + n.z * c.z[i];
    const float oi = o.x * c.x[i] + o.y * c.y[i] + o.z * c.z[i];
    const float h2 = greater(2.0f + 2.0f * oi, 1e-4f);  // of the vector wi + wo
    const float nh2 = lesser((ni + no) * (ni + no) / h2, 1.0f);
    const float a2 = lobe.alpha2 + 0.25f * c.spread2[i];  // half vectors turn half as far
    const float t = nh2 * (a2 - 1.0f) + 1.0f;
    const float flat = 1.0f - 0.5f * std::sqrt(h2), flat2 = flat * flat;
    const float f =
        lobe.normal_reflectance + (1.0f - lobe.normal_reflectance) * flat2 * flat2 * flat;
    // Grooves mask flat light; a cluster whose middle is below the horizon may reach above it.
    const float masking = lesser(greater(2.0f * ni + std::sqrt(c.spread2[i]), 0.0f), 1.0f);
    weights[i] += lobe.share * c.flux[i] * f * masking * a2 / (t * t);
  }
}

void add_lobes(const LightClusters& clusters, const BoundaryView& view, float* weights) {
  std::fill_n(weights, clusters.count, 0.0f);
  for (int i = 0; i < view.boundary.count; ++i) {
    const SpecularLobe& lobe = view.boundary.lobes[static_cast<std::size_t>(i)];
    const float root = (lobe.table->ior() - 1.0f) / (lobe.table->ior() + 1.0f);
    add_lobe(clusters, {lobe.roughness * lobe.roughness, root * root, lobe.share}, view.normal,
             view.wo, weights);
  }
}

/// Four sums side by side, so that none waits for the one before.
float sum_of(const float* values, std::size_t count) {
  std::array<float, 4> sums = {};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += values[i + k];
  for (; i < count; ++i) sums[0] += values[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}  // namespace

LightClusterSampler::LightClusterSampler(const Lights& lights, const BoundaryView& view,
                                         const Vec3f& position)
    : lights_(lights), position_(position) {
  const std::size_t count = lights.cluster_count();
  assert(count > 0);
  const LightClusters far = lights.far_clusters();
  NearLightClusters storage;
  const LightClusters near = lights.near_clusters(position, storage);
  add_lobes(far, view, ends_.data());
  add_lobes(near, view, ends_.data() + far.count);
  const float of_lobe = sum_of(ends_.data(), count);
  const float of_flux = sum_of(far.flux, far.count) + sum_of(near.flux, near.count);
  const float by_lobe = of_lobe > 0.0f ? (1.0f - by_flux_alone) / of_lobe : 0.0f;
  const float by_flux = of_flux > 0.0f ? (by_lobe > 0.0f ? by_flux_alone : 1.0f) / of_flux : 0.0f;
  float end = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float flux = i < far.count ? far.flux[i] : near.flux[i - far.count];
    end += by_lobe * ends_[i] + by_flux * flux;
    ends_[i] = end;
  }
}

LightClusterSampler::Sample LightClusterSampler::sample(float u_cluster, Vec2f u) const {
  const std::size_t count = lights_.cluster_count();
  const float all = ends_[count - 1];
  if (!(all > 0.0f)) return {};
  const auto end = ends_.begin() + static_cast<std::ptrdiff_t>(count);
  const auto at = std::upper_bound(ends_.begin(), end - 1, u_cluster * all);
  const auto cluster = static_cast<std::size_t>(at - ends_.begin());
  const float chance = (*at - (cluster > 0 ? ends_[cluster - 1] : 0.0f)) / all;
  if (!(chance > 0.0f)) return {};
  return {lights_.sample_cluster(cluster, position_, u),
          chance / lights_.probability_of_cluster(cluster)};
}

}  // namespace lamina
