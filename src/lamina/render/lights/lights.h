// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "lamina/core/vec.h"
#include "lamina/render/lights/internal/environment.h"
#include "lamina/scene/scene.h"
#include "lamina/surface/ray.h"

namespace lamina {

/// A direction towards a light, as seen from a point.
struct LightSample {
  Vec3f direction;
  float distance = 0.0f;  ///< [mm]; infinite for what is far away
  Vec3f radiance;         ///< of a point or directional light its irradiance on a facing surface
  float pdf = 0.0f;       ///< [1/sr], or a probability if is_delta; 0: nothing to be had
  bool is_delta = false;  ///< from one direction only, which no other sampling finds
  float sought = 1.0f;    ///< as LightSeen has it
};

/// Some of the numbers by which sample_light chooses: [low, low + size) draws from these lights
/// alone.
struct LightShare {
  float low = 0.0f, size = 1.0f;
  int candidates = 4;  ///< directions to choose one of, by what each would give
};

/// A light met by a ray.
struct LightSeen {
  Vec3f radiance;
  float pdf = 0.0f;       ///< with which sample_light draws that direction [1/sr]
  float distance = 0.0f;  ///< [mm]; infinite for the sky
  /// Share that is sought from inside translucent objects; the rest is left to paths that leave
  /// them. 1 for a lamp; of the sky what shines brighter than most of the scene's light.
  float sought = 1.0f;
};

/// Parts of lights as seen from a point.
struct LightPartsSeen {
  std::size_t count;
  const float *x, *y, *z;  ///< directions towards their middles
  const float* flux;       ///< irradiance on a facing surface
  const float* spread2;    ///< mean square of the distance of their directions from the middle
};

inline constexpr std::size_t most_light_parts = 320, most_near_light_parts = 64;

/// What Lights::near_parts fills.
struct NearLightParts {
  std::array<float, most_near_light_parts> x, y, z, flux, spread2;
};

/// All lights of a scene. A light casts no shadow: it adds to what is seen behind it.
class Lights {
 public:
  /// @param low, high  corners of a box around the scene [mm]
  Lights(const Scene& scene, const Vec3f& low, const Vec3f& high);

  /// Draws a light, with a probability that follows the irradiance it gives at the middle of the
  /// scene, and a direction towards it.
  [[nodiscard]] LightSample sample_light(const Vec3f& position, float u_light, Vec2f u) const;

  /// Shares that leave out no light: each light by itself where they are few, else all in one.
  [[nodiscard]] const std::vector<LightShare>& shares() const { return shares_; }

  /// The lights are cut into parts, for choosing among them by what a surface makes of each: first
  /// those that are far away, whose directions are the same everywhere. 0: there are no lights to
  /// draw from, or too many.
  [[nodiscard]] std::size_t part_count() const { return parts_.size(); }
  [[nodiscard]] LightPartsSeen far_parts() const;
  [[nodiscard]] LightPartsSeen near_parts(const Vec3f& position, NearLightParts& storage) const;

  /// A direction towards a part, with the pdf of sample_light; and the probability with which
  /// sample_light draws one of this part.
  [[nodiscard]] LightSample sample_part(std::size_t part, const Vec3f& position, Vec2f u) const;
  [[nodiscard]] float probability_of_part(std::size_t part) const {
    return parts_[part].probability;
  }

  /// The lights seen along a ray between the distances `from` and `limit`, which is infinite if it
  /// meets nothing. `on_light(LightSeen)` is called for each.
  template <class OnLight>
  void for_lights_seen(const Ray& ray, float from, float limit, bool is_camera_ray,
                       const OnLight& on_light) const {
    for (const Panel& panel : panels_)
      if (const auto seen = look_at_panel(panel, ray, from, limit)) on_light(*seen);
    if (limit < std::numeric_limits<float>::infinity()) return;
    for (const Sky& sky : skies_) {
      if (is_camera_ray && !sky.is_visible) continue;
      const auto [radiance, pdf] = sky.environment.look(ray.direction);
      on_light(LightSeen{radiance, pdf * sky.probability, std::numeric_limits<float>::infinity(),
                         sought_share(radiance)});
    }
  }

  /// Whether there is light to be sought from inside, by LightSeen::sought.
  [[nodiscard]] bool has_sought() const;

  /// About how bright the scene is: irradiance of all lights on a facing surface, unshadowed.
  [[nodiscard]] float typical_irradiance() const { return typical_irradiance_; }

 private:
  struct Panel {
    Vec3f corner, edge_u, edge_v;  ///< [mm]
    Vec3f axis_u, axis_v, normal;  ///< unit length; it shines towards normal
    float size_u, size_v;
    Vec3f radiance;
    float probability = 0.0f;
  };
  struct Spot {   ///< point or directional
    Vec3f where;  ///< position [mm], or direction towards the light
    Vec3f strength;
    bool is_far;
    float probability = 0.0f;
  };
  struct Sky {
    Environment environment;
    bool is_visible;
    float probability = 0.0f;
  };
  /// Of a sky.
  [[nodiscard]] float sought_share(const Vec3f& radiance) const;
  [[nodiscard]] std::optional<LightSeen> look_at_panel(const Panel& panel, const Ray& ray,
                                                       float from, float limit) const;
  [[nodiscard]] static LightSample sample_panel(const Panel& panel, const Vec3f& position, Vec2f u);
  [[nodiscard]] static float pdf_panel(const Panel& panel, const Vec3f& position,
                                       const Vec3f& direction, float distance);

  /// What the random numbers of a rectangle in the unit square draw from one light.
  struct Part {
    enum class Of { sky, spot, panel } of;
    std::size_t light;
    Vec2f low, size;
    float probability;
  };
  [[nodiscard]] LightSample sample_spot(const Spot& spot, const Vec3f& position) const;
  [[nodiscard]] LightSample sample_sky(const Sky& sky, Vec2f u) const;
  void make_shares();
  void make_parts();
  /// Halves a rectangle of a sky's random numbers so many times, across its longer side in the sky.
  void cut_sky(std::size_t sky, Vec2f low, Vec2f size, int halvings);

  std::vector<Panel> panels_;
  std::vector<Spot> spots_;
  std::vector<Sky> skies_;
  std::vector<LightShare> shares_;
  std::vector<Part> parts_;                      ///< far ones first
  std::array<std::vector<float>, 5> far_parts_;  ///< x, y, z, flux, spread2
  float typical_irradiance_ = 0.0f;
};

}  // namespace lamina
