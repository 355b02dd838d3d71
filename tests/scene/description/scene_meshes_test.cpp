// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Meshes as people have them, in scenes: tiles, colors of vertices, instances, patterns of names,
// materials of files.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/scene/description/file_materials.h"
#include "lamina/scene/description/internal/scene_file.h"
#include "lamina/scene/description/plausible_size.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/map_range.h"
#include "lamina/scene/surface/texture.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

const fs::path good = fs::path(LAMINA_SOURCE_DIR) / "tests" / "inputs" / "scene" / "good";

/// A scene in a folder of its own beside copies of what the good ones use.
class SceneMeshes : public testing::Test {
 protected:
  SceneMeshes()
      : folder_(fs::path(testing::TempDir()) / ("scene_meshes." + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    for (const char* name : {"two_tiles.obj", "triangle.gltf", "tiles.1001.png", "tiles.1002.png"})
      fs::copy_file(good / name, folder_ / name, fs::copy_options::overwrite_existing);
  }
  ~SceneMeshes() override { fs::remove_all(folder_); }

  Scene load(const std::string& materials, const std::string& meshes,
             MemoryBudget memory = {}) const {
    std::ofstream(folder_ / "scene.json")
        << R"({ "lamina": "scene", "version": 1, "mm_per_unit": 10,
           "camera": { "position": [0, 0, 10], "look_at": [0, 0, 0] }, "lights": [],
           "materials": { )"
        << materials << " }, \"meshes\": [ " << meshes << " ] }";
    return load_scene(folder_ / "scene.json", memory);
  }

  fs::path folder_;
};

const DiffuseSurface& diffuse_of(const Scene& scene, std::size_t material) {
  return std::get<DiffuseSurface>(scene.materials.at(material).surface);
}

TEST(NamePatterns, FitAsInShells) {
  using scene_file::fits_pattern;
  for (const auto& [name, pattern] :
       {std::pair{"head_left", "head_*"}, std::pair{"head_", "head_*"}, std::pair{"a", "?"},
        std::pair{"aXbXc", "a*b*c"}, std::pair{"", "*"}, std::pair{"abab", "*ab"},
        std::pair{"head", "head"}})
    EXPECT_TRUE(fits_pattern(name, pattern)) << name << ' ' << pattern;
  for (const auto& [name, pattern] :
       {std::pair{"head", "head_*"}, std::pair{"", "?"}, std::pair{"abc", "a*b"},
        std::pair{"headx", "head"}, std::pair{"aba", "*ab"}})
    EXPECT_FALSE(fits_pattern(name, pattern)) << name << ' ' << pattern;
}

TEST_F(SceneMeshes, PartsAreFoundByPatternsAfterWholeNames) {
  const std::string materials = R"("a": { "diffuse": 0.1 }, "b": { "diffuse": 0.2 })";
  const Scene scene = load(
      materials, R"({ "file": "two_tiles.obj", "parts": { "head_*": "a", "head_right": "b" } })");
  EXPECT_EQ(scene.meshes[0].material, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  const Scene ordered =
      load(materials, R"({ "file": "two_tiles.obj", "parts": { "*_left": "b", "*": null } })");
  EXPECT_EQ(ordered.meshes[0].material, (std::vector<std::uint32_t>{1, 1}));
}

TEST_F(SceneMeshes, TilesAreLookedUpByTheTriangleAndNothingBleeds) {
  const Scene scene =
      load(R"("t": { "diffuse": { "map": "tiles.<UDIM>.png", "encoding": "srgb" } })",
           R"({ "file": "two_tiles.obj", "material": "t" })");
  ASSERT_EQ(scene.images.size(), 2U);
  const TextureStore textures(scene.images);
  const ColorParameter& color = diffuse_of(scene, 0).color;
  const Mesh& mesh = scene.meshes[0];
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const float u : {0.0f, 0.3f, 1.0f})
      for (const float footprint : {0.0f, 1.0f, 50.0f}) {  // corners and edges, near and from far
        const SurfacePoint point = make_surface_point(
            scene.meshes, {.distance = 0, .u = u, .v = 0, .mesh = 0, .triangle = t}, footprint);
        const bool is_left = t < 2;  // tile 1001 is red, 1002 green
        EXPECT_EQ(textures.color(color, point), (is_left ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0})) << t;
      }
  EXPECT_EQ(textures.mean_color(std::get<ImageMap>(color.map->source)), (Vec3f{0.5f, 0.5f, 0}));
  const auto [low, high] = range_of(TextureStore(scene.images), color);
  EXPECT_EQ(low, (Vec3f{0, 0, 0}));
  EXPECT_EQ(high, (Vec3f{1, 1, 0}));
}

