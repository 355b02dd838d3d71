// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lamina/core/band_values.h"
#include "lamina/core/random.h"
#include "lamina/optics/phase_function.h"
#include "lamina/render/band_conversion.h"
#include "lamina/render/refracted_entry.h"
#include "lamina/render/render_scene.h"
#include "lamina/render/subsurface_transport.h"
#include "lamina/render/walk_field.h"
#include "lamina/scattering/first_order.h"

namespace lamina {

/// The truth for curved objects: paths that scatter inside a closed mesh of one homogeneous medium
/// until they leave it. No profile, no diffusion, no flatness.
///
/// Bands share paths: each segment is drawn by one band, and counts for every band by the mean of
/// the densities of all (balance heuristic), so that a colour costs no more than grey.
///
/// Lamps are sought from every scattering event through the smooth boundary, on the way that
/// Snell's law takes. A path that leaves by itself and meets a lamp counts only if that search
/// would not have found the same way; so light that takes a second way, which the search misses on
/// a wavy surface, is not lost. The sky and other objects are found by paths that leave.
///
/// About the light that lamps send to places inside, what earlier searches found nearby is known;
/// it is added, and corrected by a search at random events, so that the mean is that of searching
/// at each. Segments that lie in balls without a surface take no ray.
///
/// An opaque object inside reflects as its material says. The boundary is taken as smooth: a coat
/// or a rough one counts for the light that leaves towards the eye, not inside.
///
/// Source: the search for lamps follows [JakobMarschner2012] §4, the bands' weights the balance
/// heuristic of [VeachGuibas1995].
template <int N>
class RandomWalk final : public SubsurfaceTransport<N> {
 public:
  using Bands = BandValues<N>;

  /// @throws InvalidInput if the material has layers, or a mesh of it is open
  RandomWalk(const RenderScene& scene, const BandConversion<N>& conversion, std::uint32_t material);

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  /// By diffusion: for light on its way between objects.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override;

 private:
  struct Path;
  class Numbers;
  [[nodiscard]] Bands walk(const ExitPoint& exit, const Vec3f& inward,
                           const LightGatherer<N>& light, PixelSamples& samples) const;
  /// Ways of light from a point of a lamp to a place inside, through the boundary. Calls
  /// `on_way(RefractedEntry)` for each that is found, the same ones for the same arguments.
  template <class OnWay>
  void for_ways_in(const Vec3f& inside, const LightSample& lamp, const OnWay& on_way) const;
  /// Light of one point of a lamp, drawn at random; `on_light(fluence, direction)` for each way.
  template <class OnLight>
  void search_lamp(const Vec3f& inside, float u_light, Vec2f u, const LightGatherer<N>& light,
                   const OnLight& on_light) const;
  [[nodiscard]] LampLight<N> lamp_light_around(std::size_t node, const Vec3f& position,
                                               const LightGatherer<N>& light) const;
  [[nodiscard]] Bands light_from_lamps(const Path& path, const LightGatherer<N>& light,
                                       Random& random) const;
  [[nodiscard]] Bands light_from_outside(const Path& path, const SurfacePoint& point,
                                         const Vec3f& outside, const LightGatherer<N>& light,
                                         PixelSamples& samples) const;
  /// Whether light_from_lamps finds the way by which a path leaves.
  [[nodiscard]] bool is_found_by_lamps(const Path& path, const SurfacePoint& exit,
                                       const Ray& outside, float lamp_distance) const;
  void scatter(Path& path, Vec2f u, double u_lobe) const;
  [[nodiscard]] bool meet_surface(Path& path, const Hit& hit, Vec3f& outside, SurfacePoint& point,
                                  Vec2f u, float u_boundary) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  std::uint32_t material_;
  int bands_;
  float ior_;  ///< over that outside, mean of the bands
  FirstOrderStack<Bands> medium_;
  Bands sigma_s_, sigma_t_;
  Bands sigma_t_over_least_;           ///< of the bands
  std::vector<PhaseFunction> phases_;  ///< [band]
  bool is_same_phase_ = true;          ///< in all bands
  Bands reflectance_;
  bool has_lamps_ = false;
  std::unique_ptr<SafeDistances> safe_;
  std::unique_ptr<LampField<N>> lamp_field_;
};

}  // namespace lamina
