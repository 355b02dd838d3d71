// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lamina/core/vec.h"
#include "lamina/optics/rough/surface_boundary.h"
#include "lamina/render/lights/lights.h"

namespace lamina {

/// A reflecting boundary seen from one direction, all in the world's directions.
struct MirrorView {
  const SurfaceBoundary& boundary;
  Vec3f normal, wo;
};

/// A choice among the parts of the lights by about what a mirror makes of each: flux times the
/// mirror's lobe at the part's middle, the lobe as much wider as the part is wide; no shadows. A
/// tenth of the choices follows the flux alone, so that no light is left out.
///
/// Source: [Clarberg2005] for sampling the product of lights and lobes; parts by halving the random
/// numbers of the lights are lamina's.
class MirroredParts {
 public:
  /// @param lights  with at least one part.
  MirroredParts(const Lights& lights, const MirrorView& view, const Vec3f& position);

  struct Drawn {
    LightSample light;       ///< with the pdf of Lights::sample_light
    float advantage = 1.0f;  ///< times which it is drawn here
  };
  /// @param u_part  in [0, 1), chooses the part
  /// @param u       in the unit square, chooses the direction
  [[nodiscard]] Drawn draw(float u_part, Vec2f u) const;

 private:
  const Lights& lights_;
  Vec3f position_;
  std::array<float, most_light_parts> ends_;  ///< cumulative probability
};

}  // namespace lamina
