// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/render_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/kept/kept_parts.h"
#include "lamina/render/planning/method_choice.h"

namespace lamina {
namespace {

using Wait = RenderSession::Wait;

/// Where textures of scenes lie.
std::filesystem::path scratch() { return std::filesystem::path(testing::TempDir()); }

void write_map(float value) {
  Image image = make_image(4, 4, {"Y"});
  std::ranges::fill(image.pixels, value);
  image.pixels.front() = 1.5f * value;
  save_exr(image, scratch() / "map.exr", ExrPrecision::single_float);
}

/// A ball of wax beside a wall, both lit; the wax has a map of its absorption.
JsonFile scene_of(const std::string& method, int side = 48, const std::string& samples = "2") {
  return {scratch() / "scene.json", R"({ "lamina": "scene", "version": 1, "mm_per_unit": 1,
    "camera": { "position": [2, 3, 30], "look_at": [0, 0, 0], "horizontal_fov": 30 },
    "film": { "width": )" + std::to_string(side) +
                                        R"(, "height": )" + std::to_string(side) + R"( },
    "materials": {
      "wax": { "subsurface": { "lamina": "material", "version": 1, "length_unit": "mm",
          "bands": "rgb", "layers": [ { "sigma_a": )" +
                                        (method == "texture_space"
                                             ? R"({ "map": "map.exr" })"
                                             : std::string("[0.02, 0.06, 0.1]")) +
                                        R"(, "sigma_s": [2, 3, 4], "g": 0,
            "ior": 1.4, "thickness": "infinite" } ] },
        "coat": { "ior": 1.4, "roughness": 0.3 } },
      "wall": { "diffuse": [0.7, 0.3, 0.2] } },
    "meshes": [ { "shape": "sphere", "radius": 6, "tessellation": 16, "material": "wax" },
      { "shape": "rectangle", "width": 40, "height": 40, "material": "wall",
        "transform": { "translate": [0, 0, -8] } } ],
    "lights": [ { "type": "environment", "radiance": 0.5 },
      { "type": "rectangle", "position": [20, 20, 20], "look_at": [0, 0, 0], "size": [5, 5],
        "radiance": [9, 8, 7] } ],
    "render": { "method": ")" + method + R"(", )" +
                                        (method == "probe" || method == "hierarchy"
                                             ? R"("profile": "diffusion", )"
                                             : "") +
                                        R"("samples_per_pixel": )" + samples +
                                        R"(, "max_bounces": 2 } })"};
}

RenderSession::Options quiet(bool goes_on = false) {
  RenderSession::Options options;
  options.goes_on = goes_on;
  return options;
}

/// The largest difference of two pictures' colors.
double difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
    if (std::isfinite(a.pixels[i]) || std::isfinite(b.pixels[i]))
      most = std::max(most, std::abs(static_cast<double>(a.pixels[i]) -
                                     static_cast<double>(b.pixels[i])));
  return most;
}

TEST(KeptParts, AreMadeAnewByTheTableRowByRow) {
  for (const KeptPartNeeds& row : kept_part_needs) {
    ASSERT_EQ(row.needs.size(), scene_aspect_count) << row.name;
    EXPECT_EQ(&row, &kept_part_needs[static_cast<std::size_t>(row.part)]) << row.name;
    for (std::size_t aspect = 0; aspect < scene_aspect_count; ++aspect) {
      const Need need = need_of(row.part, static_cast<SceneAspect>(aspect));
      ASSERT_TRUE(need == Need::no || need == Need::yes || need == Need::in_the_end) << row.name;
      for (const bool is_first_look : {false, true}) {
        KeptParts kept;
        AspectHashes before{1, 2, 3, 4, 5, 6, 7, 8}, after = before;
        after[aspect] = 99;
        int made = 0;
        const auto ask = [&] {
          return *kept
                      .get<int>(
                          row.part, 3, 0, [&] { return std::make_shared<const int>(++made); },
                          [](const int&) { return true; })
                      .part;
        };
        kept.begin_picture(before, 1, is_first_look);
        EXPECT_EQ(ask(), 1);
        EXPECT_EQ(ask(), 1) << "of the same picture";
        kept.begin_picture(after, 1, is_first_look);
        const bool is_anew = need == Need::yes || (need == Need::in_the_end && !is_first_look);
        EXPECT_EQ(ask(), is_anew ? 2 : 1) << row.name << " " << aspect;
        EXPECT_EQ(kept.has_stand_ins(), need == Need::in_the_end && is_first_look);
      }
    }
  }
}

