// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/optics/rough/surface_boundary.h"
#include "lamina/render/lights/sky_irradiance.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// Light that enters a surface, by one random estimate, and what is known of its error: how far the
/// same random numbers are off the light of a sky that nothing hides.
template <int N>
struct EnteringLight {
  BandValues<N> irradiance;
  BandValues<N> missed;  ///< of the irradiance of an open sky, as it is less as it was found
  float open = 0.0f;     ///< brightness of the sky where it was sampled, cosine and boundary in it,
  float seen = 0.0f;     ///< and of what of that was not hidden
};

/// Interface by which methods of subsurface transport ask the renderer for the light that enters a
/// surface.
template <int N>
class LightGatherer {
 public:
  virtual ~LightGatherer() = default;

  /// Flux per area that passes the boundary at a point, by one random estimate: light from all
  /// lights and other surfaces, less what the boundary reflects.
  [[nodiscard]] virtual BandValues<N> entering_irradiance(const SurfacePoint& entry,
                                                          PixelSamples& samples) const = 0;

  /// Light that enters, with its error.
  /// @param sky  for a boundary much like that at the point
  [[nodiscard]] virtual EnteringLight<N> entering_light(const SurfacePoint& entry,
                                                        PixelSamples& samples,
                                                        const SkyIrradiance& /*sky*/) const {
    return {.irradiance = entering_irradiance(entry, samples)};
  }

  /// Shadow transmittance: the fraction of light that comes straight through between the start of a
  /// ray and a distance along it.
  [[nodiscard]] virtual BandValues<N> shadow_transmittance(const Ray& ray,
                                                           float distance) const = 0;

  /// Radiance that comes along a ray from outside, from other surfaces and the sky, by one random
  /// estimate. Of lights that the ray meets itself, what is left to next-event estimation
  /// (LightSeen::next_event_share) is left out.
  [[nodiscard]] virtual BandValues<N> arriving_radiance(const Ray& ray,
                                                        PixelSamples& samples) const = 0;
};

/// The point where light leaves a translucent surface towards the eye.
struct ExitPoint {
  const SurfacePoint& point;
  const SurfaceBoundary& boundary;
  float cos_o;   ///< between the normal and the direction in which it leaves
  Vec3f to_eye;  ///< that direction, unit length
};

template <int N>
struct Preparation;

/// About how long a picture takes by a method, beside light above surfaces [CPU s].
struct SubsurfaceCost {
  double preparation = 0.0;
  double refinement = 0.0;         ///< by refine()
  std::optional<double> lookup;    ///< of the light at a point that the camera sees, once prepared;
                                   ///< absent: found by timing paths
  double prepared_fraction = 1.0;  ///< of the time of such paths, once prepared
};

/// A BSSRDF over the surfaces of one material: how light that enters a translucent object at one
/// point leaves it at others. One interface for all methods: some gather along random paths, some
/// look up what they prepared.
template <int N>
class SubsurfaceMethod {
 public:
  virtual ~SubsurfaceMethod() = default;

  /// Makes local_reflectance ready. Asked of all materials of a scene before any is prepared.
  virtual void prepare_reflectance(const Preparation<N>& /*with*/) {}

  /// Makes leaving_radiance ready, from the light that the gatherer finds.
  /// @return  false if progress asked to stop
  [[nodiscard]] virtual bool prepare(const Preparation<N>& /*with*/) { return true; }

  /// Makes leaving_radiance, which is ready, better, until progress asks to stop: what there is by
  /// then counts. Reports how far it is.
  virtual void refine(const Preparation<N>& /*with*/) {}

  /// Asked before anything is prepared.
  [[nodiscard]] virtual SubsurfaceCost expected_cost(const Preparation<N>& /*with*/) const {
    return {};
  }

  /// Radiance that leaves the inside of the object, by one random estimate.
  [[nodiscard]] virtual BandValues<N> leaving_radiance(const ExitPoint& exit,
                                                       const LightGatherer<N>& light,
                                                       PixelSamples& samples) const = 0;

  /// Scattered radiance without light that came straight through, which is as narrow as what shines
  /// behind.
  [[nodiscard]] virtual BandValues<N> scattered_radiance(const ExitPoint& exit,
                                                         const LightGatherer<N>& light,
                                                         PixelSamples& samples) const {
    return leaving_radiance(exit, light, samples);
  }

  /// Fraction of the flux that entered that leaves again on the lit side, as if it did so at the
  /// point where it entered. What paths of indirect light use.
  [[nodiscard]] virtual BandValues<N> local_reflectance(const SurfacePoint& point) const = 0;

  /// Whether light passes the surface at a point, so that it has another side: it is seen from
  /// there, too, by points that are turned over.
  [[nodiscard]] virtual bool is_sheet(const SurfacePoint& /*point*/) const { return false; }

  /// Fraction of the flux that entered a sheet on the other side that leaves on the point's side,
  /// as local_reflectance.
  [[nodiscard]] virtual BandValues<N> local_transmittance(const SurfacePoint& /*point*/) const {
    return {};
  }
};

/// [material], null where a material has none.
template <int N>
using SubsurfaceMethods = std::vector<std::unique_ptr<SubsurfaceMethod<N>>>;

}  // namespace lamina
