// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/shading/refracted_entry.h"
#include "render/subsurface/papers/single_scattering/light_once.h"

namespace lamina {
namespace {

using namespace once;

// A flat half-space under one distant light: [HanrahanKrueger1993]'s first order with the angles
// inside, T(i) T(o) / n^2 * albedo p / (mu_i' + mu_o').
TEST(SingleScattering, OfAFlatHalfSpaceIsTheFirstOrder) {
  for (const double g : {0.0, 0.6, 0.8})
    for (const bool is_refracted : {false, true}) {
      const double n = 1.4, theta_i = 0.7, theta_o = 0.5, phi = 2.0;
      const Material material = one_layer(g, n);
      const Vec3f wo = along(theta_o, phi);
      const Scene scene =
          scene_of(make_square(200.0f), material,
                   DirectionalLight{.direction = {std::sin(theta_i), 0, std::cos(theta_i)},
                                    .irradiance = {pi, pi, pi}});
      const BandValues<4> found = mean_once(scene, wo, is_refracted, 1 << 14);
      const double mu_i = std::cos(theta_i), mu_o = std::cos(theta_o);
      const double in_i = std::sqrt(1 - (1 - mu_i * mu_i) / (n * n));
      const double in_o = std::sqrt(1 - (1 - mu_o * mu_o) / (n * n));
      const double sin_i = std::sin(theta_i) / n, sin_o = std::sin(theta_o) / n;
      const double cos_turn = -(in_i * in_o + sin_i * sin_o * std::cos(phi));
      const double k = 1 + g * g - 2 * g * cos_turn;
      const double phase = (1 - g * g) / (4 * std::numbers::pi * k * std::sqrt(k));
      for (std::size_t b = 0; b < 3; ++b) {
        const auto& layer = material.layers[0];
        const double albedo = layer.sigma_s[b] / (layer.sigma_a[b] + layer.sigma_s[b]);
        const double first_order = (1 - fresnel(mu_i, n)) * (1 - fresnel(mu_o, n)) / (n * n) *
                                   albedo * phase / (in_i + in_o) * mu_i * std::numbers::pi;
        EXPECT_NEAR(static_cast<double>(found[static_cast<int>(b)]), first_order,
                    1e-3 * first_order)
            << "g " << g << " band " << b << (is_refracted ? " refracted" : " straight");
      }
    }
}

// Even light on a matched half-space, seen along the normal: the closed form's integral over
// directions, albedo / 2 * (1 - ln 2) for isotropic scattering.
TEST(SingleScattering, GathersLightFromTheWholeSky) {
  const Material material = one_layer(0.0, 1.0);
  const Scene scene = scene_of(make_square(200.0f), material, EnvironmentLight{});
  const BandValues<4> found = mean_once(scene, {0, 0, 1}, false, 1 << 16, true);
  for (std::size_t b = 0; b < 3; ++b) {
    const auto& layer = material.layers[0];
    const double albedo = layer.sigma_s[b] / (layer.sigma_a[b] + layer.sigma_s[b]);
    const double expected = 0.5 * albedo * (1.0 - std::log(2.0));
    EXPECT_NEAR(static_cast<double>(found[static_cast<int>(b)]), expected, 0.01 * expected);
  }
}

// A coat that lies everywhere but in one corner of its map, where the texture coordinates are 0:
// grazing light that enters far from there is mirrored by it, as by one without maps.
TEST(SingleScattering, LightEntersThroughTheCoatThatLiesThere) {
  Image map = make_image(64, 64, {"Y"});
  std::ranges::fill(map.pixels, 1.0f);
  for (const int y : {0, 1, 62, 63})
    for (const int x : {0, 1, 62, 63}) *map.at(x, y) = 0.0f;
  const TextureMap but_a_corner{.source = ImageMap{.image = 0}};
  Scene scene = scene_of(
      make_square(200.0f), one_layer(0.0, 1.4),
      DirectionalLight{.direction = {std::sin(1.3), 0, std::cos(1.3)}, .irradiance = {pi, pi, pi}});
  scene.images = {map};
  for (const bool is_refracted : {false, true}) {
    scene.materials[0].coat = Coat{.ior = 1.8f, .roughness = {0.6f}};
    const float wanted = mean_once(scene, {0, 0, 1}, is_refracted, 1 << 8)[0];
    scene.materials[0].coat->weight.map = but_a_corner;
    EXPECT_EQ(mean_once(scene, {0, 0, 1}, is_refracted, 1 << 8)[0], wanted);
    scene.materials[0].coat->weight.map = {};
    scene.materials[0].coat->roughness.map = but_a_corner;
    EXPECT_NEAR(mean_once(scene, {0, 0, 1}, is_refracted, 1 << 8)[0], wanted, 0.005f * wanted)
        << (is_refracted ? "refracted" : "straight");
  }
}

// The refracted entry into a sphere obeys Snell's law, and its focus is the ratio of cross-sections
// that two neighbouring rays find.
TEST(RefractedEntry, ObeysSnellsLawAndFocusesAsNeighbouringRaysDo) {
  const float radius = 5.0f, ior = 1.4f;
  const Scene scene = scene_of(make_sphere(radius, 200), one_layer(0.0, 1.4), EnvironmentLight{});
  const RenderScene prepared(scene);
  const Vec3f inside{0.5f, -0.3f, 3.0f};
  for (const Vec3f& direction : {along(0.2, 1.0), along(0.7, 4.0)}) {
    const LightSample light{.direction = direction,
                            .distance = std::numeric_limits<float>::infinity(),
                            .radiance = {1, 1, 1},
                            .pdf = 1.0f,
                            .is_delta = true};
    const auto entry = find_refracted_entry(prepared, inside, 0, ior, light, direction);
    ASSERT_TRUE(entry.has_value());
    const Vec3f n = normalize(entry->point.position);
    const Vec3f t = normalize(inside - entry->point.position);  // the light's way inside
    EXPECT_NEAR(length(cross(t, n)) * ior, length(cross(direction, n)), 3e-3f);
    EXPECT_NEAR(dot(cross(t, n), direction), 0.0f, 3e-3f);  // one plane
    // A parallel beam of side e refracted into an ideal sphere, where it passes the point.
    const auto passes = [&](Vec3f start) {
      const float b = dot(start, direction), c = dot(start, start) - radius * radius;
      const Vec3f p = start + (-b + std::sqrt(b * b - c)) * direction;
      const Vec3f q = refract_inside(direction, normalize(p), ior);
      const float length_inside = dot(p - inside, entry->to_surface) / dot(q, entry->to_surface);
      return p - length_inside * q;
    };
    const Framef frame = make_frame(direction);
    const float e = 0.02f;
    const Vec3f start = entry->point.position - 0.5f * direction;
    const Vec3f du = passes(start + e * frame.x) - passes(start - e * frame.x);
    const Vec3f dv = passes(start + e * frame.y) - passes(start - e * frame.y);
    const float focus = 4.0f * e * e / std::abs(dot(cross(du, dv), entry->to_surface));
    EXPECT_NEAR(entry->geometry_term, focus, 0.02f * focus);  // facets of 1.6 degrees
  }
}

// Light that leaves almost along the surface is found, too: what a search misses there, paths that
// meet a lamp bring as specks.
TEST(RefractedEntry, IsFoundForGrazingLight) {
  const float ior = 1.4f;
  const Scene scene = scene_of(make_sphere(5.0f, 200), one_layer(0.0, 1.4), EnvironmentLight{});
  const RenderScene prepared(scene);
  int sought = 0, found = 0;
  for (const float x : {0.0f, 0.7f, 2.0f})
    for (double angle = 0.5; angle < 1.6; angle += 0.0001) {
      const Vec3f inside{x, 0.0f, 4.5f - 0.5f * x}, direction = along(angle, 0.3);
      const Hit hit = prepared.geometry.first_hit({inside, direction}, 0.0f);
      const SurfacePoint exit = make_bare_surface_point(scene.meshes, hit);
      const Vec3f n = exit.smooth_normal;
      const float cos_inside = dot(direction, n);
      const float sin_outside = ior * std::sqrt(1.0f - cos_inside * cos_inside);
      if (!(sin_outside > 0.98f && sin_outside < 0.9999f)) continue;
      const float cos_outside = std::sqrt(1.0f - sin_outside * sin_outside);
      const Vec3f towards = normalize(ior * direction + (cos_outside - ior * cos_inside) * n);
      const LightSample light{.direction = towards,
                              .distance = std::numeric_limits<float>::infinity(),
                              .radiance = {1, 1, 1},
                              .pdf = 1.0f,
                              .is_delta = true};
      ++sought;
      for (const Vec3f& first : {refract_inside(towards, {0, 0, 1}, ior), towards}) {
        const auto entry = find_refracted_entry(prepared, inside, 0, ior, light, first);
        if (!entry || !(length(entry->point.position - exit.position) < 0.05f)) continue;
        ++found;
        break;
      }
    }
  EXPECT_GT(sought, 20);
  EXPECT_EQ(found, sought);
}

}  // namespace
}  // namespace lamina
