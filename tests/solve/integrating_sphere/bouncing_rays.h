// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/solve/integrating_sphere/integrating_sphere.h"

namespace lamina {

/// A slow and literal second version of the light in a sphere: rays between a wall that scatters as
/// Lambert's law has it, round flat ports, and a baffle. Lengths are in radii of the sphere.
class BouncingRays {
 public:
  /// @param in_port  reflectance of what is in the sample's port
  BouncingRays(const IntegratingSphere& sphere, double in_port) : sphere_(sphere) {
    const auto port = [&](Vec3 toward, double diameter, double reflectance) {
      const double radius = diameter / sphere.diameter;
      return Port{toward, std::sqrt(1.0 - radius * radius), radius, reflectance};
    };
    ports_ = {port({0, 0, -1}, sphere.sample_port, in_port),
              port({1, 0, 0}, sphere.detector_port, sphere.detector_reflectance),
              port({0, 0, 1}, sphere.entrance_port, 0.0)};
    baffle_radius_ = 0.53 * (ports_[0].radius + ports_[1].radius);
  }

  /// How often light meets the detector, of that which the whole of the sample's face scatters, or
  /// of a beam that meets the wall.
  [[nodiscard]] double signal(bool is_beam, int rays, std::uint64_t seed) {
    met_ = 0;
    for (int i = 0; i < rays; ++i) {
      random_ = make_random(seed, static_cast<std::uint64_t>(i));
      if (is_beam) {
        const Vec3 spot = {-0.8, 0.0, 0.6};
        if (chance(sphere_.wall_reflectance)) follow(spot, -spot);
      } else {
        const double r = ports_[0].radius * std::sqrt(random_.uniform());
        const double phi = 2.0 * std::numbers::pi * random_.uniform();
        follow({r * std::cos(phi), r * std::sin(phi), -ports_[0].depth}, {0, 0, 1});
      }
    }
    return static_cast<double>(met_) / rays;
  }

 private:
  struct Port {
    Vec3 toward;  ///< from the middle of the sphere
    double depth, radius, reflectance;
  };

  [[nodiscard]] bool chance(double p) { return random_.uniform() < p; }

  /// A direction by the cosine around a normal.
  [[nodiscard]] Vec3 scattered(const Vec3& normal) {
    const double z = 2.0 * random_.uniform() - 1.0;
    const double phi = 2.0 * std::numbers::pi * random_.uniform();
    const double s = std::sqrt(1.0 - z * z);
    return normalize(normal + Vec3{s * std::cos(phi), s * std::sin(phi), z});
  }

  /// Turns a ray that meets the baffle, which stands in the middle between sample and detector.
  /// @param length  free way of the ray
  [[nodiscard]] bool meets_baffle(Vec3& from, const Vec3& way, double length, Vec3& normal) const {
    const Vec3 middle = {0.5, 0.0, -0.5}, axis = normalize(Vec3{1.0, 0.0, 1.0});
    const double along = dot(way, axis);
    const double distance = dot(axis, middle - from) / along;
    if (!(distance > 1e-9 && distance < length)) return false;
    const Vec3 at = from + distance * way;
    if (lamina::length(at - middle) > baffle_radius_) return false;
    from = at;
    normal = along > 0.0 ? -axis : axis;
    return true;
  }

  void follow(Vec3 from, Vec3 normal) {
    for (;;) {
      const Vec3 way = scattered(normal);
      const double b = dot(from, way);
      double length = -b + std::sqrt(std::max(0.0, b * b + 1.0 - dot(from, from)));
      const Vec3 end = from + length * way;
      double reflectance = sphere_.wall_reflectance;
      Vec3 next_normal = -end;
      bool is_detector = false;
      for (std::size_t p = 0; p < ports_.size(); ++p) {
        if (dot(end, ports_[p].toward) <= ports_[p].depth) continue;
        length = (ports_[p].depth - dot(from, ports_[p].toward)) / dot(way, ports_[p].toward);
        reflectance = ports_[p].reflectance;
        next_normal = -ports_[p].toward;
        is_detector = p == 1;
      }
      if (sphere_.has_baffle && meets_baffle(from, way, length, normal)) {
        if (!chance(sphere_.wall_reflectance)) return;
        continue;
      }
      met_ += is_detector ? 1 : 0;
      if (!chance(reflectance)) return;
      from = from + length * way;
      normal = next_normal;
    }
  }

  const IntegratingSphere& sphere_;
  std::array<Port, 3> ports_;
  double baffle_radius_ = 0.0;
  Random random_ = make_random(0, 0);
  long met_ = 0;
};

}  // namespace lamina
