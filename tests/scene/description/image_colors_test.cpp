// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Images of scenes have the colors, and the side up, that their files say, or that the scene says.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include "base/image/png_chunk.h"
#include "base/image/scratch_folder.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/color_space.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/spectrum/rgb_encoding.h"
#include "lamina/base/spectrum/rgb_space.h"
#include "lamina/base/spectrum/srgb.h"
#include "lamina/scene/description/scene.h"

namespace lamina {
namespace {

using Color = std::array<double, 3>;
constexpr Color wanted = {0.5, 0.3, 0.2};

/// Of one color, the lower half black where it is halved.
Image painted(const Color& color, bool is_halved = false) {
  Image image = make_image(4, 4, {"R", "G", "B"});
  for (int y = 0; y < (is_halved ? 2 : 4); ++y)
    for (int x = 0; x < 4; ++x)
      for (std::size_t c = 0; c < 3; ++c) image.at(x, y)[c] = static_cast<float>(color[c]);
  return image;
}

Image in_p3(Image image) {
  return converted_colors(std::move(image),
                          rgb_conversion(rec709_primaries(), display_p3_primaries()));
}

class ImageColors : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    save_png(painted(wanted), path("srgb.png"));
    write_png_with_chunk(path("p3.png"), encode_png(in_p3(painted(wanted))), display_p3_chunk);
    // Numbers of light: what save_png encodes must come out as them.
    Color decoded{};
    for (std::size_t c = 0; c < 3; ++c) decoded[c] = srgb_decode(wanted[c]);
    std::vector<std::byte> light = encode_png(painted(decoded));
    // Without its chunk sRGB, which goes before gAMA.
    const std::string_view text(reinterpret_cast<const char*>(light.data()), light.size());
    const auto at = static_cast<std::ptrdiff_t>(text.find("sRGB")) - 4;
    light.erase(light.begin() + at, light.begin() + at + 13);
    write_png_with_chunk(path("light.png"), light, light_chunk);
    write_png_with_chunk(path("turned.png"), encode_png(painted(wanted, true)),
                         orientation_chunk(3));
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }

  [[nodiscard]] Scene scene_of(const std::string& material, const std::string& mesh,
                               const std::string& light) const {
    write("scene.json", R"({ "lamina": "scene", "version": 1, "mm_per_unit": 1,
      "camera": { "position": [0, 0, 10], "look_at": [0, 0, 0] },
      "materials": { "wall": )" +
                            material + R"( }, "meshes": [ )" + mesh + R"( ], "lights": [ )" +
                            light + " ] }");
    return load_scene(path("scene.json"));
  }

  [[nodiscard]] Scene of_texture(const std::string& diffuse) const {
    return scene_of("{ \"diffuse\": " + diffuse + " }",
                    R"({ "shape": "rectangle", "material": "wall" })",
                    R"({ "type": "environment", "radiance": 1 })");
  }

  [[nodiscard]] Scene of_mesh(const std::string& mesh) const {
    return scene_of("{ \"diffuse\": 1 }", mesh, R"({ "type": "environment", "radiance": 1 })");
  }

  static Color first_color(const Image& image) {
    const float* pixel = image.at(0, 0);
    return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1]),
            static_cast<double>(pixel[2])};
  }

  static void expect_color(const Color& found, const Color& expected) {
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(srgb_encode(found[c]), srgb_encode(expected[c]), 1.0 / 255.0) << c;
  }

  static Color numbers_of_p3() {
    const auto conversion = rgb_conversion(rec709_primaries(), display_p3_primaries());
    return conversion * wanted;
  }

  /// The color of a wall by MaterialX: a color, or the image of that name.
  [[nodiscard]] Scene by_materialx(const std::string& document, const std::string& value,
                                   const std::string& of_file = "") const {
    const bool is_image = value.find(',') == std::string::npos;
    write(
        "look.mtlx",
        "<materialx version=\"1.39\" " + document + ">" +
            (is_image ? "<image name=\"i\" type=\"color3\"><input name=\"file\" type=\"filename\" "
                        "value=\"" +
                            value + "\" " + of_file + "/></image>"
                      : "") +
            "<standard_surface name=\"s\" type=\"surfaceshader\"><input name=\"base\" "
            "type=\"float\" value=\"1\"/><input name=\"base_color\" type=\"color3\" " +
            (is_image ? "nodename=\"i\"" : "value=\"" + value + "\"") +
            "/></standard_surface><surfacematerial name=\"board\" type=\"material\"><input "
            "name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"s\"/></surfacematerial>"
            "</materialx>");
    write("wall.obj",
          "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng board\n"
          "f 1/1 2/2 3/3 4/4\n");
    return of_mesh(R"({ "file": "wall.obj", "materials_file": "look.mtlx" })");
  }

  static Color diffuse_of(const Scene& scene) {
    const Vec3f& value = std::get<DiffuseSurface>(scene.materials.back().surface).color.value;
    return {static_cast<double>(value.x), static_cast<double>(value.y),
            static_cast<double>(value.z)};
  }
};

TEST_F(ImageColors, OfTexturesAreWhatTheFileSays) {
  for (const char* name : {"srgb.png", "p3.png", "light.png"})
    expect_color(
        first_color(of_texture("{ \"map\": \"" + std::string(name) + "\", \"encoding\": \"srgb\" }")
                        .images.at(0)),
        wanted);
}

