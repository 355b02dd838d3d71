// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/light_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/vec.h"
#include "lamina/render/lights/internal/environment.h"
#include "lamina/render/lights/internal/light_shapes.h"

namespace lamina {
namespace {

/// Points spread evenly over the unit square: [Roberts2018]'s R2 sequence.
Vec2f spread_point(int i) {
  const double k = i + 0.5, x = 0.5 + 0.7548776662466927 * k, y = 0.5 + 0.5698402909980532 * k;
  return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
}

void add_views(const RectangleLight& rectangle, int count, std::vector<LightView>& views) {
  const Vec3f u = to_float(rectangle.edge_u), v = to_float(rectangle.edge_v), n = cross(u, v);
  const float area = length(n);
  if (!(area > 0.0f)) return;
  for (int i = 0; i < count; ++i) {
    const Vec2f at = spread_point(i);
    views.push_back({.where = to_float(rectangle.center) + (at.x - 0.5f) * u + (at.y - 0.5f) * v,
                     .strength = (area / static_cast<float>(count)) * rectangle.radiance,
                     .facing = n / area,
                     .parts = count});
  }
}

void add_views(const SphereLight& ball, int count, std::vector<LightView>& views) {
  const auto radius = static_cast<float>(ball.radius);
  const float area = 4.0f * float_pi * radius * radius;
  for (int i = 0; i < count; ++i) {
    const Vec2f at = spread_point(i);
    const float z = 1.0f - 2.0f * at.x, r = std::sqrt(std::max(1.0f - z * z, 0.0f));
    const float phi = 2.0f * float_pi * at.y;
    const Vec3f normal{r * std::cos(phi), r * std::sin(phi), z};
    views.push_back({.where = to_float(ball.center) + radius * normal,
                     .strength = (area / static_cast<float>(count)) * ball.radiance,
                     .facing = normal,
                     .parts = count});
  }
}

void add_views(const ShiningTriangles& surface, const Vec3f& radiance, int count,
               std::vector<LightView>& views) {
  if (!(surface.area() > 0.0f)) return;
  for (int i = 0; i < count; ++i) {
    const ShiningPoint point = surface.sample(spread_point(i));
    views.push_back({.where = point.position,
                     .strength = (surface.area() / static_cast<float>(count)) * radiance,
                     .facing = point.normal,
                     .parts = count});
  }
}

/// Directions drawn from the bright parts of the sky and from the whole sphere, in proportion to
/// the light of both, each weighed by the density of all.
void add_views(const Environment& sky, int count, std::vector<LightView>& views) {
  const Vec3f mean = sky.mean_radiance();
  const float all = mean.x + mean.y + mean.z;
  if (!(all > 0.0f)) return;
  int drawn = 0;
  if (sky.can_be_sampled())
    drawn = std::clamp(
        static_cast<int>(std::lround(static_cast<float>(count) * 3.0f * sky.mean_sampled() / all)),
        0, count);
  const int even = count - drawn;
  const auto add = [&](const Vec3f& direction) {
    const Environment::Seen seen = sky.evaluate(direction);
    const float density =
        static_cast<float>(drawn) * seen.pdf + static_cast<float>(even) / (4.0f * float_pi);
    if (density > 0.0f)
      views.push_back({.where = normalize(direction),
                       .is_far = true,
                       .strength = seen.radiance / density,
                       .parts = count});
  };
  for (int i = 0; i < drawn; ++i) add(sky.sample(spread_point(i)).direction);
  for (int i = 0; i < even; ++i) {
    // A spiral over the sphere, whose turns are a golden ratio apart.
    const float y = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(even);
    const float s = std::sqrt(1.0f - y * y), phi = 2.39996323f * static_cast<float>(i);
    add({s * std::cos(phi), y, s * std::sin(phi)});
  }
}

}  // namespace

std::vector<LightView> make_light_views(const Scene& scene, int lamp_views, int dome_views) {
  std::vector<LightView> views;
  for (const Light& light : scene.lights) {
    if (const auto* point = std::get_if<PointLight>(&light))
      views.push_back({.where = to_float(point->position), .strength = point->intensity});
    else if (const auto* far_light = std::get_if<DirectionalLight>(&light))
      views.push_back({.where = normalize(to_float(far_light->direction)),
                       .is_far = true,
                       .strength = far_light->irradiance});
    else if (const auto* spot = std::get_if<SpotLight>(&light))
      views.push_back({.where = to_float(spot->position),
                       .strength = spot->intensity,
                       .cone_axis = normalize(to_float(spot->direction)),
                       .cos_inner = spot->cos_inner,
                       .cos_outer = spot->cos_outer});
    else if (const auto* ball = std::get_if<SphereLight>(&light))
      add_views(*ball, lamp_views, views);
    else if (const auto* rectangle = std::get_if<RectangleLight>(&light))
      add_views(*rectangle, lamp_views, views);
    else if (const auto& sky = std::get<EnvironmentLight>(light); sky.image)
      add_views(Environment(scene.images[*sky.image], sky.scale, sky.rotation), dome_views, views);
    else
      add_views(Environment(sky.scale), dome_views, views);
  }
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m)
    if (mean_of_channels(scene.materials[m].emission) > 0.0f)
      add_views(ShiningTriangles(scene.meshes, m), scene.materials[m].emission, lamp_views, views);
  return views;
}

IncidentLight incident_light(const Vec3f& position, const LightView& view) {
  if (view.is_far) return {view.where, std::numeric_limits<float>::infinity(), 1.0f};
  const Vec3f d = view.where - position;
  const float d2 = dot(d, d), distance = std::sqrt(d2);
  if (!(d2 > 0.0f)) return {{0, 0, 1}, 0.0f, 0.0f};
  IncidentLight from{d / distance, distance, 1.0f / d2};
  if (dot(view.facing, view.facing) > 0.0f)
    from.irradiance *= std::max(-dot(from.direction, view.facing), 0.0f);
  if (dot(view.cone_axis, view.cone_axis) > 0.0f)
    from.irradiance *=
        spot_share(-dot(from.direction, view.cone_axis), view.cos_inner, view.cos_outer);
  return from;
}

}  // namespace lamina
