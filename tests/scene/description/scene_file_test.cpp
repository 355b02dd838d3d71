// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <variant>

#include "base/io/bad_files.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/scene/description/common_bands.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/description/studio_environment.h"
#include "lamina/solve/scattering/diffusion/dipole.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

const fs::path root = LAMINA_SOURCE_DIR;
const fs::path inputs = root / "tests/inputs";

std::string load_error(const fs::path& file) {
  return message_of([&] { (void)load_scene(file); });
}

/// Writes a scene next to the good ones' meshes and images, but in a folder of its own.
Scene load_text(const std::string& text, const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("scene_" + name);
  fs::create_directories(folder);
  std::ofstream(folder / "scene.json") << text;
  return load_scene(folder / "scene.json");
}

/// A scene of one mesh of the material "wall"; `meshes` and `lights` are the insides of arrays.
std::string scene_text(const std::string& mm_per_unit, const std::string& meshes,
                       const std::string& lights) {
  return R"({"lamina": "scene", "version": 1, "mm_per_unit": )" + mm_per_unit +
         R"(, "camera": {"position": [0, 0, 3], "look_at": [0, 0, 1], "focus_distance": 2,
                         "aperture_diameter": 0.5},
             "materials": {"wall": {"diffuse": 0.5}}, "meshes": [)" +
         meshes + R"(], "lights": [)" + lights + "]}";
}

