// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Which method a scene gets that leaves it open, and what it is said to cost.
#include "lamina/render/planning/method_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/render/subsurface/bodies/optical_size.h"
#include "lamina/render/subsurface/spacing_field.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;

Scene lit_ball(Method method = Method::automatic) {
  Scene scene = translucent_scene(method, make_sphere(5.0f, 32),
                                  half_space({0.1, 0.3, 1.0}, 10.0, 1.3), EnvironmentLight{});
  scene.meshes[0].is_closed = true;
  scene.camera = camera_above(12.0);
  scene.film = {.width = 32, .height = 32};
  scene.render.max_bounces = 1;
  return scene;
}

Material skin_by_bands() {
  return parse_material(
      R"({ "lamina": "material", "version": 1, "name": "skin", "length_unit": "mm",
           "bands": [450, 540, 640], "skin": { "constants": "calibrated_diffusion" } })",
      "test");
}

SubsurfaceSurface& surface_of(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

RenderStatistics chosen_for(const Scene& scene) { return render(scene).statistics; }

TEST(MethodChoice, FollowsWhatTheMaterialsNeed) {
  Scene scene = lit_ball();
  surface_of(scene).maps = {{.quantity = LayerMap::Quantity::sigma_a, .terms = {{.value = 0.5f}}}};
  EXPECT_EQ(chosen_for(scene).method, Method::layered_bsdf);

  scene = lit_ball();
  surface_of(scene).material = skin_by_bands();
  Image map = make_image(2, 2, {"R"});
  for (float& value : map.pixels) value = 0.02f;
  surface_of(scene).material_maps = {
      {{.of = MappableNumber::Of::skin, .part = 0, .name = "skin.melanin"}, map}};
  scene.render.texture_space.texel = 0.5f;
  const RenderStatistics of_maps = chosen_for(scene);
  EXPECT_EQ(of_maps.method, Method::texture_space);
  EXPECT_NE(of_maps.why_method.find("maps"), std::string::npos) << of_maps.why_method;

  // A black ball inside: only the sum over samples knows of it.
  scene = lit_ball();
  scene.meshes.push_back(make_sphere(2.0f, 12, 1));
  scene.materials.push_back(diffuse_material(0.0f));
  EXPECT_EQ(chosen_for(scene).method, Method::hierarchy);

  // Without scattering there is no profile; and what is inside an open surface nobody knows.
  scene = lit_ball();
  surface_of(scene).material = half_space({0.1, 0.3, 1.0}, 0.0, 1.3);
  EXPECT_EQ(chosen_for(scene).method, Method::random_walk);
  scene.meshes[0].is_closed = false;
  EXPECT_EQ(chosen_for(scene).method, Method::layered_bsdf);
}

TEST(MethodChoice, FollowsSettingsOfOneMethod) {
  const auto with = [](auto&& change) {
    Scene scene = lit_ball();
    change(scene.render);
    return chosen_for(scene).method;
  };
  EXPECT_EQ(with([](RenderSettings& s) { s.orders = LayeredOrders::first; }), Method::layered_bsdf);
  EXPECT_EQ(with([](RenderSettings& s) { s.hierarchy.spacing = 1.0f; }), Method::hierarchy);
  EXPECT_EQ(with([](RenderSettings& s) { s.shadow_map.resolution = 64; }), Method::shadow_map);
}

// However few the samples; and the picture is the one of the method by its name.
TEST(MethodChoice, TakesLightWithoutNoise) {
  Scene scene = lit_ball();
  for (const int samples : {1, 64}) {
    scene.render.samples_per_pixel = samples;
    scene.render.method = Method::automatic;
    const RenderResult open = render(scene);
    EXPECT_EQ(open.statistics.method, Method::hierarchy);
    EXPECT_EQ(open.statistics.why_method, "no noise below surfaces");
    EXPECT_TRUE(open.statistics.warnings.empty());
    scene.render.method = Method::hierarchy;
    const RenderResult named = render(scene);
    EXPECT_EQ(named.image.pixels, open.image.pixels);
    EXPECT_TRUE(named.statistics.why_method.empty());
  }
}

TEST(MethodChoice, CorrectedLightIsThatOfAMethodThatIsCorrected) {
  Scene scene = lit_ball();
  scene.film = {.width = 4, .height = 4};
  scene.render.is_corrected = true;
  const RenderStatistics statistics = chosen_for(scene);
  EXPECT_EQ(statistics.method, Method::hierarchy);
  EXPECT_EQ(statistics.corrections.size(), 1u);
}

TEST(Quality, ChoosesMethodCorrectionAndSamples) {
  using Quality = RenderSettings::Quality;
  const auto chosen = [](Quality quality, auto&& change) {
    Scene scene = lit_ball();
    set_quality(quality, scene);
    change(scene);
    return choose_settings(scene, {}).settings;
  };
  const auto nothing = [](Scene&) {};
  const RenderSettings preview = chosen(Quality::preview, nothing);
  const RenderSettings final = chosen(Quality::final, nothing);
  const RenderSettings reference = chosen(Quality::reference, nothing);
  EXPECT_EQ(preview.method, Method::probe);
  EXPECT_FALSE(preview.is_corrected);
  EXPECT_EQ(final.method, Method::hierarchy);
  EXPECT_TRUE(final.is_corrected);
  EXPECT_EQ(reference.method, Method::random_walk);
  EXPECT_FALSE(reference.is_corrected);
  EXPECT_LT(4 * preview.samples_per_pixel, final.samples_per_pixel);
  EXPECT_LT(4 * final.samples_per_pixel, reference.samples_per_pixel);

  // A final picture is that of the method and the correction by name, bit by bit.
  Scene scene = lit_ball();
  scene.film = {.width = 6, .height = 4};
  Scene named = scene;
  set_quality(Quality::final, scene);
  named.render.method = Method::hierarchy;
  named.render.is_corrected = true;
  named.render.samples_per_pixel = scene.render.samples_per_pixel;
  const RenderResult result = render(scene);
  EXPECT_EQ(result.image.pixels, render(named).image.pixels);
  EXPECT_TRUE(result.statistics.is_corrected);

  // Bodies that no flat profile fits are corrected, but for a first look.
  const auto smaller = [](Scene& s) {
    surface_of(s).material = half_space({0.1, 0.1, 0.1}, 1.0, 1.3);
  };
  EXPECT_EQ(chosen(Quality::final, smaller).method, Method::hierarchy);
  EXPECT_TRUE(chosen(Quality::final, smaller).is_corrected);
  EXPECT_EQ(chosen(Quality::preview, smaller).method, Method::probe);

  // Maps of constituents are of texture_space alone among methods without noise.
  const auto mapped = [](Scene& s) {
    surface_of(s).material = skin_by_bands();
    surface_of(s).material_maps = {
        {{.of = MappableNumber::Of::skin, .part = 0, .name = "skin.melanin"},
         make_image(2, 2, {"R"})}};
  };
  EXPECT_EQ(chosen(Quality::preview, mapped).method, Method::texture_space);
  EXPECT_EQ(chosen(Quality::final, mapped).method, Method::texture_space);
}

TEST(Quality, YieldsToWhatIsNamed) {
  using Quality = RenderSettings::Quality;
  const auto chosen = [](Quality quality, auto&& change) {
    Scene scene = lit_ball();
    set_quality(quality, scene);
    change(scene);
    return choose_settings(scene, {}).settings;
  };
  const auto probe = [](Scene& s) { s.render.method = Method::probe; };
  EXPECT_EQ(chosen(Quality::final, probe).method, Method::probe);
  EXPECT_FALSE(chosen(Quality::final, probe).is_corrected);
  EXPECT_EQ(chosen(Quality::reference, probe).method, Method::probe);
  const auto corrected = [](Scene& s) {
    s.places["render.correct"] = "--correct";
    s.render.is_corrected = true;
  };
  EXPECT_EQ(chosen(Quality::preview, corrected).method, Method::hierarchy);
  EXPECT_TRUE(chosen(Quality::preview, corrected).is_corrected);
  const auto planar = [](Scene& s) { s.places["render.correct"] = "scene.json:9"; };
  EXPECT_FALSE(chosen(Quality::final, planar).is_corrected);
  // Open surfaces and light scattered once cannot be corrected.
  EXPECT_FALSE(
      chosen(Quality::final, [](Scene& s) { s.meshes[0].is_closed = false; }).is_corrected);
  EXPECT_FALSE(chosen(Quality::final, [](Scene& s) {
                 s.render.single_scattering = RenderSettings::SingleScattering::straight;
               }).is_corrected);
  // Random walks are the reference even where "auto" is named, and refuse what they do not honour.
  const auto automatic = [](Scene& s) { s.render.method = Method::automatic; };
  EXPECT_EQ(chosen(Quality::reference, automatic).method, Method::random_walk);
  EXPECT_THROW((void)chosen(Quality::reference,
                            [](Scene& s) {
                              s.render.method = Method::automatic;
                              s.render.exit_angle = RenderSettings::ExitAngle::printed;
                            }),
               InvalidInput);
}

// A ball of 15 mm that is nearly clear, in even light of radiance 1: .944 of it comes back, by
// random walks; by a flat profile a third of that.
TEST(MethodChoice, FollowsLightInsideSmallBodies) {
  Scene scene = lit_ball();
  scene.meshes = {make_sphere(7.5f, 48)};
  scene.meshes[0].is_closed = true;
  scene.camera = camera_above(7.5);
  surface_of(scene).material = half_space({0.002, 0.002, 0.002}, 0.00014, 1.33);
  const RenderResult open = render(scene);
  EXPECT_EQ(open.statistics.method, Method::random_walk);
  EXPECT_NE(open.statistics.why_method.find("9.99 mm, 0.021 transport mean free paths"),
            std::string::npos)
      << open.statistics.why_method;
  EXPECT_TRUE(open.statistics.warnings.empty());
  EXPECT_NEAR(mean_of(open.image, 0), 0.97, 0.02);  // as far as it is seen here

  // What is named is not switched, but says so; with correction, too, it follows the light.
  scene.render.method = Method::hierarchy;
  const std::vector<std::string> warnings = chosen_for(scene).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("9.99 mm, 0.021 transport mean free paths"), std::string::npos)
      << warnings[0];
  scene.meshes[0].is_closed = false;  // of unknown size
  EXPECT_TRUE(chosen_for(scene).warnings.empty());
  scene.render.method = Method::automatic;
  EXPECT_EQ(chosen_for(scene).method, Method::hierarchy);

  // Flat profiles are a tenth off at 30 mean free paths: docs/measurements/subsurface.md.
  const auto of_size = [](double size) {
    Scene ball = lit_ball();  // of a mean chord of 20 / 3 mm
    const double sigma_s = 0.15 * size - 0.01;
    surface_of(ball).material = half_space({0.01, 0.01, 0.01}, sigma_s, 1.4);
    ball.film = {.width = 4, .height = 4};
    return chosen_for(ball);
  };
  EXPECT_EQ(of_size(9.0).method, Method::random_walk);
  EXPECT_TRUE(of_size(9.0).warnings.empty());
  EXPECT_EQ(of_size(11.0).method, Method::hierarchy);
  EXPECT_EQ(of_size(29.0).warnings.size(), 1u);
  EXPECT_EQ(of_size(31.0).method, Method::hierarchy);
  EXPECT_TRUE(of_size(31.0).warnings.empty());

  // A light without an area, which walks do not find below layers that refract.
  Scene layered = lit_ball();
  layered.lights = {PointLight{.position = {0, 0, 50}, .intensity = {100, 100, 100}}};
  surface_of(layered).material =
      material_of({layer_of({0.1, 0.1, 0.1}, {1, 1, 1}, 0.0, 0.1, 1.5),
                   layer_of({0.1, 0.1, 0.1}, {1, 1, 1}, 0.0, infinite, 1.3)});
  const RenderStatistics statistics = chosen_for(layered);
  EXPECT_EQ(statistics.method, Method::hierarchy);
  EXPECT_EQ(statistics.warnings.size(), 1u);
}

