// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/editable_skin.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/skin/maps/edits/files/editable_skin_file.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class EditableSkinFiles : public ::testing::Test {
 protected:
  EditableSkinFiles() { fs::create_directories(folder_); }
  ~EditableSkinFiles() override { fs::remove_all(folder_); }

  void save(const std::string& name, int width, int height, float value) const {
    Image image = make_image(width, height, {"Y"});
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      image.pixels[i] = value * static_cast<float>(i + 1);
    save_exr(image, folder_ / name, ExrPrecision::single_float);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] std::string message() const {
    try {
      (void)load_editable_skin(folder_);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_ = fs::temp_directory_path() / "lamina_editable_skin_test";
};

TEST_F(EditableSkinFiles, ArePatchesAndComeBackAsTheyWere) {
  save("melanin.exr", 4, 2, 0.01f);
  save("melanin.sd.exr", 4, 2, 0.1f);
  save("ink_red.exr", 4, 2, 0.2f);
  write("patch.json", R"({ "lamina": "patch", "version": 1, "mm_per_pixel": 0.5, "name": "arm",
      "light": { "theta": 10 }, "skin": { "melanin": { "map": "melanin.exr" }, "oiliness": 0.3,
      "carotene": 0.002,
      "inks": [ { "name": "red", "absorbance": { "map": "ink_red.exr" }, "spectrum": [[400, 1], [600, 0]] } ] } })");
  const EditableSkin skin = load_editable_skin(folder_);
  EXPECT_DOUBLE_EQ(skin.width_mm, 2.0);
  ASSERT_EQ(skin.deviations.size(), 1u);
  EXPECT_EQ(skin.deviations[0].name, "melanin");
  const std::string text = maps_file_json(skin, skin.files[0]).text();
  for (const NamedImage& image : images_of(skin))
    save_exr(*image.image, folder_ / image.file, ExrPrecision::single_float);
  write("patch.json", text);
  const EditableSkin again = load_editable_skin(folder_ / "patch.json");
  EXPECT_EQ(maps_file_json(again, again.files[0]).text(), text);
  ASSERT_EQ(images_of(again).size(), images_of(skin).size());
  for (std::size_t i = 0; i < images_of(skin).size(); ++i) {
    EXPECT_EQ(images_of(again)[i].file, images_of(skin)[i].file);
    EXPECT_EQ(images_of(again)[i].image->pixels, images_of(skin)[i].image->pixels);
  }
  EXPECT_EQ(again.skin.oiliness, 0.3);
  EXPECT_EQ(again.skin.skin.carotene, 0.002);
}

// As lamina acquire has them: one saturation for both layers, and where there is skin.
TEST_F(EditableSkinFiles, AreCapturesWithAMask) {
  save("saturation.exr", 2, 2, 0.1f);
  save("saturation.sd.exr", 2, 2, 0.3f);
  save("mask.exr", 2, 2, 0.25f);
  write("patch.json", R"({ "lamina": "patch", "version": 1, "mm_per_pixel": 1, "skin": {
      "saturation_dermis": { "map": "saturation.exr" }, "saturation_epidermis": { "map": "saturation.exr" } } })");
  write(
      "material.json",
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "name": "arm", "skin": {} })");
  const EditableSkin skin = load_editable_skin(folder_);
  ASSERT_EQ(skin.files.size(), 2u);  // a patch and a material of the same maps
  EXPECT_NE(maps_file_json(skin, skin.files[1]).text().find("saturation_dermis.exr"),
            std::string::npos);
  ASSERT_EQ(skin.deviations.size(), 2u);
  EXPECT_EQ(skin.deviations[0].values.pixels, skin.deviations[1].values.pixels);
  EXPECT_EQ(skin.mask.pixels[3], 1.0f);
  EXPECT_EQ(images_of(skin).back().file, "mask.exr");
  save("mask.exr", 4, 2, 0.1f);
  EXPECT_NE(message().find("mask.exr: must have the proportions of the maps"), std::string::npos);
}

TEST_F(EditableSkinFiles, AreMaterialsWhoseWidthIsNotKnown) {
  save("blood.exr", 3, 3, 0.002f);
  save("oil.exr", 3, 3, 0.1f);
  write("material.json",
        R"({ "lamina": "material", "version": 1, "length_unit": "cm", "name": "face",
      "skin": { "hemoglobin_dermis": { "map": "blood.exr" }, "oiliness": { "map": "oil.exr" },
                "epidermis_thickness": 0.01 } })");
  const EditableSkin skin = load_editable_skin(folder_);
  EXPECT_EQ(skin.width_mm, 0.0);
  ASSERT_EQ(skin.files.size(), 1u);
  EXPECT_EQ(skin.files[0].name, "material.json");
  EXPECT_NEAR(skin.skin.skin.epidermis_thickness, 0.1, 1e-12);  // in mm from now on
  EXPECT_NE(maps_file_json(skin, skin.files[0]).text().find(R"("length_unit":"mm")"),
            std::string::npos);
  ASSERT_EQ(images_of(skin).size(), 2u);
  EXPECT_EQ(images_of(skin)[0].file, "hemoglobin_dermis.exr");
  EXPECT_EQ(images_of(skin)[1].file, "oiliness.exr");
}

TEST_F(EditableSkinFiles, AreRefusedWithTheFileAndTheReason) {
  EXPECT_NE(message().find("patch.json or a material.json"), std::string::npos);
  write("material.json",
        R"({ "lamina": "material", "version": 1, "length_unit": "mm", "layers": [] })");
  EXPECT_NE(message().find("must have \"skin\""), std::string::npos);
  write(
      "patch.json",
      R"({ "lamina": "patch", "version": 1, "mm_per_pixel": 1, "skin": { "melanin": { "map": "m.exr" } } })");
  EXPECT_NE(message().find("m.exr"), std::string::npos);
  save("m.exr", 2, 2, std::numeric_limits<float>::quiet_NaN());
  EXPECT_NE(message().find("nan"), std::string::npos);
  save("m.exr", 2, 2, 0.01f);
  save("melanin.sd.exr", 3, 2, 0.01f);
  EXPECT_NE(message().find("melanin.sd.exr: must have the size of the map, 2 x 2, but has 3 x 2"),
            std::string::npos);
  save("melanin.sd.exr", 2, 2, -0.1f);
  EXPECT_NE(message().find("must be >= 0"), std::string::npos);
}

// Light and albedo that are images would be missed from another folder.
TEST_F(EditableSkinFiles, LeaveOutWhatNamesOtherImages) {
  save("m.exr", 2, 2, 0.01f);
  write("patch.json",
        R"({ "lamina": "patch", "version": 1, "mm_per_pixel": 1, "light": { "map": "m.exr" },
      "skin": { "melanin": { "map": "m.exr" } } })");
  const EditableSkin skin = load_editable_skin(folder_);
  EXPECT_EQ(maps_file_json(skin, skin.files[0]).text().find("light"), std::string::npos);
  ASSERT_EQ(skin.skin.warnings.size(), 1u);
  EXPECT_NE(skin.skin.warnings[0].find("light"), std::string::npos);
}

}  // namespace
}  // namespace lamina