// An image of n bytes, and smaller copies of it that take as much again where it is grey.
TEST(SceneFile, ImagesAndWhatIsMadeOfThemAreTakenFromOneBudget) {
  const std::filesystem::path folder =
      fs::path(testing::TempDir()) / ("scene_budget." + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto map = [&](const std::string& name) {
    save_png(make_image(512, 512, {"Y"}), folder / (name + ".png"));
    return "\"" + name + R"(": { "diffuse": { "map": ")" + name +
           R"(.png", "encoding": "linear" } })";
  };
  std::ofstream(folder / "scene.json") << R"({ "lamina": "scene", "version": 1, "mm_per_unit": 1,
              "camera": { "position": [0, 0, 9], "look_at": [0, 0, 0] },
              "materials": { )" << map("a")
                                       << ", " << map("b") << R"( },
              "meshes": [{ "shape": "box", "material": "a" }],
              "lights": [{ "type": "environment", "radiance": 1 }] })";
  const auto refusal = [&](double mebibytes) {
    return message_of([&] {
      (void)load_scene(folder / "scene.json", {static_cast<std::size_t>(mebibytes * (1 << 20))});
    });
  };
  EXPECT_EQ(refusal(4.5), "");
  EXPECT_NE(refusal(3.8).find("b.png: 512 x 512 pixels of 1 channel would take"),
            std::string::npos);
  EXPECT_NE(refusal(2.5).find("b.png: 512 x 512 pixels of 1 channel would take"),
            std::string::npos);
  EXPECT_NE(refusal(1.8).find("a.png: 512 x 512 pixels of 1 channel would take"),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(SceneFile, ReadsEveryKey) {
  const Scene scene = load_scene(inputs / "scene/good/everything.json");
  EXPECT_EQ(scene.camera.position, (Vec3{0, 0, 100}));
  EXPECT_EQ(scene.camera.look_at, (Vec3{0, 10, 0}));
  EXPECT_EQ(scene.camera.up, (Vec3{0, 1, 0}));
  EXPECT_NEAR(scene.camera.horizontal_fov, std::numbers::pi / 6, 1e-15);
  EXPECT_EQ(scene.camera.aperture_diameter, 1.0);
  EXPECT_EQ(scene.camera.focus_distance, 90.0);
  EXPECT_EQ(scene.film.width, 8);
  EXPECT_EQ(scene.film.height, 4);
  EXPECT_EQ(scene.film.exposure, -1.5F);
  EXPECT_EQ(scene.film.view, View::standard);
  EXPECT_EQ(scene.render.method, RenderSettings::Method::layered_bsdf);
  EXPECT_EQ(scene.render.samples_per_pixel, 16);
  EXPECT_EQ(scene.render.max_bounces, 2);
  EXPECT_EQ(scene.render.seed, 42U);
  EXPECT_EQ(scene.render.single_scattering, RenderSettings::SingleScattering::refracted);
  EXPECT_EQ(scene.render.profile, RenderSettings::Profile::dipole);
  EXPECT_EQ(scene.render.hierarchy.spacing, 0.5F);
  EXPECT_EQ(scene.render.hierarchy.max_points, 20'000);
  EXPECT_EQ(scene.render.hierarchy.irradiance_samples, 8);
  EXPECT_EQ(scene.render.hierarchy.error, 0.1F);
  EXPECT_EQ(scene.render.hierarchy.refine, 0.02F);

  EXPECT_EQ(scene.render.shadow_map.resolution, 128);
  EXPECT_EQ(scene.render.shadow_map.lamp_views, 4);
  EXPECT_EQ(scene.render.shadow_map.dome_views, 32);
  EXPECT_EQ(scene.render.shadow_map.lookups, 8);
  EXPECT_EQ(scene.render.orders, LayeredOrders::first);
  EXPECT_TRUE(scene.render.factors.seeliger && scene.render.factors.phase);
  EXPECT_FALSE(scene.render.factors.fresnel || scene.render.factors.depth);

  ASSERT_EQ(scene.materials.size(), 9U);
  EXPECT_EQ(scene.images.size(),
            2U);  // the checker, the same as sRGB and as linear, and the studio
  const auto& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  EXPECT_EQ(scene.materials[0].name, "skin");
  EXPECT_EQ(skin.material.name, "jensen_skin1");
  EXPECT_EQ(skin.color_use, SubsurfaceSurface::ColorUse::invert);
  EXPECT_EQ(skin.color.value, (Vec3f{1, 0.9F, 0.8F}));
  EXPECT_EQ(skin.color.map->scale, 0.5F);
  EXPECT_EQ(skin.color.map->offset, 0.1F);
  EXPECT_EQ(std::get<ImageMap>(skin.color.map->source).placement,
            (UvPlacement{.u_axis = {2, 0}, .v_axis = {0, 3}}));
  EXPECT_EQ(std::get<NoiseMap>(skin.thickness.map->source).size, 3.0F);
  EXPECT_EQ(std::get<NoiseMap>(skin.single_scattering_weight.map->source).size, 4.0F);
  EXPECT_EQ(skin.single_scattering_blur.value, 0.3F);
  const Coat& coat = scene.materials[0].coat.value();
  EXPECT_EQ(coat.ior, 1.44F);
  EXPECT_EQ(coat.weight.value, 0.5F);
  EXPECT_EQ(coat.distribution, MicrofacetDistribution::ggx);
  EXPECT_EQ(std::get<ImageMap>(coat.roughness.map->source).image,
            scene.materials[0].normal_map->image);
  const auto& pores = std::get<NoiseMap>(scene.materials[0].bump->source);
  EXPECT_EQ(pores.kind, NoiseMap::Kind::cellular);
  EXPECT_EQ(pores.octaves, 3);
  EXPECT_EQ(pores.seed, 7U);
  const auto& own = std::get<SubsurfaceSurface>(scene.materials[1].surface);
  EXPECT_DOUBLE_EQ(own.material.layers[0].sigma_s[0], 1.0);  // 10 per cm
  EXPECT_EQ(own.color_use, SubsurfaceSurface::ColorUse::none);
  EXPECT_EQ(own.thickness.value, 0.0F);
  EXPECT_TRUE(scene.materials[3].opacity->map);
  const auto& leaf = std::get<ThinSurface>(scene.materials[4].surface);
  EXPECT_EQ(leaf.material.layers.size(), 2U);
  EXPECT_EQ(leaf.thickness->map->offset, 0.2F);
  EXPECT_EQ(scene.materials[4].opacity->value, 0.9F);
  const auto& frost = std::get<DielectricSurface>(scene.materials[5].surface);
  EXPECT_EQ(frost.smoothness->value, 3.0F);
  EXPECT_EQ(frost.scattering, FacetScattering::xu_sun);
  const auto& glass = std::get<DielectricSurface>(scene.materials[6].surface);
  EXPECT_EQ(glass.roughness.value, 0.1F);
  EXPECT_EQ(glass.distribution, MicrofacetDistribution::ggx);
  EXPECT_EQ(glass.scattering, FacetScattering::multiple);
  const auto& freckles = std::get<SubsurfaceSurface>(scene.materials[7].surface);
  using Quantity = LayerMap::Quantity;
  ASSERT_EQ(freckles.maps.size(), 4U);
  EXPECT_EQ(freckles.maps[0].quantity, Quantity::fraction);
  EXPECT_EQ(freckles.maps[0].layer, 0U);
  ASSERT_EQ(freckles.maps[0].terms.size(), 2U);
  EXPECT_EQ(freckles.maps[0].terms[0].value, 0.01F);
  EXPECT_EQ(freckles.maps[0].terms[1].map->low, 0.0F);
  EXPECT_EQ(freckles.maps[0].terms[1].map->high, 1.0F);
  EXPECT_EQ(freckles.maps[1].quantity, Quantity::fraction);
  EXPECT_EQ(freckles.maps[1].layer, 1U);
  EXPECT_EQ(freckles.maps[1].terms[0].map->scale, 0.1F);
  EXPECT_EQ(freckles.maps[2].quantity, Quantity::thickness);
  EXPECT_EQ(freckles.maps[2].terms[0].value, 0.1F);
  EXPECT_EQ(freckles.maps[3].quantity, Quantity::sigma_s);
  EXPECT_EQ(freckles.maps[3].layer, 1U);
  const auto& arm = std::get<SubsurfaceSurface>(scene.materials[8].surface);
  ASSERT_EQ(arm.maps.size(), 1U);
  EXPECT_EQ(arm.maps[0].quantity, Quantity::skin);
  EXPECT_EQ(skin_parameter_ranges()[arm.maps[0].part].name, "melanin");

  ASSERT_EQ(scene.meshes.size(), 8U);
  const Mesh& triangle =
      scene.meshes[0];  // the part "left" alone, subdivided into 3 quadrilaterals
  EXPECT_EQ(triangle.triangles.size(), 6U);
  EXPECT_EQ(triangle.material[0], 6U);
  ASSERT_EQ(scene.lights.size(), 4U);
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).position, (Vec3{10, 20, 30}));
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).intensity, (Vec3f{500, 500, 500}));
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[1]).direction, (Vec3{0, 1, 0}));
  const auto& sky = std::get<EnvironmentLight>(scene.lights[3]);
  EXPECT_EQ(scene.images[*sky.image].width, 512);
  EXPECT_EQ(sky.scale, (Vec3f{1, 0.5F, 2}));
  EXPECT_NEAR(sky.rotation, std::numbers::pi / 2, 1e-6);
  EXPECT_FALSE(sky.is_visible);
}

