// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/covering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/render.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;

MaterialLayer film() { return layer_of({0.5, 1.5, 3.0}, {20, 20, 20}, 0.3, 0.05); }
MaterialLayer clear_film() { return layer_of({0, 0, 0}, {0, 0, 0}, 0.0, 0.05); }
MaterialLayer white_film() { return layer_of({0, 0, 0}, {20, 20, 20}, 0.3, 0.05); }
MaterialLayer dense_base() {
  return layer_of({0.1, 0.015, 0.06}, {40, 40, 40}, 0.5, infinite, 1.5);
}

Covering covering_of(MaterialLayer layer, float coverage = 1.0f) {
  return {
      .name = "film", .material = material_of({std::move(layer)}), .coverage = {.value = coverage}};
}

SurfaceMaterial matte(float reflectance, std::vector<Covering> over) {
  SurfaceMaterial material = diffuse_material(reflectance);
  std::get<DiffuseSurface>(material.surface).over = std::move(over);
  return material;
}

SurfaceMaterial translucent(std::vector<Covering> over) {
  return {.name = "base",
          .surface = SubsurfaceSurface{.material = material_of({dense_base()}),
                                       .thickness = {.value = 0},
                                       .over = std::move(over)}};
}

/// A wide square in even light, seen under a cosine.
Scene square_in_even_light(SurfaceMaterial material, double mu, int samples = 1024) {
  Scene scene;
  scene.camera = camera_above(0.5);
  const double distance = scene.camera.position.z;
  scene.camera.position = {distance * std::sqrt(1.0 - mu * mu), 0.0, distance * mu};
  scene.film = {.width = 4, .height = 4};
  scene.render = {.method = Method::probe, .samples_per_pixel = samples, .max_bounces = 0};
  scene.materials = {std::move(material)};
  scene.meshes = {make_square(100.0f)};
  scene.lights = {EnvironmentLight{}};
  return scene;
}

double total(const LayerStack& stack, double mu) {
  const SlabTotals totals = adding_doubling(stack, {.theta = std::acos(mu)}).totals;
  return totals.specular_reflectance + totals.diffuse_reflectance;
}

// By reciprocity the eye sees in even light what is reflected of light that comes from the eye.
TEST(Covering, OnAMatteSurfaceHasTheTotalsOfLayersOnAGround) {
  Material layers = material_of({film()});
  layers.ground.reflectance = 0.5;
  for (const double mu : {1.0, 0.5, 0.2}) {
    const Image image = render(square_in_even_light(matte(0.5f, {covering_of(film())}), mu)).image;
    for (std::size_t b = 0; b < 3; ++b) {
      const double expected = total(layer_stack(layers, b), mu);
      EXPECT_NEAR(mean_of(image, b), expected, 0.02 * expected) << mu << ' ' << b;
    }
  }
}

// Clear, it is Saunderson's correction of the color of paint for its surface.
TEST(Covering, OfClearFilmMeetsItsClosedForm) {
  const double inside = 1.0 - (1.0 - fresnel_diffuse(1.4)) / (1.4 * 1.4);
  for (const double mu : {1.0, 0.5}) {
    const double passed = 1.0 - fresnel(mu, 1.4);
    const double expected = 1.0 - passed + passed * (1.0 - inside) * 0.5 / (1.0 - inside * 0.5);
    EXPECT_NEAR(
        mean_of(render(square_in_even_light(matte(0.5f, {covering_of(clear_film())}), mu)).image,
                0),
        expected, 0.01 * expected)
        << mu;
  }
}

TEST(Covering, OnATranslucentSurfaceHasTheTotalsOfAllLayersTogether) {
  const Material merged = material_of({film(), dense_base()});
  for (const Method method : {Method::probe, Method::hierarchy, Method::texture_space})
    for (const double mu : {1.0, 0.5}) {
      Scene scene = square_in_even_light(translucent({covering_of(film())}), mu);
      scene.render.method = method;
      const Image image = render(scene).image;
      for (std::size_t b = 0; b < 3; ++b) {
        const double expected = total(layer_stack(merged, b), mu);
        EXPECT_NEAR(mean_of(image, b), expected, 0.03 * expected)
            << method.name() << ' ' << mu << ' ' << b;
      }
    }
}

// The upper one is the last.
TEST(Covering, LiesOnTheOneBeforeIt) {
  const MaterialLayer black = layer_of({100, 100, 100}, {0, 0, 0}, 0.0, 0.05);
  const auto seen = [&](std::vector<Covering> over) {
    return mean_of(render(square_in_even_light(matte(1.0f, std::move(over)), 1.0)).image, 0);
  };
  EXPECT_GT(seen({covering_of(black), covering_of(white_film())}),
            seen({covering_of(white_film()), covering_of(black)}) + 0.1);
}

/// What a matte base under coverings sends out into all directions of a light's, of the flux that
/// has entered; without noise.
double entered_light_returned(float reflectance, std::vector<Covering> over, float cos_i) {
  const Scene scene = square_in_even_light(matte(reflectance, std::move(over)), 1.0, 1);
  const RenderScene prepared(scene);
  const Coverings<4> coverings = make_coverings<4>(prepared);
  const std::optional<CoverAt<4>> cover =
      cover_at<4>(prepared, coverings, SurfacePoint{.material = 0});
  // Leaves through the boundary on top, inside of which the light is diffuse.
  const double ior = 1.4;
  const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
  double weights = 0.0, returned = 0.0;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double mu = rule.nodes[k], weight = rule.weights[k] * mu * (1.0 - fresnel(mu, ior));
    const auto cos_o = static_cast<float>(mu);
    weights += weight;
    returned +=
        weight * static_cast<double>(
                     cover->reflection(cos_i, cos_o)[0] +
                     cover->matte_reflection(cos_i, cos_o, BandValues<4>::filled(reflectance))[0]);
  }
  return returned / weights;
}

