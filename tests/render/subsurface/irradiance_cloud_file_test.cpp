// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>

#include "base/image/peak_memory.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/io/file_bytes.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

fs::path fresh_file(const std::string& name) {
  const fs::path file = fs::path(testing::TempDir()) / ("cloud_" + name + ".ply");
  fs::remove(file);
  return file;
}

std::vector<IrradianceCloud> two_clouds() {
  const CloudPoint thick{.position = {1, 2, 3},
                         .normal = {0, 0, 1},
                         .uv = {0.25f, 0.5f},
                         .area = 0.1f,
                         .albedo = {0.5f, 0.6f, 0.7f},
                         .thickness = std::numeric_limits<float>::infinity()};
  CloudPoint thin = thick;
  thin.thickness = 2.5f;
  return {{.material = 1, .bands = 2, .spacing = 0.3f, .points = {thick}, .irradiance = {1, 2}},
          {.material = 4,
           .bands = 2,
           .spacing = 1.0f / 3.0f,
           .points = {thin, thick},
           .irradiance = {3, 4, 5, 6}}};
}

constexpr LightFingerprint some_scene{
    .meshes = 1, .materials = 0xffffffffffffffffu, .maps = 3, .lights = 4, .settings = 5};

TEST(IrradianceCloudFile, IsReadBackAsItWas) {
  const fs::path file = fresh_file("back");
  const std::vector<IrradianceCloud> written = two_clouds();
  save_irradiance_clouds(written, {}, some_scene, file);
  const std::vector<IrradianceCloud> read = load_irradiance_clouds(file, some_scene).clouds;
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t c = 0; c < read.size(); ++c) {
    EXPECT_EQ(read[c].material, written[c].material);
    EXPECT_EQ(read[c].bands, written[c].bands);
    EXPECT_EQ(read[c].spacing, written[c].spacing);
    EXPECT_EQ(read[c].irradiance, written[c].irradiance);
    ASSERT_EQ(read[c].points.size(), written[c].points.size());
    for (std::size_t i = 0; i < read[c].points.size(); ++i) {
      EXPECT_EQ(read[c].points[i].position, written[c].points[i].position);
      EXPECT_EQ(read[c].points[i].normal, written[c].points[i].normal);
      EXPECT_EQ(read[c].points[i].uv, written[c].points[i].uv);
      EXPECT_EQ(read[c].points[i].area, written[c].points[i].area);
      EXPECT_EQ(read[c].points[i].albedo, written[c].points[i].albedo);
      EXPECT_EQ(read[c].points[i].thickness, written[c].points[i].thickness);
    }
  }
}

TEST(IrradianceCloudFile, OfLightThatHasSpreadIsReadBackAsItWas) {
  const fs::path file = fresh_file("spread");
  std::vector<IrradianceCloud> written = two_clouds();
  for (IrradianceCloud& cloud : written) {
    cloud.exitance = cloud.irradiance;
    for (float& value : cloud.irradiance) value *= 0.1f;
    cloud.reflectance = std::move(cloud.irradiance);
    cloud.irradiance.clear();
  }
  save_irradiance_clouds(written, {}, some_scene, file);
  const std::vector<IrradianceCloud> read = load_irradiance_clouds(file, some_scene).clouds;
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t c = 0; c < read.size(); ++c) {
    EXPECT_EQ(read[c].points.size(), written[c].points.size());
    EXPECT_EQ(read[c].exitance, written[c].exitance);
    EXPECT_EQ(read[c].reflectance, written[c].reflectance);
    EXPECT_TRUE(read[c].transmittance.empty());
    EXPECT_TRUE(read[c].irradiance.empty());
  }
  // A sheet among them.
  written[1].transmittance = {7, 8, 9, 10};
  save_irradiance_clouds(written, {}, some_scene, file);
  const std::vector<IrradianceCloud> with_sheet = load_irradiance_clouds(file, some_scene).clouds;
  ASSERT_EQ(with_sheet.size(), written.size());
  EXPECT_EQ(with_sheet[0].transmittance, (std::vector<float>{0, 0}));
  EXPECT_EQ(with_sheet[1].transmittance, written[1].transmittance);
  EXPECT_EQ(with_sheet[1].reflectance, written[1].reflectance);
}

