// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/skin/patch/skin_patch.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

// Finite layers by texture_space: light that passes them leaves on their other side.

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr double ior = 1.4;

/// An absorbing layer over a scattering one, in air.
Material two_layers(std::vector<double> sigma_a) {
  Material material = material_of({layer_of(std::move(sigma_a), {8, 8, 8}, 0.0, 0.15, ior),
                                   layer_of({0, 0, 0}, {40, 40, 40}, 0.5, 0.1, ior)});
  material.ior_below = {1, 1, 1};
  return material;
}

/// @param from_below  whether the camera looks at z = 0 from there
Scene scene_of(Mesh mesh, Material material, double view, bool from_below) {
  Scene scene = translucent_scene(RenderSettings::Method::texture_space, std::move(mesh),
                                  std::move(material), EnvironmentLight{});
  scene.camera = camera_above(view);
  if (from_below) scene.camera.position.z = -scene.camera.position.z;
  scene.render.texture_space = {.texel = 1.0f, .irradiance_samples = 1024};
  return scene;
}

SubsurfaceSurface& surface_of(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

/// A sky that shines on one side of the plane z = 0. Its map has -z in the middle.
void light_one_side(Scene& scene, bool above) {
  Image sky = make_image(64, 32, {"R", "G", "B"});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      if ((x < 16 || x >= 48) == above) std::fill_n(sky.at(x, y), 3, 1.0f);
  scene.images.push_back(std::move(sky));
  scene.lights = {EnvironmentLight{.image = 0}};
}

/// Fractions of light that has entered evenly, by adding-doubling.
struct Leaving {
  double reflected, transmitted;
};
Leaving leaving(const Material& material, std::size_t band, bool from_below) {
  const LayerStack stack = layer_stack(material, band);
  const SlabTotals totals =
      adding_doubling(from_below ? flipped(stack) : stack, {.is_diffuse = true}).totals;
  const double entered = 1.0 - totals.specular_reflectance;
  return {totals.diffuse_reflectance / entered, totals.transmittance / entered};
}

TEST(TextureSpaceSheet, ShowsTheTotalsOfTheSlabOnEitherSide) {
  const Material material = two_layers({0.5, 3.0, 12.0});
  for (const bool from_below : {false, true})
    for (const bool lit_above : {false, true}) {
      Scene scene = scene_of(make_square(12.0f), material, 8.0, from_below);
      light_one_side(scene, lit_above);
      const Image image = render(scene).image;
      for (std::size_t b = 0; b < 3; ++b) {
        const auto [reflected, transmitted] = leaving(material, b, !lit_above);
        const double wanted =
            (from_below == lit_above ? transmitted : reflected) * (1.0 - fresnel(1.0, ior));
        const double found =
            mean_of(image, *channel_index(image, std::string("subsurface.") + "RGB"[b]));
        EXPECT_NEAR(found, wanted, 0.01 * wanted)
            << b << (from_below ? " from below" : " from above")
            << (lit_above ? ", lit above" : ", lit below");
      }
    }
}

// In even light nothing is lost and nothing is made. Between a smooth and a rough boundary a
// percent goes to the wrong side, for the layers take both as smooth.
TEST(TextureSpaceSheet, WithoutAbsorptionDisappearsInEvenLight) {
  for (const double roughness_below : {0.0, 0.4}) {
    double both_sides = 0.0;
    for (const bool from_below : {false, true}) {
      Material material = two_layers({0, 0, 0});
      material.ground.top.roughness = roughness_below;
      Scene scene = scene_of(make_square(12.0f), material, 8.0, from_below);
      scene.render.samples_per_pixel = 64;
      const double found = mean_of(render(scene).image, 1);
      EXPECT_NEAR(found, 1.0, roughness_below > 0.0 ? 0.015 : 3e-3) << from_below;
      both_sides += found;
    }
    EXPECT_NEAR(both_sides, 2.0, 4e-3) << roughness_below;
  }
}

/// What `lamina patch` makes of layers on 8 mm in even light, the upper or the lower one a map.
Image on_plane(Material material, std::size_t mapped_layer, const Image& thickness) {
  const MaterialMap map{{.of = MappableNumber::Of::thickness, .layer = mapped_layer}, thickness};
  SkinPatch patch{.width = 128,
                  .height = 128,
                  .mm_per_texel = 8.0 / 128.0,
                  .material = MappedMaterial{std::move(material), {map}, {}},
                  .light = make_image(128, 128, {"Y"}),
                  .totals = OperatorTotals::radiative_transfer_diffuse};
  std::ranges::fill(patch.light.pixels, 1.0f);
  return render_skin_patch(patch, std::nullopt).image;
}

// A map of the upper layer's thickness, under a lamp on either side: what a patch of the layers
// transmits, and what one of the layers in reverse order reflects.
TEST(TextureSpaceSheet, OfVaryingThicknessIsThatOfAPatch) {
  constexpr int size = 32;
  const Material material = two_layers({0.3, 1.0, 4.0});
  Material reversed = material;
  std::ranges::reverse(reversed.layers);
  Image thickness = make_image(64, 64, {"Y"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      *thickness.at(x, y) =
          0.25f * std::exp(0.8f * static_cast<float>(std::sin(0.2 * y) + 0.5 * std::cos(0.1 * x)));
  const Image transmitted = on_plane(material, 0, thickness);
  const Image reflected = on_plane(reversed, 1, thickness);

  const double seen = (1.0 - fresnel(1.0, ior)) / (1.0 - fresnel_diffuse(ior));
  for (const bool lit_above : {true, false}) {
    Scene scene = scene_of(make_square(8.0f), material, 8.0, true);
    scene.film = {.width = size, .height = size};
    scene.render.samples_per_pixel = 16;
    scene.render.texture_space = {.texel = 0.0625f, .irradiance_samples = 1};
    surface_of(scene).material_maps = {
        {{.of = MappableNumber::Of::thickness, .name = "layers[0].thickness"}, thickness}};
    scene.lights = {
        DirectionalLight{.direction = {0, 0, lit_above ? 1.0 : -1.0}, .irradiance = {pi, pi, pi}}};
    const Image image = render(scene).image;
    for (const std::string band : {"R", "G", "B"}) {
      const std::size_t channel = *channel_index(image, "subsurface." + band);
      const Image& plane = lit_above ? transmitted : reflected;
      const std::size_t wanted_channel =
          *channel_index(plane, lit_above ? "transmitted." + band : band);
      double square = 0.0, mean = 0.0, mean_found = 0.0;
      for (int y = 2; y < size - 2; ++y)
        for (int x = 2; x < size - 2; ++x) {
          double wanted = 0.0;
          for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i)  // seen from below left is right
              wanted +=
                  seen / 16.0 *
                  static_cast<double>(plane.at(4 * (size - 1 - x) + i, 4 * y + j)[wanted_channel]);
          const auto found = static_cast<double>(image.at(x, y)[channel]);
          square += (found - wanted) * (found - wanted);
          mean += wanted;
          mean_found += found;
        }
      const double pixels = (size - 4.0) * (size - 4.0);
      EXPECT_GT(mean / pixels, 0.02);
      EXPECT_NEAR(mean_found, mean, 0.01 * mean) << band << lit_above;
      EXPECT_LT(std::sqrt(square / pixels) / (mean / pixels), 0.02) << band << lit_above;
    }
  }
}

// The two faces of a closed mesh bound the layers, if they are near enough.
TEST(TextureSpaceSheet, ClosedMeshesLetLightThroughToTheFaceOpposite) {
  Material material = material_of({layer_of({0.5, 3.0, 12.0}, {30, 30, 30}, 0.0, 0.25, ior)});
  material.ior_below = {1, 1, 1};
  for (const float distance : {0.3f, 5.0f}) {
    Scene scene = scene_of(make_plate(12.0f, distance), material, 8.0, true);
    scene.render.texture_space.irradiance_samples = 1;
    scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {pi, pi, pi}}};
    const RenderResult result = render(scene);
    const double seen = std::pow(1.0 - fresnel(1.0, ior), 2) / (1.0 - fresnel_diffuse(ior));
    for (std::size_t b = 0; b < 3; ++b) {
      const double wanted = distance < 1.0f ? seen * leaving(material, b, false).transmitted : 0.0;
      EXPECT_NEAR(mean_of(result.image, b), wanted, 0.01 * wanted) << b;
    }
    ASSERT_EQ(result.statistics.warnings.size(), distance < 1.0f ? 0u : 1u);
    if (distance > 1.0f) {
      EXPECT_EQ(result.statistics.warnings[0],
                "material \"translucent\": on 100 % of its closed meshes light that passes the "
                "layers is lost, for no far side is within 1 mm, four times their thickness");
    }
  }
}