TEST(SceneFile, OpacityIsTheAlphaOfAnImageThatHasIt) {
  const fs::path folder = fs::path(testing::TempDir()) / "scene_alpha";
  fs::create_directories(folder);
  Image hair = make_image(2, 1, {"R", "G", "B", "A"});
  hair.at(1, 0)[3] = 1.0F;
  save_png(hair, folder / "hair.png");
  std::string text = scene_text("1", R"({"shape": "rectangle", "material": "wall"})", "");
  const std::string matte = R"({"diffuse": 0.5})";
  text.replace(text.find(matte), matte.size(),
               R"({"diffuse": {"map": "hair.png", "encoding": "linear"},
                   "opacity": {"map": "hair.png"}})");
  const Scene scene = load_text(text, "alpha");
  ASSERT_EQ(scene.images.size(), 2U);  // black as a color, but there where its alpha is
  EXPECT_EQ(scene.images[0].channel_count(), 4U);
  EXPECT_EQ(scene.images[1].pixels, (std::vector<float>{0.0F, 1.0F}));
}

TEST(SceneFile, AnExrOfOtherPrimariesIsAnotherImageAsAColorThanAsQuantities) {
  const fs::path folder = fs::path(testing::TempDir()) / "scene_primaries";
  fs::create_directories(folder);
  Image dye = make_image(1, 1, {"R", "G", "B"});
  dye.pixels = {0.5F, 0.25F, 0.125F};
  for (const auto& [space, count] :
       {std::pair{RgbSpace::rec709, 1U}, std::pair{RgbSpace::acescg, 2U}}) {
    save_exr(dye, folder / "dye.exr", ExrPrecision::single_float, {}, space);
    std::string text = scene_text("1", R"({"shape": "rectangle", "material": "wall"})", "");
    const std::string matte = R"({"diffuse": 0.5})";
    text.replace(text.find(matte), matte.size(),
                 R"({"diffuse": {"map": "dye.exr", "encoding": "linear"},
                     "opacity": {"map": "dye.exr", "encoding": "linear"}})");
    const Scene scene = load_text(text, "primaries");
    ASSERT_EQ(scene.images.size(), count);
    EXPECT_NEAR(scene.images[0].pixels[2], 0.5F, 1e-6F);  // R, the last in order of the alphabet
  }
}

