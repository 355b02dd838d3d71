// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/irradiance_cloud_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/file_bytes.h"
#include "small_scenes.h"

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

constexpr SceneFingerprint some_scene{
    .meshes = 1, .materials = 0xffffffffffffffffu, .maps = 3, .lights = 4, .settings = 5};

TEST(IrradianceCloudFile, IsReadBackAsItWas) {
  const fs::path file = fresh_file("back");
  const std::vector<IrradianceCloud> written = two_clouds();
  save_irradiance_clouds(written, some_scene, file);
  const std::vector<IrradianceCloud> read = load_irradiance_clouds(file, some_scene);
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
  save_irradiance_clouds(written, some_scene, file);
  const std::vector<IrradianceCloud> read = load_irradiance_clouds(file, some_scene);
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t c = 0; c < read.size(); ++c) {
    EXPECT_EQ(read[c].points.size(), written[c].points.size());
    EXPECT_EQ(read[c].exitance, written[c].exitance);
    EXPECT_EQ(read[c].reflectance, written[c].reflectance);
    EXPECT_TRUE(read[c].irradiance.empty());
  }
}

TEST(IrradianceCloudFile, OfAnotherSceneIsRefusedByThePartThatDiffers) {
  const fs::path file = fresh_file("stale");
  save_irradiance_clouds(two_clouds(), some_scene, file);
  SceneFingerprint other = some_scene;
  other.lights = 7;
  try {
    (void)load_irradiance_clouds(file, other);
    FAIL() << "it was read";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("the scene's lights have changed"), std::string::npos)
        << error.what();
  }
}

TEST(IrradianceCloudFile, OfAnotherVersionIsRefusedBySayingSo) {
  const fs::path file = fresh_file("version");
  save_irradiance_clouds(two_clouds(), some_scene, file);
  std::string bytes = read_file_bytes(file);
  const std::size_t at = bytes.find("version 2,");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 8] = '9';
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    (void)load_irradiance_clouds(file, some_scene);
    FAIL() << "it was read";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("must be of version 2, but is of version 9"),
              std::string::npos)
        << error.what();
  }
}

// Cut anywhere, or with any byte of the header or a number changed, a file is refused or gives
// finite numbers; it never does worse.
TEST(IrradianceCloudFile, DamageIsRefusedOrHarmless) {
  const fs::path file = fresh_file("damaged");
  save_irradiance_clouds(two_clouds(), some_scene, file);
  const std::string whole = read_file_bytes(file);
  const auto try_load = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      for (const IrradianceCloud& cloud : load_irradiance_clouds(file, some_scene))
        for (const float value : cloud.irradiance) EXPECT_TRUE(std::isfinite(value));
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  EXPECT_TRUE(try_load(whole));
  for (std::size_t size = 0; size < whole.size(); size += 7)
    EXPECT_FALSE(try_load(whole.substr(0, size))) << size;
  EXPECT_FALSE(try_load(whole + "x"));
  for (std::size_t i = 0; i < whole.size(); i += 3) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x7f);
    (void)try_load(changed);
  }
}

TEST(SceneFingerprint, FollowsWhatTheLightFollowsFromAndNothingElse) {
  Scene scene;
  scene.materials = {diffuse_material(0.5f)};
  scene.meshes = {make_square(1.0f)};
  scene.lights = {EnvironmentLight{}};
  const SceneFingerprint before = fingerprint(scene);
  scene.camera.position.x += 1.0;
  scene.film.width = 7;
  scene.render.samples_per_pixel = 3;
  scene.render.hierarchy.error = 0.5f;
  EXPECT_EQ(fingerprint(scene), before);
  const auto changes = [&](auto&& change, auto part) {
    Scene other = scene;
    change(other);
    SceneFingerprint after = fingerprint(other);
    EXPECT_NE(after.*part, before.*part);
    after.*part = before.*part;
    EXPECT_EQ(after, before);  // only that part
  };
  changes([](Scene& s) { s.meshes[0].positions[2].y += 1e-6f; }, &SceneFingerprint::meshes);
  changes([](Scene& s) { s.materials[0] = diffuse_material(0.50001f); },
          &SceneFingerprint::materials);
  changes([](Scene& s) { s.lights.push_back(PointLight{}); }, &SceneFingerprint::lights);
  changes([](Scene& s) { s.images.push_back(make_image(1, 1, {"R"})); }, &SceneFingerprint::maps);
  changes([](Scene& s) { s.render.seed = 9; }, &SceneFingerprint::settings);
  changes([](Scene& s) { s.render.max_bounces = 1; }, &SceneFingerprint::settings);
}

// The picture of a cloud that was read is that of one that was made, from any camera.
TEST(IrradianceCloudFile, GivesTheSamePictureAsSamplingAnew) {
  Material material{.name = "test", .ior_above = {1, 1, 1}, .ior_below = {1.3, 1.3, 1.3}};
  material.layers = {{.name = "layer",
                      .sigma_a = {0.1, 0.3, 1.0},
                      .sigma_s = {5, 5, 5},
                      .g = {0, 0, 0},
                      .ior = {1.3, 1.3, 1.3}}};
  Scene scene;
  scene.camera = camera_above(3.0);
  scene.film = {.width = 8, .height = 8};
  scene.render = {.method = RenderSettings::Method::hierarchy, .samples_per_pixel = 2};
  scene.materials = {
      {.name = "translucent",
       .surface = SubsurfaceSurface{.material = material, .thickness = {.value = 0}}}};
  scene.meshes = {make_sphere(2.0f, 16)};
  scene.lights = {EnvironmentLight{}};
  const fs::path file = fresh_file("picture");
  const Image made = render(scene, {.cache = file}).image;
  ASSERT_TRUE(fs::exists(file));
  EXPECT_EQ(render(scene, {.cache = file}).image.pixels, made.pixels);
  scene.lights = {EnvironmentLight{.scale = {1, 1, 2}}};
  EXPECT_THROW((void)render(scene, {.cache = file}), InvalidInput);
}

}  // namespace
}  // namespace lamina
