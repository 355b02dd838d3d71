// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/render/lights/internal/environment.h"
#include "lamina/render/lights/internal/light_shapes.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// A light sample: a direction towards a light from a point, for next-event estimation.
struct LightSample {
  Vec3f direction;
  float distance = 0.0f;  ///< [mm]; infinite for what is far away
  Vec3f radiance;         ///< of a point or directional light its irradiance on a facing surface
  float pdf = 0.0f;       ///< [1/sr], or a probability if is_delta; 0: nothing to be had
  bool is_delta = false;  ///< from one direction only, which sampling of surfaces never finds
  float next_event_share = 1.0f;  ///< as LightSeen has it
  Vec3f normal;                   ///< of an area light there, unit length; 0: of any other
};

/// A stratum of the numbers by which sample_light chooses: [low, low + size) draws from these
/// lights alone.
struct LightStratum {
  float low = 0.0f, size = 1.0f;
  int candidates = 4;  ///< for resampled importance sampling
};

/// A light met by a ray.
struct LightSeen {
  Vec3f radiance;
  float pdf = 0.0f;       ///< with which sample_light draws that direction [1/sr]
  float distance = 0.0f;  ///< [mm]; infinite for the sky
  /// Share that next-event estimation from inside translucent objects finds; the rest is left to
  /// paths that leave them. 1 for an area light; of the sky what is brighter than most of the
  /// light; 0 for a surface that shines.
  float next_event_share = 1.0f;
};

/// Light clusters as seen from a point: parts of lights, to sample by what a surface makes of each.
struct LightClusters {
  std::size_t count;
  const float *x, *y, *z;  ///< directions towards their middles
  const float* flux;       ///< irradiance on a facing surface
  const float* spread2;    ///< mean square of the distance of their directions from the middle
};

inline constexpr std::size_t max_light_clusters = 320, max_near_light_clusters = 64;

/// Result of Lights::near_clusters.
struct NearLightClusters {
  std::array<float, max_near_light_clusters> x, y, z, flux, spread2;
};

/// All lights of a scene, sampled and intersected: point, spot and directional (delta) lights,
/// rectangles (area lights), balls, environments (infinite lights). A light casts no shadow: it
/// adds to what is seen behind it. Surfaces that shine are sampled here, too; paths meet them as
/// surfaces.
class Lights {
 public:
  /// @param low, high  corners of a box around the scene [mm]
  Lights(const Scene& scene, const Vec3f& low, const Vec3f& high);

  /// Draws a light, with a probability that follows the irradiance it gives at the middle of the
  /// scene (where lights are few, also some for each), and a direction towards it.
  [[nodiscard]] LightSample sample_light(const Vec3f& position, float u_light, Vec2f u) const;

  /// Strata that leave out no light: each light by itself where they are few, else all in one.
  [[nodiscard]] const std::vector<LightStratum>& strata() const { return strata_; }

  /// The clusters that the lights are cut into, for product importance sampling: first those that
  /// are far away, whose directions are the same everywhere. 0: there are no lights to sample, or
  /// too many.
  [[nodiscard]] std::size_t cluster_count() const { return clusters_.size(); }
  [[nodiscard]] LightClusters far_clusters() const;
  [[nodiscard]] LightClusters near_clusters(const Vec3f& position,
                                            NearLightClusters& storage) const;

  /// A direction towards a cluster, with the pdf of sample_light; and the probability with which
  /// sample_light draws one of this cluster.
  [[nodiscard]] LightSample sample_cluster(std::size_t cluster, const Vec3f& position,
                                           Vec2f u) const;
  [[nodiscard]] float probability_of_cluster(std::size_t cluster) const {
    return clusters_[cluster].probability;
  }

  /// The lights seen along a ray between the distances `from` and `limit`, which is infinite if it
  /// meets nothing. `on_light(LightSeen)` is called for each.
  template <class OnLight>
  void for_lights_seen(const Ray& ray, float from, float limit, bool is_camera_ray,
                       const OnLight& on_light) const {
    for (const AreaLight& area_light : area_lights_)
      if (const auto seen = intersect_area_light(area_light, ray, from, limit)) on_light(*seen);
    for (const BallLight& ball : ball_lights_)
      if (const auto seen = intersect_ball(ball, ray, from, limit)) on_light(*seen);
    if (limit < std::numeric_limits<float>::infinity()) return;
    for (const InfiniteLight& infinite_light : infinite_lights_) {
      if (is_camera_ray && !infinite_light.is_visible) continue;
      const auto [radiance, pdf] = infinite_light.environment.evaluate(ray.direction);
      on_light(LightSeen{radiance, pdf * infinite_light.probability,
                         std::numeric_limits<float>::infinity(), next_event_share_of(radiance)});
    }
  }

