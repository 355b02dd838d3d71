// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/papers/shadow_map/internal/shadow_buffer.h"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

/// Calls on_point for points spread over the faces of a box, corners and edges included.
template <class OnPoint>
void for_points_of_box(const Vec3f& low, const Vec3f& high, const OnPoint& on_point) {
  constexpr int steps = 8;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j)
      for (int k = 0; k <= steps; ++k) {
        const bool is_on_face = i % steps == 0 || j % steps == 0 || k % steps == 0;
        const Vec3f at{static_cast<float>(i) / steps, static_cast<float>(j) / steps,
                       static_cast<float>(k) / steps};
        if (is_on_face)
          on_point(Vec3f{low.x + at.x * (high.x - low.x), low.y + at.y * (high.y - low.y),
                         low.z + at.z * (high.z - low.z)});
      }
}

}  // namespace

ShadowGrid::ShadowGrid(const LightView& view, const Vec3f& low, const Vec3f& high, int texels)
    : is_far_(view.is_far) {
  const Vec3f middle = 0.5f * (low + high);
  const float radius = std::max(0.5f * length(high - low), 1e-6f);
  const Vec3f towards = middle - view.where;
  if (is_far_) {
    frame_ = make_frame(-view.where);
    origin_ = middle + radius * view.where;
  } else {
    frame_ = make_frame(length(towards) > 1e-6f * radius ? normalize(towards) : Vec3f{0, 0, 1});
    origin_ = view.where;
  }
  bool is_around = !is_far_;  // the light is within the box
  const float margin = 0.01f * radius;
  for (int k = 0; k < 3; ++k)
    is_around = is_around && origin_[k] > low[k] - margin && origin_[k] < high[k] + margin;
  Vec2f high_corner{1, 1};
  low_ = {-1, -1};
  if (!is_around) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    low_ = {infinity, infinity};
    high_corner = {-infinity, -infinity};
    for_points_of_box(low, high, [&](const Vec3f& point) {
      const Vec3f offset = point - origin_;
      const Vec2f at = project(offset, length(offset));
      low_ = {std::min(low_.x, at.x), std::min(low_.y, at.y)};
      high_corner = {std::max(high_corner.x, at.x), std::max(high_corner.y, at.y)};
    });
    // Between those points the outline of a box that is seen from near by bulges a little.
    const Vec2f size = high_corner - low_;
    const float least = 1e-3f * std::max({size.x, size.y, 1e-6f});
    const Vec2f border{0.02f * size.x + least, 0.02f * size.y + least};
    low_ = low_ - border;
    high_corner = high_corner + border;
  }
  const Vec2f size = high_corner - low_;
  columns_ = std::clamp(
      static_cast<int>(std::lround(std::sqrt(static_cast<float>(texels) * size.x / size.y))), 1,
      texels);
  rows_ = std::max(texels / columns_, 1);
  texel_ = {size.x / static_cast<float>(columns_), size.y / static_cast<float>(rows_)};
  texel_width_ = (is_far_ ? 1.0f : 2.0f) * std::sqrt(texel_.x * texel_.y);
}

/// A far light sees the plane across it, a near one Lambert's equal-area map of directions, whose
/// radius is sin(theta / 2).
Vec2f ShadowGrid::project(const Vec3f& offset, float distance) const {
  const Vec3f p = frame_.to_local(offset);
  if (is_far_) return {p.x, p.y};
  // 1 / (2 cos(theta / 2)) per unit of distance.
  const float scale = 1.0f / std::sqrt(std::max(2.0f * distance * (distance + p.z), 1e-20f));
  return {scale * p.x, scale * p.y};
}

Ray ShadowGrid::ray(std::size_t texel) const {
  const auto columns = static_cast<std::size_t>(columns_);
  const float x = low_.x + (static_cast<float>(texel % columns) + 0.5f) * texel_.x;
  const float y = low_.y + (static_cast<float>(texel / columns) + 0.5f) * texel_.y;
  if (is_far_) return {origin_ + x * frame_.x + y * frame_.y, frame_.z};
  const float s2 = std::min(x * x + y * y, 1.0f);
  const float scale = 2.0f * std::sqrt(1.0f - s2);
  return {origin_, normalize(frame_.to_world({scale * x, scale * y, 1.0f - 2.0f * s2}))};
}

ShadowGrid::Place ShadowGrid::find(const Vec3f& point) const {
  const Vec3f offset = point - origin_;
  const float distance = is_far_ ? dot(offset, frame_.z) : length(offset);
  const Vec2f at = project(offset, distance);
  const float x = (at.x - low_.x) / texel_.x, y = (at.y - low_.y) / texel_.y;
  if (!(x >= 0.0f && y >= 0.0f && x < static_cast<float>(columns_) &&
        y < static_cast<float>(rows_)))
    return {};
  Place place{.texel = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                       static_cast<std::size_t>(x),
              .ray = {{}, frame_.z},
              .distance = distance};
  if (is_far_)
    place.ray.origin = offset - distance * frame_.z;
  else
    place.ray.direction = offset / std::max(distance, 1e-20f);
  return place;
}

}  // namespace lamina
