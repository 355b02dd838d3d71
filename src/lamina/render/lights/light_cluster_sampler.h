// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/rough/surface_boundary.h"
#include "lamina/render/lights/lights.h"

namespace lamina {

/// A reflecting boundary seen from one direction, all in the world's directions.
struct BoundaryView {
  const SurfaceBoundary& boundary;
  Vec3f normal, wo;
};

/// Product importance sampling of lights and the specular lobe of a boundary: light clusters are
/// sampled by about what the boundary reflects of each, flux times the lobe at the cluster's
/// middle, the lobe as much wider as the cluster is wide; no shadows. A tenth of the samples
/// follows the flux alone, so that no light is left out.
///
/// Source: [Clarberg2005] for sampling the product of lights and lobes; clusters by halving the
/// random numbers of the lights are lamina's.
class LightClusterSampler {
 public:
  /// @param lights  with at least one cluster.
  LightClusterSampler(const Lights& lights, const BoundaryView& view, const Vec3f& position);

  struct Sample {
    LightSample light;           ///< with the pdf of Lights::sample_light
    float density_ratio = 1.0f;  ///< its density here over that of Lights::sample_light
  };
  /// @param u_cluster  in [0, 1), chooses the cluster
  /// @param u          in the unit square, chooses the direction
  [[nodiscard]] Sample sample(float u_cluster, Vec2f u) const;

 private:
  const Lights& lights_;
  Vec3f position_;
  std::array<float, max_light_clusters> ends_;  ///< cumulative probability
};

}  // namespace lamina
