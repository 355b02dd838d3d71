// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Random walks through layers whose numbers are maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/subsurface/media/walk_layers.h"
#include "lamina/scene/description/common_bands.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using Of = MappableNumber::Of;

// The plane is striped along x: 64 texels of 0.1 mm, the first one begins at
// -3.2 mm.
constexpr int columns = 64;
constexpr float texel = 0.1f;

/// A map by column, whose own texels are smaller, for they are interpolated.
MaterialMap stripes(const MappableNumber& number, const std::function<float(int)>& value) {
  constexpr int finer = 16;
  MaterialMap map{number, make_image(finer * columns, 1, {"Y"})};
  for (int x = 0; x < finer * columns; ++x) *map.values.at(x, 0) = value(x / finer);
  return map;
}

SubsurfaceSurface& surface_of_walk(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

/// A wide plate under an even sky, of which the camera sees one column.
Scene striped_plate(Material material, std::vector<MaterialMap> maps, int column, int samples) {
  Mesh plate = make_plate(60.0f, 30.0f);
  for (std::size_t i = 0; i < plate.uvs.size(); ++i)
    plate.uvs[i] = {(plate.positions[i].x + 3.2f) / (columns * texel), 0.5f};
  Scene scene = translucent_scene(RenderSettings::Method::random_walk, std::move(plate),
                                  std::move(material), EnvironmentLight{});
  surface_of_walk(scene).material_maps = std::move(maps);
  scene.camera = camera_above(texel);
  const double x = static_cast<double>((static_cast<float>(column) + 0.5f) * texel - 3.2f);
  scene.camera.position.x = scene.camera.look_at.x = x;
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = samples;
  return scene;
}

/// Black over all that is left of a column.
void cover(Scene& scene, int column) {
  Mesh mesh = make_square(30.0f, 1);
  for (Vec3f& p : mesh.positions)
    p += Vec3f{static_cast<float>(column) * texel - 3.2f - 15.0f, 0, 0.002f};
  scene.meshes.push_back(mesh);
  scene.materials.push_back(diffuse_material(0.0f));
}

double subsurface_mean(const Image& image, std::size_t c) {
  return mean_of(image, channel_index(image, std::string("subsurface.") + "RGB"[c]).value());
}

/// What a beam that enters one column sends back right of another one: by
/// reciprocity the radiance there towards the eye, of a sky that shines on all
/// but what is left of the other one.
double photons_sent_back(const Patch& patch, int column, int covered) {
  Patch beam = patch;
  beam.irradiance.assign(columns, 0.0);
  beam.irradiance[static_cast<std::size_t>(column)] = 1.0;
  const PatchPhotons photons = trace_patch_photons(beam, {.photons = 15'000, .seed = 5});
  double sum = 0.0;
  for (int x = covered; x < columns; ++x)
    sum += photons.exitance[static_cast<std::size_t>(x)].value;
  return sum;
}

// Absorption of two layers of two indices, each with an edge, under a sky that
// is partly covered. With many photons and samples the two are within 0.2 %,
// which is their noise.
TEST(WalkMaps, PlateOfMappedAbsorptionReflectsAsPhotonsDo) {
  const auto upper = [](int x) { return x < 32 ? 6.0f : 0.2f; };
  const auto lower = [](int x) { return x < 36 ? 0.4f : 2.0f; };
  const Material material = material_of({layer_of({1, 1, 1}, {8, 12, 16}, 0.5, 0.2, 1.4),
                                         layer_of({1, 1, 1}, {6, 8, 10}, 0.3, infinite, 1.3)});
  for (const int covered : {0, 31}) {
    constexpr int seen = 34;
    Scene scene = striped_plate(material,
                                {stripes({.of = Of::sigma_a, .layer = 0}, upper),
                                 stripes({.of = Of::sigma_a, .layer = 1}, lower)},
                                seen, 128);
    if (covered > 0) cover(scene, covered);
    const Image image = render(scene).image;
    for (const std::size_t c : {covered > 0 ? 2u : 0u}) {
      Patch patch{.stack = layer_stack(material, c), .columns = columns, .texel = texel};
      patch.sigma_a.resize(2);
      for (int x = 0; x < columns; ++x) {
        patch.sigma_a[0].push_back(static_cast<double>(upper(x)));
        patch.sigma_a[1].push_back(static_cast<double>(lower(x)));
      }
      const double expected = photons_sent_back(patch, seen, covered);
      EXPECT_NEAR(subsurface_mean(image, c), expected, 0.03 * expected) << covered << ' ' << c;
    }
  }
}

// By what skin is made of: an edge of melanin, of the absorbing junction and of
// blood. Photons take the junction as a layer of a micrometre. With many
// photons and samples: within 0.4 %.
TEST(WalkMaps, PlateOfMappedSkinReflectsAsPhotonsDo) {
  const Material skin = parse_material(
      R"({ "lamina": "material", "version": 1, "name": "skin", "length_unit": "mm",
           "bands": [560, 660], "skin": { "epidermis_thickness": 0.1 } })",
      "test");
  const auto at = [&](int x) {
    SkinParameters values = skin.skin->skin;
    values.melanin = x < 32 ? 0.05 : 0.004;
    values.junction_absorption = x < 34 ? 0.5 : 0.1;
    values.hemoglobin_dermis = x < 30 ? 0.001 : 0.008;
    return values;
  };
  std::vector<MaterialMap> maps;
  const auto ranges = skin_parameter_ranges();
  for (const auto value : {&SkinParameters::melanin, &SkinParameters::junction_absorption,
                           &SkinParameters::hemoglobin_dermis}) {
    const auto range = std::ranges::find(ranges, value, &SkinParameterRange::value);
    maps.push_back(
        stripes({.of = Of::skin, .part = static_cast<std::size_t>(range - ranges.begin())},
                [&](int x) { return static_cast<float>(at(x).*value); }));
  }
  constexpr int seen = 33;
  const Scene scene = striped_plate(skin, maps, seen, 72);
  const Image image = render(scene).image;
  std::vector<double> spectrum;
  for (const double wavelength : skin.bands.wavelengths()) {
    Patch patch{
        .stack = skin_layer_stack(skin.skin->skin, wavelength), .columns = columns, .texel = texel};
    patch.sigma_a.resize(3);
    for (int x = 0; x < columns; ++x)
      for (std::size_t l = 0; l < 3; ++l)
        patch.sigma_a[l].push_back(skin_layer_stack(at(x), wavelength).layers()[l].medium.sigma_a);
    spectrum.push_back(photons_sent_back(patch, seen, 0));
  }
  const LinearSrgb expected = linear_srgb(weights_of_bands(scene, skin.bands), spectrum);
  for (const std::size_t c : {0u, 1u, 2u})
    EXPECT_NEAR(subsurface_mean(image, c), expected[c], 0.04 * expected[c]) << c;
}

// Thickness, too: the same everywhere, so that layers are flat, by maps of many
// texels.
TEST(WalkMaps, OfOneValueAreLayers) {
  Material material = material_of({layer_of({0.3, 0.6, 2.0}, {6, 8, 10}, 0.5, 0.3),
                                   layer_of({0.1, 0.4, 0.8}, {2, 2, 2}, 0.0, infinite)});
  const Scene scene =
      striped_plate(material,
                    {stripes({.of = Of::thickness, .layer = 0}, [](int) { return 0.3f; }),
                     stripes({.of = Of::g, .layer = 0}, [](int) { return 0.5f; }),
                     stripes({.of = Of::sigma_s, .layer = 1}, [](int) { return 2.0f; })},
                    32, 128);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = adding_doubling(layer_stack(material, c)).totals.diffuse_reflectance;
    EXPECT_NEAR(subsurface_mean(image, c), expected, 0.02 * expected) << c;
  }
}