TEST_F(SceneMeshes, TilesTakeMemoryFromTheBudget) {
  save_png(make_image(600, 600, {"R", "G", "B"}), folder_ / "big.1001.png");
  save_png(make_image(600, 600, {"R", "G", "B"}), folder_ / "big.1002.png");
  const auto with = [&](std::size_t bytes) {
    (void)load(R"("t": { "diffuse": { "map": "big.<UDIM>.png", "encoding": "srgb" } })",
               R"({ "file": "two_tiles.obj", "material": "t" })", {bytes});
  };
  EXPECT_NO_THROW(with(std::size_t{14} << 20));  // 4.3 MB each, and a third of it
  try {
    with(std::size_t{10} << 20);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("big.1002.png"), std::string::npos) << error.what();
  }
}

TEST_F(SceneMeshes, ColorsOfVerticesHaveTheirMeanByArea) {
  const Scene scene = load(R"("p": { "diffuse": "vertex_colors" })",
                           R"({ "file": "triangle.gltf", "material": "p" })");
  const auto& map = std::get<VertexColorMap>(diffuse_of(scene, 0).color.map->source);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(map.mean[c], 1.0f / 3.0f, 1e-6f);
  const TextureStore textures(scene.images);
  const SurfacePoint point = make_surface_point(
      scene.meshes, {.distance = 0, .u = 0.25f, .v = 0.25f, .mesh = 0, .triangle = 0}, 0.0f);
  const Vec3f color = textures.color(diffuse_of(scene, 0).color, point);
  EXPECT_NEAR(color.x + color.y + color.z, 1.0f, 1e-6f);
  EXPECT_NEAR(std::max({color.x, color.y, color.z}), 0.5f, 1e-6f);
}

TEST_F(SceneMeshes, InstancesAreCopiesThatAreMovedTurnedAndMirrored) {
  const std::string box =
      R"({ "shape": "box", "material": "a", "transform": { "scale": [1, 2, 1] }, "instances": [
      { "translate": [10, 0, 0] }, { "rotate": [0, 0, 90] }, { "scale": [-1, 1, 1] } ] })";
  const Scene scene = load(R"("a": { "diffuse": 0.1 })", box);
  ASSERT_EQ(scene.meshes.size(), 3U);
  const auto extent = [&](std::size_t m, int axis) {
    float low = 1e9f, high = -1e9f;
    for (const Vec3f& p : scene.meshes[m].positions)
      low = std::min(low, p[axis]), high = std::max(high, p[axis]);
    return std::pair{low, high};
  };
  EXPECT_EQ(extent(0, 0), (std::pair{95.0f, 105.0f}));  // in mm
  EXPECT_EQ(extent(0, 1), (std::pair{-10.0f, 10.0f}));
  EXPECT_NEAR(extent(1, 0).second, 10.0f, 1e-5f);  // its longer side lies along x
  EXPECT_NEAR(extent(1, 1).second, 5.0f, 1e-5f);
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_TRUE(mesh.is_closed);
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3f area =
          cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      EXPECT_GT(dot(area, mesh.normals[a]), 0.0f) << mesh.name;  // still wound outward
      EXPECT_GT(dot(mesh.normals[a],
                    mesh.positions[a] - (&mesh == &scene.meshes[0] ? Vec3f{100, 0, 0} : Vec3f{})),
                0.0f);
    }
  }
  EXPECT_THROW(
      (void)load(
          R"("a": { "diffuse": 0.1 })",
          R"({ "shape": "sphere", "tessellation": 100, "material": "a", "instances": [ {}, {}, {}, {}, {} ] })",
          {std::size_t{8} << 20}),
      FileError);
}

