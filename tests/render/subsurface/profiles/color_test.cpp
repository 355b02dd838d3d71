// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/layers/materials/material.h"
#include "lamina/render/subsurface/profiles/absorption_series.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/profiles/radius_mixture.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using ColorUse = SubsurfaceSurface::ColorUse;
using Method = RenderSettings::Method;

constexpr float pi_f = std::numbers::pi_v<float>;

/// Two greys side by side.
Image step_image(float left, float right) {
  Image image{.width = 512, .height = 2, .channels = {"R", "G", "B"}, .pixels = {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.pixels.insert(image.pixels.end(), 3, x < image.width / 2 ? left : right);
  return image;
}

SubsurfaceSurface& surface_of(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

void set_color(Scene& scene, ColorUse use, const Vec3f& value) {
  surface_of(scene).color_use = use;
  surface_of(scene).color = {.value = value, .map = std::nullopt};
}

/// A step at x = 0 of a plate whose texture coordinates span it.
void set_step(Scene& scene, ColorUse use, float left, float right) {
  scene.images = {step_image(left, right)};
  set_color(scene, use, {1, 1, 1});
  surface_of(scene).color.map = TextureMap{.source = ImageMap{.image = 0}};
}

/// A wide plate under a light from straight above, of which a line of 9 pixels, a fifth of a
/// millimetre each, is seen.
Scene line_scene(Method method, Material material) {
  Scene scene = translucent_scene(
      method, method == Method::random_walk ? make_plate(20.0f, 20.0f) : make_square(20.0f),
      std::move(material),
      DirectionalLight{.direction = {0, 0, 1}, .irradiance = {pi_f, pi_f, pi_f}});
  scene.camera = camera_above(1.8);
  scene.film = {.width = 9, .height = 1};
  scene.render.hierarchy = {.spacing = 0.1f, .irradiance_samples = 1};
  return scene;
}

/// Share of the light of a profile that leaves beyond a straight line at a distance from where it
/// enters.
double share_beyond(const Profile& profile, double distance, std::size_t band) {
  double beyond = 0.0;
  for (std::size_t i = 0; i + 1 < profile.r.size(); ++i) {
    const double r = std::sqrt(profile.r[i] * profile.r[i + 1]);
    if (!(r > distance)) continue;
    beyond += std::numbers::pi *
              (profile.r[i + 1] * profile.r[i + 1] - profile.r[i] * profile.r[i]) *
              std::sqrt(profile.reflectance_at(i, band) * profile.reflectance_at(i + 1, band)) *
              std::acos(distance / r) / std::numbers::pi;
  }
  return beyond / profile.total_reflectance[band];
}

// [DonnerJensen2005] §3.1: the texture is convolved with the profile. Of a step that is the share
// of the profile beyond a line; a pixel sees its mean over its width.
TEST(ColorThatScales, IsAsWideAsTheProfileSays) {
  const Material material = half_space({0.05, 0.2, 1.0}, 4.0, 1.0);
  const Profile profile = diffusion_profile(material);
  struct Case {
    Method method;
    int samples;
    double tolerance;
  };
  for (const auto& [method, samples, tolerance] :
       {Case{Method::hierarchy, 16, 0.015}, Case{Method::probe, 1024, 0.01},
        Case{Method::shadow_map, 256, 0.01}, Case{Method::random_walk, 512, 0.04}}) {
    Scene scene = line_scene(method, material);
    scene.render.samples_per_pixel = samples;
    const Image plain = render(scene).image;
    set_step(scene, ColorUse::scale, 0.75f, 1.0f);
    const Image stepped = render(scene).image;
    const double dark = 0.75 / 0.875, bright = 1.0 / 0.875;  // over the mean
    for (int x = 0; x < 9; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        double share = 0.0;  // of the brighter half
        constexpr int steps = 16;
        for (int i = 0; i < steps; ++i) {
          const double at = 0.2 * (x - 4.5 + (i + 0.5) / steps);
          const double beyond = share_beyond(profile, std::abs(at), c);
          share += (at < 0.0 ? beyond : 1.0 - beyond) / steps;
        }
        const double found = static_cast<double>(stepped.at(x, 0)[c] / plain.at(x, 0)[c]);
        EXPECT_NEAR(found, dark + share * (bright - dark), tolerance)
            << method.name() << " pixel " << x << " band " << c;
      }
  }
}

// A color without a map scales all that leaves; one whose map is even changes nothing.
TEST(ColorThatScales, IsAFactorWhereItIsEven) {
  for (const Method method :
       {Method::hierarchy, Method::probe, Method::shadow_map, Method::random_walk}) {
    Scene scene = line_scene(method, half_space({0.05, 0.2, 1.0}, 4.0, 1.0));
    scene.render.samples_per_pixel = 8;
    scene.render.hierarchy.spacing = 0.5f;
    const Image plain = render(scene).image;
    set_color(scene, ColorUse::scale, {0.5f, 0.25f, 0.0f});
    const Image scaled = render(scene).image;
    set_step(scene, ColorUse::scale, 0.4f, 0.4f);
    const Image even = render(scene).image;
    // A walk has the random numbers of the place of the color before it.
    const double noise = method == Method::random_walk ? 0.1 : 1e-5;
    const double factors[3] = {0.5, 0.25, 0.0};
    for (std::size_t c = 0; c < 3; ++c) {
      const double whole = mean_of(plain, c);
      EXPECT_NEAR(mean_of(scaled, c), factors[c] * whole, noise * whole) << method.name() << c;
      EXPECT_NEAR(mean_of(even, c), whole, noise * whole) << method.name() << c;
    }
  }
}

// With the absorption of a color its layers reflect it, by diffusion and the dipole, one layer and
// three.
TEST(AbsorptionSeries, MeetsColorsToAThousandth) {
  const std::vector<Material> materials = {half_space({0.05, 0.2, 1.0}, 4.0, 1.3),
                                           half_space({0.0, 0.2, 9.0}, 1.0, 1.5),
                                           find_material("donner_jensen_skin")};
  for (const Material& material : materials) {
    const std::vector<LayerStack> layers = layer_stacks(material);
    const auto make = [&](std::span<const LayerStack> stacks) {
      return make_diffusion_profile(stacks).profile;
    };
    const AbsorptionSeries series(layers,
                                  {.darkest = {0.001, 0.001, 0.001}, .brightest = {1, 1, 1}}, make);
    for (const double color : {0.001, 0.003, 0.01, 0.04, 0.1, 0.25, 0.5, 0.7, 0.85, 0.95, 0.99})
      for (std::size_t b = 0; b < layers.size(); ++b) {
        const double factor = series.factor(color, b);
        const LayerStack found = with_absorption(layers[b], factor);
        const double reflectance = make(std::span(&found, 1)).total_reflectance[0];
        EXPECT_NEAR(reflectance, color, 1e-3 * color) << material.name << " band " << b;
      }
    // No more nodes than the colors that are asked for take.
    EXPECT_LT(
        AbsorptionSeries(layers, {.darkest = {0.5, 0.5, 0.5}, .brightest = {0.5, 0.5, 0.5}}, make)
            .size(),
        series.size());
  }
}

// Each band a color of its own, from all but black to all but white, in even light.
TEST(InvertedColor, IsMetFromBlackToWhite) {
  for (const Method method : {Method::hierarchy, Method::probe, Method::shadow_map}) {
    for (const Vec3f& color : {Vec3f{0.001f, 0.5f, 0.99f}, Vec3f{0.01f, 0.1f, 0.9f}}) {
      Scene scene = translucent_scene(
          method, make_square(400.0f), half_space({0.05, 0.05, 0.05}, 50.0, 1.0),
          DirectionalLight{.direction = {0, 0, 1}, .irradiance = {pi_f, pi_f, pi_f}});
      scene.render.samples_per_pixel = 64;
      set_color(scene, ColorUse::invert, color);
      const Image image = render(scene).image;
      for (int c = 0; c < 3; ++c) {
        const auto wanted = static_cast<double>(color[c]);
        // The sum over cells errs, and points drawn for bright bands are few for dark ones.
        EXPECT_NEAR(mean_of(image, static_cast<std::size_t>(c)), wanted,
                    (method == Method::hierarchy ? 0.015
                     : wanted < 0.1              ? 0.1
                                                 : 5e-3) *
                        wanted)
            << method.name() << ' ' << c;
      }
    }
  }
}

// Light is exchanged by the absorption halfway between two colors, so what the bright side of a
// step sends to the dark one is what it gets: the same darkening and brightening of the light that
// leaves, whichever method.
TEST(InvertedColor, HasBothEndsInAllMethods) {
  const Material material = half_space({0.05, 0.2, 1.0}, 4.0, 1.0);
  std::vector<Image> images;
  for (const Method method : {Method::hierarchy, Method::probe, Method::shadow_map}) {
    Scene scene = line_scene(method, material);
    scene.render.samples_per_pixel = method == Method::hierarchy ? 64 : 4096;
    set_step(scene, ColorUse::invert, 0.2f, 0.8f);
    images.push_back(render(scene).image);
  }
  for (int x = 0; x < 9; ++x) {
    const auto at = [&](std::size_t image) {
      return static_cast<double>(images[image].at(x, 0)[0]);
    };
    EXPECT_NEAR(at(1), at(2), 0.01 * at(2)) << x;
    if (x == 4) continue;  // the samples of hierarchy blur the edge
    EXPECT_NEAR(at(0), at(2), 0.03 * at(2)) << x;
  }
  // The dark side gets light from the bright one, which loses it.
  EXPECT_GT(images[1].at(3, 0)[0], 0.21f);
  EXPECT_LT(images[1].at(5, 0)[0], 0.78f);
}

// Stripes of much contrast on a small ball: dark cells get light from bright ones, which is no
// light that bright ones would have more of.
TEST(InvertedColor, OfFineStripesIsTheSameByAllMethods) {
  std::vector<double> means;
  for (const Method method : {Method::hierarchy, Method::probe, Method::shadow_map}) {
    Scene scene = translucent_scene(method, make_sphere(2.0f),
                                    half_space({0.01, 0.01, 0.01}, 3.0, 1.4), EnvironmentLight{});
    Image stripes{.width = 64, .height = 1, .channels = {"R", "G", "B"}, .pixels = {}};
    for (int x = 0; x < stripes.width; ++x)
      stripes.pixels.insert(stripes.pixels.end(), 3, x % 8 < 4 ? 1.0f : 0.02f);
    scene.images = {stripes};
    set_color(scene, ColorUse::invert, {1, 1, 1});
    surface_of(scene).color.map = TextureMap{.source = ImageMap{.image = 0}};
    scene.camera = camera_above(3.0);
    scene.film = {.width = 12, .height = 12};
    scene.render.samples_per_pixel = 64;
    means.push_back(mean_of(render(scene).image, 0));
  }
  EXPECT_NEAR(means[0], means[1], 0.12 * means[1]);  // stripes as narrow as two cells
  EXPECT_NEAR(means[2], means[1], 0.04 * means[1]);
}

// Of a sum of profiles radii have its density, and a sweep of the unit interval is a sweep of
// radii: samples that are spread over the one are spread over the other.
TEST(RadiusMixture, DrawsRadiiOfTheWholeSumInOrder) {
  const Profile narrow = diffusion_profile(half_space({0.5, 1.0, 3.0}, 10.0, 1.4)),
                wide = diffusion_profile(half_space({0.01, 0.02, 0.1}, 10.0, 1.4));
  const RadiusGrid grid = make_radius_grid({narrow, wide});
  const auto one = BandValues<4>::filled(1.0f);
  const ProfileTable<4> a(narrow, grid, one), b(wide, grid, one);
  RadiusMixture<4> mixture;
  mixture.add(a, 1, 1.0f);
  mixture.add(b, ProfileTable<4>::all_bands, 2.0f);
  mixture.add(b, 0, 0.0f);
  double within = 0.0, before = 0.0, expected = 0.0, drawn = 0.0;
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    const auto r =
        static_cast<double>(mixture.sample_radius((static_cast<float>(i) + 0.5f) / count));
    EXPECT_GE(r, before) << i;
    // Between two samples lies 1 / count of the density.
    const auto middle = static_cast<float>(0.5 * (r + before));
    within +=
        std::numbers::pi * (r * r - before * before) * static_cast<double>(mixture.density(middle));
    drawn += std::exp(-r) / count;
    expected += std::exp(-static_cast<double>(middle)) * std::numbers::pi *
                (r * r - before * before) * static_cast<double>(mixture.density(middle));
    before = r;
  }
  EXPECT_NEAR(within, 1.0, 5e-3);
  EXPECT_NEAR(drawn, expected, 5e-3);
}

/// How much of the light in red differs from pixel to pixel: the median and the 99th percentile of
/// the difference between neighbours over their mean.
std::array<double, 2> red_grain(const Image& image) {
  std::vector<double> differences;
  const auto share = [&](int x, int y) {
    const float* p = image.at(x, y);
    return static_cast<double>(p[0] / (p[0] + p[1] + p[2]));
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x + 1 < image.width; ++x) {
      const double here = share(x, y), there = share(x + 1, y);
      differences.push_back(std::abs(here - there) / (0.5 * (here + there)));
    }
  std::ranges::sort(differences);
  return {differences[differences.size() / 2], differences[differences.size() * 99 / 100]};
}

// [Hery2003] §3: color grain comes from channels that have points of their own. All bands of an
// inverted color share theirs, spread over the radii, so its grain is about that of the material
// without a color; where each band is given some of the samples it is 6 to 8 times that.
TEST(InvertedColor, HasNoColorGrain) {
  for (const Method method : {Method::probe, Method::shadow_map}) {
    Scene scene = line_scene(method, half_space({0.03, 0.17, 0.48}, 1.0, 1.0));
    scene.film = {.width = 32, .height = 32};
    scene.camera = camera_above(8.0);
    scene.render.samples_per_pixel = 16;
    const auto plain = red_grain(render(scene).image);
    set_color(scene, ColorUse::invert, {0.6f, 0.41f, 0.32f});
    const auto inverted = red_grain(render(scene).image);
    EXPECT_LT(inverted[0], 2.0 * plain[0]) << method.name();
    EXPECT_LT(inverted[1], 2.0 * plain[1]) << method.name();
  }
}

}  // namespace
}  // namespace lamina
