// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/zones_by_creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace lamina {
namespace {

constexpr float alike = 0.766f;  // cosine of 40 degrees
constexpr float most_points_of_edge = 1e4f;
constexpr float furthest = 16.0f;  // units

/// An edge by its places, for vertices are not shared across sharp ones.
struct Edge {
  std::array<Vec3f, 2> end;  ///< the lower first
  Vec3f normal;              ///< of its face
};

auto order_of(const Vec3f& p) { return std::tuple(p.x, p.y, p.z); }
auto order_of(const Edge& edge) {
  return std::tuple_cat(order_of(edge.end[0]), order_of(edge.end[1]));
}

}  // namespace

ZonesByCreases::ZonesByCreases(const std::vector<Mesh>& meshes, std::uint32_t material,
                               float spacing)
    : unit_(0.25f * spacing) {
  for (const Mesh& mesh : meshes) add_creases(mesh, material);
  std::ranges::sort(points_, {}, [](const auto& point) { return point.first; });
}

void ZonesByCreases::add_creases(const Mesh& mesh, std::uint32_t material) {
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.material[t] != material) continue;
    const auto& [i, j, k] = mesh.triangles[t];
    const std::array<Vec3f, 3> p = {mesh.positions[i], mesh.positions[j], mesh.positions[k]};
    const Vec3f n = normalize(cross(p[1] - p[0], p[2] - p[0]));
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3f &a = p[e], &b = p[(e + 1) % 3];
      const bool is_in_order = order_of(a) < order_of(b);
      edges.push_back({is_in_order ? std::array{a, b} : std::array{b, a}, n});
    }
  }
  std::ranges::sort(edges, {}, [](const Edge& edge) { return order_of(edge); });
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const auto& [end, normal] = edges[i];
    if (order_of(edges[i - 1]) != order_of(edges[i]) || dot(edges[i - 1].normal, normal) > alike)
      continue;
    const Vec3f along = end[1] - end[0];
    const float steps = std::clamp(std::ceil(length(along) / unit_), 1.0f, most_points_of_edge);
    for (float s = 0.0f; s <= steps; s += 1.0f) {
      const Vec3f point = end[0] + (s / steps) * along;
      points_.emplace_back(cube_of(point, 0, 0, 0), point);
    }
  }
}

std::uint64_t ZonesByCreases::cube_of(const Vec3f& position, int dx, int dy, int dz) const {
  constexpr std::int64_t middle = 1 << 20;
  const auto index = [&](float x, int step) {
    const float at = std::floor(x / (furthest * unit_));
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::clamp(at, -1e6f, 1e6f)) +
                                      step + middle);
  };
  return (index(position.x, dx) << 42) | (index(position.y, dy) << 21) | index(position.z, dz);
}

float ZonesByCreases::at(const Vec3f& position) const {
  float least = furthest * unit_;
  for (int i = 0; i < 27 && !points_.empty(); ++i) {
    const auto near =
        std::ranges::equal_range(points_, cube_of(position, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1),
                                 {}, [](const auto& point) { return point.first; });
    for (const auto& [cube, point] : near) least = std::min(least, length(point - position));
  }
  return std::log1p(least / unit_);
}

}  // namespace lamina