TEST_F(SceneMeshes, MaterialsOfFilesStandInWhereTheSceneNamesNone) {
  const std::string mesh = R"({ "file": "triangle.gltf" })";
  const Scene scene = load(R"("other": { "diffuse": 0.1 })", mesh + "," + mesh);
  ASSERT_EQ(scene.materials.size(), 2U);  // the file's once
  EXPECT_NE(scene.materials[1].name.find("triangle.gltf: paint"), std::string::npos);
  EXPECT_EQ(diffuse_of(scene, 1).color.value, (Vec3f{0.8f, 0.4f, 0.2f}));
  ASSERT_TRUE(scene.materials[1].coat);
  EXPECT_EQ(scene.materials[1].coat->roughness.value, 0.25f);  // alpha is the square
  EXPECT_EQ(scene.materials[1].coat->ior, 1.5f);
  EXPECT_EQ(scene.meshes[0].material[0], 1U);
  // A material of the scene that has the file's name goes first, then "material", then "parts".
  EXPECT_EQ(load(R"("paint": { "diffuse": 0.1 })", mesh).meshes[0].material[0], 0U);
  const Scene said =
      load(R"("paint": { "diffuse": 0.1 }, "b": { "diffuse": 0.2 })",
           R"({ "file": "triangle.gltf", "material": "b", "parts": { "first": "paint" } })");
  EXPECT_EQ(said.meshes[0].material, (std::vector<std::uint32_t>{1, 0}));
}

TEST_F(SceneMeshes, MaterialsOfMaterialXStandInForThoseOfTheFile) {
  fs::copy_file(good / "look.mtlx", folder_ / "look.mtlx", fs::copy_options::overwrite_existing);
  const Scene scene = load(R"("other": { "diffuse": 0.1 })",
                           R"({ "file": "two_tiles.obj", "materials_file": "look.mtlx" })");
  ASSERT_EQ(scene.materials.size(), 3U);
  const auto& stone = std::get<SubsurfaceSurface>(scene.materials[1].surface);
  const MaterialLayer& layer = stone.material.layers[0];
  for (std::size_t c = 0; c < 3; ++c)  // the radius is the mean free path: 2, 1 and 0.5 mm
    EXPECT_NEAR(layer.sigma_a[c] + layer.sigma_s[c], (std::array{0.5, 1.0, 2.0}[c]), 1e-9);
  EXPECT_NEAR(scene.materials[1].coat->roughness.value, 0.16f, 1e-6f);
  const auto is_of_coat = [](const std::string& warning) {
    return warning.find("not taken from the mesh file: coat_weight") != std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(scene.warnings, is_of_coat));
  EXPECT_EQ(diffuse_of(scene, 2).color.value, (Vec3f{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(scene.images.size(), 1U);
  EXPECT_FALSE(scene.materials[2].coat);
}

TEST_F(SceneMeshes, ColorsOfVerticesAreAFactorOfTheBaseColorOfGltf) {
  const Scene scene = load(R"("other": { "diffuse": 0.1 })", R"({ "file": "triangle.gltf" })");
  const TextureStore textures(scene.images);
  const SurfacePoint point = make_surface_point(
      scene.meshes, {.distance = 0, .u = 0.25f, .v = 0.25f, .mesh = 0, .triangle = 0}, 0.0f);
  const Vec3f color = textures.color(diffuse_of(scene, 1).color, point);
  const Vec3f base{0.8f, 0.4f, 0.2f};
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], base[c] * point.color[c], 1e-6f);
  EXPECT_NEAR(point.color.x + point.color.y + point.color.z, 1.0f, 1e-6f);
  const auto [low, high] = range_of(TextureStore(scene.images), diffuse_of(scene, 1).color);
  EXPECT_EQ(high, base);
  EXPECT_EQ(low, (Vec3f{0, 0, 0}));
}

TEST_F(SceneMeshes, ColorsOfVerticesAreAFactorOfAnImageToo) {
  const Scene scene = load(
      R"("p": { "diffuse": { "map": "tiles.1002.png", "encoding": "srgb", "vertex_colors": true,
         "value": 0.5 } })",
      R"({ "file": "triangle.gltf", "material": "p" })");
  const TextureStore textures(scene.images);
  const SurfacePoint point = make_surface_point(
      scene.meshes, {.distance = 0, .u = 0.25f, .v = 0.5f, .mesh = 0, .triangle = 0}, 0.0f);
  const Vec3f color = textures.color(diffuse_of(scene, 0).color, point);  // the image is green
  EXPECT_EQ(color.x, 0.0f);
  EXPECT_NEAR(color.y, 0.5f * point.color.y, 1e-6f);
  const auto [low, high] = range_of(TextureStore(scene.images), diffuse_of(scene, 0).color);
  EXPECT_EQ(high.x, 0.0f);
  EXPECT_NEAR(high.y, 0.5f, 1e-6f);
}

