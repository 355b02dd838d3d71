// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/light_cluster_sampler.h"

#include <algorithm>
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

/// Adds flux times the lobe. A plain loop, for vectors of any width.
void add_lobe(const LightClusters& clusters, const Lobe& lobe, const Vec3f& n, const Vec3f& o,
              float* weights) {
  const float no = dot(n, o);
  for (std::size_t i = 0; i < clusters.count; ++i) {
    const float ni = n.x * clusters.x[i] + n.y * clusters.y[i] + n.z * clusters.z[i];
    const float oi = o.x * clusters.x[i] + o.y * clusters.y[i] + o.z * clusters.z[i];
    const float h2 = std::max(2.0f + 2.0f * oi, 1e-4f);  // of the vector wi + wo
    const float nh2 = std::min((ni + no) * (ni + no) / h2, 1.0f);
    const float a2 = lobe.alpha2 + 0.25f * clusters.spread2[i];  // half vectors turn half as far
    const float t = nh2 * (a2 - 1.0f) + 1.0f;
    const float c = 1.0f - 0.5f * std::sqrt(h2), c2 = c * c;
    const float f = lobe.normal_reflectance + (1.0f - lobe.normal_reflectance) * c2 * c2 * c;
    // Grooves mask flat light; a cluster whose middle is below the horizon may reach above it.
    const float masking =
        std::min(std::max(2.0f * ni + std::sqrt(clusters.spread2[i]), 0.0f), 1.0f);
    weights[i] += lobe.share * clusters.flux[i] * f * masking * a2 / (t * t);
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
  float of_lobe = 0.0f, of_flux = 0.0f;
  for (std::size_t i = 0; i < count; ++i) of_lobe += ends_[i];
  for (const LightClusters& clusters : {far, near})
    for (std::size_t i = 0; i < clusters.count; ++i) of_flux += clusters.flux[i];
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
