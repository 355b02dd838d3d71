// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// All hits of one probe through an object, in no order.
struct ProbeHits {
  static constexpr int capacity = 24;  ///< further hits are left out
  std::array<Hit, capacity> hits;
  int count = 0;
  [[nodiscard]] std::span<const Hit> all() const {
    return {hits.data(), static_cast<std::size_t>(count)};
  }
};

/// The barycentric weights of b and c at the point of triangle abc that is nearest to p.
[[nodiscard]] Vec2f nearest_on_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b,
                                        const Vec3f& c);

/// The triangles of a scene, ready for rays. Safe to use from any thread; copies share all.
class RayGeometry {
 public:
  /// `meshes` must outlive the geometry.
  explicit RayGeometry(const std::vector<Mesh>& meshes);
  ~RayGeometry();
  RayGeometry(const RayGeometry&);
  RayGeometry& operator=(const RayGeometry&);
  RayGeometry(RayGeometry&&) noexcept;
  RayGeometry& operator=(RayGeometry&&) noexcept;

  /// The nearest hit between the distances t_near and t_far, both sides of a triangle counting.
  [[nodiscard]] Hit first_hit(const Ray& ray, float t_near,
                              float t_far = std::numeric_limits<float>::infinity()) const;

  /// First hit among the triangles of one material.
  [[nodiscard]] Hit first_hit_of(std::uint32_t material, const Ray& ray, float t_near) const;

  /// Whether anything lies between the distances t_near and t_far.
  [[nodiscard]] bool is_blocked(const Ray& ray, float t_near, float t_far) const;

  /// All hits with triangles of a material, or with any, within the length of a segment: one
  /// traversal.
  void all_hits(const Ray& ray, float length, std::optional<std::uint32_t> material,
                ProbeHits& found) const;

  /// The point of a surface nearest to a position, within a radius: of triangles of one material or
  /// all. `Hit::distance` is the distance to it.
  ///
  /// @param slack  in [0, 1): nothing is nearer than 1 - slack of the distance found; saves time
  [[nodiscard]] Hit closest_point(const Vec3f& position, float radius,
                                  std::optional<std::uint32_t> material = std::nullopt,
                                  float slack = 0.1f) const;

  /// Smallest box around everything; both corners 0 if there is nothing.
  [[nodiscard]] Vec3f box_low() const { return box_low_; }
  [[nodiscard]] Vec3f box_high() const { return box_high_; }

 private:
  struct Traversal;
  std::shared_ptr<const Traversal> traversal_;
  Vec3f box_low_, box_high_;
};

}  // namespace lamina
