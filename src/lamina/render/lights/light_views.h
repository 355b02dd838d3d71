// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// A virtual point or directional light: a whole light of the scene, or a sample of an area light
/// or environment.
struct LightView {
  Vec3f where;          ///< position [mm], or the direction towards the light, unit length
  bool is_far = false;  ///< `where` is a direction
  Vec3f strength;       ///< radiant intensity [W/sr], or irradiance on a facing surface
  Vec3f facing;         ///< where an area light shines, unit length; 0: everywhere alike
  Vec3f cone_axis;      ///< of a spot light, unit length; 0: none
  float cos_inner = 1.0f, cos_outer = 1.0f;
  int parts = 1;  ///< views of its light
};

/// A view for every point and distant light, and a set of them for every soft one: points spread
/// over an area light, directions of a dome that follow the radiance of a sky and the sphere.
///
/// The sum over the views of a light tends to what the light gives as they become more. Nothing is
/// random about them.
///
/// Source: [Hery2003] §3 for soft lights, §5.1 for the dome.
///
/// @param lamp_views, dome_views  of each rectangle, of each environment; >= 1
[[nodiscard]] std::vector<LightView> make_light_views(const Scene& scene, int lamp_views,
                                                      int dome_views);

/// Light from a view as it arrives at a point.
struct IncidentLight {
  Vec3f direction;          ///< unit length
  float distance = 0.0f;    ///< [mm]; infinite for what is far away
  float irradiance = 0.0f;  ///< on a facing surface, per LightView::strength
};
[[nodiscard]] IncidentLight incident_light(const Vec3f& position, const LightView& view);

}  // namespace lamina
