// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Patches of any material: numbers of layers, leaves, paints and skin that are maps.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "lamina/base/image/files/image_file.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "skin/patch/patch_files.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class MaterialPatches : public PatchFolder {
 protected:
  /// A patch of 16 x 16 texels of .1 mm.
  [[nodiscard]] SkinPatch load(const std::string& rest) const {
    return load_patch(R"("mm_per_pixel": 0.1, "width": 16, "height": 16, )" + rest);
  }
  void save(const char* name, const std::vector<std::string>& channels,
            const std::vector<float>& values) const {
    Image image = make_image(static_cast<int>(values.size() / channels.size()), 1, channels);
    image.pixels = values;
    save_exr(image, folder_ / name);
  }
  [[nodiscard]] static std::string material(const std::string& says) {
    return R"("material": {"lamina": "material", "version": 1, "length_unit": "mm", )" + says + "}";
  }
  /// Paint on jade, with a coefficient and a thickness of the paint.
  [[nodiscard]] static std::string painted(const std::string& sigma_a,
                                           const std::string& thickness) {
    return material(R"("bands": "rgb", "layers": [
        { "sigma_a": )" +
                    sigma_a + R"(, "sigma_s": 100, "g": 0.8, "ior": 1.5, "thickness": )" +
                    thickness + R"(},
        { "sigma_a": [0.10, 0.015, 0.06], "sigma_s": 4.0, "g": 0.8, "ior": 1.61,
          "thickness": "infinite" }])");
  }
};