TEST(SceneFile, ANumberTakesTheChannelOfAnImageThatIsNamed) {
  const fs::path folder = fs::path(testing::TempDir()) / "scene_channel";
  fs::create_directories(folder);
  Image oil = make_image(1, 1, {"R", "G", "B"});
  oil.pixels = {0.0F, 1.0F, 0.2F};
  save_png(oil, folder / "oil.png");
  std::string text = scene_text("1", R"({"shape": "rectangle", "material": "wall"})", "");
  const std::string matte = R"({"diffuse": 0.5})";
  text.replace(text.find(matte), matte.size(),
               R"({"diffuse": 0.5,
                   "coat": {"weight": {"map": "oil.png", "channel": "G"},
                            "roughness": {"map": "oil.png", "channel": "G", "scale": 0.3}}})");
  const Scene scene = load_text(text, "channel");
  ASSERT_EQ(scene.images.size(), 2U);  // the whole, and its green once
  EXPECT_EQ(scene.images[1].pixels, std::vector<float>{1.0F});
  const Coat& coat = *scene.materials[0].coat;
  EXPECT_EQ(std::get<ImageMap>(coat.weight.map->source).image, 1U);
  EXPECT_EQ(std::get<ImageMap>(coat.roughness.map->source).image, 1U);
}

TEST(SceneFile, SaysWhatLiesOverASurface) {
  std::string text = scene_text("1", R"({"shape": "rectangle", "material": "wall"})", "");
  const std::string matte = R"({"diffuse": 0.5})";
  text.replace(text.find(matte), matte.size(),
               R"({"diffuse": 0.5, "over": [
                     {"material": "jade", "thickness": 0.2, "name": "green"},
                     {"material": "dust", "coverage": {"noise": {"size": 3}, "scale": 0.5}}],
                   "coat": {"second_lobe": {"roughness": 0.6, "share": 0.2}}})");
  const Scene scene = load_text(text, "over");
  const std::span<const Covering> over = coverings_of(scene.materials[0]);
  ASSERT_EQ(over.size(), 2U);
  EXPECT_EQ(over[0].name, "green");
  EXPECT_EQ(over[0].material.layers.back().thickness, 0.2);
  EXPECT_EQ(over[0].coverage.value, 1.0F);
  EXPECT_EQ(over[1].name, "dust");
  EXPECT_EQ(over[1].coverage.map->scale, 0.5F);
  // Of dust, which has wavelengths; jade is turned into them.
  EXPECT_FALSE(bands_of(scene).is_rgb());
  EXPECT_EQ(over[0].material.bands, over[1].material.bands);
  ASSERT_EQ(scene.warnings.size(), 1U + (scene.lights.empty() ? 1U : 0U));
  EXPECT_NE(scene.warnings.back().find(R"(material "wall": over "green": RGB turned into the )"),
            std::string::npos);
  const auto& second = scene.materials[0].coat->second;
  EXPECT_EQ(second->roughness.value, 0.6F);
  EXPECT_EQ(second->share.value, 0.2F);
}

TEST(SceneFile, TheUnitScalesWhatLiesInSpaceAndNothingElse) {
  const std::string meshes = R"({"shape": "box", "size": 2, "material": "wall",
      "transform": {"translate": [0, 3, 0]}})";
  const std::string lights = R"({"type": "rectangle", "position": [0, 4, 0], "look_at": [0, 0, 0],
      "size": [1, 2], "radiance": 7}, {"type": "point", "position": [1, 0, 0], "intensity": 2})";
  const Scene small = load_text(scene_text("1", meshes, lights), "small");
  const Scene large = load_text(scene_text("100", meshes, lights), "large");
  EXPECT_EQ(large.camera.position, 100.0 * small.camera.position);
  EXPECT_EQ(large.camera.focus_distance, 100.0 * small.camera.focus_distance);
  EXPECT_EQ(large.camera.aperture_diameter, 100.0 * small.camera.aperture_diameter);
  EXPECT_EQ(large.camera.horizontal_fov, small.camera.horizontal_fov);
  for (std::size_t i = 0; i < small.meshes[0].positions.size(); ++i)
    EXPECT_LT(length(large.meshes[0].positions[i] - 100.0F * small.meshes[0].positions[i]), 1e-4F);
  const auto &a = std::get<RectangleLight>(small.lights[0]),
             &b = std::get<RectangleLight>(large.lights[0]);
  EXPECT_EQ(b.edge_u, 100.0 * a.edge_u);
  EXPECT_EQ(b.radiance, a.radiance);
  // A point light gives the same irradiance at the same place of the scene.
  EXPECT_FLOAT_EQ(std::get<PointLight>(large.lights[1]).intensity.x, 2.0F * 100 * 100);
}

