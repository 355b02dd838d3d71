// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/subsurface/media/walk_path.h"
#include "lamina/render/subsurface/random_walk/internal/walk_boundary.h"
#include "lamina/render/subsurface/random_walk/internal/walk_media.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// One random walk over media: a path from where a ray of the eye enters, through layers, rough
/// boundaries and from body to body, until it leaves or is ended by Russian roulette.
///
/// At every scattering event lights are sampled by next-event estimation, and by paths that leave
/// and meet them; multiple importance sampling weights the two. Where a medium has a precomputed
/// radiance field, that is a control variate of both.
template <int N>
class Walker {
 public:
  using Bands = BandValues<N>;

  /// @param path             as it has entered
  /// @param least_reference  radiance below which noise does not matter
  Walker(const WalkMedia<N>& media, const MediaPlace<N>& start, const WalkPath<N>& path,
         const LightGatherer<N>& light, PixelSamples& samples, float least_reference);

  /// Follows the path to its end: the radiance that it finds, by one random estimate.
  ///
  /// @param with_unscattered  also of light that comes straight through
  [[nodiscard]] Bands trace(bool with_unscattered);
  /// Sets the record for all that it finds.
  void record_to(WalkRecord<N>& record) { record_ = &record; }

 private:
  using Place = MediaPlace<N>;
  using Surface = typename WalkMedia<N>::Surface;
  using Crossing = DepthLayers::Crossing;
  /// End of a step of a path: a scattering event, a surface that reflects or refracts it, or a
  /// layer of another index.
  struct Step {
    enum class End { event, surface, layer, lost } end = End::lost;
    Surface surface = {};
    Crossing crossing = {};
  };

  // walker.cpp: scattering events. False where the path ends.
  void trace_homogeneous();
  [[nodiscard]] bool scatter();
  struct Expectation;
  [[nodiscard]] bool expects() const;
  [[nodiscard]] Expectation add_expectation();

  // walker_steps.cpp: from one event, surface or layer to the next; at the end `place_` is that of
  // the path's new origin.
  //
  // Weighted delta tracking by the largest extinction of a layer: a free path is sampled for one
  // band, and so is whether light is scattered at its end or passes for maps have less there. All
  // bands count by the density of their mixture, so that the throughput summed over them never
  // grows. Sources: [Wilkie2014], [Kutz2017] §5.
  [[nodiscard]] Step advance();
  [[nodiscard]] bool meet_surface(const Surface& surface);
  void meet_layer(const Crossing& crossing);
  /// Throughput over the density of the mixture of bands of what was sampled.
  ///
  /// @param density  of each band
  /// @return         false: beyond what floats hold
  [[nodiscard]] bool weigh(const Bands& value, const Bands& density);
  /// End of a free path by the largest extinction of a layer: a
  /// scattering event, or nothing.
  ///
  /// @param passing  transmittance of the free path, but for a factor
  /// @param most     the largest extinction
  enum class Collision { real, none, lost };
  [[nodiscard]] Collision collide(const Bands& passing, const Bands& most);
  /// The next surface before an end of the path's ray, as far as it is not known.
  struct Ahead {
    Surface surface;
    float clear;   ///< no surface is nearer, but that [mm]
    float t_near;  ///< where to look from [mm]
  };
  void look_ahead(float end, float free_path, Ahead& ahead) const;
  /// The path has turned at a surface.
  void restart();

  // walker_lights.cpp: light that next-event estimation finds, and light that paths meet.
  /// Direct light, scattered into the path at its last event, through the smooth boundary.
  [[nodiscard]] Bands sample_direct_light();
  /// Light from outside for a path that leaves by a smooth boundary.
  [[nodiscard]] Bands escaping_radiance(const WalkPath<N>& path, const WalkExit& exit);
  /// At an event: light from a light vertex near it.
  [[nodiscard]] Bands sample_light_vertex();
  /// The MIS weight of a path that leaves and meets a light which next-event estimation does not
  /// find, against light vertices.
  [[nodiscard]] float weight_against_vertices(const WalkPath<N>& path, const WalkExit& exit,
                                              const LightSeen& seen) const;
  /// At the last event: the transmittance of a straight segment from there times the phase
  /// function.
  [[nodiscard]] Bands scattered_along(const Vec3f& direction, float length) const;
  /// The MIS weight of next-event estimation at the last event, against paths that go on from
  /// there.
  [[nodiscard]] float mis_weight(const Bands& scattered, float pdf) const;

  /// The density of paths that go on from the last event and come out of a segment, a mean over
  /// bands in proportion to their throughput.
  [[nodiscard]] float density_of_paths(const Bands& scattered) const;

  // walker_rough.cpp: the same where the boundary to the outside is rough. Direct light is found
  // from the last event, through facets that refract it; where a path meets the boundary; and by
  // paths that leave. All three share by the power heuristic.
  /// From the last event to the boundary, straight but for refraction by layers.
  struct WayOut {
    Surface surface;
    Vec3f direction;  ///< at the boundary
    Bands passing;    ///< transmittance
  };
  [[nodiscard]] std::optional<WayOut> way_out(const Vec3f& direction) const;
  /// Density with which `sample_light_through_facets` samples a direction at the last event [1/sr].
  [[nodiscard]] float pdf_through_facets(const Vec3f& direction, const Vec3f& to_light) const;
  /// Whether that is done for events in a medium.
  [[nodiscard]] static bool finds_light_through_facets(const BodyMedium<N>& medium) {
    return medium.is_rough && !medium.has_neighbors && !medium.layers.has_maps() && !medium.glass;
  }
  [[nodiscard]] Bands sample_light_through_facets();
  /// The density of paths that meet the boundary as this one does, straight from the last event;
  /// 0 for others, whose light `sample_light_through_facets` does not find.
  [[nodiscard]] float arriving_density() const;
  /// The density of `sample_light_through_facets` over that, for light to a point of the boundary.
  [[nodiscard]] float facets_over_paths(float arriving, const SurfacePoint& point,
                                        const Vec3f& to_light, float distance) const;
  /// Direct light, refracted into the path where it meets the boundary.
  ///
  /// @param arriving  arriving_density()
  [[nodiscard]] Bands sample_direct_light(const WalkBoundary& boundary, const SurfacePoint& point,
                                          float arriving);
  /// Light from outside for a path that leaves.
  [[nodiscard]] Bands escaping_radiance(const BoundaryTurn& turn, const SurfacePoint& point,
                                        float arriving);

  const WalkMedia<N>& media_;
  const LightGatherer<N>& light_;
  PixelSamples& samples_;
  WalkNumbers numbers_;
  WalkPath<N> path_;
  Place place_, last_place_;  ///< of the path's origin; of its last event
  Bands radiance_;
  float least_reference_;
  WalkRecord<N>* record_ = nullptr;
  bool with_unscattered_ = true;
  float reference_ = 0.0f;  ///< about the radiance that the path finds; 0 before its first event
};

}  // namespace lamina