TEST(Covering, WithoutAbsorptionOnWhiteReturnsAllLight) {
  for (const float cos_i : {1.0f, 0.7f, 0.3f}) {
    EXPECT_NEAR(entered_light_returned(1.0f, {covering_of(white_film())}, cos_i), 1.0, 2e-3);
    EXPECT_NEAR(
        entered_light_returned(1.0f, {covering_of(white_film()), covering_of(clear_film())}, cos_i),
        1.0, 2e-3);
  }
}

TEST(Covering, WithoutAbsorptionOnWhiteDisappearsInEvenLight) {
  for (const float coverage : {1.0f, 0.5f})
    for (const double mu : {1.0, 0.5}) {
      const Scene scene =
          square_in_even_light(matte(1.0f, {covering_of(white_film(), coverage)}), mu);
      EXPECT_NEAR(mean_of(render(scene).image, 0), 1.0, 0.02) << coverage << ' ' << mu;
    }
}

TEST(Covering, ThatIsNowhereChangesNothing) {
  for (const auto& make :
       {+[](std::vector<Covering> over) { return matte(0.5f, std::move(over)); },
        +[](std::vector<Covering> over) { return translucent(std::move(over)); }}) {
    const auto seen = [&](std::vector<Covering> over) {
      return render(square_in_even_light(make(std::move(over)), 0.5, 16)).image.pixels;
    };
    EXPECT_EQ(seen({covering_of(film(), 0.0f)}), seen({}));
  }
}

// Light that is kept on disk was found under other coverings, or another coat.
TEST(Covering, IsPartOfWhatKeptLightFollowsFrom) {
  const auto key = [](std::vector<Covering> over, std::optional<Coat::SecondLobe> second = {}) {
    SurfaceMaterial material = translucent(std::move(over));
    material.coat = Coat{.second = std::move(second)};
    const Scene scene = square_in_even_light(std::move(material), 1.0);
    return light_fingerprint(scene, scene.render, {}).materials;
  };
  EXPECT_EQ(key({covering_of(film())}), key({covering_of(film())}));
  EXPECT_NE(key({covering_of(film())}), key({}));
  EXPECT_NE(key({covering_of(film())}), key({covering_of(film(), 0.5f)}));
  EXPECT_NE(key({covering_of(film())}), key({covering_of(white_film())}));
  EXPECT_NE(key({}), key({}, Coat::SecondLobe{}));
}

// The surface below has no bands of its own.
TEST(Covering, ByWavelengthsMakesThePictureOneOfThem) {
  const Material paint = find_material("red_paint");
  Scene scene = square_in_even_light(
      matte(0.4f, {{.name = "paint", .material = paint, .coverage = {.value = 1.0f}}}), 1.0, 256);
  const Image image = render(scene).image;
  std::vector<double> spectrum;
  for (std::size_t b = 0; b < paint.bands.size(); ++b)
    spectrum.push_back(total(layer_stack(paint, b), 1.0));  // its ground reflects as much
  const LinearSrgb expected = linear_srgb(make_band_weights(paint.bands), spectrum);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(mean_of(image, c), expected[c], 0.02 * expected[0]) << c;
  scene.materials.push_back(translucent({}));  // in RGB
  scene.meshes.push_back(scene.meshes[0]);
  std::ranges::fill(scene.meshes[1].material, 1U);
  EXPECT_THROW(render(scene), InvalidInput);
}

TEST(Covering, RefusesLayersWithoutEnd) {
  EXPECT_THROW(render(square_in_even_light(matte(0.5f, {covering_of(dense_base())}), 1.0, 1)),
               InvalidInput);
}

TEST(Covering, StandsBesideNoLightThatTakesTheSurfaceAsBare) {
  Scene scene = square_in_even_light(translucent({covering_of(film())}), 1.0, 1);
  scene.render.method = Method::random_walk;
  EXPECT_THROW(render(scene), InvalidInput);
  scene.render.method = Method::hierarchy;
  scene.render.is_corrected = true;
  EXPECT_THROW(render(scene), InvalidInput);
}

// Two lobes of a coat reflect what each does alone, by their shares.
TEST(Coat, ReflectsWithBothOfItsLobes) {
  const auto seen = [](std::optional<Coat::SecondLobe> second, float roughness) {
    SurfaceMaterial material = diffuse_material(0.0f);
    material.coat = Coat{.roughness = {.value = roughness}, .second = std::move(second)};
    Scene scene = square_in_even_light(std::move(material), 1.0, 4);
    scene.lights = {DirectionalLight{.direction = {0.3, 0, 1}, .irradiance = {1, 1, 1}}};
    return mean_of(render(scene).image, 0);
  };
  const double sharp = seen({}, 0.2f), wide = seen({}, 0.5f);
  EXPECT_GT(std::abs(sharp / wide - 1.0), 0.2);
  EXPECT_NEAR(seen(Coat::SecondLobe{.roughness = {.value = 0.5f}, .share = {.value = 0.25f}}, 0.2f),
              0.75 * sharp + 0.25 * wide, 1e-3 * sharp);
}

}  // namespace
}  // namespace lamina
