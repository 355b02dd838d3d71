// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/refracted_entry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lamina/layers/optics/fresnel.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

// Light that a flat face reflects inside a cube, followed from the given point by Snell's law and
// the law of reflection, leaves towards the light; and its cross-section is that of two neighbours.
TEST(ReflectedEntry, ObeysTheLawsOfSnellAndReflection) {
  constexpr float ior = 1.4f;
  Scene scene;
  scene.materials = {diffuse_material(0.5f)};
  scene.meshes = {make_cube(2.0f)};
  const RenderScene prepared(scene);
  const Vec3f inside{0.8f, 0.1f, 0.0f}, lamp{-7, 1, 6};
  const Hit side = prepared.geometry.first_hit({inside, {1, 0, 0}}, 0.0f);
  const SurfacePoint mirror = make_bare_surface_point(scene.meshes, side);
  ASSERT_TRUE(is_flat(mirror));
  for (const bool is_far : {false, true}) {
    const Vec3f offset = is_far ? lamp : lamp - inside;
    const LightSample light{
        .direction = normalize(offset),
        .distance = is_far ? std::numeric_limits<float>::infinity() : length(offset),
        .radiance = {1, 1, 1},
        .pdf = 1.0f};
    const auto entry = find_reflected_entry(prepared, inside, mirror, ior, light,
                                            refract_inside(light.direction, {0, 0, 1}, ior));
    ASSERT_TRUE(entry.has_value());
    // Where a beam that starts at the point meets the side x = 1 and the top z = 1.
    const auto follow = [&](Vec3f d, Vec3f& top) {
      const Vec3f at_side = inside + ((1.0f - inside.x) / d.x) * d;
      d.x = -d.x;
      top = at_side + ((1.0f - at_side.z) / d.z) * d;
      const float sx = ior * d.x, sy = ior * d.y;
      return Vec3f{sx, sy, std::sqrt(1.0f - sx * sx - sy * sy)};
    };
    Vec3f top;
    const Vec3f out = follow(entry->to_surface, top);
    EXPECT_LT(length(top - entry->point.position), 1e-3f);
    EXPECT_LT(length(out - entry->to_light), 1e-3f);
    const Vec3f to_lamp = is_far ? normalize(lamp) : normalize(lamp - top);
    EXPECT_LT(length(out - to_lamp), 1e-3f);
    const float way =
        (1.0f - inside.x) / entry->to_surface.x + (1.0f - top.x) / entry->to_surface.x;
    EXPECT_NEAR(entry->length, way, 1e-3f);
    EXPECT_NEAR(entry->reflectance,
                static_cast<float>(fresnel(std::abs(entry->to_surface.x), 1.0f / ior)), 1e-4f);
    // Solid angles outside over inside: what Snell's law makes of neighbouring directions.
    const Framef frame = make_frame(entry->to_surface);
    constexpr float e = 2e-3f;
    const auto to_plane = [&](const Vec3f& d) {  // across the beam at the lamp
      Vec3f start;
      const Vec3f w = follow(normalize(d), start);
      const float t = is_far ? 0.0f : dot(lamp - start, to_lamp) / dot(w, to_lamp);
      return is_far ? w : start + t * w;
    };
    const Vec3f& d = entry->to_surface;
    const Vec3f du = to_plane(d + e * frame.x) - to_plane(d - e * frame.x);
    const Vec3f dv = to_plane(d + e * frame.y) - to_plane(d - e * frame.y);
    const float area = std::abs(dot(cross(du, dv), to_lamp)) / (4.0f * e * e);
    // Per solid angle inside; the light sample states the lamp's as seen from the point.
    const float outside = is_far ? area : area / (light.distance * light.distance);
    // Radiance over its index squared stays; so does flux: the term is the solid angle inside over
    // that outside, times the index squared.
    EXPECT_NEAR(entry->geometry_term, ior * ior / outside, 0.02f * ior * ior / outside)
        << (is_far ? "far" : "near");
  }
}

}  // namespace
}  // namespace lamina
