// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lamina/optics/phase_function.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/render/subsurface/random_walk/internal/manifold_next_event.h"
#include "lamina/render/subsurface/random_walk/internal/radiance_field.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/scattering/layered_bsdf/first_order.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// The truth for curved objects: paths that scatter inside a closed mesh of one homogeneous medium
/// until they leave it. No profile, no diffusion, no flatness.
///
/// Lamps are sought from scattering events through the smooth boundary, on the way that Snell's law
/// takes. A path that leaves by itself and meets a lamp counts only if that search would not have
/// found the same way; so light that takes a second way, which the search misses on a wavy surface,
/// is not lost. What is bright in the sky (LightSeen::next_event_share) is a lamp; the rest of it
/// and other objects are found by paths that leave.
///
/// About the light inside, straight from lamps and scattered more than once, something is known
/// beforehand (WalkLamps, WalkLight). At each event a path adds what is known there, and at random
/// finds out more, by a search or by going on, and corrects what it added: by the difference, over
/// the chance of doing so. So the mean is that of complete paths, whatever was known, and few
/// need to be.
///
/// The boundary is taken as smooth; a coat counts for the light that leaves towards the eye, not
/// inside. MediaWalk has rough ones.
template <int N>
class RandomWalk final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @throws InvalidInput if the material has layers, or a mesh of it is open
  RandomWalk(const RenderScene& scene, const BandConversion<N>& conversion, std::uint32_t material);

  /// Finds out about the light inside. Without it the mean is the same, at more work.
  ///
  /// @param scale  of what is found out: 1, unless to show that the mean is the same with any
  /// @return       false if `progress` asked to stop
  [[nodiscard]] bool prepare(const LightGatherer<N>& light, const Progress& progress,
                             float scale = 1.0f);
  [[nodiscard]] bool prepare(const Preparation<N>& with) override {
    return prepare(with.light, with.progress);
  }
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& /*with*/) const override {
    // A second for what is known of the light inside; a walk that knows what to expect takes so
    // much of one that does not. Measured on one core of a Zen 4.
    return {.preparation = 1.0, .lookup = {}, .prepared_fraction = 0.02};
  }

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  /// That of flat layers: for light on its way between objects.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    (void)point;
    return reflectance_;
  }

 private:
  using Known = typename WalkLight<N>::Known;
  [[nodiscard]] Known what_is_known(const Vec3f& place, bool in_detail,
                                    const LightGatherer<N>& light) const;
  [[nodiscard]] Bands walk(const ExitPoint& exit, const Vec3f& inward,
                           const LightGatherer<N>& light, PixelSamples& samples) const;
  [[nodiscard]] Bands phase(float one_minus_cos) const;
  void scatter(WalkPath<N>& path, WalkNumbers& numbers) const;
  [[nodiscard]] float weight_of_search(const typename WalkPath<N>::Event& event,
                                       const RefractedEntry& entry, float pdf) const;

  int bands_;
  FirstOrderStack<Bands> stack_;
  std::vector<PhaseFunction> phases_;  ///< [band]
  bool is_same_phase_ = true;          ///< in all bands
  bool is_isotropic_ = false;
  Bands mean_cosine_;
  Bands reflectance_;
  float typical_radiance_;
  WalkMedium<N> medium_, reduced_;
  float reduced_free_path_;
  Bands reduction_;  ///< of the extinction
  std::unique_ptr<WalkSpace<N>> space_;
  std::unique_ptr<WalkLamps<N>> lamps_;
  WalkLight<N> light_;
};

}  // namespace lamina
