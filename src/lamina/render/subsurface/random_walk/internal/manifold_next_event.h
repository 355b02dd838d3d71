// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lamina/core/lazy_values.h"
#include "lamina/optics/fresnel.h"
#include "lamina/render/shading/refracted_entry.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// About the light that comes to places inside straight from lamps, as paths need it to spare
/// themselves the search for a lamp: they add what is known here and correct it at random.
template <int N>
struct LampLight {
  BandValues<N> fluence;  ///< radiance integrated over directions
  Vec3f direction;        ///< mean of those towards the light, length at most 1
  float weight = 0.0f;    ///< 0: nothing is known
  float spread = 0.0f;    ///< of single estimates around the mean, at most
  BandValues<N> reduced;  ///< fluence if it were weakened by the reduced extinction
};

/// Light of one point of a lamp at a place inside.
template <int N>
struct FoundLamp {
  RefractedEntry entry;
  BandValues<N> unweakened;  ///< fluence there, if nothing were lost inside, over the density
  float pdf = 0.0f;          ///< over directions inside [1/sr]; infinite if from one only
};

/// Lamps, and what is bright in the sky (LightSeen::next_event_share), as seen from inside, through
/// the refracting boundary.
///
/// A lamp is sought on the way that Snell's law takes. What searches from around the nodes of a
/// lattice found, each node when it is first asked for, is known from then on. Safe to use from any
/// thread.
///
/// Source: the search follows [JakobMarschner2012] §4.
template <int N>
class WalkLamps {
 public:
  using Bands = BandValues<N>;

  /// @param reduced_sigma_t  by which LampLight::reduced decays
  WalkLamps(const WalkSpace<N>& space, const Bands& sigma_t, const Bands& reduced_sigma_t,
            float free_path);

  [[nodiscard]] bool are_there() const { return are_there_; }

  /// What is known at a place: from the nodes around, along their beams.
  [[nodiscard]] LampLight<N> known(const Vec3f& p, const LightGatherer<N>& light) const;

  /// Light of one point of a lamp, drawn at random: `on_light(FoundLamp)` for each way.
  ///
  /// @param find_boundary  from the place; null: what is met first, if it is of the material
  template <class OnLight>
  void search(const Vec3f& inside, float u_light, Vec2f u, const LightGatherer<N>& light,
              const OnLight& on_light, const FindBoundary* find_boundary = nullptr) const;

  /// Radiance from outside along a ray that leaves at a point, less what a search from the place of
  /// the path's last event finds.
  ///
  /// @param weight_of_search  (RefractedEntry, pdf) to its share of the light that both find
  /// @param find_boundary     as `search` has it
  template <class WeightOfSearch>
  [[nodiscard]] Bands light_from_outside(const WalkPath<N>& path, const WalkExit& leaving,
                                         const LightGatherer<N>& light, PixelSamples& samples,
                                         const WeightOfSearch& weight_of_search,
                                         const FindBoundary* find_boundary = nullptr) const;

 private:
  /// At a point of reference among the places where light was sought.
  struct Node {
    LampLight<N> light;
    Vec3f place;
  };
  /// Ways of light from a point of a lamp to a place inside, through the boundary. Calls
  /// `on_way(RefractedEntry)` for each that is found, the same ones for the same arguments.
  template <class OnWay>
  void for_ways_in(const Vec3f& inside, const LightSample& lamp, const FindBoundary* find_boundary,
                   const OnWay& on_way) const;
  [[nodiscard]] Node search_around(std::size_t node, const LightGatherer<N>& light) const;
  /// What a search from the last event finds of a path's way to a lamp.
  struct SameWay {
    RefractedEntry entry;
    float pdf;
  };
  [[nodiscard]] std::optional<SameWay> find_same_way(const WalkPath<N>& path,
                                                     const SurfacePoint& exit, const Ray& outside,
                                                     const LightSeen& lamp,
                                                     const FindBoundary* find_boundary) const;

  const WalkSpace<N>& space_;
  Bands sigma_t_, reduced_sigma_t_;
  bool are_there_;
  bool is_reduced_ = false;  ///< the extinction differs from the reduced one
  NodeLattice lattice_;
  mutable LazyValues<Node> nodes_;
};

template <int N>
template <class OnWay>
void WalkLamps<N>::for_ways_in(const Vec3f& inside, const LightSample& lamp,
                               const FindBoundary* find_boundary, const OnWay& on_way) const {
  const auto enters = [&](const Vec3f& first) {
    const auto entry = find_boundary
                           ? find_refracted_entry(space_.scene(), inside, *find_boundary,
                                                  space_.ior(), lamp, first)
                           : find_refracted_entry(space_.scene(), inside, space_.material(),
                                                  space_.ior(), lamp, first);
    if (entry) on_way(*entry);
    return entry.has_value();
  };
  // As if the nearest surface went on flat, which is often near the way; then the straight way.
  const Vec3f n = space_.safe().nearest_normal(inside);
  if (dot(n, lamp.direction) > 0.0f && enters(refract_inside(lamp.direction, n, space_.ior())))
    return;
  (void)enters(lamp.direction);
}

template <int N>
template <class OnLight>
void WalkLamps<N>::search(const Vec3f& inside, float u_light, Vec2f u,
                          const LightGatherer<N>& light, const OnLight& on_light,
                          const FindBoundary* find_boundary) const {
  const LightSample lamp = space_.scene().lights.sample_light(inside, u_light, u);
  if (!(lamp.pdf > 0.0f && lamp.next_event_share > 0.0f)) return;
  for_ways_in(inside, lamp, find_boundary, [&](const RefractedEntry& entry) {
    const float ior = space_.ior();
    const float entering =
        1.0f - static_cast<float>(fresnel(std::min(entry.cos_outside, 1.0f), ior));
    const Bands clear =
        light.shadow_transmittance({leave_surface(entry.point, entry.to_light), entry.to_light},
                                   0.9999f * entry.light_distance);
    if (!(largest(clear) > 0.0f)) return;
    const float widening = entry.geometry_term / (ior * ior);  // of solid angles
    on_light(FoundLamp<N>{
        .entry = entry,
        .unweakened = (lamp.next_event_share * entering * widening / lamp.pdf) * clear *
                      space_.conversion().from_rgb(lamp.radiance),
        .pdf = lamp.is_delta ? std::numeric_limits<float>::infinity() : lamp.pdf / widening});
  });
}

template <int N>
template <class WeightOfSearch>
BandValues<N> WalkLamps<N>::light_from_outside(const WalkPath<N>& path, const WalkExit& leaving,
                                               const LightGatherer<N>& light, PixelSamples& samples,
                                               const WeightOfSearch& weight_of_search,
                                               const FindBoundary* find_boundary) const {
  const Ray ray{leave_surface(leaving.point, leaving.outside), leaving.outside};
  Bands radiance = light.arriving_radiance(ray, samples);
  space_.scene().lights.for_lights_seen(
      ray, 0.0f, std::numeric_limits<float>::infinity(), false, [&](const LightSeen& seen) {
        if (!(seen.next_event_share > 0.0f)) return;
        const auto found = find_same_way(path, leaving.point, ray, seen, find_boundary);
        const float weight = found ? 1.0f - weight_of_search(found->entry, found->pdf) : 1.0f;
        if (weight > 0.0f)
          radiance += weight * seen.next_event_share * space_.conversion().from_rgb(seen.radiance) *
                      light.shadow_transmittance(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

}  // namespace lamina
