// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/shading/refracted_entry.h"
#include "lamina/render/subsurface/random_walk/interior/body_interior.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {
/// The power heuristic of multiple importance sampling: the MIS weight of the sample of one
/// technique, where another finds the same light. Both densities per the same measure.
///
/// Source: [VeachGuibas1995] §3.2, with exponent 2.
[[nodiscard]] inline float power_heuristic(float own, float other) {
  return own > 0.0f ? 1.0f / (1.0f + (other / own) * (other / own)) : 0.0f;
}

/// Light of one point of a light source at a point inside.
template <int N>
struct RefractedLight {
  RefractedEntry entry;
  BandValues<N> unattenuated;  ///< fluence there without extinction, over the density
  float pdf = 0.0f;            ///< over directions inside [1/sr]; infinite if from one only
};

/// Manifold next-event estimation: connects points inside a body with lights, and with what is
/// bright in the sky (LightSeen::next_event_share), through the refracting boundary, on the path
/// that Snell's law takes.
///
/// Source: [Hanika2015] for one vertex; the solver is that of [JakobMarschner2012] §4.
template <int N>
class ManifoldNextEvent {
 public:
  using Bands = BandValues<N>;

  /// @param finds_reflected  light that the boundary reflects once inside, too: in one medium
  ManifoldNextEvent(const BodyInterior<N>& interior, bool finds_reflected)
      : interior_(interior),
        has_lights_(interior.scene().lights.has_next_event_light()),
        finds_reflected_(finds_reflected) {}

  [[nodiscard]] bool has_lights() const { return has_lights_; }

  /// Samples a point of a light: `on_light(RefractedLight)` for each path from there that is found.
  ///
  /// @param find_boundary  from the point; null: what is met first, if it is of the material
  template <class OnLight>
  void sample_light(const Vec3f& inside, float u_light, Vec2f u, const LightGatherer<N>& light,
                    const OnLight& on_light, const FindBoundary* find_boundary = nullptr) const;

  /// Radiance from outside along a ray on which a path leaves; light that next-event estimation at
  /// the path's last event finds, too, is weighted by multiple importance sampling.
  ///
  /// @param mis_weight     (RefractedEntry, pdf) to the MIS weight of next-event estimation
  /// @param lost_weight    (LightSeen) to the MIS weight of the path where that finds nothing
  /// @param find_boundary  as in `sample_light`
  template <class MisWeight, class LostWeight>
  [[nodiscard]] Bands escaping_radiance(const WalkPath<N>& path, const WalkExit& exit,
                                        const LightGatherer<N>& light, PixelSamples& samples,
                                        const MisWeight& mis_weight, const LostWeight& lost_weight,
                                        const FindBoundary* find_boundary = nullptr) const;

  /// Whether next-event estimation at an event finds light that entered at a point and was
  /// reflected so often before.
  ///
  /// @param outside  ray towards the light
  [[nodiscard]] bool finds(const Vec3f& event, int reflections, const SurfacePoint& entry,
                           const Ray& outside, const LightSeen& light) const;

 private:
  /// Whether two entries of paths of about a length are one.
  [[nodiscard]] bool is_same_entry(const Vec3f& a, const Vec3f& b, float path_length) const {
    constexpr float same_entry = 0.02f;  // of that length
    return length(a - b) < same_entry * path_length + least_distance(interior_.scene());
  }
  /// Surface point that a ray from inside meets, where its normal is about n.
  [[nodiscard]] std::optional<SurfacePoint> meet(const Vec3f& inside, const Vec3f& direction,
                                                 const Vec3f& n) const;
  /// Connections found of one kind, so that nothing counts twice.
  struct Connections {
    std::array<Vec3f, FewNormals::most * FewNormals::most + 2> entry;
    std::size_t count = 0;
  };
  template <class OnConnection>
  void add(const std::optional<RefractedEntry>& entry, Connections& found,
           const OnConnection& on_connection) const {
    if (!entry) return;
    const auto known = std::span(found.entry).first(found.count);
    const Vec3f& position = entry->point.position;
    if (std::ranges::any_of(
            known, [&](const Vec3f& k) { return is_same_entry(k, position, entry->length); }))
      return;
    found.entry[found.count++] = position;
    on_connection(*entry);
  }
  /// Paths from a point of a light to a point inside, through the boundary. Calls
  /// `on_connection(RefractedEntry)` for each that is found, the same ones for the same arguments.
  template <class OnConnection>
  void for_connections(const Vec3f& inside, const LightSample& sample,
                       const FindBoundary* find_boundary, const OnConnection& on_connection) const;
  /// Calls a function for paths that a flat part of the boundary reflects once inside.
  template <class OnConnection>
  void for_reflected_connections(const Vec3f& inside, const LightSample& sample,
                                 const OnConnection& on_connection) const;
  /// Next-event estimate at the last event of the path on which light is met.
  struct SameConnection {
    RefractedEntry entry;
    float pdf;
  };
  [[nodiscard]] std::optional<SameConnection> find_same_connection(
      const WalkPath<N>& path, const SurfacePoint& exit, const Ray& outside, const LightSeen& met,
      const FindBoundary* find_boundary) const;

