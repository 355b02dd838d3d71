// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/geometry/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/vec.h"

namespace lamina {
namespace {

/// Quantiles of the Blackman-Harris window on [-radius, radius]. Source: [Harris1978] Table 1, the
/// four-term window of -92 dB.
std::vector<float> filter_quantiles(double radius) {
  constexpr int count = 257, steps = 4096;
  const auto window = [](double t) {  // t in [0, 1]
    const double a = 2.0 * std::numbers::pi * t;
    return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) -
           0.01168 * std::cos(3.0 * a);
  };
  std::vector<double> cumulative = {0.0};
  for (int i = 0; i < steps; ++i)
    cumulative.push_back(cumulative.back() + window((i + 0.5) / steps));
  std::vector<float> quantiles;
  std::size_t at = 0;
  for (int i = 0; i < count; ++i) {
    const double target = cumulative.back() * i / (count - 1);
    while (at + 2 < cumulative.size() && cumulative[at + 1] < target) ++at;
    const double f = (target - cumulative[at]) / (cumulative[at + 1] - cumulative[at]);
    const double t = (static_cast<double>(at) + std::clamp(f, 0.0, 1.0)) / steps;
    quantiles.push_back(static_cast<float>(radius * (2.0 * t - 1.0)));
  }
  return quantiles;
}

}  // namespace

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : position_(camera.position),
      pixel_size_(2.0 * std::tan(0.5 * camera.horizontal_fov) / width),
      width_(width),
      height_(height),
      lens_radius_(0.5 * camera.aperture_diameter),
      focus_distance_(camera.focus_distance),
      filter_quantiles_(filter_quantiles(1.5)) {
  const Vec3 view = camera.look_at - camera.position;
  const double distance = length(view);
  if (!(distance > 0.0)) throw InvalidInput("camera: look_at must differ from position");
  const Vec3 z = -view / distance, x = cross(camera.up, z);
  if (!(length(x) > 1e-9 * length(camera.up)))
    throw InvalidInput("camera: up must not be parallel to the view");
  frame_.z = z;
  frame_.x = normalize(x);
  frame_.y = cross(frame_.z, frame_.x);
  if (!(focus_distance_ > 0.0)) focus_distance_ = distance;
}

float CameraRays::sample_offset(float u) const {
  const float at = u * static_cast<float>(filter_quantiles_.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), filter_quantiles_.size() - 2);
  const float f = at - static_cast<float>(i);
  return filter_quantiles_[i] + f * (filter_quantiles_[i + 1] - filter_quantiles_[i]);
}

Ray CameraRays::make_ray(int x, int y, PixelSamples& samples) const {
  const Vec2f offset = samples.next_2d();
  const double px = x + 0.5 + static_cast<double>(sample_offset(offset.x)) - 0.5 * width_;
  const double py = 0.5 * height_ - (y + 0.5 + static_cast<double>(sample_offset(offset.y)));
  Vec3 direction{px * pixel_size_, py * pixel_size_, -1.0};
  Vec3 origin;
  if (lens_radius_ > 0.0) {
    const Vec2f u = samples.next_2d();
    const double r = lens_radius_ * std::sqrt(static_cast<double>(u.x));
    const double phi = 2.0 * std::numbers::pi * static_cast<double>(u.y);
    origin = {r * std::cos(phi), r * std::sin(phi), 0.0};
    direction = focus_distance_ * direction - origin;
  }
  const Vec3 from = position_ + frame_.to_world(origin);
  const Vec3 to = normalize(frame_.to_world(direction));
  return {to_float(from), to_float(to)};
}

}  // namespace lamina