// The example of KHR_texture_transform, "only the lower left quadrant of the source image, rotated
// clockwise 90 degrees", in the words of a scene.
TEST_F(SceneMeshes, ImagesAreRepeatedTurnedAndMoved) {
  Image image = make_image(4, 4, {"R", "G", "B"});
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      image.at(x, y)[0] = static_cast<float>(x) / 3.0f;
      image.at(x, y)[1] = static_cast<float>(y) / 3.0f;  // from above
    }
  save_png(image, folder_ / "ramp.png");
  FileMaterial said{.has_specular = false};
  said.base_color_texture = FileTexture{.map = "ramp.png",
                                        .repeat_u = 0.5,
                                        .repeat_v = 0.5,
                                        .rotate = std::acos(0.0),
                                        .shift_u = 0.5};
  const Scene scene = load("\"t\": " + scene_material_text(said, 1.0, 0).json,
                           R"({ "shape": "rectangle", "material": "t" })");
  const auto& placement = std::get<ImageMap>(diffuse_of(scene, 0).color.map->source).placement;
  // Texture coordinates with v upward: the corners of the rectangle and of the quadrant.
  const auto expect = [&](Vec2f at, Vec2f wanted) {
    const Vec2f found = place_uv(placement, at);
    EXPECT_NEAR(found.x, wanted.x, 1e-6f);
    EXPECT_NEAR(found.y, wanted.y, 1e-6f);
  };
  expect({0, 1}, {0, 0});  // top left shows the bottom left
  expect({1, 1}, {0, 0.5f});
  expect({0, 0}, {0.5f, 0});
  expect({1, 0}, {0.5f, 0.5f});
  const TextureStore textures(scene.images);
  SurfacePoint point{};
  point.uv = {0.25f, 0.75f};  // a quarter from the left and from above
  const Vec3f color = textures.color(diffuse_of(scene, 0).color, point);
  EXPECT_LT(color.x, 0.1f);  // left in the image
  EXPECT_GT(color.y, 0.9f);  // and below
}

TEST_F(SceneMeshes, PrimitivesWithoutAMaterialHaveThatOfTheStandard) {
  std::ifstream file(good / "triangle.gltf");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const std::string_view gone : {R"(, "material": 0)", R"(, "COLOR_0": 3)"})
    text.erase(text.find(gone), gone.size());
  std::ofstream(folder_ / "bare.gltf") << text;
  const Scene scene = load(R"("other": { "diffuse": 0.1 })", R"({ "file": "bare.gltf" })");
  ASSERT_EQ(scene.materials.size(), 2U);
  EXPECT_EQ(diffuse_of(scene, 1).color.value, (Vec3f{1, 1, 1}));
  EXPECT_FALSE(diffuse_of(scene, 1).color.map);
}

