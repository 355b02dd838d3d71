// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/surface/point_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lamina/core/hash.h"

namespace lamina {
namespace {

constexpr float least_agreement = 0.25f;  // of normals
constexpr float width_of_reach = 2.1f;    // of a cell; 2 would do if numbers were not rounded

std::int32_t cell_of(float x, float width) {
  return static_cast<std::int32_t>(std::floor(std::clamp(x / width, -1e9f, 1e9f)));
}

/// First row of the inverse of the symmetric matrix of a plane's least squares:
/// sums of 1, u, v, uu, uv, vv. A mean where the points do not span a plane.
std::array<float, 3> first_of_inverse(const std::array<float, 6>& m) {
  const auto [s, u, v, uu, uv, vv] = m;
  const float c0 = uu * vv - uv * uv, c1 = uv * v - u * vv, c2 = u * uv - uu * v;
  const float det = s * c0 + u * c1 + v * c2;
  if (!(det > 1e-3f * s * s * s)) return {1.0f / s, 0.0f, 0.0f};
  return {c0 / det, c1 / det, c2 / det};
}

}  // namespace

PointGrid::PointGrid(std::span<const Place> places, float reach)
    : places_(places.size()), reach_(reach), point_(places.size()) {
  first_.assign(std::bit_ceil(places.size() / 4 + 8) + 1, 0);
  std::vector<std::size_t> slots;
  slots.reserve(places.size());
  const float width = width_of_reach * reach_;
  for (const Place& p : places) {
    slots.push_back(slot(cell_of(p.position.x, width), cell_of(p.position.y, width),
                         cell_of(p.position.z, width)));
    ++first_[slots.back() + 1];
  }
  for (std::size_t s = 1; s < first_.size(); ++s) first_[s] += first_[s - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::uint32_t k = next[slots[i]]++;
    places_[k] = places[i];
    point_[k] = static_cast<std::uint32_t>(i);
  }
}

std::size_t PointGrid::slot(std::int32_t x, std::int32_t y, std::int32_t z) const {
  return hash_cell(x, y, z) & (first_.size() - 2);
}

PointGrid::Near PointGrid::near(const Vec3f& position, const Vec3f& normal) const {
  Near found;
  const float width = width_of_reach * reach_, reach2 = reach_ * reach_;
  // The ball around the position meets the cells of its box's corners, and no others.
  std::array<std::size_t, 8> seen;
  auto seen_end = seen.begin();
  for (int corner = 0; corner < 8; ++corner) {
    const auto cell = [&](float x, int bit) {
      return cell_of(x + ((corner >> bit) & 1 ? reach_ : -reach_), width);
    };
    const std::size_t s = slot(cell(position.x, 0), cell(position.y, 1), cell(position.z, 2));
    if (std::find(seen.begin(), seen_end, s) != seen_end) continue;
    *seen_end++ = s;
    for (std::uint32_t k = first_[s]; k < first_[s + 1] && found.count < capacity; ++k) {
      const Place& p = places_[k];
      const Vec3f offset = p.position - position;
      if (!(dot(offset, offset) < reach2)) continue;
      const float facing = dot(p.normal, normal);
      if (!(facing > least_agreement)) continue;
      found.point[found.count] = point_[k];
      found.offset[found.count] = offset;
      found.facing[found.count++] = facing;
    }
  }
  return found;
}

PointGrid::Weights PointGrid::weights_at(const Vec3f& position, const Vec3f& normal) const {
  const Near points = near(position, normal);
  Weights found{.point = points.point, .weight = {}, .count = points.count};
  if (points.count == 0) return found;
  const Framef frame = make_frame(normal);
  std::array<Vec2f, capacity> at;
  std::array<float, 6> sums{};
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3f offset = points.offset[i] / reach_;
    const float nearness = 1.0f - dot(offset, offset);
    const float w = nearness * nearness * (points.facing[i] - least_agreement);
    const Vec2f uv{dot(offset, frame.x), dot(offset, frame.y)};
    found.weight[i] = w;
    at[i] = uv;
    const std::array<float, 6> terms = {1.0f, uv.x, uv.y, uv.x * uv.x, uv.x * uv.y, uv.y * uv.y};
    for (std::size_t k = 0; k < 6; ++k) sums[k] += w * terms[k];
  }
  const auto [a, b, c] = first_of_inverse(sums);
  for (std::size_t i = 0; i < points.count; ++i) found.weight[i] *= a + b * at[i].x + c * at[i].y;
  return found;
}

}  // namespace lamina