// Of shapes whose mean chord has a closed form, 4 V / S; and through a layer that is denser.
TEST(MethodChoice, SizesOfBodiesAreMeanChords) {
  Scene scene = lit_ball();
  surface_of(scene).material = half_space({0.2, 0.3, 0.1}, 0.3, 1.3);
  const auto size = [&](Mesh mesh) {
    mesh.is_closed = true;
    scene.meshes = {std::move(mesh)};
    return optical_size(scene, 0).value();
  };
  EXPECT_NEAR(size(make_sphere(6.0f, 96)).size, 8.0, 0.01);
  EXPECT_NEAR(size(make_sphere(6.0f, 96)).mean_free_path, 2.5, 1e-9);
  EXPECT_NEAR(size(make_cube(3.0f)).size, 2.0, 1e-5);
  Mesh sheet = make_cube(100.0f);
  for (Vec3f& position : sheet.positions) position.z *= 0.001f;
  EXPECT_NEAR(size(sheet).size, 0.2 / 1.002, 1e-5);
  surface_of(scene).material = material_of({layer_of({2, 2, 2}, {1, 1, 1}, 0.0, 0.5),
                                            layer_of({0.1, 0.1, 0.1}, {1, 1, 1}, 0.9, infinite)});
  // 2 x .5 mm of 3 /mm, and the rest of .2 /mm
  EXPECT_NEAR(size(make_cube(6.0f)).in_mean_free_paths(), 3.0 + 3.0 * 0.2, 1e-5);
  scene.meshes[0].is_closed = false;
  EXPECT_FALSE(optical_size(scene, 0));
}

