// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/skin_totals.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/scene/description/method_settings.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;

/// A ball of skin in even light.
Scene scene_of(const Material& skin, Method method) {
  Scene scene;
  scene.film = {.width = 16, .height = 16};
  scene.render = {.method = method, .profile = quick_profile(method), .samples_per_pixel = 16};
  scene.render.max_bounces = 0;
  scene.render.hierarchy = {.spacing = 0.7f, .irradiance_samples = 2};
  scene.render.texture_space = {.texel = 0.7f, .irradiance_samples = 2};
  scene.materials = {{.name = "skin", .surface = SubsurfaceSurface{.material = skin}}};
  const float radius = method == Method::random_walk ? 100.0f : 20.0f;
  scene.camera = camera_above(2.0 * static_cast<double>(radius));
  scene.meshes = {make_sphere(radius, 48)};
  scene.meshes[0].is_closed = true;
  scene.lights = {EnvironmentLight{}};
  return scene;
}

/// The color of light that leaves the inside, over all directions: the disc of the ball touches the
/// borders of the picture.
Vec3 color_of(const Material& skin, Method method) {
  const Image image = render(scene_of(skin, method)).image;
  Vec3 color;
  for (int c = 0; c < 3; ++c)
    color[c] = mean_of(image, *channel_index(image, std::string("subsurface.") + "RGB"[c])) * 4.0 /
               std::numbers::pi;
  return color;
}

/// What flat skin reflects of diffuse light, by adding-doubling, as a color.
Vec3 exact_color(const Material& skin) {
  std::vector<double> spectrum;
  for (std::size_t b = 0; b < skin.bands.size(); ++b)
    spectrum.push_back(
        adding_doubling(layer_stack(skin, b), {.is_diffuse = true}).totals.diffuse_reflectance);
  const LinearSrgb color =
      linear_srgb(make_skin_band_weights(skin.bands, skin.skin->skin), spectrum);
  return {color[0], color[1], color[2]};
}

// Dark skin, of which diffusion makes twice as much in blue and 1.3 times as much in red: ashy.
TEST(SkinTotals, BuiltInSkinHasOneColorByAllMethods) {
  Material skin = find_material("skin_type_6");
  const Vec3 exact = exact_color(skin);
  // Its rough mirror sends back less of grazing light than a smooth one, so that more enters.
  const Vec3 under_rough = color_of(skin, Method::hierarchy);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(under_rough[c], exact[c], 0.04 * exact[c]) << "RGB"[c];
  skin.specular_roughness.reset();
  // Few views of the sky make steps of light in shadow_map; a ball is not flat for random_walk.
  const std::pair<Method, double> tolerances[] = {
      {Method::hierarchy, 0.02},     {Method::probe, 0.02},      {Method::layered_bsdf, 0.02},
      {Method::texture_space, 0.02}, {Method::shadow_map, 0.08}, {Method::random_walk, 0.03}};
  for (const auto& [method, tolerance] : tolerances) {
    const Vec3 color = color_of(skin, method);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(color[c], exact[c], tolerance * exact[c]) << method.name() << ' ' << "RGB"[c];
  }
}

TEST(SkinTotals, ConstantsThatAreNamedAreNeverExchanged) {
  const auto skin = [](const std::string& constants) {
    return parse_material(R"({"lamina": "material", "version": 1, "length_unit": "mm",
      "bands": [450, 540, 640], "skin": {"melanin": 0.05)" +
                              constants + "}}",
                          "test");
  };
  const Material diffusion = skin(R"(, "constants": "calibrated_diffusion")");
  const Material exact = skin(R"(, "constants": "calibrated")");
  EXPECT_EQ(exact.layers, skin("").layers);
  for (const auto profile : {RenderSettings::Profile::diffusion, RenderSettings::Profile::dipole}) {
    RenderSettings settings{.profile = profile};
    EXPECT_FALSE(takes_material_totals(diffusion, settings));
    EXPECT_FALSE(takes_material_totals(skin(R"(, "constants": "paper")"), settings));
    EXPECT_TRUE(takes_material_totals(exact, settings));
    settings.single_scattering = RenderSettings::SingleScattering::straight;
    EXPECT_FALSE(takes_material_totals(exact, settings));
  }
  const ProfileMaker by_diffusion(RenderSettings{.profile = RenderSettings::Profile::diffusion});
  const Profile own = by_diffusion(diffusion, layer_stacks(diffusion)),
                scaled = by_diffusion(exact, layer_stacks(exact));
  EXPECT_EQ(own.reflectance_profile, diffusion_profile(diffusion).reflectance_profile);
  const std::vector<EnteredTotals> totals = material_totals(layer_stacks(exact));
  const Profile before = diffusion_profile(exact);
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_NEAR(scaled.total_reflectance[b], totals[b].reflectance, 1e-9);
    // The shape stays.
    EXPECT_NEAR(scaled.reflectance_at(9, b) / scaled.total_reflectance[b],
                before.reflectance_at(9, b) / before.total_reflectance[b],
                1e-9 * scaled.reflectance_at(9, b) / scaled.total_reflectance[b]);
  }
}

TEST(SkinTotals, ReportNamesConstantsAndTotals) {
  Scene scene = scene_of(find_material("skin_type_6"), Method::hierarchy);
  const auto line = [&] { return describe_skin_totals(skin_totals(scene).at(0), scene); };
  EXPECT_EQ(line(), "skin: skin with the constants \"calibrated\", totals by radiative transfer");
  scene.render.single_scattering = RenderSettings::SingleScattering::refracted;
  EXPECT_NE(line().find("totals by diffusion: brighter than"), std::string::npos);
  scene.render = {.method = Method::random_walk};
  std::get<SubsurfaceSurface>(scene.materials[0].surface).material.skin->constants =
      SkinConstants::calibrated_diffusion;
  EXPECT_NE(line().find("totals by radiative transfer: darker than"), std::string::npos);
}

}  // namespace
}  // namespace lamina