TEST_F(SceneMeshes, SurveyedCoordinatesAreMovedInDoubleOrRefused) {
  std::ofstream(folder_ / "survey.obj")
      << "v 332499.642 5621873.207 87.4\nv 332500.642 5621873.207 87.4\n"
         "v 332499.642 5621873.457 87.4\nf 1 2 3\n";
  const std::string materials = R"("a": { "diffuse": 0.1 })";
  const Scene scene = load(materials,
                           R"({ "file": "survey.obj", "material": "a",
      "transform": { "translate": [-332499.642, -5621873.207, -87.4] } })");
  const Mesh& mesh = scene.meshes[0];  // 10 mm to the unit
  EXPECT_NEAR(length(mesh.positions[1] - mesh.positions[0]), 10.0f, 1e-5f);
  EXPECT_NEAR(length(mesh.positions[2] - mesh.positions[0]), 2.5f, 1e-5f);
  try {
    (void)load(materials, R"({ "file": "survey.obj", "material": "a" })");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("survey.obj: its middle lies at (3325001.42"),
              std::string::npos)
        << error.what();
  }
  EXPECT_THROW((void)load(materials, R"({ "shape": "box", "material": "a",
      "instances": [ {}, { "translate": [1e7, 0, 0] } ] })"),
               InvalidInput);
}

TEST_F(SceneMeshes, TexturesThatAreMissingAreNamedByTheLineOfTheirLibrary) {
  std::ofstream(folder_ / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"
                                      "usemtl red\nf 1/1 2/1 3/1\n";
  std::ofstream(folder_ / "a.mtl") << "newmtl red\nKd 1 0 0\nmap_Kd none.png\n";
  try {
    (void)load(R"("other": { "diffuse": 0.1 })", R"({ "file": "a.obj" })");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("a.mtl:3: must name an image, but there is no "),
              std::string::npos)
        << error.what();
  }
}

TEST_F(SceneMeshes, SizesOfTranslucentThingsThatAreUnlikelyAreSaid) {
  const std::string materials =
      R"("a": { "subsurface": "jensen_marble" }, "b": { "diffuse": 0.1 })";
  const auto sizes = [&](const std::string& radius, const std::string& material) {
    return implausible_sizes(load(materials, R"({ "shape": "sphere", "radius": )" + radius +
                                                 R"(, "material": ")" + material + "\" }"));
  };
  EXPECT_TRUE(sizes("1", "a").empty());  // 20 mm
  EXPECT_TRUE(sizes("1000", "b").empty());
  ASSERT_EQ(sizes("1000", "a").size(), 1U);  // 20 m
  EXPECT_NE(sizes("1000", "a")[0].find("sphere is 20 m long"), std::string::npos);
  EXPECT_NE(sizes("1000", "a")[0].find("with mm_per_unit 0.1 it would be 200 mm"),
            std::string::npos);
}

/// The material of a file as a scene decodes it.
std::string json_of(const FileMaterial& material) {
  return scene_material_text(material, 10.0, 0).json;
}

TEST(FileMaterials, AreWhatTheyComeNearestTo) {
  EXPECT_EQ(json_of({.has_specular = false}), R"({"diffuse":[1.0,1.0,1.0]})");
  const SceneMaterialText glass = scene_material_text(
      {.base_color = {1, 0, 0}, .metallic = 1, .roughness = 0.5, .ior = 1.4, .transmission = 1},
      1.0, 0);
  EXPECT_EQ(glass.json, R"({"dielectric":{"ior":1.4,"roughness":0.25,"distribution":"ggx"}})");
  ASSERT_EQ(glass.ignored.size(), 2U);
  EXPECT_NE(glass.ignored[0].find("metallic"), std::string::npos);
  EXPECT_NE(glass.ignored[1].find("base color"), std::string::npos);
  FileMaterial textured{.has_specular = false};
  textured.base_color_texture = FileTexture{.map = "a.png", .uv_set = 0, .repeat_u = 2};
  textured.has_cutouts = true;
  EXPECT_EQ(
      json_of(textured),
      R"({"diffuse":{"map":"a.png","repeat":[2.0,1.0],"encoding":"srgb","value":[1.0,1.0,1.0]},)"
      R"("opacity":{"map":"a.png","repeat":[2.0,1.0],"encoding":"srgb"}})");
  textured.base_color_texture->uv_set = 1;
  EXPECT_EQ(json_of(textured), R"({"diffuse":[1.0,1.0,1.0]})");
}

