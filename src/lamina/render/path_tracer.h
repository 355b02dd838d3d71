// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lamina/core/band_values.h"
#include "lamina/render/band_conversion.h"
#include "lamina/render/clear_fraction.h"
#include "lamina/render/layered_material.h"
#include "lamina/render/low_discrepancy.h"
#include "lamina/render/render_scene.h"
#include "lamina/render/subsurface_transport.h"
#include "lamina/render/thin_sheet.h"

namespace lamina {

/// What one camera ray brings home, in linear Rec.709.
struct CameraSample {
  Vec3f beauty, subsurface, specular;  ///< subsurface and specular: parts at the first surface
  Vec3f normal, albedo;                ///< of the first surface
  float depth = 0.0f;                  ///< distance to it [mm]
  bool is_subsurface = false;
  bool is_hit = false;
};

/// How directions are drawn at a surface. Each alone converges to the same image; they are for
/// tests, together they have the least noise.
enum class DirectLight { combined, lights_only, surfaces_only };

struct PathOptions {
  int max_bounces = 4;  ///< of light between surfaces
  DirectLight direct_light = DirectLight::combined;
};

/// Follows light from the camera back to the lights.
///
/// At the first translucent surface both its reflection and its inside are followed; behind a
/// bounce translucent surfaces count as diffuse ones of the same total reflectance, since the
/// spread of light below them is lost in the next bounce anyway.
template <int N>
class PathTracer final : public LightGatherer<N> {
 public:
  using Bands = BandValues<N>;

  /// `transports`, `layered` and `sheets` hold one entry per material, null where it is not
  /// translucent, none for its BSDF alone, or not thin. All must outlive the tracer.
  PathTracer(const RenderScene& scene, const BandConversion<N>& conversion,
             const std::vector<std::unique_ptr<SubsurfaceTransport<N>>>& transports,
             const LayeredMaterials<N>& layered, const ThinSheets<N>& sheets,
             const PathOptions& options)
      : scene_(scene),
        conversion_(conversion),
        transports_(transports),
        layered_(layered),
        sheets_(sheets),
        options_(options) {}

  /// @param spread  angle between the rays of neighbouring pixels [rad]
  [[nodiscard]] CameraSample trace_camera_ray(const Ray& ray, float spread,
                                              PixelSamples& samples) const;

  /// Of a point that no path has come to before.
  [[nodiscard]] Bands entering_irradiance(const SurfacePoint& entry,
                                          PixelSamples& samples) const override {
    return entering_irradiance(entry, 0, samples);
  }
  [[nodiscard]] Bands clear_fraction(const Ray& ray, float distance) const override {
    return lamina::clear_fraction(scene_, sheets_, ray, distance, Dielectrics::let_through);
  }
  [[nodiscard]] Bands arriving_radiance(const Ray& ray, PixelSamples& samples) const override {
    return arriving_radiance(ray, 0, samples);
  }

 private:
  class Gatherer;

  /// An opaque or thin surface seen from `wo`.
  struct Surface {
    SurfacePoint point;
    SurfaceBoundary boundary;
    Framef frame;
    Vec3f wo;           ///< in the frame
    Bands reflectance;  ///< of the base
    const SubsurfaceTransport<N>* transport = nullptr;

    // Of layers without spread alone:
    std::unique_ptr<LayeredPoint<N>> layered;
    Bands mirrored;                ///< by mirrors below the surface
    float mirrored_chance = 0.0f;  ///< share of them among the light of the base that is drawn

    // Of a thin sheet alone:
    const ThinSheet<N>* sheet = nullptr;
    typename ThinSheet<N>::Place place;
    int side = 0;            ///< that it is seen from
    Bands color;             ///< of the scattered light
    SurfaceBoundary beyond;  ///< the boundary on the other side
    Bands transmittance;     ///< fraction that comes through scattered
    /// Share of light scattered by the base that is drawn from beyond.
    [[nodiscard]] float beyond_chance() const {
      const float t = sum(transmittance);
      return t > 0.0f ? std::clamp(t / (t + sum(reflectance)), 0.05f, 0.95f) : 0.0f;
    }
  };