  /// Emission of a surface where a ray meets it at a distance; absent if nothing.
  /// @param normal  of its triangle, outward
  [[nodiscard]] std::optional<LightSeen> surface_emission(std::uint32_t material,
                                                          const Vec3f& normal,
                                                          const Vec3f& direction,
                                                          float distance) const;

  /// Density with which sample_light draws, at a position, the point of an area light or ball that
  /// is at a distance in a direction [1/sr]; 0 if none is there.
  [[nodiscard]] float pdf_of_area_light(const Vec3f& position, const Vec3f& direction,
                                        float distance) const;

  /// Whether any light is left to next-event estimation from inside, by
  /// LightSeen::next_event_share.
  [[nodiscard]] bool has_next_event_light() const;

  /// About how bright the scene is: irradiance of all lights on a facing surface, unshadowed.
  [[nodiscard]] float typical_irradiance() const { return typical_irradiance_; }

 private:
  struct AreaLight {
    Vec3f corner, edge_u, edge_v;  ///< [mm]
    Vec3f axis_u, axis_v, normal;  ///< unit length; it shines towards normal
    float size_u, size_v;
    Vec3f radiance;
    float probability = 0.0f;
  };
  struct DeltaLight {  ///< point, spot or directional
    Vec3f where;       ///< position [mm], or direction towards the light
    Vec3f strength;
    bool is_far;
    float probability = 0.0f;
    Vec3f axis{};  ///< of a spot, unit length; 0: none
    float cos_inner = 1.0f, cos_outer = 1.0f;
  };
  struct BallLight {
    Vec3f center;
    float radius;
    Vec3f radiance;
    float probability = 0.0f;
  };
  struct SurfaceLight {  ///< all surfaces of a material
    ShiningTriangles triangles;
    Vec3f radiance;
    float probability = 0.0f;
  };
  struct InfiniteLight {
    Environment environment;
    bool is_visible;
    float probability = 0.0f;
  };
  /// Share of next-event estimation for an infinite light of this radiance.
  [[nodiscard]] float next_event_share_of(const Vec3f& radiance) const;
  [[nodiscard]] std::optional<LightSeen> intersect_area_light(const AreaLight& area_light,
                                                              const Ray& ray, float from,
                                                              float limit) const;
  [[nodiscard]] static LightSample sample_area_light(const AreaLight& area_light,
                                                     const Vec3f& position, Vec2f u);
  [[nodiscard]] static float pdf_area_light(const AreaLight& area_light, const Vec3f& position,
                                            const Vec3f& direction, float distance);

  [[nodiscard]] static std::optional<LightSeen> intersect_ball(const BallLight& ball,
                                                               const Ray& ray, float from,
                                                               float limit);
  [[nodiscard]] static LightSample sample_ball_light(const BallLight& ball, const Vec3f& position,
                                                     Vec2f u);
  [[nodiscard]] static LightSample sample_surface_light(const SurfaceLight& surface,
                                                        const Vec3f& position, Vec2f u);

  /// A cluster: what the random numbers of a rectangle in the unit square sample of one light.
  struct Cluster {
    enum class Kind { infinite_light, delta_light, area_light, ball, surface } kind;
    std::size_t light;
    Vec2f low, size;
    float probability;
  };
  [[nodiscard]] LightSample sample_delta_light(const DeltaLight& delta_light,
                                               const Vec3f& position) const;
  [[nodiscard]] LightSample sample_infinite_light(const InfiniteLight& infinite_light,
                                                  Vec2f u) const;
  /// Calls f(probability of a light), in the order of sample_light.
  template <class F>
  void for_probabilities(const F& f);
  void normalize_probabilities();
  void make_strata();
  void make_clusters();
  /// Halves a rectangle of an environment's random numbers so many times, across its longer side
  /// in the sky.
  void split_environment(std::size_t light, Vec2f low, Vec2f size, int halvings);

  std::vector<AreaLight> area_lights_;
  std::vector<DeltaLight> delta_lights_;
  std::vector<BallLight> ball_lights_;
  std::vector<SurfaceLight> surface_lights_;
  std::vector<std::uint32_t> surface_light_of_;  ///< [material]; empty if nothing shines
  std::vector<InfiniteLight> infinite_lights_;
  std::vector<LightStratum> strata_;
  std::vector<Cluster> clusters_;                   ///< far ones first
  std::array<std::vector<float>, 5> far_clusters_;  ///< x, y, z, flux, spread2
  float typical_irradiance_ = 0.0f;
};

}  // namespace lamina
