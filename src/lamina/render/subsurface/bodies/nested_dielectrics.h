// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "lamina/render/shading/render_scene.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// The interior list of nested dielectrics: the bodies that a point lies in, with how often: a mesh
/// may overlap itself. Those beyond the eighth are left out.
struct InteriorList {
  struct Body {
    std::uint32_t mesh;
    int times;
  };
  std::array<Body, 8> bodies;
  int count = 0;
  /// @param times  how often more, or less
  void add(std::uint32_t mesh, int times);
};

/// Nested dielectrics: the closed meshes of translucent or dielectric materials, as bodies that may
/// touch, overlap and lie in one another. Where several overlap, the one of highest priority fills
/// the point: that with the least volume, so the inner one; of equal ones the later in the scene.
///
/// Source: [SchmidtBudge2002], where priorities are given by the user.
class NestedDielectrics {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// `scene` must outlive it.
  explicit NestedDielectrics(const RenderScene& scene);

  /// Material of the medium inside a mesh; `none` if it is not a body.
  [[nodiscard]] std::uint32_t material_of(std::uint32_t mesh) const { return material_[mesh]; }
  /// The mesh of highest priority; `none` if the list is empty.
  [[nodiscard]] std::uint32_t highest_priority(const InteriorList& interior) const;

  /// Medium just beyond a surface.
  struct Crossing {
    InteriorList beyond;
    bool is_blocked = false;  ///< by a surface that is not that of a body's medium
  };
  /// Takes all faces that coincide with that which a ray meets as one: none is met again.
  [[nodiscard]] Crossing cross(const InteriorList& before, const SurfacePoint& point,
                               const Vec3f& direction) const;
  /// The hits of a ray on all faces that coincide with one that it meets at a point.
  [[nodiscard]] ProbeHits coincident_hits(const SurfacePoint& point, const Vec3f& direction) const;

  /// Whether the box of a mesh of the material meets that of another body.
  [[nodiscard]] bool is_near_others(std::uint32_t material) const;

 private:
  const RenderScene& scene_;
  std::vector<std::uint32_t> material_;  ///< [mesh]
  std::vector<double> volume_;           ///< [mesh] [mm³]
};

}  // namespace lamina
