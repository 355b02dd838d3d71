// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/sky_irradiance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/parallel_chunks.h"

namespace lamina {
namespace {

/// Places on the unit square of directions: the upper half of the octahedron in the middle, the
/// lower one folded out to its corners.
Vec3f octahedral_direction(float x, float y) {
  const float a = 2.0f * x - 1.0f, b = 2.0f * y - 1.0f, z = 1.0f - std::abs(a) - std::abs(b);
  const float folded = std::max(-z, 0.0f);
  return normalize(Vec3f{a - std::copysign(folded, a), b - std::copysign(folded, b), z});
}

Vec2f octahedral_place(const Vec3f& d) {
  const float sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  float a = d.x / sum, b = d.y / sum;
  if (d.z < 0.0f) {
    const float folded = 1.0f - std::abs(b);
    b = std::copysign(1.0f - std::abs(a), b);
    a = std::copysign(folded, a);
  }
  return {0.5f + 0.5f * a, 0.5f + 0.5f * b};
}

struct SkySample {
  Vec3f direction, power;
};

/// Directions with the radiance of the sky over their density: half of them drawn as light samples
/// are, half evenly, together by the balance heuristic [VeachGuibas1995].
std::vector<SkySample> sky_samples(const Lights& lights) {
  constexpr std::uint32_t count = 4096;
  constexpr float even = 1.0f / (4.0f * float_pi);
  std::vector<SkySample> result;
  result.reserve(2 * count);
  for (std::uint32_t k = 0; k < count; ++k) {
    PixelSamples numbers(0x5bd1e995u, 0, k);
    const float which = (static_cast<float>(k) + 0.5f) / static_cast<float>(count);
    const LightSample light = lights.sample_light({}, which, numbers.next_2d());
    if (light.pdf > 0.0f && is_sky(light))
      result.push_back(
          {light.direction, light.radiance / (static_cast<float>(count) * (light.pdf + even))});
    const Vec2f u = numbers.next_2d();
    const float z = 2.0f * u.x - 1.0f, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float phi = 2.0f * float_pi * u.y;
    const Vec3f direction{r * std::cos(phi), r * std::sin(phi), z};
    Vec3f power;
    for_sky_seen(lights, direction, [&](const LightSeen& seen) {
      power += seen.radiance / (static_cast<float>(count) * (seen.pdf + even));
    });
    result.push_back({direction, power});
  }
  return result;
}

}  // namespace

bool has_uneven_sky(const Lights& lights) {
  constexpr int tries = 64;  // of a stratum, which may be all lights
  for (const LightStratum& stratum : lights.strata())
    for (int i = 0; i < tries; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(tries);
      const LightSample light =
          lights.sample_light({}, stratum.low + stratum.size * u, {0.5f, 0.5f});
      if (light.pdf > 0.0f && is_sky(light)) return true;
    }
  return false;
}

SkyIrradiance::SkyIrradiance(const Lights& lights, const SurfaceBoundary& boundary)
    : irradiance_(static_cast<std::size_t>((side + 1) * (side + 1))) {
  for (int i = 0; i <= cosines; ++i)
    passing_[static_cast<std::size_t>(i)] =
        1.0f - reflectance(boundary, static_cast<float>(i) / static_cast<float>(cosines));
  const std::vector<SkySample> samples = sky_samples(lights);
  parallel_chunks(irradiance_.size(), 32, [&](std::size_t at) {
    const auto x = static_cast<float>(at % (side + 1)), y = static_cast<float>(at / (side + 1));
    const Vec3f normal = octahedral_direction(x / side, y / side);
    for (const SkySample& sample : samples) {
      const float cos_i = dot(sample.direction, normal);
      if (cos_i > 0.0f) irradiance_[at] += entering(cos_i) * sample.power;
    }
  });
}

float SkyIrradiance::entering(float cos_i) const {
  const float place = std::min(cos_i, 1.0f) * static_cast<float>(cosines);
  const int i = std::min(static_cast<int>(place), cosines - 1);
  const float f = place - static_cast<float>(i);
  const auto k = static_cast<std::size_t>(i);
  return cos_i * (passing_[k] + f * (passing_[k + 1] - passing_[k]));
}

Vec3f SkyIrradiance::at(const Vec3f& normal) const {
  const Vec2f place = octahedral_place(normal);
  const float x = place.x * side, y = place.y * side;
  const int i = std::clamp(static_cast<int>(x), 0, side - 1);
  const int j = std::clamp(static_cast<int>(y), 0, side - 1);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const Vec3f* row = &irradiance_[static_cast<std::size_t>(j * (side + 1) + i)];
  const Vec3f* next = row + side + 1;
  const Vec3f low = row[0] + fx * (row[1] - row[0]);
  return low + fy * (next[0] + fx * (next[1] - next[0]) - low);
}

}  // namespace lamina
