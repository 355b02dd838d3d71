// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "lamina/core/vec.h"
#include "lamina/render/environment.h"
#include "lamina/render/ray_geometry.h"
#include "lamina/render/scene.h"

namespace lamina {

/// A direction towards a light, as seen from a point.
struct LightSample {
  Vec3f direction;
  float distance = 0.0f;  ///< [mm]; infinite for what is far away
  Vec3f radiance;         ///< of a point or directional light its irradiance on a facing surface
  float pdf = 0.0f;       ///< [1/sr], or a probability if is_delta; 0: nothing to be had
  bool is_delta = false;  ///< from one direction only, which no other sampling finds
};

/// A light met by a ray.
struct LightSeen {
  Vec3f radiance;
  float pdf = 0.0f;       ///< with which sample_light draws that direction [1/sr]
  float distance = 0.0f;  ///< [mm]; infinite for the sky
  bool is_lamp = false;   ///< not the sky
};

/// All lights of a scene. A light casts no shadow: it adds to what is seen behind it.
class Lights {
 public:
  /// @param low, high  corners of a box around the scene [mm]
  Lights(const Scene& scene, const Vec3f& low, const Vec3f& high);

  /// Draws a light, with a probability that follows the irradiance it gives at the middle of the
  /// scene, and a direction towards it.
  [[nodiscard]] LightSample sample_light(const Vec3f& position, float u_light, Vec2f u) const;

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
                         false});
    }
  }

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
  [[nodiscard]] std::optional<LightSeen> look_at_panel(const Panel& panel, const Ray& ray,
                                                       float from, float limit) const;
  [[nodiscard]] static LightSample sample_panel(const Panel& panel, const Vec3f& position, Vec2f u);
  [[nodiscard]] static float pdf_panel(const Panel& panel, const Vec3f& position,
                                       const Vec3f& direction, float distance);

  std::vector<Panel> panels_;
  std::vector<Spot> spots_;
  std::vector<Sky> skies_;
  float typical_irradiance_ = 0.0f;
};

}  // namespace lamina