LightRatioCloud some_ratios() {
  LightRatioCloud ratios{.material = 4,
                         .bands = 2,
                         .walks = 640,
                         .change = 0.25,
                         .error_left = 1.0 / 3.0,
                         .spacing = 0.5f,
                         .places = {{{1, 2, 3}, {0, 0, 1}, 0.0f}, {{4, 5, 6}, {0, 1, 0}, 0.01f}},
                         .shape = {1, 2, 3, 4, 5, 6},
                         .ratios = {}};
  for (int i = 0; i < 20; ++i) ratios.ratios.push_back(0.1f * static_cast<float>(i));
  return ratios;
}

TEST(IrradianceCloudFile, OfRatiosToPlanarLightIsReadBackAsItWas) {
  const fs::path file = fresh_file("ratios");
  const LightRatioCloud written = some_ratios();
  save_irradiance_clouds(two_clouds(), {written}, some_scene, file);
  const KeptClouds kept = load_irradiance_clouds(file, some_scene);
  EXPECT_EQ(kept.why_unusable, "");
  EXPECT_EQ(kept.clouds.size(), 2u);
  ASSERT_EQ(kept.ratios.size(), 1u);
  const LightRatioCloud& read = kept.ratios[0];
  EXPECT_EQ(read.material, written.material);
  EXPECT_EQ(read.bands, written.bands);
  EXPECT_EQ(read.walks, written.walks);
  EXPECT_NEAR(read.change, written.change, 1e-8);
  EXPECT_NEAR(read.error_left, written.error_left, 1e-8);
  EXPECT_EQ(read.spacing, written.spacing);
  EXPECT_EQ(read.shape, written.shape);
  EXPECT_EQ(read.ratios, written.ratios);
  ASSERT_EQ(read.places.size(), 2u);
  EXPECT_EQ(read.places[1].position, written.places[1].position);
  EXPECT_EQ(read.places[1].normal, written.places[1].normal);
  EXPECT_EQ(read.places[1].added_exitance, 0.01f);
  LightRatioCloud absurd = written;
  absurd.places[0].added_exitance = -1.0f;
  save_irradiance_clouds(two_clouds(), {absurd}, some_scene, file);
  EXPECT_EQ(load_irradiance_clouds(file, some_scene).why_unusable, "is damaged");
  absurd = written;
  absurd.spacing = 0.0f;
  save_irradiance_clouds(two_clouds(), {absurd}, some_scene, file);
  EXPECT_EQ(load_irradiance_clouds(file, some_scene).why_unusable, "is damaged");
  save_irradiance_clouds(two_clouds(), {written}, some_scene, file);
  // A place too few: what the checksum says does not matter.
  std::string bytes = read_file_bytes(file);
  std::ofstream(file, std::ios::binary) << bytes.substr(0, bytes.size() - 17 * sizeof(float));
  EXPECT_EQ(load_irradiance_clouds(file, some_scene).why_unusable, "is damaged");
}

TEST(IrradianceCloudFile, OfAnotherSceneIsOfNoUseByThePartThatDiffers) {
  const fs::path file = fresh_file("stale");
  save_irradiance_clouds(two_clouds(), {}, some_scene, file);
  LightFingerprint other = some_scene;
  other.lights = 7;
  const KeptClouds kept = load_irradiance_clouds(file, other);
  EXPECT_EQ(kept.why_unusable, "was made for other lights");
  EXPECT_TRUE(kept.clouds.empty());
}

TEST(IrradianceCloudFile, OfAnotherVersionIsOfNoUse) {
  const fs::path file = fresh_file("version");
  save_irradiance_clouds(two_clouds(), {}, some_scene, file);
  std::string bytes = read_file_bytes(file);
  const std::size_t at = bytes.find("version 6,");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 8] = '2';
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_EQ(load_irradiance_clouds(file, some_scene).why_unusable, "is of version 2, not 6");
}

// It is not lamina's to overwrite.
TEST(IrradianceCloudFile, AnotherFileIsRefused) {
  const fs::path file = fresh_file("other");
  std::ofstream(file) << "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n";
  EXPECT_THROW((void)load_irradiance_clouds(file, some_scene), FileError);
}

