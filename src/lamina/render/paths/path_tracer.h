// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/film/camera_sample.h"
#include "lamina/render/paths/path.h"
#include "lamina/render/shading/shadow_transmittance.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// A path tracer with next-event estimation and multiple importance sampling: follows light from
/// the camera back to the lights.
///
/// At the first translucent surface both its reflection and its inside are followed; behind a
/// bounce translucent surfaces count as diffuse ones of the same total reflectance, since the
/// spread of light below them is lost in the next bounce anyway.
template <int N>
class PathTracer final : public LightGatherer<N> {
 public:
  using Bands = BandValues<N>;

  explicit PathTracer(const PathWorld<N>& world) : world_(world) {}

  /// @param spread  angle between the rays of neighbouring pixels [rad]
  [[nodiscard]] CameraSample trace_camera_ray(const Ray& ray, float spread,
                                              PixelSamples& samples) const;

  /// Light that enters at a point that no path has come to before.
  [[nodiscard]] Bands entering_irradiance(const SurfacePoint& entry,
                                          PixelSamples& samples) const override {
    return entering_light(entry, 0, samples, nullptr).irradiance;
  }
  [[nodiscard]] EnteringLight<N> entering_light(const SurfacePoint& entry, PixelSamples& samples,
                                                const SkyIrradiance& sky) const override {
    return entering_light(entry, 0, samples, &sky);
  }
  [[nodiscard]] Bands shadow_transmittance(const Ray& ray, float distance) const override {
    return lamina::shadow_transmittance(world_.scene, world_.sheets, ray, distance,
                                        Dielectrics::transmit);
  }
  [[nodiscard]] Bands arriving_radiance(const Ray& ray, PixelSamples& samples) const override {
    return arriving_radiance(ray, 0, samples);
  }

 private:
  class Gatherer;

  [[nodiscard]] Bands trace_path(PathState<N> path, PixelSamples& samples,
                                 CameraSample* first = nullptr) const;
  /// @param sky  null: of the light that enters its irradiance alone
  [[nodiscard]] EnteringLight<N> entering_light(const SurfacePoint& entry, int bounce,
                                                PixelSamples& samples,
                                                const SkyIrradiance* sky) const;
  [[nodiscard]] Bands arriving_radiance(const Ray& ray, int bounce, PixelSamples& samples) const {
    return trace_path({.ray = ray,
                       .bounce = bounce + 1,
                       .spread = 0.3f,
                       .is_from_inside = true,
                       .is_scattered = true},
                      samples);
  }
  /// Adds the lights that the ray meets before `limit` [mm], by their MIS weights.
  void add_lights_on_ray(float limit, PathState<N>& path) const;
  /// Adds one that it meets.
  void add_light_seen(const LightSeen& seen, PathState<N>& path) const;
  /// Whether a path goes straight through a surface: by a hole, or unscattered through a sheet.
  [[nodiscard]] bool passes_straight(const SurfacePoint& point, PathState<N>& path,
                                     PixelSamples& samples) const;
  /// A dielectric on the way of indirect light: passed straight, as in shadow_transmittance, or
  /// mirrored.
  void pass_unbent(const Hit& hit, const SurfacePoint& point, const DielectricSurface& glass,
                   PathState<N>& path, PixelSamples& samples) const;
  /// Next-event estimation at a surface and the next direction of the path; false if it ends.
  [[nodiscard]] bool take_step(const SurfacePoint& point, PathState<N>& path, PixelSamples& samples,
                               CameraSample* first) const;
  /// Indirect clamping: light on its way to a surface by a mirror or a highlight, cut off at ten
  /// times the typical radiance of the scene. What is lost are caustics, which paths from the eye
  /// find so seldom that they are but fireflies; light scattered diffusely stays below that anyway.
  [[nodiscard]] Bands clamp_indirect(Bands light, const PathState<N>& path) const;

  PathWorld<N> world_;
};

}  // namespace lamina