/// Layers of one index whose numbers all differ from place to place.
std::vector<MaterialMap> wild_maps() {
  return {stripes({.of = Of::thickness, .layer = 0}, [](int x) { return x % 8 < 4 ? 0.1f : 0.3f; }),
          stripes({.of = Of::g, .layer = 0}, [](int x) { return x % 2 ? 0.2f : 0.8f; }),
          stripes({.of = Of::sigma_s, .layer = 0}, [](int x) { return x % 4 < 2 ? 3.0f : 9.0f; }),
          stripes({.of = Of::sigma_s, .layer = 1}, [](int x) { return x % 16 < 8 ? 1.0f : 4.0f; })};
}

TEST(WalkMaps, WithoutAbsorptionDisappearInEvenLight) {
  Scene scene = translucent_scene(RenderSettings::Method::random_walk, make_sphere(1.0f),
                                  material_of({layer_of({0, 0, 0}, {5, 5, 5}, 0.7, 0.2),
                                               layer_of({0, 0, 0}, {1, 1, 1}, 0.0, infinite, 1.5)}),
                                  EnvironmentLight{});
  scene.meshes[0].is_closed = true;
  surface_of_walk(scene).material_maps = wild_maps();
  scene.camera = camera_above(1.4);
  scene.render.samples_per_pixel = 8;
  EXPECT_NEAR(mean_of(render(scene).image, 0), 1.0, 0.01);
}