// Adding-doubling of the whole stack is what `lamina slab` prints.
TEST_F(MaterialPatches, UniformMaterialsReflectAndTransmitAsTheirSlabs) {
  for (const char* name :
       {"painted_jade", "green_leaf", "white_paint", "jensen_marble", "parchment"}) {
    const SkinPatchResult result =
        render_skin_patch(load(R"("material": ")" + std::string(name) + '"'));
    const Material material = find_material(name);
    for (std::size_t b = 0; b < material.bands.size(); b += 2) {
      const LayerStack stack = layer_stack(material, b);
      const SlabTotals totals = adding_doubling(stack).totals;
      EXPECT_NEAR(result.bands[b].mean_reflectance, totals.diffuse_reflectance, 1.5e-3)
          << name << " band " << b;
      const auto through =
          channel_index(result.image, "transmitted." + band_name(material.bands, b) +
                                          (material.bands.is_rgb() ? "" : "nm"));
      EXPECT_EQ(through.has_value(), !is_semi_infinite(stack) && stack.ground().reflectance == 0.0)
          << name;
      if (through) {
        EXPECT_NEAR(result.image.at(3, 3)[*through], totals.transmittance, 1.5e-3)
            << name << " band " << b;
      }
    }
  }
}

TEST_F(MaterialPatches, MapsOfOneValueAreNumbers) {
  save("one.exr", {"Y"}, {1.0f, 1.0f});
  save("rgb.exr", {"R", "G", "B"}, {0.02f, 0.05f, 0.3f, 0.02f, 0.05f, 0.3f});
  const Image numbers = render_skin_patch(load(painted("[0.02, 0.05, 0.3]", "0.1"))).image;
  const Image maps = render_skin_patch(load(painted(R"({"map": "rgb.exr"})",
                                                    R"({"map": "one.exr", "scale": 0.1})")))
                         .image;
  ASSERT_EQ(numbers.channels, maps.channels);
  for (std::size_t i = 0; i < numbers.pixels.size(); ++i)
    ASSERT_NEAR(numbers.pixels[i], maps.pixels[i], 1e-5f);
}

// Thin paint shows the green of jade, thick paint does not.
TEST_F(MaterialPatches, PaintOfVaryingThicknessCoversWhatIsBelow) {
  save("thick.exr", {"Y"}, {0.0f, 1.0f});
  SkinPatch patch =
      load(painted("[0.02, 0.02, 0.03]", R"({"map": "thick.exr", "scale": 0.2, "offset": 0.004})"));
  patch.mm_per_texel = 20.0;
  const Image image = render_skin_patch(patch).image;
  const auto at = [&](int x, const char* channel) {
    return image.at(x, 8)[*channel_index(image, channel)];
  };
  EXPECT_GT(at(0, "G"), 1.3f * at(0, "R"));
  EXPECT_LT(at(15, "G"), 1.2f * at(15, "R"));
  for (const auto& [x, thickness] : {std::pair{0, 0.004}, {15, 0.204}}) {
    Material uniform = find_material("painted_jade");
    uniform.layers[0].thickness = thickness;
    EXPECT_NEAR(at(x, "G"), adding_doubling(layer_stack(uniform, 1)).totals.diffuse_reflectance,
                0.02);
  }
}

TEST_F(MaterialPatches, InksHaveAColorEach) {
  save("left.exr", {"Y"}, {1.0f, 0.0f});
  save("right.exr", {"Y"}, {0.0f, 1.0f});
  SkinPatch patch = load(R"("bands": [470, 645], "totals": "radiative_transfer", "skin": {
      "junction_absorption": 0, "inks": [
        {"name": "red", "absorbance": {"map": "left.exr"}, "spectrum": [[560, 1], [610, 0]]},
        {"name": "blue", "absorbance": {"map": "right.exr"}, "spectrum": [[560, 0], [610, 1]]}]})");
  patch.mm_per_texel = 20.0;
  const Image image = render_skin_patch(patch).image;
  const auto at = [&](int x, const char* channel) {
    return image.at(x, 8)[*channel_index(image, channel)];
  };
  const auto plain = render_skin_patch(load(R"("bands": [470, 645],
      "totals": "radiative_transfer", "skin": {"junction_absorption": 0})"));
  EXPECT_LT(at(0, "470nm"), 0.9 * plain.bands[0].mean_reflectance);
  EXPECT_NEAR(at(0, "645nm"), plain.bands[1].mean_reflectance, 1e-4);
  EXPECT_NEAR(at(15, "470nm"), plain.bands[0].mean_reflectance, 1e-4);
  EXPECT_LT(at(15, "645nm"), 0.7 * plain.bands[1].mean_reflectance);
  // The same by one map with a channel for each band.
  save("ink.exr", {"470nm", "645nm"}, {1.0f, 0.0f, 0.0f, 1.0f});
  SkinPatch colored = load(R"("bands": [470, 645], "totals": "radiative_transfer",
      "skin": {"junction_absorption": {"map": "ink.exr"}})");
  colored.mm_per_texel = 20.0;
  const Image same = render_skin_patch(colored).image;
  for (const int x : {0, 15})
    for (std::size_t b = 0; b < 2; ++b) EXPECT_NEAR(same.at(x, 8)[b], image.at(x, 8)[b], 1e-5f);
}

// Scattering and thickness of skin, each beside the number that it is there.
TEST_F(MaterialPatches, ScatteringAndThicknessOfSkinMayVary) {
  save("two.exr", {"Y"}, {0.0f, 1.0f});
  const std::string head = R"("bands": [540], "totals": "radiative_transfer", "skin": {)";
  for (const auto& [name, low, high] :
       {std::tuple{"scattering_scale", 0.4, 0.9}, {"epidermis_thickness", 0.1, 0.4}}) {
    SkinPatch patch =
        load(head + '"' + name + R"(": {"map": "two.exr", "scale": )" + std::to_string(high - low) +
             R"(, "offset": )" + std::to_string(low) + "}}");
    patch.mm_per_texel = 30.0;
    const Image image = render_skin_patch(patch).image;
    for (const auto& [x, value] : {std::pair{0, low}, {15, high}}) {
      const auto uniform =
          render_skin_patch(load(head + '"' + name + "\": " + std::to_string(value) + "}"));
      EXPECT_NEAR(image.at(x, 8)[0], uniform.bands[0].mean_reflectance, 8e-3) << name;
    }
  }
}

TEST_F(MaterialPatches, AreRefusedInOneLineThatSaysWhere) {
  save("nan.exr", {"Y"}, {std::numeric_limits<float>::quiet_NaN()});
  save("two.exr", {"Y"}, {0.1f, 0.2f});
  const auto expect = [&](const std::string& rest, const std::string& says) {
    const std::string message = message_of([&] { return render_skin_patch(load(rest)); });
    EXPECT_NE(message.find(says), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  };
  expect(painted("0.1", R"({"map": "nan.exr"})"), "layers[0].thickness.map");
  expect(painted("0.1", R"({"map": "none.exr"})"), "none.exr");
  expect(painted(R"({"map": "two.exr", "channel": "Q"})", "0.1"), "\"Q\"");
  expect(material(R"("bands": "rgb", "layers": [{"sigma_a": 1, "sigma_s": 1, "g": 0,
         "ior": {"map": "two.exr"}, "thickness": "infinite"}])"),
         "layers[0].ior");
  expect(R"("material": "jadee")", "did you mean \"jade\"");
  expect(R"("material": "jade", "skin": {})", "skin");
  expect(R"("material": "jade", "bands": [500])", "bands");
  const SkinPatch clamped = load(painted("0.1", R"({"map": "two.exr", "offset": -0.15})"));
  ASSERT_FALSE(clamped.warnings.empty());
  EXPECT_NE(clamped.warnings[0].find("layers[0].thickness"), std::string::npos);
}

}  // namespace
}  // namespace lamina
