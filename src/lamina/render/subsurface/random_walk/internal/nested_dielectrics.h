// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "lamina/render/shading/render_scene.h"
#include "lamina/surface/surface_point.h"

namespace lamina {

/// The bodies that a place lies in, with how often: a mesh may overlap itself. Those beyond the
/// eighth are left out.
struct WalkHolders {
  struct Holder {
    std::uint32_t mesh;
    int times;
  };
  std::array<Holder, 8> each;
  int count = 0;
  /// @param times  how often more, or less
  void add(std::uint32_t mesh, int times);
};

/// The closed meshes of translucent or dielectric materials, as bodies that may touch, overlap and
/// hold one another. Where several hold a place, the one with the least volume fills it, so
/// the inner one; of equal ones the later in the scene.
class WalkBodies {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// `scene` must outlive it.
  explicit WalkBodies(const RenderScene& scene);

  /// Of the medium inside a mesh; `none` if it is not a body.
  [[nodiscard]] std::uint32_t material_of(std::uint32_t mesh) const { return material_[mesh]; }
  /// The mesh that fills a place; `none` if no body holds it.
  [[nodiscard]] std::uint32_t filling(const WalkHolders& holders) const;

  /// What holds the places just beyond a surface.
  struct Crossing {
    WalkHolders beyond;
    bool is_blocked = false;  ///< by a surface that is not that of a body's medium
  };
  /// Takes all faces that coincide with that which a ray meets as one: none is met again.
  [[nodiscard]] Crossing cross(const WalkHolders& before, const SurfacePoint& point,
                               const Vec3f& direction) const;

  /// Whether the box of a mesh of the material meets that of another body.
  [[nodiscard]] bool is_near_others(std::uint32_t material) const;

 private:
  const RenderScene& scene_;
  std::vector<std::uint32_t> material_;  ///< [mesh]
  std::vector<double> volume_;           ///< [mesh] [mm³]
};

}  // namespace lamina