TEST(SceneFile, ARectangleShinesTowardsWhatItLooksAt) {
  for (const std::string from : {"[0, 4, 0]", "[0, -4, 0]", "[1, 2, 3]", "[-3, 0.1, 0]"}) {
    const Scene scene =
        load_text(scene_text("1", R"({"shape": "box", "material": "wall"})",
                             R"({"type": "rectangle", "position": )" + from +
                                 R"(, "look_at": [0, 0, 0], "size": [1, 2], "radiance": 1})"),
                  "rectangle");
    const auto& light = std::get<RectangleLight>(scene.lights[0]);
    const Vec3 normal = normalize(cross(light.edge_u, light.edge_v));
    EXPECT_LT(length(normal + normalize(light.center)), 1e-12);
    EXPECT_NEAR(length(light.edge_u), 1.0, 1e-12);
    EXPECT_NEAR(length(light.edge_v), 2.0, 1e-12);
    EXPECT_NEAR(light.edge_u.y, 0.0, 1e-12);  // its first edge is level
  }
}

TEST(SceneFile, TransformsScaleThenTurnThenMove) {
  const auto corner = [](const std::string& transform) {
    const Scene scene = load_text(
        scene_text("2",
                   R"({"shape": "rectangle", "material": "wall", "transform": )" + transform + "}",
                   ""),
        "transform");
    for (std::size_t i = 0; i < scene.meshes[0].positions.size(); ++i)
      if (scene.meshes[0].uvs[i] == Vec2f{1, 1}) return scene.meshes[0].positions[i];
    return Vec3f{};
  };
  const auto expect = [](const Vec3f& a, const Vec3f& b) { EXPECT_LT(length(a - b), 1e-6F); };
  // The corner (1/2, 1/2, 0), in units of 2 mm.
  expect(corner("{}"), {1, 1, 0});
  expect(corner(R"({"scale": [3, 1, 1], "rotate": [0, 0, 90], "translate": [0, 0, 5]})"),
         {-1, 3, 10});
  // About x, then y, then z, of the world: (x, y, 0) -> (x, 0, y) -> (y, 0, -x) -> (0, y, -x).
  expect(corner(R"({"scale": [3, 1, 1], "rotate": [90, 90, 90]})"), {0, 1, -3});
  expect(corner(R"({"rotate": {"axis": [0, 0, 2], "degrees": 90}})"), {-1, 1, 0});
}

TEST(SceneFile, ShapesOfAnExampleLieWhereTheFileSays) {
  const Scene scene = load_scene(root / "scenes/bumpy.json");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 30'000U);
  const auto& light = std::get<RectangleLight>(scene.lights[0]);
  EXPECT_LT(length(cross(normalize(cross(light.edge_u, light.edge_v)), normalize(light.center))),
            1e-12);
  EXPECT_NEAR(length(light.edge_u) * length(light.edge_v), 400.0, 1e-9);
}

TEST(SceneFile, EveryGoodFileAndExampleLoads) {
  int count = 0;
  for (const fs::path& folder : {root / "scenes", inputs / "scene/good"})
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".json") continue;
      EXPECT_EQ(load_error(entry.path()), "") << entry.path();
      ++count;
    }
  EXPECT_GE(count, 6);
}

TEST(SceneFile, TheExampleOfThePageLoads) {
  std::ifstream page(root / "docs/scene.md");
  std::stringstream text;
  text << page.rdbuf();
  const std::string fence = "```jsonc\n";
  const std::size_t begin = text.str().find(fence);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = text.str().find("```", begin + fence.size());
  const Scene scene =
      load_text(text.str().substr(begin + fence.size(), end - begin - fence.size()), "page");
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_TRUE(scene.warnings.empty());
  // It is the one that comes with lamina.
  const Scene file = load_scene(root / "scenes/arm.json");
  EXPECT_EQ(picture_key(scene, scene.render, {}), picture_key(file, file.render, {}));
}

