// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/surface/point_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lamina/base/core/hash.h"
#include "lamina/scene/surface/internal/near_places.h"

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
    : reach_(reach), point_(places.size()) {
  for (auto& row : places_) row.resize(places.size() + surface_detail::padding_of_rows);
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
    const auto& [at, normal] = places[i];
    const std::array<float, 6> numbers = {at.x, at.y, at.z, normal.x, normal.y, normal.z};
    for (std::size_t row = 0; row < numbers.size(); ++row) places_[row][k] = numbers[row];
    point_[k] = static_cast<std::uint32_t>(i);
  }
}

std::size_t PointGrid::slot(std::int32_t x, std::int32_t y, std::int32_t z) const {
  return hash_cell(x, y, z) & (first_.size() - 2);
}

PointGrid::Near PointGrid::near(const Vec3f& position, const Vec3f& normal) const {
  // The ball around the position meets the cells of its box's corners, and no others.
  const float width = width_of_reach * reach_;
  std::array<std::array<std::int32_t, 3>, 2> cells;
  for (const std::size_t side : {0U, 1U}) {
    const float there = side == 0 ? -reach_ : reach_;
    cells[side] = {cell_of(position.x + there, width), cell_of(position.y + there, width),
                   cell_of(position.z + there, width)};
  }
  std::array<std::size_t, 8> seen;
  std::array<surface_detail::PlaceRange, 8> ranges;
  std::size_t range_count = 0;
  auto seen_end = seen.begin();
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t s =
        slot(cells[corner & 1][0], cells[corner >> 1 & 1][1], cells[corner >> 2][2]);
    if (std::find(seen.begin(), seen_end, s) != seen_end) continue;
    *seen_end++ = s;
    ranges[range_count++] = {first_[s], first_[s + 1]};
  }
  Near found;
  found.count =
      surface_detail::find_near_places(places_, std::span(ranges).first(range_count), position,
                                       normal, reach_, least_agreement, found.point);
  for (std::size_t i = 0; i < found.count; ++i) {
    const std::uint32_t k = found.point[i];
    found.point[i] = point_[k];
    found.offset[i] = Vec3f{places_[0][k], places_[1][k], places_[2][k]} - position;
    found.facing[i] = dot(Vec3f{places_[3][k], places_[4][k], places_[5][k]}, normal);
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