// Materials that no mesh has ask for nothing and are not prepared: not even what a method refuses.
TEST(MethodChoice, UnusedMaterialsAskForNothing) {
  Scene scene = lit_ball();
  const RenderResult alone = render(scene);
  scene.materials.push_back(scene.materials[0]);
  auto& unused = std::get<SubsurfaceSurface>(scene.materials[1].surface);
  unused.maps = {{.quantity = LayerMap::Quantity::sigma_a, .terms = {{.value = 0.5f}}}};
  unused.material = skin_by_bands();
  const RenderResult open = render(scene);
  EXPECT_EQ(open.statistics.method, Method::hierarchy);
  EXPECT_EQ(open.statistics.profiles.size(), 1u);
  EXPECT_EQ(open.statistics.light_samples.size(), 1u);
  EXPECT_EQ(open.image.pixels, alone.image.pixels);
  scene.render.method = Method::random_walk;
  scene.meshes[0].is_closed = true;
  EXPECT_NO_THROW((void)render(scene));
}

TEST(MethodChoice, SaysWhatItIsAndCostsBeforeTheWork) {
  Scene scene = lit_ball();
  std::vector<std::string> lines;
  bool has_begun = false;
  const RenderResult result = render(scene,
                                     {.on_notice =
                                          [&](const std::string& line) {
                                            EXPECT_FALSE(has_begun);
                                            lines.push_back(line);
                                          }},
                                     [&](double finished) {
                                       has_begun = has_begun || finished > 0.0;
                                       return true;
                                     });
  ASSERT_FALSE(lines.empty());
  EXPECT_LE(lines.size(), 2u);  // where no cache has the profile, that it is solved comes first
  const std::string& line = lines.back();
  EXPECT_TRUE(line.starts_with("method hierarchy (")) << line;
  EXPECT_NE(line.find(" CPU-s, "), std::string::npos) << line;
  EXPECT_TRUE(line.ends_with(" MiB")) << line;
}

