// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>

#include "lamina/render/subsurface/papers/single_scattering/single_scattering.h"
#include "render/small_scenes.h"

// Light scattered once, alone: what SingleScattering adds to a method that finds nothing.

namespace lamina::once {

inline constexpr float pi = std::numbers::pi_v<float>;

inline Material one_layer(double g, double ior) {
  Material material{.name = "test", .ior_above = {1, 1, 1}, .ior_below = {ior, ior, ior}};
  material.layers = {{.name = "layer",
                      .sigma_a = {0.2, 1.0, 3.0},
                      .sigma_s = {2, 1, 1},
                      .g = {g, g, g},
                      .ior = {ior, ior, ior}}};
  return material;
}

/// Finds no light: what is left is light scattered once.
class Nothing final : public SubsurfaceMethod<4> {
  [[nodiscard]] BandValues<4> leaving_radiance(const ExitPoint&, const LightGatherer<4>&,
                                               PixelSamples&) const override {
    return {};
  }
  [[nodiscard]] BandValues<4> local_reflectance(const SurfacePoint&) const override { return {}; }
};

/// Nothing but a white sky around.
class ClearAir final : public LightGatherer<4> {
  [[nodiscard]] BandValues<4> entering_irradiance(const SurfacePoint&,
                                                  PixelSamples&) const override {
    return {};
  }
  [[nodiscard]] BandValues<4> shadow_transmittance(const Ray&, float) const override {
    return BandValues<4>::filled(1.0f);
  }
  [[nodiscard]] BandValues<4> arriving_radiance(const Ray&, PixelSamples&) const override {
    return BandValues<4>::filled(has_sky ? 1.0f : 0.0f);
  }

 public:
  bool has_sky = false;
};

inline Scene scene_of(Mesh mesh, Material material, Light light) {
  Scene scene;
  scene.materials = {{.name = "translucent", .surface = SubsurfaceSurface{.material = material}}};
  scene.meshes = {std::move(mesh)};
  scene.lights = {light};
  return scene;
}

inline Vec3f along(double theta, double phi) {
  return {static_cast<float>(std::sin(theta) * std::cos(phi)),
          static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta))};
}

/// A scene that is prepared for light scattered once.
class LightOnce {
 public:
  LightOnce(Scene scene, bool is_refracted, bool has_sky = false)
      : scene_(std::move(scene)),
        prepared_(scene_),
        single_(prepared_, conversion_, 0, is_refracted,
                ProfileMaker(RenderSettings{.profile = RenderSettings::Profile::diffusion}),
                std::make_unique<Nothing>()) {
    air_.has_sky = has_sky;
  }

  /// Mean radiance leaving the surface at a place, over `count` samples.
  [[nodiscard]] BandValues<4> mean(const Vec3f& to_eye, std::uint32_t count,
                                   const Vec3f& at = {}) const {
    const Hit hit = prepared_.geometry.first_hit({at + 50.0f * to_eye, -to_eye}, 0.0f);
    const SurfacePoint point = surface_at(prepared_, hit, 0.0f);
    const SurfaceBoundary boundary = boundary_at(prepared_, point);
    const ExitPoint exit{point, boundary, dot(point.normal, to_eye), to_eye};
    BandValues<4> sum;
    for (std::uint32_t s = 0; s < count; ++s) {
      PixelSamples samples(1, 2, s);
      sum += single_.leaving_radiance(exit, air_, samples);
    }
    return (1.0f / static_cast<float>(count)) * sum;
  }

 private:
  Scene scene_;
  RenderScene prepared_;
  BandConversion<4> conversion_ =
      make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
  SingleScattering<4> single_;
  ClearAir air_;
};

inline BandValues<4> mean_once(const Scene& scene, const Vec3f& to_eye, bool is_refracted,
                               std::uint32_t count, bool has_sky = false, const Vec3f& at = {}) {
  return LightOnce(scene, is_refracted, has_sky).mean(to_eye, count, at);
}

}  // namespace lamina::once
