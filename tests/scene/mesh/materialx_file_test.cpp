// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/materialx_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

std::string sample() {
  std::ifstream stream(std::filesystem::path(LAMINA_SOURCE_DIR) /
                       "tests/inputs/scene/good/look.mtlx");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(MaterialX, InputsAreValuesOrImages) {
  const std::vector<FileMaterial> materials = parse_materialx(sample(), "look.mtlx");
  ASSERT_EQ(materials.size(), 2U);
  EXPECT_EQ(materials[0].name, "head_left");
  EXPECT_EQ(materials[0].multiscatter_color, (std::array{0.8, 0.6, 0.4}));
  EXPECT_EQ(materials[0].attenuation_distance, 0.05);
  EXPECT_EQ(materials[0].roughness, 0.4);
  EXPECT_EQ(materials[0].ignored, std::vector<std::string>{"coat_weight"});
  ASSERT_TRUE(materials[1].base_color_texture);
  EXPECT_EQ(materials[1].base_color_texture->map, "tiles.1001.png");
  EXPECT_FALSE(materials[1].has_specular);
}

FileMaterial surface_of(const std::string& kind, const std::string& inputs) {
  const std::string text = "<materialx version=\"1.39\"><" + kind +
                           " name=\"s\" type=\"surfaceshader\">" + inputs + "</" + kind +
                           "><surfacematerial name=\"m\" type=\"material\"><input "
                           "name=\"surfaceshader\" nodename=\"s\"/></surfacematerial></materialx>";
  return parse_materialx(text, "a.mtlx").at(0);
}

std::string input(const std::string& name, const std::string& value) {
  return "<input name=\"" + name + "\" value=\"" + value + "\"/>";
}

TEST(MaterialX, SubsurfaceIsByTheRuleOfItsFormat) {
  const FileMaterial openpbr =
      surface_of("open_pbr_surface",
                 input("subsurface_weight", "1") + input("subsurface_scatter_anisotropy", "0.3"));
  EXPECT_EQ(openpbr.multiscatter_definition, SubsurfaceColor::openpbr);
  EXPECT_EQ(openpbr.multiscatter_color, (std::array{0.8, 0.8, 0.8}));
  EXPECT_EQ(openpbr.scatter_anisotropy, 0.3);
  const FileMaterial standard = surface_of("standard_surface", input("subsurface", "1"));
  EXPECT_EQ(standard.multiscatter_definition, SubsurfaceColor::standard_surface);
  EXPECT_EQ(standard.multiscatter_color, (std::array{1.0, 1.0, 1.0}));
}

TEST(MaterialX, SubsurfaceThatDoesNotTravelIsMatte) {
  for (const auto& [kind, weight, zero] :
       {std::tuple{"open_pbr_surface", "subsurface_weight", "subsurface_radius"},
        std::tuple{"standard_surface", "subsurface", "subsurface_scale"}}) {
    const std::string color = input(weight, "1") + input("subsurface_color", "0.5, 0.4, 0.3");
    const FileMaterial matte = surface_of(kind, color + input(zero, "0"));
    EXPECT_FALSE(matte.multiscatter_color);
    EXPECT_EQ(matte.attenuation_distance, 0.0);
    EXPECT_EQ(matte.base_color, (std::array{0.5, 0.4, 0.3}));
  }
  const FileMaterial one_channel = surface_of(
      "standard_surface", input("subsurface", "1") + input("subsurface_radius", "1, 0, 0.5"));
  EXPECT_EQ(one_channel.attenuation_distance, 1e-3);
}

TEST(MaterialX, ThinWallsPassTheirSubsurfaceColor) {
  const std::string color = input("subsurface_color", "0.5, 0.4, 0.3");
  const FileMaterial openpbr =
      surface_of("open_pbr_surface", color + input("subsurface_weight", "1") +
                                         input("geometry_thin_walled", "true") +
                                         input("subsurface_scatter_anisotropy", "0.2"));
  EXPECT_EQ(openpbr.diffuse_transmission, 0.6);
  EXPECT_EQ(openpbr.base_color, openpbr.diffuse_transmission_color);
  const FileMaterial standard = surface_of(
      "standard_surface", color + input("subsurface", "0.25") + input("thin_walled", "true") +
                              input("base_color", "0.1, 0.2, 0.3"));
  EXPECT_EQ(standard.diffuse_transmission, 0.25);
  EXPECT_EQ(standard.diffuse_transmission_color, (std::array{0.5, 0.4, 0.3}));
  EXPECT_EQ(standard.base_color, (std::array{0.1, 0.2, 0.3}));
}

/// The material of a document, and of the surface's inputs.
FileMaterial material_of(const std::string& of_document, const std::string& inputs,
                         const std::string& nodes = "") {
  return parse_materialx("<materialx version=\"1.39\" " + of_document + ">" + nodes +
                             "<open_pbr_surface name=\"s\" type=\"surfaceshader\">" + inputs +
                             "</open_pbr_surface><surfacematerial name=\"m\" type=\"material\">"
                             "<input name=\"surfaceshader\" type=\"surfaceshader\" "
                             "nodename=\"s\"/></surfacematerial></materialx>",
                         "a.mtlx")
      .at(0);
}

// MaterialX 1.39, Color Spaces and Color Management Systems: the attribute of an input, or else
// that of what is around it, at last that of the document.
TEST(MaterialX, ColorsAreOfTheSpaceThatTheInnermostElementSays) {
  const std::string value = "<input name=\"base_color\" type=\"color3\" value=\".18, .18, .18\" ";
  const std::string srgb = "colorspace=\"srgb_texture\"";
  EXPECT_NEAR(material_of("", value + srgb + "/>").base_color[0], 0.0272, 5e-5);
  EXPECT_NEAR(material_of(srgb, value + "/>").base_color[0], 0.0272, 5e-5);
  EXPECT_EQ(material_of("", value + "/>").base_color[0], 0.18);
  EXPECT_EQ(material_of(srgb, value + "colorspace=\"lin_rec709\"/>").base_color[0], 0.18);
  EXPECT_NEAR(material_of("colorspace=\"g22_rec709\"", value + "/>").base_color[1],
              std::pow(0.18, 2.2), 1e-12);
  // ACEScg's red in linear Rec.709 by the published matrix (ACES white, Bradford): 1.70505.
  const FileMaterial wide = material_of(
      "colorspace=\"lin_ap1\"", "<input name=\"base_color\" type=\"color3\" value=\".5, 0, 0\"/>");
  EXPECT_NEAR(wide.base_color[0], 0.5 * 1.70505, 1e-4);
  EXPECT_EQ(wide.base_color[1], 0.0);  // below
  EXPECT_NE(message_of([&] {
              (void)material_of("colorspace=\"rgb2\"", value + "/>");
            }).find("a.mtlx: the color space of base_color must be one of srgb_texture, "),
            std::string::npos);
}

TEST(MaterialX, ImagesAreOfTheSpaceThatTheInnermostElementSays) {
  const auto encoding = [](const std::string& of_document, const std::string& of_graph,
                           const std::string& of_node, const std::string& of_file) {
    const auto space = [](const std::string& name) {
      return name.empty() ? name : " colorspace=\"" + name + "\"";
    };
    return material_of(
               space(of_document), "<input name=\"base_color\" type=\"color3\" nodegraph=\"g\"/>",
               "<nodegraph name=\"g\"" + space(of_graph) + "><image name=\"i\" type=\"color3\"" +
                   space(of_node) + "><input name=\"file\" type=\"filename\" value=\"a.png\"" +
                   space(of_file) +
                   "/></image><output name=\"out\" type=\"color3\" "
                   "nodename=\"i\"/></nodegraph>")
        .base_color_texture->encoding;
  };
  EXPECT_EQ(encoding("", "", "", ""), "");
  EXPECT_EQ(encoding("lin_rec709", "", "", ""), "lin_rec709");
  EXPECT_EQ(encoding("lin_rec709", "", "", "srgb_texture"), "srgb_texture");
  EXPECT_EQ(encoding("lin_rec709", "", "srgb_displayp3", ""), "srgb_displayp3");
  EXPECT_EQ(encoding("lin_rec709", "lin_ap1", "", ""), "acescg");
}

TEST(MaterialX, FaultsAreNamedWithTheirLine) {
  for (const auto& [text, says] :
       {std::pair{"", "is cut off"}, std::pair{"text", "is cut off"},
        std::pair{"<a>\n<b></a>", "2: an element must end with its own name, b"},
        std::pair{"<a b></a>", "1: an attribute must have a value"},
        std::pair{"<a b=c></a>", "a value must stand in quotes"},
        std::pair{"<usd></usd>", "must be a MaterialX file, but is <usd>"}})
    EXPECT_NE(message_of([&, given = text] { (void)parse_materialx(given, "a.mtlx"); }).find(says),
              std::string::npos)
        << text << ": "
        << message_of([&, given = text] { (void)parse_materialx(given, "a.mtlx"); });
  std::string deep;
  for (int i = 0; i < 1000; ++i) deep += "<a>";
  EXPECT_NE(message_of([&] { (void)parse_materialx(deep, "a.mtlx"); }).find("64 deep"),
            std::string::npos);
  EXPECT_NE(message_of([] {
              std::string text = sample();
              text.replace(text.find("0.8, 0.6"), 3, "0.x");
              (void)parse_materialx(text, "a.mtlx");
            }).find("subsurface_color must be numbers"),
            std::string::npos);
}

TEST(MaterialX, CutOrDamagedNeverCrashes) {
  const std::string whole = sample();
  for (std::size_t size = 0; size < whole.size() - 2; size += 7)
    EXPECT_NE(message_of([&] { (void)parse_materialx(whole.substr(0, size), "a.mtlx"); }), "");
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Random random = make_random(9, i);
    std::string damaged = whole;
    for (int k = 0; k < 3; ++k)
      damaged[static_cast<std::size_t>(random.uniform() * static_cast<double>(damaged.size()))] =
          static_cast<char>(random.bits() & 255);
    (void)message_of([&] { (void)parse_materialx(damaged, "a.mtlx"); });
  }
}

}  // namespace
}  // namespace lamina
