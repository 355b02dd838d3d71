// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/surface/surface_point.h"

#include <algorithm>
#include <cmath>

namespace lamina {

SurfacePoint make_bare_surface_point(const std::vector<Mesh>& meshes, const Hit& hit) {
  const Mesh& mesh = meshes[hit.mesh];
  const auto [i0, i1, i2] = mesh.triangles[hit.triangle];
  const float w1 = hit.u, w2 = hit.v, w0 = 1.0f - w1 - w2;
  const Vec3f &p0 = mesh.positions[i0], &p1 = mesh.positions[i1], &p2 = mesh.positions[i2];
  SurfacePoint point;
  point.position = w0 * p0 + w1 * p1 + w2 * p2;
  const Vec3f area_normal = cross(p1 - p0, p2 - p0);
  const float double_area = length(area_normal);
  point.geometric_normal = double_area > 0.0f ? area_normal / double_area : mesh.normals[i0];
  const Vec3f n = w0 * mesh.normals[i0] + w1 * mesh.normals[i1] + w2 * mesh.normals[i2];
  const float n_length = length(n);
  point.smooth_normal = n_length > 1e-6f ? n / n_length : point.geometric_normal;
  // The vertex normals say which side is outside; the winding may not.
  if (dot(point.geometric_normal, point.smooth_normal) < 0.0f)
    point.geometric_normal = -point.geometric_normal;
  point.normal = point.smooth_normal;
  point.mesh = hit.mesh;
  point.triangle = hit.triangle;
  point.material = mesh.material[hit.triangle];
  return point;
}

SurfacePoint make_surface_point(const std::vector<Mesh>& meshes, const Hit& hit, float footprint) {
  SurfacePoint point = make_bare_surface_point(meshes, hit);
  point.footprint = footprint;
  const Mesh& mesh = meshes[hit.mesh];
  if (!mesh.uvs.empty()) {
    const auto [i0, i1, i2] = mesh.triangles[hit.triangle];
    const float w1 = hit.u, w2 = hit.v, w0 = 1.0f - w1 - w2;
    const Vec3f e1 = mesh.positions[i1] - mesh.positions[i0];
    const Vec3f e2 = mesh.positions[i2] - mesh.positions[i0];
    const float double_area = length(cross(e1, e2));
    const Vec2f &t0 = mesh.uvs[i0], &t1 = mesh.uvs[i1], &t2 = mesh.uvs[i2];
    point.uv = w0 * t0 + w1 * t1 + w2 * t2;
    point.uv_middle = (1.0f / 3.0f) * (t0 + t1 + t2);
    const Vec2f d1 = t1 - t0, d2 = t2 - t0;
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    if (determinant != 0.0f && double_area > 0.0f) {
      point.du = (d2.y * e1 - d1.y * e2) / determinant;
      point.dv = (d1.x * e2 - d2.x * e1) / determinant;
      point.uv_footprint = footprint * std::sqrt(std::abs(determinant) / double_area);
    }
  }
  if (!mesh.colors.empty()) {
    const auto [i0, i1, i2] = mesh.triangles[hit.triangle];
    point.color = (1.0f - hit.u - hit.v) * mesh.colors[i0] + hit.u * mesh.colors[i1] +
                  hit.v * mesh.colors[i2];
  }
  return point;
}

Vec3f leave_surface(const SurfacePoint& point, const Vec3f& direction) {
  // The interpolated position is off by a few units in the last place of its coordinates.
  const Vec3f& p = point.position;
  const float magnitude = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), 1e-3f});
  const float side = dot(direction, point.geometric_normal) < 0.0f ? -1.0f : 1.0f;
  return p + (side * 2e-6f * magnitude) * point.geometric_normal;
}

}  // namespace lamina