TEST(TextureSpaceSheet, ClosedMeshesWithoutAbsorptionDisappearInEvenLight) {
  Material material = material_of({layer_of({0, 0, 0}, {30, 30, 30}, 0.0, 0.25, ior)});
  material.ior_below = {1, 1, 1};
  Scene scene = scene_of(make_plate(12.0f, 0.3f), material, 8.0, false);
  scene.render.samples_per_pixel = 64;
  EXPECT_NEAR(mean_of(render(scene).image, 1), 1.0, 3e-3);
}

// Paths of indirect light pass a sheet: a floor below it has what it transmits.
TEST(TextureSpaceSheet, ShinesOnWhatIsBelowIt) {
  const Material material = two_layers({0.5, 3.0, 12.0});
  Scene scene = scene_of(make_square(2000.0f), material, 1.0, false);
  scene.camera = {.position = {0, 0, -2}, .look_at = {0, 0, -5}, .up = {0, 1, 0}};
  scene.render.texture_space = {.texel = 20.0f, .irradiance_samples = 1};
  scene.render.samples_per_pixel = 1024;
  scene.render.max_bounces = 1;
  Mesh floor = make_square(2000.0f, 1);
  for (Vec3f& p : floor.positions) p.z = -5.0f;
  scene.meshes.push_back(std::move(floor));
  scene.materials.push_back(diffuse_material(0.5f));
  scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {pi, pi, pi}}};
  const Image image = render(scene).image;
  for (std::size_t b = 0; b < 3; ++b) {
    const double wanted = 0.5 * (1.0 - fresnel(1.0, ior)) * leaving(material, b, false).transmitted;
    EXPECT_NEAR(mean_of(image, b), wanted, 0.015 * wanted) << b;
  }
}

TEST(TextureSpaceSheet, IsTheSameByLightThatWasKept) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "sheet.ply";
  std::filesystem::remove(file);
  Scene scene = scene_of(make_square(12.0f), two_layers({0.5, 3.0, 12.0}), 8.0, true);
  scene.render.texture_space.irradiance_samples = 4;
  light_one_side(scene, true);
  const Image made = render(scene, {.cache = file}).image;
  EXPECT_EQ(render(scene, {.cache = file, .needs_cache = true}).image.pixels, made.pixels);
}

}  // namespace
}  // namespace lamina