// The same light as a lamp, found by next-event estimation through the maps,
// and as a sky, which paths that leave find.
TEST(WalkMaps, PassALampAsTheyPassSky) {
  const Material material = material_of({layer_of({0.3, 0.3, 0.3}, {5, 5, 5}, 0.7, 0.2),
                                         layer_of({0.2, 0.2, 0.2}, {1, 1, 1}, 0.0, infinite)});
  Scene scene = striped_plate(material, wild_maps(), 32, 48);
  const double of_sky = subsurface_mean(render(scene).image, 0);
  scene.lights = {RectangleLight{
      .center = {0, 0, 5}, .edge_u = {200, 0, 0}, .edge_v = {0, -200, 0}, .radiance = {1, 1, 1}}};
  EXPECT_GT(of_sky, 0.1);
  EXPECT_NEAR(subsurface_mean(render(scene).image, 0), of_sky, 0.05 * of_sky);
}

// Against the integral of the extinction along the segment: from the second
// layer up to the surface.
TEST(WalkMaps, LetThroughAlongASegmentWhatTheIntegralOfTheirExtinctionSays) {
  const auto upper = [](int x) { return x % 4 < 2 ? 6.0f : 0.2f; };
  const auto lower = [](int x) { return x % 6 < 3 ? 0.4f : 2.0f; };
  const Scene scene = striped_plate(material_of({layer_of({1, 1, 1}, {1, 2, 3}, 0.5, 0.2),
                                                 layer_of({1, 1, 1}, {1, 2, 3}, 0.3, infinite)}),
                                    {stripes({.of = Of::sigma_a, .layer = 0}, upper),
                                     stripes({.of = Of::sigma_a, .layer = 1}, lower)},
                                    32, 1);
  const RenderScene prepared(scene);
  const auto conversion =
      make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
  const WalkLayers<4> layers(prepared, conversion, 0);
  const Vec3f origin{0.33f, 0.1f, -0.5f}, end{1.07f, 0.2f, 0.0f};
  const float distance = length(end - origin);
  const Ray ray{origin, (1.0f / distance) * (end - origin)};
  double integral = 0.0;
  constexpr int steps = 20'000;
  for (int i = 0; i < steps; ++i) {
    const Vec3f p = origin + ((static_cast<float>(i) + 0.5f) / steps) * (end - origin);
    const auto column = static_cast<int>((p.x + 3.2f) / texel);
    integral +=
        static_cast<double>((p.z > -0.2f ? upper(column) : lower(column)) * distance) / steps;
  }
  const auto start = layers.by_depth().at(origin), out = layers.by_depth().at(end);
  ASSERT_EQ(start.layer, 1u);
  EXPECT_NEAR(start.depth, 0.5f, 1e-3f);
  const BandValues<4> expected = exp_minus(layers.optical_thickness(ray, start, distance, out));
  Random random(3);
  BandValues<4> sum;
  constexpr int count = 20'000;
  for (int i = 0; i < count; ++i)
    sum += expected * layers.sample_residual(ray, start, distance, out, random);
  for (int b = 0; b < 3; ++b) {
    const double truth = std::exp(-integral - (1.0 + b) * static_cast<double>(distance));
    EXPECT_NEAR(static_cast<double>(sum[b]) / count, truth, 0.02 * truth) << b;
    EXPECT_GT(std::abs(static_cast<double>(expected[b]) - truth), 0.1 * truth) << b;
  }
}