// Within a factor of 3, for every method.
TEST(MethodChoice, ExpectsTheTimeThatItTakes) {
  for (const Method method : {Method::probe, Method::layered_bsdf, Method::hierarchy,
                              Method::shadow_map, Method::texture_space, Method::random_walk}) {
    Scene scene = lit_ball(method);
    scene.render.samples_per_pixel = method == Method::random_walk ? 16 : 128;
    scene.film = {.width = 48, .height = 48};
    if (method == Method::texture_space) surface_of(scene).material = skin_by_bands();
    const RenderStatistics statistics = chosen_for(scene);
    EXPECT_LT(std::abs(std::log(statistics.expected_cpu_seconds / statistics.cpu_seconds)),
              std::log(3.0))
        << method.name() << ": " << statistics.expected_cpu_seconds << " for "
        << statistics.cpu_seconds;
  }
}

TEST(SpacingField, DoublesAwayFromWhatIsSeen) {
  const std::vector<Vec3f> seen = {{0, 0, 0}, {3, 0, 0}};
  const SpacingField field(seen, 0.1f, 0.0f);
  EXPECT_EQ(field.level({0, 0, 0}), 0);
  EXPECT_EQ(field.level({3.5f, 0.5f, 0}), 0);
  int before = 0;
  for (float d = 0.0f; d < 200.0f; d += 0.05f) {
    const int level = field.level({0, d, 0});
    EXPECT_GE(level, before);
    before = level;
    EXPECT_LE(field.spacing(level), std::max(0.1f, 0.26f * d)) << d;  // 1/16 sr
  }
  EXPECT_EQ(before, SpacingField::levels - 1);
  EXPECT_TRUE(SpacingField(0.1f).is_even());
  EXPECT_EQ(SpacingField(0.1f).level({9, 9, 9}), 0);
}

