// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/probe/probe_transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lamina/base/core/float_pi.h"
#include "lamina/render/subsurface/leaving_fraction.h"

namespace lamina {
namespace {

/// Mean number of probes along the two tangents and the normal. On a flat surface the tangents find
/// nothing, so the normal is always probed and one of the others every other time.
constexpr std::array<float, 3> probes_along = {0.25f, 0.25f, 1.0f};

}  // namespace

template <int N>
BandValues<N> ProbeTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                  const LightGatherer<N>& light,
                                                  PixelSamples& samples) const {
  const SurfacePoint& point = exit.point;
  const auto local = profiles_.profiles_at(point);
  const RadiusMixture<N> radii = profiles_.radius_mixture(local);
  const float support = profiles_.support_radius();
  const Framef frame = make_frame(point.smooth_normal);
  const std::array<Vec3f, 3> axes = {frame.x, frame.y, frame.z};

  // One of all hits, drawn by its weight.
  float total = 0.0f, chosen_weight = 0.0f, u_left = samples.next_1d();
  Bands chosen_value;
  SurfacePoint entry;
  const auto probe_along = [&](std::size_t axis, Vec2f u) {
    const Vec3f &probe = axes[axis], &across = axes[(axis + 1) % 3], &along = axes[(axis + 2) % 3];
    const float r = radii.sample_radius(u.x), phi = 2.0f * float_pi * u.y;
    const float half = std::sqrt(std::max(support * support - r * r, 1e-6f * support * support));
    const Vec3f origin =
        point.position + r * (std::cos(phi) * across + std::sin(phi) * along) + half * probe;
    ProbeHits found;
    scene_.geometry.all_hits({origin, -probe}, 2.0f * half, material_, found);
    for (const Hit& hit : found.all()) {
      const SurfacePoint candidate = make_surface_point(scene_.scene->meshes, hit, point.footprint);
      const Vec3f offset = candidate.position - point.position;
      // Each point belongs to the axis that its facet faces most, and counts on that one alone.
      const Vec3f facing{std::abs(dot(candidate.geometric_normal, axes[0])),
                         std::abs(dot(candidate.geometric_normal, axes[1])),
                         std::abs(dot(candidate.geometric_normal, axes[2]))};
      const std::size_t own_axis = facing.z >= facing.x && facing.z >= facing.y ? 2
                                   : facing.x >= facing.y                       ? 0
                                                                                : 1;
      if (own_axis != axis) continue;
      const float height = dot(offset, probe);
      const float across_probe = std::sqrt(std::max(dot(offset, offset) - height * height, 0.0f));
      // Mean number of probes that find the point, per area of the surface.
      const float density =
          probes_along[axis] * facing[static_cast<int>(axis)] * radii.density(across_probe);
      if (!(density > 0.0f)) continue;
      const Bands index =
          local.is_inverted ? profiles_.albedo_index(profiles_.color_at(candidate)) : Bands{};
      const Bands value = (1.0f / density) * profiles_.evaluate(local, offset, point.smooth_normal,
                                                                candidate.smooth_normal, index);
      const float weight = sum(value);
      if (!(weight > 0.0f)) continue;
      total += weight;
      // Reservoir: the new one replaces the old with chance weight / total; u is used up in parts.
      const float chance = weight / total;
      if (u_left < chance) {
        u_left /= chance;
        chosen_value = value;
        chosen_weight = weight;
        entry = candidate;
      } else {
        u_left = (u_left - chance) / std::max(1.0f - chance, 1e-9f);
      }
    }
  };
  probe_along(2, samples.next_2d());
  const float u_axis = samples.next_1d();
  const Vec2f u_tangent = samples.next_2d();
  if (u_axis < probes_along[0])
    probe_along(0, u_tangent);
  else if (u_axis < probes_along[0] + probes_along[1])
    probe_along(1, u_tangent);
  if (!(total > 0.0f)) return {};
  const SurfaceMaterial& material = scene_.scene->materials[material_];
  if (material.bump || material.normal_map)
    entry.normal = bent_normal(scene_.textures, material, entry);
  return (leaving_fraction(exit, is_printed_exit_) * total / chosen_weight) * chosen_value *
         profiles_.entering_color(entry) * light.entering_irradiance(entry, samples);
}

template class ProbeTransport<4>;
template class ProbeTransport<8>;
template class ProbeTransport<16>;

}  // namespace lamina
