// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Share of a spot light's intensity at an angle from its direction: 1 within the inner angle, 0
/// beyond the outer one, 3 t² - 2 t³ of the cosine between them.
[[nodiscard]] inline float spot_share(float cosine, float cos_inner, float cos_outer) {
  if (cosine >= cos_inner) return 1.0f;
  if (!(cosine > cos_outer)) return 0.0f;
  const float t = (cosine - cos_outer) / (cos_inner - cos_outer);
  return t * t * (3.0f - 2.0f * t);
}

/// A ball as seen from a point outside of it.
struct BallSeen {
  float one_minus_cos = 0.0f;  ///< of the cone around it
  float solid_angle = 0.0f;
};

/// Absent from inside.
[[nodiscard]] std::optional<BallSeen> see_ball(const Vec3f& center, float radius,
                                               const Vec3f& from);

/// A point of a surface that shines.
struct ShiningPoint {
  Vec3f position;
  Vec3f normal;  ///< unit length, outward
};

/// A point of the side of a ball that is seen, evenly over its solid angle.
[[nodiscard]] ShiningPoint sample_ball(const Vec3f& center, float radius, const Vec3f& from,
                                       const BallSeen& seen, Vec2f u);

/// The distance at which a ray meets a ball from outside.
[[nodiscard]] std::optional<float> meet_ball(const Vec3f& center, float radius, const Vec3f& origin,
                                             const Vec3f& direction);

/// The triangles of a material that shines, sampled evenly over their area.
class ShiningTriangles {
 public:
  /// Collects the triangles of all meshes of a scene; their normals are on the side of those of the
  /// vertices.
  ShiningTriangles(const std::vector<Mesh>& meshes, std::uint32_t material);

  [[nodiscard]] ShiningPoint sample(Vec2f u) const;
  [[nodiscard]] float area() const { return area_; }  ///< [mm²]; 0: there are none
  [[nodiscard]] const Vec3f& middle() const { return middle_; }
  [[nodiscard]] float spread2() const { return spread2_; }  ///< mean square distance from it [mm²]

 private:
  struct Triangle {
    Vec3f corner, edge_u, edge_v, normal;
  };
  std::vector<Triangle> triangles_;
  std::vector<float> cumulative_;  ///< [triangle], share of the area up to its end
  float area_ = 0.0f, spread2_ = 0.0f;
  Vec3f middle_;
};

}  // namespace lamina