TEST(KeptParts, MadeOfStandInsServeNoOtherPicture) {
  KeptParts kept;
  AspectHashes aspects{};
  const auto ask = [&](KeptPart part, int value) {
    return *kept.get<int>(
                    part, 0, 0, [&] { return std::make_shared<const int>(value); },
                    [](const int&) { return true; })
                .part;
  };
  kept.begin_picture(aspects, 1, false);
  EXPECT_EQ(ask(KeptPart::entering_light, 1), 1);
  EXPECT_EQ(ask(KeptPart::leaving_light, 1), 1);
  aspects[static_cast<std::size_t>(SceneAspect::materials)] = 5;
  kept.begin_picture(aspects, 1, true);
  EXPECT_EQ(ask(KeptPart::entering_light, 2), 1);  // stands in
  EXPECT_EQ(ask(KeptPart::leaving_light, 2), 2);   // is made of it
  kept.begin_picture(aspects, 1, false);
  EXPECT_EQ(ask(KeptPart::entering_light, 3), 3);
  EXPECT_EQ(ask(KeptPart::leaving_light, 3), 3);
}

TEST(KeptParts, ForgetsPartsThatNoPictureAsksFor) {
  KeptParts kept;
  for (int i = 0; i < 1000; ++i) {
    kept.begin_picture({}, 1, false);
    (void)kept.get<int>(KeptPart::boundary, static_cast<std::uint64_t>(i), 0,
                        [] { return std::make_shared<const int>(0); });
  }
  EXPECT_LE(kept.count(), 20u);
}

TEST(AspectHashes, ChangeWithWhatTheyAreOf) {
  using enum SceneAspect;
  write_map(0.05f);
  const JsonFile file = scene_of("texture_space");
  const auto hashes_of = [&](const std::vector<std::string>& settings) {
    const Scene scene = load_scene(file, {}, settings);
    return aspect_hashes(scene, choose_settings(scene, {}).settings, {});
  };
  const AspectHashes before = hashes_of({});
  const std::vector<std::pair<std::string, std::vector<SceneAspect>>> changes = {
      {"name=other", {}},
      {"camera.position=[2, 3, 31]", {camera}},
      {"camera.horizontal_fov=31", {camera}},
      {"film.width=50", {film}},
      {"film.exposure=2", {}},
      {"lights[1].radiance=[9, 8, 6]", {lights}},
      {"lights[1]=null", {lights}},
      {"materials.wall.diffuse=0.4", {surfaces}},
      {"materials.wall.emission=3", {lights, surfaces}},
      {"materials.wax.coat.roughness=0.2", {surfaces}},
      {"materials.wax.subsurface.layers[0].ior=1.3", {surfaces, materials}},
      {"materials.wax.subsurface.layers[0].sigma_s=3", {materials}},
      {"materials.wax.subsurface.layers[0].sigma_a.value=2", {materials}},
      {"meshes[0].radius=7", {meshes}},
      {"meshes[0].material=wall", {meshes}},
      {"render.max_bounces=3", {settings}},
      {"render.seed=3", {settings}},
      {"render.texture_space.irradiance_samples=3", {settings}},
      {"render.clamp=3", {}}};
  for (const auto& [setting, aspects] : changes) {
    const AspectHashes after = hashes_of({setting});
    for (std::size_t i = 0; i < scene_aspect_count; ++i)
      EXPECT_EQ(before[i] != after[i],
                std::ranges::find(aspects, static_cast<SceneAspect>(i)) != aspects.end())
          << setting << ", aspect " << i;
  }
  write_map(0.06f);
  const AspectHashes painted = hashes_of({});
  for (std::size_t i = 0; i < scene_aspect_count; ++i)
    EXPECT_EQ(before[i] != painted[i], static_cast<SceneAspect>(i) == materials) << i;
}

