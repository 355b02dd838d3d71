// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lamina/base/core/inline_vector.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/optics/phase_function.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/profiles/material_profiles.h"
#include "lamina/render/subsurface/profiles/once_in_even_light.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {

/// Single scattering: adds light that was scattered exactly once to a method that leaves it out, as
/// diffusion does.
///
/// A ray of the eye is refracted into the object; on it an event is sampled, by the layers'
/// extinction. Lights, and what is bright in the sky (LightSeen::next_event_share), are sampled by
/// next-event estimation through the surface; the rest of the sky and other objects along a
/// direction that samples the phase function.
/// Layers follow the depth below the point where the ray enters, then below the point where the
/// light does. Boundaries are taken as smooth for the path, with what the surface really lets
/// through, and those between layers as matched.
///
/// Colors count as with the method beside it: one that scales does so where the light enters; of
/// one that is inverted the layers have the absorption of the exit on the way out and that of the
/// entry on the way in.
///
/// Diffusion and light scattered once together can make more than the light that entered, as near
/// white: in even light on flat layers both are scaled so that they do not.
///
/// Source: [Hery2003] §1.1, §2, §4; [Jensen2001] §2.1. The print's estimator divides by the
/// extinction along the way in and so counts the falloff twice, lacks the 1/4 pi of the phase
/// function and the (cos_i / cos_i') / n^2 of the refracted beam.
template <int N>
class SingleScattering final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param is_refracted  connect events with lights by Snell's law, not on a straight line
  /// @param make_profile  that of `multiple`
  /// @param multiple      the method that finds light scattered more often
  SingleScattering(const RenderScene& scene, const BandConversion<N>& conversion,
                   std::uint32_t material, bool is_refracted, const ProfileMaker& make_profile,
                   std::unique_ptr<SubsurfaceMethod<N>> multiple);

  void prepare_reflectance(const Preparation<N>& with) override {
    multiple_->prepare_reflectance(with);
  }
  [[nodiscard]] bool prepare(const Preparation<N>& with) override {
    return multiple_->prepare(with);
  }
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override {
    return multiple_->expected_cost(with);
  }
  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    return multiple_->local_reflectance(point);
  }

  /// Radiance of light scattered once, by one random estimate.
  [[nodiscard]] Bands once(const ExitPoint& exit, const LightGatherer<N>& light,
                           PixelSamples& samples) const;

 private:
  /// The extinction of each layer where a path enters or leaves.
  using Extinction = InlineVector<Bands, 4>;
  [[nodiscard]] Extinction extinction_at(const SurfacePoint& point) const;
  /// The exit itself, or near it where the light is blurred.
  [[nodiscard]] SurfacePoint blurred(const ExitPoint& exit, PixelSamples& samples) const;
  [[nodiscard]] Bands blurred_once(const ExitPoint& exit, const LightGatherer<N>& light,
                                   PixelSamples& samples) const;

  /// A scattering event on the refracted ray.
  struct Event {
    Vec3f inside, to_exit;
    std::size_t layer = 0;
    Bands throughput;  ///< of light scattered there per solid angle, to the eye
  };
  [[nodiscard]] Event sample_event(const ExitPoint& exit, Vec2f u) const;
  [[nodiscard]] Bands next_event_radiance(const Event& event, const LightGatherer<N>& light,
                                          float u_light, Vec2f u) const;
  [[nodiscard]] Bands phase_sampled_radiance(const Event& event, const LightGatherer<N>& light,
                                             Vec2f u, PixelSamples& samples) const;
  /// Transmittance of the way of light from where it enters, of a length [mm] inside.
  [[nodiscard]] Bands way_from(const SurfacePoint& entry, float length, float cos_inside) const;
  /// Optical thickness of the layers down to a depth [mm].
  [[nodiscard]] Bands optical_depth(const Extinction& extinction, float depth) const;
  [[nodiscard]] std::size_t layer_at(float depth) const;
  /// Depth [mm] at which a band's optical depth is reached.
  [[nodiscard]] float depth_at(const Extinction& extinction, float optical_depth, int band) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  std::uint32_t material_;
  bool is_refracted_;
  int bands_;
  float ior_;  ///< over that outside, mean of the bands
  const SubsurfaceSurface& surface_;
  FirstOrderStack<Bands> layers_;
  std::vector<Bands> absorption_;      ///< [layer], that of inverted colors is a factor of [1/mm]
  MaterialProfiles<N> profiles_;       ///< for what colors make of the light
  OnceInEvenLight<N> in_even_light_;   ///< of the brightest color
  std::vector<PhaseFunction> phases_;  ///< [layer], of the middle band: what directions follow
  std::unique_ptr<SubsurfaceMethod<N>> multiple_;
};

}  // namespace lamina