TEST_F(ImageColors, OfTexturesAreWhatTheSceneSaysByName) {
  expect_color(
      first_color(of_texture(R"({ "map": "p3.png", "encoding": "srgb_texture" })").images.at(0)),
      numbers_of_p3());
  write_png_with_chunk(path("bare.png"), encode_png(in_p3(painted(wanted))), "teXtnothing");
  expect_color(
      first_color(
          of_texture(R"({ "map": "bare.png", "encoding": "srgb_displayp3" })").images.at(0)),
      wanted);
  try {
    (void)scene_of(R"({ "diffuse": 1, "opacity": { "map": "p3.png", "encoding": "acescg" } })",
                   R"({ "shape": "rectangle", "material": "wall" })", "");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("is of colors"), std::string::npos) << error.what();
  }
}

TEST_F(ImageColors, OfEnvironmentsAreWhatTheFileSays) {
  const Scene scene =
      scene_of("{ \"diffuse\": 1 }", R"({ "shape": "rectangle", "material": "wall" })",
               R"({ "type": "environment", "image": "p3.png" })");
  expect_color(first_color(scene.images.at(0)), wanted);
}

TEST_F(ImageColors, OfQuantitiesAreNeverConverted) {
  const Scene scene = scene_of(R"({ "diffuse": 1, "normal_map": "p3.png" })",
                               R"({ "shape": "rectangle", "material": "wall" })",
                               R"({ "type": "environment", "radiance": 1 })");
  Color numbers = numbers_of_p3();
  for (double& number : numbers) number = srgb_encode(number);
  const Color found = first_color(scene.images.at(0));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], numbers[c], 0.5 / 255.0 + 1e-6);
}

TEST_F(ImageColors, OfMaterialXAreOfTheSpaceThatItSays) {
  const std::string srgb = "colorspace=\"srgb_texture\"", linear = "colorspace=\"lin_rec709\"";
  EXPECT_NEAR(diffuse_of(by_materialx(srgb, ".18, .18, .18"))[0], 0.0272, 5e-5);
  EXPECT_NEAR(diffuse_of(by_materialx(linear, ".18, .18, .18"))[0], 0.18, 1e-6);
  const double number = 118.0 / 255.0;
  save_png(painted({srgb_decode(number), srgb_decode(number), srgb_decode(number)}), path("a.png"));
  EXPECT_NEAR(first_color(by_materialx(linear, "a.png").images.at(0))[0], 0.463, 5e-4);
  EXPECT_NEAR(first_color(by_materialx(linear, "a.png", srgb).images.at(0))[0], srgb_decode(number),
              1e-6);
}

// glTF 2.0, Images: profiles, if present, must be ignored; the base color is sRGB.
TEST_F(ImageColors, OfGltfAreSrgbAndAsTheyLieWhateverTheImageSays) {
  const std::array<float, 20> numbers = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1,
                                         1,  0,  0, 0, 1,  0, 1, 1, 0, 1};
  const std::array<std::uint16_t, 6> corners = {0, 1, 2, 0, 2, 3};
  std::ofstream(path("b.bin"), std::ios::binary)
      .write(reinterpret_cast<const char*>(numbers.data()), sizeof numbers)
      .write(reinterpret_cast<const char*>(corners.data()), sizeof corners);
  for (const char* name : {"p3.png", "turned.png"}) {
    write("wall.gltf",
          R"({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [ { "nodes": [ 0 ] } ],
      "nodes": [ { "mesh": 0 } ], "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0,
      "TEXCOORD_0": 1 }, "indices": 2, "material": 0 } ] } ], "materials": [ { "name": "board",
      "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 } } ],
      "textures": [ { "source": 0 } ], "images": [ { "uri": ")" +
              std::string(name) +
              R"(" } ], "accessors": [
      { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [ -1, -1, 0 ], "max": [ 1, 1, 0 ] },
      { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
      { "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" } ],
      "bufferViews": [ { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
      { "buffer": 0, "byteOffset": 80, "byteLength": 12 } ],
      "buffers": [ { "uri": "b.bin", "byteLength": 92 } ] })");
    expect_color(first_color(of_mesh(R"({ "file": "wall.gltf" })").images.at(0)),
                 std::string(name) == "p3.png" ? numbers_of_p3() : wanted);
  }
}

TEST_F(ImageColors, OfPicturesThatLieOnTheirHeadAreTurned) {
  const Image image = of_texture(R"({ "map": "turned.png", "encoding": "srgb" })").images.at(0);
  EXPECT_EQ(image.at(0, 0)[0], 0.0f);
  EXPECT_GT(image.at(0, 3)[0], 0.4f);
}

// A file of few bytes that would take the memory of the scene is refused before it is decoded.
TEST_F(ImageColors, ThatLeaveNoMemoryToTheirSmallerCopiesAreNotDecoded) {
  const std::vector<std::byte> png = encode_png(make_image(2000, 2000, {"R", "G", "B"}));
  std::ofstream(path("srgb.png"), std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), 100);  // whose pixels are not there
  write("scene.json", R"({ "lamina": "scene", "version": 1, "mm_per_unit": 1,
      "camera": { "position": [0, 0, 10], "look_at": [0, 0, 0] },
      "materials": { "wall": { "diffuse": { "map": "srgb.png", "encoding": "srgb" } } },
      "meshes": [ { "shape": "rectangle", "material": "wall" } ], "lights": [] })");
  try {
    (void)load_scene(path("scene.json"), MemoryBudget{.left = std::size_t{60} << 20});
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("of memory"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lamina
