// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/internal/light_shapes.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/vec.h"

namespace lamina {

std::optional<BallSeen> see_ball(const Vec3f& center, float radius, const Vec3f& from) {
  const Vec3f d = center - from;
  const float distance2 = dot(d, d), sin2 = radius * radius / distance2;
  if (!(sin2 < 1.0f)) return std::nullopt;
  const float one_minus_cos = sin2 / (1.0f + std::sqrt(1.0f - sin2));
  return BallSeen{one_minus_cos, 2.0f * float_pi * one_minus_cos};
}

/// Source: [Shirley1996] §3.2, directions evenly in the cone around the ball.
ShiningPoint sample_ball(const Vec3f& center, float radius, const Vec3f& from, const BallSeen& seen,
                         Vec2f u) {
  const Vec3f d = center - from;
  const float distance = length(d);
  const float one_minus_cos = u.x * seen.one_minus_cos, cosine = 1.0f - one_minus_cos;
  const float sin2 = one_minus_cos * (1.0f + cosine), sine = std::sqrt(sin2);
  const float phi = 2.0f * float_pi * u.y;
  const Vec3f direction =
      make_frame(d / distance).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
  const float half_chord = std::sqrt(std::max(radius * radius - distance * distance * sin2, 0.0f));
  const Vec3f position = from + (distance * cosine - half_chord) * direction;
  return {position, normalize(position - center)};
}

std::optional<float> meet_ball(const Vec3f& center, float radius, const Vec3f& origin,
                               const Vec3f& direction) {
  const Vec3f d = center - origin;
  const float radius2 = radius * radius, along = dot(d, direction);
  if (!(dot(d, d) > radius2 && along > 0.0f)) return std::nullopt;
  const Vec3f across = d - along * direction;
  const float left2 = radius2 - dot(across, across);
  if (!(left2 >= 0.0f)) return std::nullopt;
  return along - std::sqrt(left2);
}

ShiningTriangles::ShiningTriangles(const std::vector<Mesh>& meshes, std::uint32_t material) {
  std::vector<double> areas;
  double total = 0.0;
  Vec3 moment;
  for (const Mesh& mesh : meshes)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material[t] != material) continue;
      const auto [i0, i1, i2] = mesh.triangles[t];
      const Vec3f &a = mesh.positions[i0], &b = mesh.positions[i1], &c = mesh.positions[i2];
      const Vec3f doubled = cross(b - a, c - a);
      const float doubled_area = length(doubled);
      if (!(doubled_area > 0.0f)) continue;
      const Vec3f smooth = mesh.normals[i0] + mesh.normals[i1] + mesh.normals[i2];
      const float side = dot(doubled, smooth) < 0.0f ? -1.0f : 1.0f;
      triangles_.push_back({a, b - a, c - a, (side / doubled_area) * doubled});
      areas.push_back(0.5 * static_cast<double>(doubled_area));
      total += areas.back();
      moment += (areas.back() / 3.0) * to_double(a + b + c);
    }
  if (triangles_.empty()) return;
  area_ = static_cast<float>(total);
  const Vec3 middle = moment / total;
  middle_ = to_float(middle);
  double below = 0.0, spread2 = 0.0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    below += areas[t];
    cumulative_.push_back(static_cast<float>(below / total));
    const Triangle& triangle = triangles_[t];
    const Vec3f d = triangle.corner + (1.0f / 3.0f) * (triangle.edge_u + triangle.edge_v) - middle_;
    spread2 += areas[t] / total * static_cast<double>(dot(d, d));
  }
  spread2_ = static_cast<float>(spread2);
}

ShiningPoint ShiningTriangles::sample(Vec2f u) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), u.x);
  const std::size_t t =
      std::min(static_cast<std::size_t>(found - cumulative_.begin()), triangles_.size() - 1);
  const float low = t > 0 ? cumulative_[t - 1] : 0.0f, size = cumulative_[t] - low;
  const float x = size > 0.0f ? std::clamp((u.x - low) / size, 0.0f, 1.0f) : 0.5f;
  const float root = std::sqrt(x);  // evenly over the triangle
  const Triangle& triangle = triangles_[t];
  return {triangle.corner + root * (1.0f - u.y) * triangle.edge_u + root * u.y * triangle.edge_v,
          triangle.normal};
}

}  // namespace lamina