// At every column: sigma_s and the extinction less sigma_s times g, from maps and without.
TEST(WalkMaps, ScatterEvenlyBySimilarity) {
  const auto scattering = [](int x) { return x % 8 < 4 ? 5.0f : 2.0f; };
  const auto forward = [](int x) { return x % 4 < 2 ? 0.8f : 0.3f; };
  const Scene scene = striped_plate(material_of({layer_of({1, 2, 3}, {1, 1, 1}, 0.5, 0.2),
                                                 layer_of({1, 2, 3}, {4, 5, 6}, 0.7, infinite)}),
                                    {stripes({.of = Of::sigma_s, .layer = 0}, scattering),
                                     stripes({.of = Of::g, .layer = 0}, forward)},
                                    32, 1);
  const RenderScene prepared(scene);
  const auto conversion =
      make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
  const WalkLayers<4> layers(prepared, conversion, 0);
  const WalkLayers<4> even = layers.with_even_scattering();
  for (int column = 1; column < 9; ++column) {
    const float x = (static_cast<float>(column) + 0.5f) * texel - 3.2f;
    const Vec3f upper{x, 0.1f, -0.1f}, lower{x, 0.1f, -0.5f};
    auto place = even.by_depth().at(upper), below = even.by_depth().at(lower);
    ASSERT_EQ(place.layer, 0u);
    ASSERT_EQ(below.layer, 1u);
    place.texel = even.sample_texel(place, 0.5f);
    const float s = scattering(column), g = forward(column);
    const auto here = even.coefficients(place), there = even.coefficients(below);
    const BandValues<4> along = even.optical_thickness(
        {upper, {0, 1, 0}}, place, 0.5f, even.by_depth().at(upper + Vec3f{0, 0.5f, 0}));
    for (int b = 0; b < 3; ++b) {
      const float absorbed = 1.0f + static_cast<float>(b), s_below = 4.0f + static_cast<float>(b);
      EXPECT_NEAR(here.sigma_s[b], s * (1 - g), 1e-4f) << column;
      EXPECT_NEAR(here.sigma_t[b], absorbed + s * (1 - g), 1e-4f) << column;
      EXPECT_NEAR(there.sigma_s[b], 0.3f * s_below, 1e-4f);
      EXPECT_NEAR(there.sigma_t[b], absorbed + 0.3f * s_below, 1e-4f);
      EXPECT_NEAR(along[b], 0.5f * (absorbed + s * (1 - g)), 1e-3f) << column;
      EXPECT_LE(here.sigma_t[b], even.most_extinction(0)[b]);
      EXPECT_EQ(even.phase(place, 0.1f)[b], even.phase(place, 1.9f)[b]);
    }
  }
  EXPECT_NEAR(even.most_extinction(0)[0], 1.0f + 5.0f * 0.7f, 1e-3f);
}

// From a dark place in a clear plate, centimetres of the way to a lamp: what the dark would let
// through underflows, and the clear plate is more than that by more than a float holds.
TEST(WalkMaps, StayFiniteFarFromADarkPlace) {
  const Material material = material_of({layer_of({1, 1, 1}, {0.3, 0.3, 0.3}, 0.0, infinite)});
  const auto spot = [](int x) { return x >= 30 && x < 34 ? 60.0f : 0.001f; };
  Scene scene = striped_plate(material, {stripes({.of = Of::sigma_a, .layer = 0}, spot)}, 40, 64);
  scene.lights = {RectangleLight{
      .center = {0, 0, 5}, .edge_u = {200, 0, 0}, .edge_v = {0, -200, 0}, .radiance = {1, 1, 1}}};
  const Image image = render(scene).image;
  for (const float value : image.pixels) ASSERT_TRUE(std::isfinite(value));
}

TEST(WalkMaps, NeedTextureCoordinates) {
  Scene scene = striped_plate(half_space({1, 1, 1}, 2.0, 1.4), {}, 32, 1);
  surface_of_walk(scene).material_maps = {
      stripes({.of = Of::sigma_a, .layer = 0}, [](int x) { return x < 32 ? 1.0f : 2.0f; })};
  (void)render(scene);
  scene.meshes[0].uvs.clear();
  try {
    (void)render(scene);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("texture coordinates"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lamina
