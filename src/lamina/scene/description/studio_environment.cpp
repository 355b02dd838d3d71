// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/studio_environment.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/base/core/smooth_step.h"
#include "lamina/base/core/vec.h"

namespace lamina {
namespace {

/// A flat lamp one unit away, seen from the origin.
struct SoftBox {
  Vec3 direction;  ///< to its middle, about unit length
  double half_width, half_height;
  Vec3 radiance;         ///< in its middle
  double edge_radiance;  ///< fraction of it at the edge: cloth is brightest before the lamp
};

constexpr std::array<SoftBox, 5> boxes{{
    {{-0.62, 0.46, 0.64}, 0.46, 0.58, {4.6, 4.3, 3.9}, 0.55},   // key
    {{0.78, 0.22, -0.59}, 0.10, 0.75, {7.0, 7.2, 7.6}, 0.75},   // rim, right
    {{-0.86, 0.30, -0.42}, 0.08, 0.60, {3.4, 3.5, 3.8}, 0.75},  // rim, left
    {{0.86, 0.05, 0.51}, 0.60, 0.65, {0.36, 0.38, 0.42}, 0.6},  // fill
    {{0.05, 1.0, -0.15}, 0.38, 0.24, {2.0, 2.0, 2.0}, 0.6},     // overhead
}};

Vec3 light_of(const SoftBox& box, const Vec3& direction) {
  const Vec3 forward = normalize(box.direction);
  const double along = dot(direction, forward);
  if (along <= 0.0) return {};
  const Vec3 up = std::abs(forward.y) > 0.9 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  const Vec3 right = normalize(cross(forward, up));
  const double x = dot(direction, right) / along / box.half_width;
  const double y = dot(direction, cross(right, forward)) / along / box.half_height;
  if (std::max(std::abs(x), std::abs(y)) > 1.5) return {};
  // The frame, rounded and a little out of focus.
  const double to_edge = std::pow(std::pow(std::abs(x), 8.0) + std::pow(std::abs(y), 8.0), 0.125);
  const double blur = 0.03 / std::min(box.half_width, box.half_height);
  const double inside = 1.0 - smooth_step(1.0 - 0.5 * blur, 1.0 + 0.5 * blur, to_edge);
  const double r2 = std::min(x * x + y * y, 2.0);
  return inside * (1.0 + (box.edge_radiance - 1.0) * 0.5 * r2) * box.radiance;
}

Vec3 room(const Vec3& direction) {
  const double height = direction.y;
  const double wall = 0.05 + 0.09 * smooth_step(-0.2, 0.9, height);
  // The backdrop is lit from above behind the subject; the paper sweeps into a dark floor.
  const double backdrop =
      0.10 * std::exp(-4.0 * (direction.x * direction.x + (height - 0.1) * (height - 0.1))) *
      smooth_step(0.0, 0.6, -direction.z);
  const double floor = 0.02 + 0.03 * std::max(0.0, direction.z);
  const double above = smooth_step(-0.35, -0.1, height);
  const double level = above * (wall + backdrop) + (1.0 - above) * floor;
  return level * Vec3{0.97, 1.0, 1.05};
}

}  // namespace

Image make_studio_environment(int height) {
  assert(height > 0);
  Image image = make_image(2 * height, height, {"R", "G", "B"});
  constexpr int samples = 3;  // per pixel and axis: lamps have edges
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 2 * height; ++x) {
      Vec3 sum;
      for (int s = 0; s < samples * samples; ++s) {
        const double v = (y + (s / samples + 0.5) / samples) / height;
        const double u = (x + (s % samples + 0.5) / samples) / (2.0 * height);
        const double theta = std::numbers::pi * v, phi = 2.0 * std::numbers::pi * (u - 0.5);
        const Vec3 direction{std::sin(theta) * std::sin(phi), std::cos(theta),
                             -std::sin(theta) * std::cos(phi)};
        sum += room(direction);
        for (const SoftBox& box : boxes) sum += light_of(box, direction);
      }
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = static_cast<float>(sum[c] / (samples * samples));
    }
  return image;
}

}  // namespace lamina