TEST(SceneFile, LookHasItsColorAndSpread) {
  const Scene scene = load_scene(inputs / "scene/good/look.json");
  const auto& surface = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  const double color[3] = {0.8, 0.5, 0.3}, spread[3] = {3.0, 1.0, 0.5};  // [mm]
  for (std::size_t b = 0; b < 3; ++b) {
    const LayerStack stack = layer_stack(surface.material, b);
    const Medium& medium = stack.layers()[0].medium;
    EXPECT_NEAR(medium.g, 0.5, 1e-12);
    EXPECT_NEAR(total_reflectance(make_dipole(medium, 1.0)), color[b], 1e-9);
    EXPECT_NEAR(sigma_tr(medium) * spread[b], 1.0, 1e-9);
  }
}

TEST(SceneFile, EveryBadFileIsRefusedInOneLineThatNamesTheFault) {
  EXPECT_GT(expect_refusals(inputs / "scene/bad", load_error, {"wrong_material.json"}), 80U);
}

TEST(SceneFile, MeshInPlaceOfASceneIsCalledAMesh) {
  const fs::path mesh = inputs / "scene/good/triangle.gltf";
  EXPECT_EQ(load_error(mesh),
            mesh.string() +
                ": must be a scene, but is a mesh, which a scene names as the "
                "\"file\" of one of its \"meshes\"; lamina info says what it holds");
}

TEST(SceneFile, WarnsOfAMendedMeshAndOfDarkness) {
  const fs::path folder = fs::path(testing::TempDir()) / "scene_warnings";
  fs::create_directories(folder);
  std::ofstream(folder / "m.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n";
  const Scene scene =
      load_text(scene_text("1", R"({"file": "m.obj", "material": "wall"})", ""), "warnings");
  ASSERT_EQ(scene.warnings.size(), 2U);
  EXPECT_EQ(scene.warnings[0], (folder / "m.obj").string() + ": 1 face of zero area is dropped");
  EXPECT_NE(scene.warnings[1].find("lights is empty: the picture will be black"),
            std::string::npos);
}

TEST(SceneFile, EnvironmentImagesLoseNegativeNumbersAndRefuseInfiniteOnes) {
  const fs::path folder = fs::path(testing::TempDir()) / "scene_environment";
  fs::create_directories(folder);
  Image image = make_image(2, 1, {"R", "G", "B"});
  image.pixels = {-0.25F, 1, 2, 3, 4, 5};
  save_exr(image, folder / "sky.exr");
  const std::string text = scene_text("1", R"({"shape": "box", "material": "wall"})",
                                      R"({"type": "environment", "image": "sky.exr"})");
  Scene scene = load_text(text, "environment");
  std::ranges::sort(scene.images[0].pixels);  // in whatever order of channels
  EXPECT_EQ(scene.images[0].pixels, (std::vector<float>{0, 1, 2, 3, 4, 5}));
  image.pixels[3] = INFINITY;
  save_exr(image, folder / "sky.exr", ExrPrecision::single_float);
  EXPECT_NE(message_of([&] { (void)load_text(text, "environment"); }).find("lights[0].image: "),
            std::string::npos);
}

TEST(StudioEnvironment, LightsASubjectFromTheFrontLeftAboutAsBrightAsWhitePaper) {
  const Image studio = make_studio_environment(64);
  EXPECT_EQ(studio.width, 128);
  // Irradiance over pi on a white surface that faces a direction, by summing over the image.
  const auto white = [&](const Vec3& towards) {
    double sum = 0.0;
    for (int y = 0; y < studio.height; ++y)
      for (int x = 0; x < studio.width; ++x) {
        const double theta = std::numbers::pi * (y + 0.5) / studio.height;
        const double phi = 2.0 * std::numbers::pi * ((x + 0.5) / studio.width - 0.5);
        const Vec3 d{std::sin(theta) * std::sin(phi), std::cos(theta),
                     -std::sin(theta) * std::cos(phi)};
        const double solid_angle = std::sin(theta) * 2.0 * std::numbers::pi * std::numbers::pi /
                                   (studio.width * studio.height);
        sum += solid_angle * std::max(0.0, dot(d, normalize(towards))) *
               static_cast<double>(studio.at(x, y)[1]);
      }
    return sum / std::numbers::pi;
  };
  const double key = white({-0.62, 0.46, 0.64});
  EXPECT_NEAR(key, 1.0, 0.35);
  EXPECT_GT(key, 2.0 * white({0.9, 0, 0.4}));  // the fill
  EXPECT_GT(white({0, 1, 0}), 3.0 * white({0, -1, 0}));
  for (const float value : studio.pixels) EXPECT_TRUE(value > 0.0F && value < 20.0F);
}

}  // namespace
}  // namespace lamina