/// Gives a file the checksum that it should have.
void sign(std::string& bytes) {
  const std::size_t at = bytes.find("comment checksum ") + 17;
  bytes.replace(at, 16, std::string(16, '0'));
  Hash hash;
  hash.add_text(bytes);
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << hash.value();
  bytes.replace(at, 16, text.str());
}

// A header of a hundred kilobytes that promises ten clouds of all points after another.
TEST(IrradianceCloudFile, ThatPromisesMoreThanItHoldsIsRefusedBeforeMemoryIsTaken) {
  const fs::path file = fresh_file("promises");
  save_irradiance_clouds(two_clouds(), {}, some_scene, file);
  std::string bytes = read_file_bytes(file);
  std::string promises;
  for (int i = 0; i < 4000; ++i) promises += "comment cloud 7 90000 0.5\n";
  bytes.insert(bytes.find("comment cloud"), promises);
  sign(bytes);
  std::ofstream(file, std::ios::binary) << bytes;
  const auto peak = peak_memory(
      [&] { EXPECT_EQ(load_irradiance_clouds(file, some_scene).why_unusable, "is damaged"); });
  if (peak) {
    EXPECT_LT(*peak, std::size_t{4} << 20);
  }
}

TEST(IrradianceCloudFile, TakesItsPointsFromTheBudget) {
  const fs::path file = fresh_file("budget");
  std::vector<IrradianceCloud> clouds = two_clouds();
  clouds[1].points.resize(10'000, clouds[1].points[0]);
  clouds[1].irradiance.resize(20'000, 1.0f);
  save_irradiance_clouds(clouds, {}, some_scene, file);
  EXPECT_EQ(load_irradiance_clouds(file, some_scene).clouds[1].points.size(), 10'000u);
  try {
    (void)load_irradiance_clouds(file, some_scene, {1 << 20});
    FAIL() << "it was read";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("10001 points would take"), std::string::npos)
        << error.what();
  }
}

// Cut anywhere, or with any bit of it changed, a file is of no use: no number of it is taken.
TEST(IrradianceCloudFile, DamageIsSeenWhereverItIs) {
  const fs::path file = fresh_file("damaged");
  save_irradiance_clouds(two_clouds(), {}, some_scene, file);
  const std::string whole = read_file_bytes(file);
  const auto is_taken = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      return load_irradiance_clouds(file, some_scene).why_unusable.empty();
    } catch (const FileError&) {
      return false;
    }
  };
  EXPECT_TRUE(is_taken(whole));
  for (std::size_t size = 0; size < whole.size(); size += 7)
    EXPECT_FALSE(is_taken(whole.substr(0, size))) << size;
  EXPECT_FALSE(is_taken(whole + "x"));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
    EXPECT_FALSE(is_taken(changed)) << "byte " << i;
  }
}

// Even under a right checksum: what no surface has is not read.
TEST(IrradianceCloudFile, NumbersOutOfRangeAreOfNoUse) {
  const fs::path file = fresh_file("range");
  const auto why = [&](auto&& change) {
    std::vector<IrradianceCloud> clouds = two_clouds();
    change(clouds[1]);
    save_irradiance_clouds(clouds, {}, some_scene, file);
    return load_irradiance_clouds(file, some_scene).why_unusable;
  };
  EXPECT_EQ(why([](IrradianceCloud&) {}), "");
  for (const float area : {-1.0f, 0.0f, 1e38f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_EQ(why([&](IrradianceCloud& c) { c.points[1].area = area; }), "is damaged") << area;
  EXPECT_EQ(why([](IrradianceCloud& c) { c.points[0].normal = {0, 0, 2}; }), "is damaged");
  EXPECT_EQ(why([](IrradianceCloud& c) { c.points[0].position.x = 1.0f / 0.0f; }), "is damaged");
  EXPECT_EQ(why([](IrradianceCloud& c) { c.points[0].thickness = -2.0f; }), "is damaged");
  EXPECT_EQ(why([](IrradianceCloud& c) { c.irradiance[3] = -1e-3f; }), "is damaged");
  EXPECT_EQ(why([](IrradianceCloud& c) { c.spacing = 0.0f; }), "is damaged");
}

}  // namespace
}  // namespace lamina