  struct Path {
    int bounce = 0;
    float pdf = 0.0f;        ///< with which its direction was drawn [1/sr]; 0: from a single one
    float spread = 0.0f;     ///< growth of the footprint with distance [rad]
    float footprint = 0.0f;  ///< at the origin of the ray [mm]
    float index = 1.0f;      ///< refractive index of what it is in, known on paths from the eye
    bool is_camera_ray = false;  ///< straight from the camera
    bool is_from_eye = false;    ///< from the camera, maybe through glass
    bool sees_lamps = true;      ///< at the end of its first ray
    bool is_scattered = false;   ///< spread out by a surface on the way
  };

  [[nodiscard]] Bands follow(Ray ray, Path path, PixelSamples& samples, CameraSample* first) const;
  [[nodiscard]] Surface make_surface(const SurfacePoint& point, const Vec3f& towards_eye) const;

  struct LightDrawn {
    LightSample light;
    float weight = 0.0f;  ///< on its radiance; 0: nothing to be had
    Bands clear;          ///< fraction that arrives, for what lies between
  };
  /// A light, drawn in proportion to what it would give: `value(LightSample)` is the factor on its
  /// radiance. Source: [Talbot2005], with one visibility for all candidates.
  template <class Value>
  [[nodiscard]] LightDrawn draw_light(const SurfacePoint& point, PixelSamples& samples,
                                      const Value& value,
                                      Dielectrics dielectrics = Dielectrics::let_through) const;

  /// Light from one light sample, mirrored and, if asked for, scattered by the base.
  struct Reflected {
    Bands specular, base;
  };
  [[nodiscard]] Reflected direct_light(const Surface& surface, bool with_base,
                                       float specular_chance, float base_chance,
                                       PixelSamples& samples) const;
  [[nodiscard]] Bands entering_irradiance(const SurfacePoint& entry, int bounce,
                                          PixelSamples& samples) const;
  [[nodiscard]] Bands arriving_radiance(const Ray& ray, int bounce, PixelSamples& samples) const {
    return follow(ray,
                  {.bounce = bounce + 1, .spread = 0.3f, .sees_lamps = false, .is_scattered = true},
                  samples, nullptr);
  }
  /// Chance that a path goes on by the boundary of a surface rather than its base.
  [[nodiscard]] static float specular_chance(const Surface& surface);
  /// Turns a path at a diffuse or coated surface; false if it ends there.
  [[nodiscard]] bool scatter(const Surface& surface, float chance, Ray& ray, Path& path,
                             Bands& throughput, bool& is_specular, PixelSamples& samples) const;
  /// What the base makes of light from wi: its bsdf is lobe * color [1/sr].
  [[nodiscard]] static float base_lobe(const Surface& surface, const Vec3f& wi);
  [[nodiscard]] static Bands base_color(const Surface& surface, const Vec3f& wi);
  /// Density with which `scatter` draws a direction by the base [1/sr].
  [[nodiscard]] static float pdf_base(const Surface& surface, const Vec3f& wi);
  /// Whether a path goes straight through a surface: by a hole, or unscattered through a sheet.
  [[nodiscard]] bool passes(const SurfacePoint& point, const Ray& ray, Bands& throughput,
                            PixelSamples& samples) const;
  /// Adds the light that a rough dielectric scatters towards the eye, and turns the path there;
  /// false if it ends.
  [[nodiscard]] bool pass_dielectric(const SurfacePoint& point, const DielectricSurface& glass,
                                     Ray& ray, Path& path, Bands& throughput, Bands& radiance,
                                     PixelSamples& samples) const;
  /// Light on its way to a surface by a mirror or a highlight, cut off at ten times the typical
  /// radiance of the scene. What is lost are caustics, which paths from the eye find so seldom that
  /// they are but bright specks; light scattered diffusely stays below that anyway.
  [[nodiscard]] Bands without_caustics(Bands light, const Path& path) const;
  [[nodiscard]] float weight_of_surface_sample(float pdf, float pdf_light) const;
  [[nodiscard]] float weight_of_light_sample(const LightSample& light, float pdf) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const std::vector<std::unique_ptr<SubsurfaceTransport<N>>>& transports_;
  const LayeredMaterials<N>& layered_;
  const ThinSheets<N>& sheets_;
  PathOptions options_;
};

}  // namespace lamina