  const BodyInterior<N>& interior_;
  bool has_lights_, finds_reflected_;
};

template <int N>
template <class OnConnection>
void ManifoldNextEvent<N>::for_connections(const Vec3f& inside, const LightSample& sample,
                                           const FindBoundary* find_boundary,
                                           const OnConnection& on_connection) const {
  const BodyInterior<N>& body = interior_;
  const auto straight = [&](const Vec3f& first) {
    return find_boundary ? find_refracted_entry(body.scene(), inside, *find_boundary, body.ior(),
                                                sample, first)
                         : find_refracted_entry(body.scene(), inside, body.material(), body.ior(),
                                                sample, first);
  };
  Connections found;
  // Start as if the nearest surface went on flat, which is often close; then as if each did that is
  // near; or straight to the light.
  const Vec3f& to_light = sample.direction;
  const Vec3f n = body.distance().nearest_normal(inside);
  const FewNormals near = body.distance().normals_near(inside);
  if (dot(n, to_light) > 0.0f)
    add(straight(refract_inside(to_light, n, body.ior())), found, on_connection);
  for (std::size_t i = 0; i < near.count; ++i) {
    if (!(dot(near.at[i], to_light) > 0.0f && differ(near.at[i], n))) continue;
    const Vec3f first = refract_inside(to_light, near.at[i], body.ior());
    if (meet(inside, first, near.at[i])) add(straight(first), found, on_connection);
  }
  if (found.count == 0) add(straight(to_light), found, on_connection);
}

template <int N>
template <class OnConnection>
void ManifoldNextEvent<N>::for_reflected_connections(const Vec3f& inside, const LightSample& sample,
                                                     const OnConnection& on_connection) const {
  const BodyInterior<N>& body = interior_;
  const Vec3f& to_light = sample.direction;
  const FewNormals near = body.distance().normals_near(inside);
  Connections found;
  for (std::size_t i = 0; i < near.count; ++i) {
    if (!(dot(near.at[i], to_light) > 0.0f)) continue;
    const Vec3f first = refract_inside(to_light, near.at[i], body.ior());
    for (std::size_t m = 0; m < near.count; ++m) {
      const float cosine = dot(first, near.at[m]);
      if (!(cosine < 0.0f)) continue;
      const auto mirror = meet(inside, first - 2.0f * cosine * near.at[m], near.at[m]);
      if (mirror && is_flat(*mirror) && mirror->material == body.material())
        add(find_reflected_entry(body.scene(), inside, *mirror, body.ior(), sample, first), found,
            on_connection);
    }
  }
}

template <int N>
template <class OnLight>
void ManifoldNextEvent<N>::sample_light(const Vec3f& inside, float u_light, Vec2f u,
                                        const LightGatherer<N>& light, const OnLight& on_light,
                                        const FindBoundary* find_boundary) const {
  const LightSample sample = interior_.scene().lights.sample_light(inside, u_light, u);
  if (!(sample.pdf > 0.0f && sample.next_event_share > 0.0f)) return;
  const auto add_light = [&](const RefractedEntry& entry) {
    const float ior = interior_.ior();
    const float entering =
        1.0f - static_cast<float>(fresnel(std::min(entry.cos_outside, 1.0f), ior));
    const Bands clear =
        light.shadow_transmittance({leave_surface(entry.point, entry.to_light), entry.to_light},
                                   0.9999f * entry.light_distance);
    if (!(largest(clear) > 0.0f)) return;
    // The Jacobian of solid angles inside with respect to those outside, inverted.
    const float jacobian = entry.geometry_term / (ior * ior);
    on_light(RefractedLight<N>{
        .entry = entry,
        .unattenuated =
            (sample.next_event_share * entering * entry.reflectance * jacobian / sample.pdf) *
            clear * interior_.conversion().from_rgb(sample.radiance),
        .pdf = sample.is_delta ? std::numeric_limits<float>::infinity() : sample.pdf / jacobian});
  };
  for_connections(inside, sample, find_boundary, add_light);
  if (finds_reflected_) for_reflected_connections(inside, sample, add_light);
}

template <int N>
template <class MisWeight, class LostWeight>
BandValues<N> ManifoldNextEvent<N>::escaping_radiance(const WalkPath<N>& path, const WalkExit& exit,
                                                      const LightGatherer<N>& light,
                                                      PixelSamples& samples,
                                                      const MisWeight& mis_weight,
                                                      const LostWeight& lost_weight,
                                                      const FindBoundary* find_boundary) const {
  const Ray ray{leave_surface(exit.point, exit.outside), exit.outside};
  Bands radiance = light.arriving_radiance(ray, samples);
  interior_.scene().lights.for_lights_seen(
      ray, 0.0f, std::numeric_limits<float>::infinity(), false, [&](const LightSeen& seen) {
        if (!(seen.next_event_share > 0.0f)) return;
        const auto found = find_same_connection(path, exit.point, ray, seen, find_boundary);
        const float weight =
            found ? 1.0f - mis_weight(found->entry, found->pdf) : lost_weight(seen);
        if (weight > 0.0f)
          radiance += weight * seen.next_event_share *
                      interior_.conversion().from_rgb(seen.radiance) *
                      light.shadow_transmittance(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

}  // namespace lamina