class RenderSessionOf : public testing::TestWithParam<const char*> {};

TEST_P(RenderSessionOf, EndsWithThePictureOfTheSceneAsItIs) {
  write_map(0.05f);
  const JsonFile file = scene_of(GetParam(), 72);  // with a picture of half the width
  RenderSession session(file, {}, quiet());
  const std::vector<std::string> changes = {
      "camera.position=[4, 2, 28]",
      "lights[1].radiance=[2, 8, 9]",
      "materials.wax.subsurface.layers[0].sigma_s=[4, 3, 2]",
      "materials.wax.coat.roughness=0.5",
      "camera.position=[2, 3, 30]",
      "meshes[0].radius=5",
      "materials.wall.diffuse=0.5",
      "film.width=80"};
  std::vector<std::string> so_far;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (i == 5) write_map(0.08f);
    so_far.push_back(changes[i]);
    const std::uint64_t change = session.set({changes[i]});
    const auto shown = session.wait_for(Wait::final);
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->change, change);
    EXPECT_FALSE(shown->is_first_look);
    const RenderResult fresh = render(load_scene(file, {}, so_far));
    EXPECT_EQ(difference(shown->image, fresh.image), 0.0) << changes[i];
  }
  session.set_region(PixelRectangle{10, 20, 30, 24});
  const auto region = session.wait_for(Wait::final);
  Scene cut = load_scene(file, {}, so_far);
  cut.film.region = {10, 20, 30, 24};
  EXPECT_EQ(difference(region->image, render(cut).image), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Methods, RenderSessionOf,
                         testing::Values("probe", "hierarchy", "texture_space"),
                         [](const auto& method) { return std::string(method.param); });