/// The layers that "subsurface" or "thin" of a scene material hold.
Material layers_of(const FileMaterial& material, const char* kind) {
  const JsonDocument document = parse_json(json_of(material), "material");
  return decode_material(*document.root().peek(kind));
}

TEST(FileMaterials, ThinWallsReflectAndLetThroughWhatTheySay) {
  FileMaterial leaf{.base_color = {0.1, 0.5, 0.9}};
  leaf.diffuse_transmission = 0.4;
  leaf.diffuse_transmission_color = {0.2, 0.6, 1.0};
  const Material sheet = layers_of(leaf, "thin");
  for (std::size_t c = 0; c < 3; ++c) {
    const EnteredTotals totals = material_totals(layer_stack(sheet, c));
    EXPECT_NEAR(totals.reflectance, 0.6 * leaf.base_color[c], 0.003) << c;
    EXPECT_NEAR(totals.transmittance, 0.4 * leaf.diffuse_transmission_color[c], 0.003) << c;
  }
}

TEST(FileMaterials, VolumesAttenuateAndHaveTheirColorOfMultipleScattering) {
  FileMaterial wax{.ior = 1.0};
  wax.thickness = 1.0;
  wax.attenuation_distance = 0.5;  // 5 mm
  wax.attenuation_color = {0.5, 0.25, 0.1};
  wax.multiscatter_color = std::array{0.2, 0.5, 0.8};
  const Material layers = layers_of(wax, "subsurface");
  for (std::size_t c = 0; c < 3; ++c) {
    const MaterialLayer& layer = layers.layers[0];
    EXPECT_NEAR(std::exp(-5.0 * (layer.sigma_a[c] + layer.sigma_s[c])), wax.attenuation_color[c],
                1e-12);
    // [KullaConty2017] fit a half-space in diffuse light to about a hundredth.
    EXPECT_NEAR(material_totals(layer_stack(layers, c)).reflectance, (*wax.multiscatter_color)[c],
                0.015)
        << c;
  }
}

// Colors and light by the definition of OpenPBR 1.1.1, in Rec. 709: what returns of even light
// below a surface of index 1.4 is that of the slab solver.
TEST(FileMaterials, SubsurfaceOfOpenPbrShowsItsColor) {
  FileMaterial skin{.ior = 1.4};
  skin.thickness = 1.0;
  skin.attenuation_distance = 0.1;
  skin.attenuation_color = {0.5, 0.4, 0.3};
  skin.multiscatter_color = std::array{0.799, 0.485, 0.347};
  skin.multiscatter_definition = SubsurfaceColor::openpbr;
  skin.scatter_anisotropy = 0.4;
  const Material layers = layers_of(skin, "subsurface");
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(layers.layers[0].g[c], 0.4);
    const auto totals = adding_doubling(layer_stack(layers, c), {}).totals;
    EXPECT_NEAR(totals.diffuse_reflectance / (1.0 - totals.specular_reflectance),
                (*skin.multiscatter_color)[c], 1e-3);
  }
}

TEST(FileMaterials, SubsurfaceWithoutSpecularHasNoBoundary) {
  FileMaterial wax{.ior = 1.5, .has_specular = false};
  wax.thickness = 1.0;
  wax.attenuation_distance = 0.1;
  wax.attenuation_color = {0.5, 0.4, 0.3};
  wax.multiscatter_color = std::array{0.5, 0.5, 0.5};
  EXPECT_EQ(layers_of(wax, "subsurface").layers[0].ior[0], 1.0);
}

}  // namespace
}  // namespace lamina
