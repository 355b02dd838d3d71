// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/subsurface/profiles/once_in_even_light.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "render/subsurface/papers/single_scattering/light_once.h"

namespace lamina {
namespace {

using namespace once;

using ColorUse = SubsurfaceSurface::ColorUse;

constexpr double n = 1.4, theta_i = 0.7;

/// A wide plate under a light from +x; it is looked at from straight above.
Scene plate_scene() {
  return scene_of(make_square(40.0f), one_layer(0.0, n),
                  DirectionalLight{.direction = {std::sin(theta_i), 0, std::cos(theta_i)},
                                   .irradiance = {pi, pi, pi}});
}

SubsurfaceSurface& surface_of(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

void set_color(Scene& scene, ColorUse use, const Vec3f& value) {
  surface_of(scene).color_use = use;
  surface_of(scene).color.value = value;
}

/// Greys of the color left and right of x = 0; their mean, that of the map, is 1 / 2.
void set_step(Scene& scene, ColorUse use, float left, float right) {
  Image image{.width = 4096, .height = 1, .channels = {"R", "G", "B"}, .pixels = {}};
  for (int x = 0; x < image.width; ++x)
    image.pixels.insert(image.pixels.end(), 3, x < image.width / 2 ? left : right);
  scene.images = {image};
  set_color(scene, use, {1, 1, 1});
  surface_of(scene).color.map = TextureMap{.source = ImageMap{.image = 0}};
}

/// The absorption with which the layer reflects a color, by bisection of what diffusion says.
double absorption_for(double reflectance, std::size_t band) {
  const LayerStack layers = layer_stack(one_layer(0.0, n), band);
  const ProfileMaker make_profile(RenderSettings{.profile = RenderSettings::Profile::diffusion});
  double low = -12.0, high = 12.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const LayerStack tried = with_absorption(layers, std::exp(middle));
    const double found = make_profile(one_layer(0.0, n), std::span(&tried, 1)).total_reflectance[0];
    (found > reflectance ? low : high) = middle;
  }
  return layers.layers()[0].medium.sigma_a * std::exp(low);
}

/// Radiance scattered once towards +z at a place x, by quadrature over the depth, where extinction
/// differs from place to place.
///
/// @param slope    how far aside light enters, over the depth
/// @param sigma_t  [1/mm] of the place on the surface
double by_quadrature(double x, double sigma_s, double slope,
                     const std::function<double(double)>& sigma_t) {
  const double mu_i = std::cos(theta_i), sin_i = std::sin(theta_i) / n;
  const double in_i = std::sqrt(1.0 - sin_i * sin_i);
  const double edge = std::max(-x, 0.0) / slope;  // light to deeper places enters at x > 0
  double total = 0.0;
  const auto add = [&](double from, double to) {
    const Quadrature rule = gauss_legendre(64, from, to);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double z = rule.nodes[i];
      total += rule.weights[i] * std::exp(-sigma_t(x) * z - sigma_t(x + z * slope) * z / in_i);
    }
  };
  if (edge > 0.0) add(0.0, edge);
  add(edge, edge + 20.0);
  const double passed = (1.0 - fresnel(mu_i, n)) * (1.0 - fresnel(1.0, n)) / (n * n);
  return passed * sigma_s / (4.0 * std::numbers::pi) * total * mu_i / in_i * std::numbers::pi;
}

// [Hery2003] §2: an inverted color is the absorption with which the layers reflect it.
TEST(SingleScatteringColor, ThatIsInvertedIsThatOfTheMaterialWithItsAbsorption) {
  const Vec3f color{0.5f, 0.02f, 0.3f};
  Scene colored = plate_scene();
  set_color(colored, ColorUse::invert, color);
  Scene own = plate_scene();
  for (std::size_t b = 0; b < 3; ++b)
    surface_of(own).material.layers[0].sigma_a[b] =
        absorption_for(static_cast<double>(color[static_cast<int>(b)]), b);
  for (const bool is_refracted : {false, true}) {
    const BandValues<4> found = mean_once(colored, {0, 0, 1}, is_refracted, 1 << 12);
    const BandValues<4> expected = mean_once(own, {0, 0, 1}, is_refracted, 1 << 12);
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(found[b], expected[b], 1e-3f * expected[b]) << b;
  }
}

TEST(SingleScatteringColor, OfBlackIsNothing) {
  for (const ColorUse use : {ColorUse::scale, ColorUse::invert}) {
    Scene scene = plate_scene();
    const BandValues<4> without = mean_once(scene, {0, 0, 1}, false, 256);
    set_color(scene, use, {0, 0, 0});
    const BandValues<4> black = mean_once(scene, {0, 0, 1}, false, 256);
    // Inverted it is the blackest that absorption makes, which reflects .0005.
    for (int b = 0; b < 3; ++b)
      EXPECT_LE(black[b], use == ColorUse::scale ? 0.0f : 0.01f * without[b]) << b;
  }
}

TEST(SingleScatteringColor, ThatScalesIsAFactor) {
  Scene scene = plate_scene();
  const BandValues<4> without = mean_once(scene, {0, 0, 1}, true, 256);
  set_color(scene, ColorUse::scale, {0.3f, 0.2f, 0.9f});
  const BandValues<4> scaled = mean_once(scene, {0, 0, 1}, true, 256);
  for (int b = 0; b < 3; ++b)
    EXPECT_NEAR(scaled[b], surface_of(scene).color.value[b] * without[b], 1e-5f * without[b]) << b;
}

// At a step: the extinction of the exit on the way out, that of the entry on the way in, which for
// deep events lies on the other side.
TEST(SingleScatteringColor, HasTheExtinctionOfBothEnds) {
  Scene scene = plate_scene();
  set_step(scene, ColorUse::invert, 0.2f, 0.6f);
  for (const bool is_refracted : {false, true})
    for (const double x : {-0.6, -0.15, 0.15}) {
      const BandValues<4> found =
          mean_once(scene, {0, 0, 1}, is_refracted, 1 << 14, false, {static_cast<float>(x), 0, 0});
      for (std::size_t b = 0; b < 3; ++b) {
        const double sigma_s = one_layer(0.0, n).layers[0].sigma_s[b];
        const double dark = absorption_for(0.2, b), bright = absorption_for(0.6, b);
        const double sin_i = std::sin(theta_i) / n;
        const double slope =
            is_refracted ? sin_i / std::sqrt(1.0 - sin_i * sin_i) : std::tan(theta_i);
        const double expected = by_quadrature(x, sigma_s, slope, [&](double place) {
          return sigma_s + (place < 0.0 ? dark : bright);
        });
        EXPECT_NEAR(static_cast<double>(found[static_cast<int>(b)]), expected, 5e-3 * expected)
            << x << ' ' << b;
      }
    }
}

// A color that scales does so where the light enters.
TEST(SingleScatteringColor, ThatScalesCountsAtTheEntry) {
  Scene scene = plate_scene();
  const double x = -0.3;
  set_step(scene, ColorUse::scale, 0.25f, 0.75f);
  const BandValues<4> found =
      mean_once(scene, {0, 0, 1}, true, 1 << 15, false, {static_cast<float>(x), 0, 0});
  const double sin_i = std::sin(theta_i) / n, in_i = std::sqrt(1.0 - sin_i * sin_i);
  for (std::size_t b = 0; b < 3; ++b) {
    const MaterialLayer layer = one_layer(0.0, n).layers[0];
    const double sigma_t = layer.sigma_s[b] + layer.sigma_a[b];
    const double whole =
        by_quadrature(x, layer.sigma_s[b], sin_i / in_i, [&](double) { return sigma_t; });
    const double beyond = std::exp(-sigma_t * (1.0 + 1.0 / in_i) * -x * in_i / sin_i);
    const double expected = whole * (0.5 + beyond);
    EXPECT_NEAR(static_cast<double>(found[static_cast<int>(b)]), expected, 0.01 * expected) << b;
  }
}

// [Hery2003] §4: it can be weighed, and blurred. A step seen and lit from above, where light enters
// and leaves at one place, becomes that of a Gaussian.
TEST(SingleScatteringColor, HasAWeightAndABlur) {
  Scene scene = plate_scene();
  const BandValues<4> without = mean_once(scene, {0, 0, 1}, false, 256);
  surface_of(scene).single_scattering_weight.value = 0.25f;
  const BandValues<4> weighed = mean_once(scene, {0, 0, 1}, false, 256);
  for (int b = 0; b < 3; ++b) EXPECT_FLOAT_EQ(weighed[b], 0.25f * without[b]);

  scene = plate_scene();
  std::get<DirectionalLight>(scene.lights[0]).direction = {0, 0, 1};
  const BandValues<4> even = mean_once(scene, {0, 0, 1}, false, 1 << 14);
  set_step(scene, ColorUse::scale, 0.25f, 0.75f);
  surface_of(scene).single_scattering_blur.value = 0.5f;
  for (const double x : {-0.5, 0.0, 0.25}) {
    const BandValues<4> found =
        mean_once(scene, {0, 0, 1}, false, 1 << 14, false, {static_cast<float>(x), 0, 0});
    const double right = 0.5 * std::erfc(-x / (0.5 * std::numbers::sqrt2));
    for (int b = 0; b < 3; ++b)
      EXPECT_NEAR(static_cast<double>(found[b] / even[b]), 0.5 + right, 0.02) << x << ' ' << b;
  }
}

// In even light on a matched half-space the share is albedo / 2 (1 - mu ln(1 + 1 / mu)), the first
// order of the plane albedo.
TEST(OnceInEvenLight, IsTheFirstOrderOfTheAlbedo) {
  const Material material = one_layer(0.0, 1.0);
  const std::vector<LayerStack> stacks = layer_stacks(material);
  const OnceInEvenLight<4> once(stacks);
  for (const double mu : {0.25, 0.5, 1.0})
    for (std::size_t b = 0; b < 3; ++b) {
      const auto& layer = material.layers[0];
      const double albedo = layer.sigma_s[b] / (layer.sigma_a[b] + layer.sigma_s[b]);
      const double expected = 0.5 * albedo * (1.0 - mu * std::log(1.0 + 1.0 / mu));
      EXPECT_NEAR(static_cast<double>(once.share(static_cast<float>(mu))[static_cast<int>(b)]),
                  expected, 1e-3 * expected);
    }
}

}  // namespace
}  // namespace lamina