TEST(RenderSession, MakesOnlyWhatAChangeNeeds) {
  write_map(0.05f);
  RenderSession session(scene_of("texture_space", 40), {}, quiet());
  (void)session.wait_for(Wait::final);
  const auto made_by = [&](const std::string& setting) {
    std::vector<int> made(kept_part_count);
    for (std::size_t i = 0; i < kept_part_count; ++i)
      made[i] = -session.made(static_cast<KeptPart>(i));
    session.set({setting});
    (void)session.wait_for(Wait::final);
    for (std::size_t i = 0; i < kept_part_count; ++i)
      made[i] += session.made(static_cast<KeptPart>(i));
    return made;
  };
  // geometry, lights, boundary, texels, texel_layers, entering_light, leaving_light
  EXPECT_EQ(made_by("camera.up=[0.1, 1, 0]"), (std::vector{0, 0, 0, 0, 0, 1, 1}));
  EXPECT_EQ(made_by("lights[1].radiance=3"), (std::vector{0, 1, 0, 0, 0, 1, 1}));
  EXPECT_EQ(made_by("materials.wax.coat.roughness=0.2"), (std::vector{0, 0, 1, 0, 0, 1, 1}));
  EXPECT_EQ(made_by("materials.wax.subsurface.layers[0].sigma_s=3"),
            (std::vector{0, 0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(made_by("meshes[0].radius=5"), (std::vector{1, 1, 0, 1, 1, 1, 1}));
}

TEST(RenderSession, ShowsSmallPicturesFirstAndFirstLooksOfAMovedCamera) {
  write_map(0.05f);
  std::mutex mutex;
  std::vector<SessionPicture> shown;
  RenderSession::Options options = quiet();
  options.on_picture = [&](const SessionPicture& picture) {
    const std::scoped_lock lock(mutex);
    shown.push_back(picture);
  };
  RenderSession session(scene_of("texture_space", 320, "1"), {}, std::move(options));
  // Pictures are told after they are there to be asked for.
  const auto wait_until_told = [&] {
    (void)session.wait_for(Wait::final);
    for (int i = 0; i < 500; ++i) {
      {
        const std::scoped_lock lock(mutex);
        if (!shown.empty() && shown.back().is_final) return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  };
  wait_until_told();
  {
    const std::scoped_lock lock(mutex);
    ASSERT_GE(shown.size(), 4u);
    EXPECT_EQ(shown.front().fraction, 8);
    EXPECT_EQ(shown.front().image.width, 40);
    EXPECT_FALSE(shown.front().is_first_look);  // there is none before
    EXPECT_TRUE(std::ranges::is_sorted(shown, std::ranges::greater{}, &SessionPicture::fraction));
    shown.clear();
  }
  session.set({"camera.position=[3, 3, 30]"});
  wait_until_told();
  const std::scoped_lock lock(mutex);
  ASSERT_GE(shown.size(), 3u);
  EXPECT_TRUE(shown.front().is_first_look);
  EXPECT_EQ(shown[1].fraction, 1);  // of the light that is there
  EXPECT_TRUE(shown[1].is_first_look);
  EXPECT_TRUE(shown.back().is_final);
  EXPECT_FALSE(shown.back().is_first_look);
}

TEST(RenderSession, GoesOnAddingSamplesToTheFinalPicture) {
  RenderSession session(scene_of("probe", 16), {}, quiet(true));
  const auto first = session.wait_for(Wait::final);
  for (int i = 0; i < 200 && session.picture()->samples_per_pixel < 16.0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_GE(session.picture()->samples_per_pixel, 16.0);
  EXPECT_TRUE(session.picture()->is_final);
  EXPECT_EQ(session.picture()->change, first->change);
  session.cancel();
  for (int i = 0; i < 100 && session.status().is_working; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(session.status().is_working);
}

TEST(RenderSession, RefusesWrongChangesAndStaysAsItWas) {
  RenderSession session(scene_of("probe", 16), {}, quiet());
  const auto before = session.wait_for(Wait::final);
  EXPECT_THROW(session.set({"camera.position=3"}), InvalidInput);
  EXPECT_THROW(session.set({"camera"}), InvalidInput);
  EXPECT_THROW(session.set({"materials.wax.coat.roughness=0.1", "film.width=-3"}), InvalidInput);
  EXPECT_THROW(session.set_region(PixelRectangle{0, 0, 17, 4}), InvalidInput);
  session.reload();
  EXPECT_EQ(difference(session.wait_for(Wait::final)->image, before->image), 0.0);
  // Wrong as a whole, which the work finds out.
  session.set({"render.method=shadow_map", "render.correct=true"});
  EXPECT_THROW((void)session.wait_for(Wait::final), InvalidInput);
  EXPECT_FALSE(session.status().error.empty());
  session.set({"render.method=probe", "render.correct=null"});
  EXPECT_EQ(difference(session.wait_for(Wait::final)->image, before->image), 0.0);
}

TEST(RenderSession, TakesManyChanges) {
  const JsonFile file = scene_of("hierarchy", 36);
  RenderSession session(file, {}, quiet());
  std::string last;
  for (int i = 0; i < 300; ++i) {
    last = "materials.wax.coat.roughness=" + std::to_string(0.1 + 0.002 * i);
    session.set({last});
    if (i % 50 == 0) (void)session.wait_for(Wait::any);
  }
  EXPECT_EQ(session.status().change, 301u);
  const RenderResult fresh = render(load_scene(file, {}, std::vector<std::string>{last}));
  EXPECT_EQ(difference(session.wait_for(Wait::final)->image, fresh.image), 0.0);
}

TEST(RenderSession, AChangeEndsTheWorkAtOnce) {
  RenderSession session(scene_of("random_walk", 256, "1000"), {}, quiet());
  (void)session.wait_for(Wait::any);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto start = std::chrono::steady_clock::now();
  session.cancel();
  while (session.status().is_working) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  RecordProperty("cancel_seconds", std::to_string(took.count()));
  EXPECT_LT(took.count(), 1.0);  // 0.01 where nothing else runs
}

}  // namespace
}  // namespace lamina