// Cells of all levels share out the whole surface, whatever its triangles.
TEST(SpacingField, CellsOfAllLevelsCoverTheSurface) {
  for (const Mesh& mesh : {make_square(200.0f), make_sphere(40.0f, 48)}) {
    const std::vector<Mesh> meshes = {mesh};
    const std::vector<Vec3f> seen = {mesh.positions[0]};
    const SpacingField field(seen, 0.2f, 0.0f);
    const auto levels = make_surface_cells(meshes, 0, field, 1);
    const auto expected = expected_cells(meshes, 0, field);
    double area = 0.0, cells = 0.0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
      area += levels[k].area;
      cells += static_cast<double>(levels[k].cells.size());
      const double wanted = expected[k];
      EXPECT_NEAR(static_cast<double>(levels[k].cells.size()), wanted, 0.25 * wanted + 20.0) << k;
    }
    EXPECT_NEAR(area, surface_area(meshes, 0), 1e-4 * area);
    EXPECT_LT(cells, 0.02 * surface_area(meshes, 0) / 0.04);
    EXPECT_GT(levels[0].cells.size(), 100u);
  }
}

// The picture of few samples is that of many: of light spaced evenly, with 32 paths each.
TEST(SpacingField, ShowsInNoPicture) {
  Scene scene = lit_ball(Method::hierarchy);
  scene.camera = camera_above(3.0);  // a part of the ball, which light from behind passes, too
  scene.lights = {
      RectangleLight{
          .center = {0, 8, 9}, .edge_u = {4, 0, 0}, .edge_v = {0, 3, -3}, .radiance = {8, 8, 8}},
      EnvironmentLight{.scale = {0.2f, 0.2f, 0.2f}}};
  scene.render.samples_per_pixel = 8;
  const RenderResult sparse = render(scene);
  scene.render.hierarchy = {
      .spacing = static_cast<float>(sparse.statistics.light_samples[0].spacing),
      .irradiance_samples = 32};
  const RenderResult dense = render(scene);
  EXPECT_LT(3 * sparse.statistics.light_samples[0].count, dense.statistics.light_samples[0].count);
  for (const std::string name : {"R", "G", "B"}) {
    const std::size_t channel = *channel_index(dense.image, "subsurface." + name);
    EXPECT_NEAR(mean_of(sparse.image, channel) / mean_of(dense.image, channel), 1.0, 0.005) << name;
    double apart = 0.0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        apart += std::abs(static_cast<double>(sparse.image.at(x, y)[channel] -
                                              dense.image.at(x, y)[channel])) /
                 1024.0;
    EXPECT_LT(apart, 0.02 * mean_of(dense.image, channel)) << name;
  }
}

}  // namespace
}  // namespace lamina
