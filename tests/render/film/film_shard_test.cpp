// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/film_shard.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/render/render.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class FilmShards : public testing::Test {
 protected:
  FilmShards() { fs::create_directories(folder); }
  ~FilmShards() override { fs::remove_all(folder); }
  FilmShards(const FilmShards&) = delete;
  FilmShards& operator=(const FilmShards&) = delete;

  fs::path folder = fs::temp_directory_path() / ("lamina_film_shards_" + std::to_string(getpid()));
};

constexpr int width = 21, height = 37, samples = 23;

/// Light of all sizes, of either sign, and some that needs few digits; now and then no surface.
CameraSample sample_of(int x, int y, int i) {
  Random random = make_random(11, static_cast<std::uint64_t>((y * width + x) * samples + i));
  const auto number = [&] {
    const float value = random.uniform_float() - 0.2f;
    return std::ldexp(value, static_cast<int>(30.0f * random.uniform_float()) - 20);
  };
  CameraSample sample{.beauty = {number(), number(), number()},
                      .subsurface = {number(), 0.0f, number()},
                      .specular = {std::round(4096.0f * (random.uniform_float() - 0.5f)) / 4096.0f,
                                   number(), 1e-9f}};
  sample.is_hit = random.uniform_float() < 0.9f;
  sample.is_subsurface = sample.is_hit && x > 10;
  sample.normal = {0.6f, -0.8f * random.uniform_float(), 0.1f};
  sample.albedo = {random.uniform_float(), 0.5f, 0.25f};
  sample.depth = 300.0f * random.uniform_float();
  return sample;
}

FilmAccumulator film_of(const IndexRange& range) {
  FilmAccumulator film(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (auto i = range.begin; i < range.end; ++i)
        film.add(x, y, sample_of(x, y, static_cast<int>(i)));
  return film;
}

FilmShardInfo info_of(const Shard& shard) {
  return {.version = "1.2",
          .program = 5,
          .key = ~std::uint64_t{0},
          .method = "probe",
          .seed = 7,
          .width = width,
          .height = height,
          .samples = samples,
          .shards = shard.count,
          .ranges = {range_of(shard, samples)},
          .exposure = -0.5,
          .command = {"render", "a b'c.json"},
          .cpu_seconds = 1.5};
}

bool are_equal(const FilmAccumulator& merged, const FilmAccumulator& whole, int band) {
  const auto rows = whole.pixels().subspan(static_cast<std::size_t>(band * film_band_rows * width),
                                           merged.pixels().size());
  return std::ranges::equal(merged.pixels(), rows);
}

TEST_F(FilmShards, AddUpToTheWholeInAnyOrderAndByWayOfPartialSums) {
  const FilmAccumulator whole = film_of({0, samples});
  constexpr int count = 5;
  std::vector<FilmShard> shards;
  for (const int i : {3, 0, 4, 2, 1}) {
    const fs::path file = folder / (std::to_string(i) + ".shard");
    save_film_shard(file, info_of({i, count}), film_of(range_of({i, count}, samples)));
    shards.emplace_back(file);
  }
  EXPECT_EQ(shards[0].info().command, info_of({0, 1}).command);
  EXPECT_EQ(shards[0].info().exposure, -0.5);
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    for (int band = 0; band < film_bands(height); ++band)
      EXPECT_TRUE(are_equal(merged_band(shards, band), whole, band)) << "band " << band;
  }
  set_thread_count(0);

  const auto add = [&](std::span<const FilmShard> some, const std::string& name) {
    std::vector<FilmAccumulator> rows;
    save_film_shard(folder / name, merged_info(some), [&](int band) {
      rows.push_back(merged_band(some, band));
      return std::span<const FilmPixel>(rows.back().pixels());
    });
    return FilmShard(folder / name);
  };
  const std::vector<FilmShard> halves = {add(std::span(shards).subspan(2), "b.shard"),
                                         add(std::span(shards).first(2), "a.shard")};
  EXPECT_EQ(missing_shards(halves[1].info()), (std::vector{1, 2, 4}));
  const FilmShardInfo info = merged_info(halves);
  EXPECT_EQ(info.ranges, (std::vector{IndexRange{0, samples}}));
  EXPECT_EQ(info.cpu_seconds, 7.5);
  EXPECT_TRUE(missing_shards(info).empty());
  for (int band = 0; band < film_bands(height); ++band)
    EXPECT_TRUE(are_equal(merged_band(halves, band), whole, band)) << "band " << band;
}

TEST_F(FilmShards, OfColorsAloneHaveTheColorsNoiseAndCoverOfTheWhole) {
  save_film_shard(folder / "a.shard", info_of({0, 1}), film_of({0, samples}));
  const std::vector<FilmShard> shards = {FilmShard(folder / "a.shard")};
  const FilmAccumulator all = merged_band(shards, 1), colors = merged_band(shards, 1, true);
  const std::vector<std::string> channels = {"R", "G", "B", "samples", "variance"};
  EXPECT_EQ(select_channels(all.image(), channels).pixels,
            select_channels(colors.image(), channels).pixels);
  EXPECT_EQ(all.covers(), colors.covers());
  EXPECT_NE(all.image().pixels, colors.image().pixels);
}

TEST_F(FilmShards, AreRefusedByNameWhereTheyDoNotBelongTogether) {
  const FilmAccumulator film = film_of(range_of({1, 5}, samples));
  save_film_shard(folder / "a.shard", info_of({0, 5}), film_of(range_of({0, 5}, samples)));
  const auto refusal = [&](const std::function<void(FilmShardInfo&)>& change) -> std::string {
    FilmShardInfo info = info_of({1, 5});
    change(info);
    save_film_shard(folder / "b.shard", info, film);
    const std::vector<FilmShard> shards = {FilmShard(folder / "a.shard"),
                                           FilmShard(folder / "b.shard")};
    try {
      (void)merged_info(shards);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto names = [](const std::string& text, const std::string& part) {
    return text.find("b.shard") != std::string::npos && text.find(part) != std::string::npos;
  };
  EXPECT_EQ(refusal([](FilmShardInfo&) {}), "accepted");
  EXPECT_TRUE(names(refusal([](auto& info) { info.version = "1.3"; }), "version"));
  EXPECT_TRUE(names(refusal([](auto& info) { info.program = 6; }), "build"));
  EXPECT_TRUE(names(refusal([](auto& info) { info.key = 3; }), "scene"));
  EXPECT_TRUE(names(refusal([](auto& info) { info.seed = 8; }), "seed"));
  EXPECT_TRUE(names(refusal([](auto& info) { info.samples = 24; }), "samples"));
  EXPECT_TRUE(names(refusal([](auto& info) { info.shards = 6; }), "shards"));
  EXPECT_TRUE(names(refusal([](auto& info) { info.method = "hierarchy"; }), "method"));
  EXPECT_TRUE(names(refusal([](auto& info) {
                      info.ranges = {{3, 8}};
                    }),
                    "samples 3 to 3 must be given once"));
}

// A flipped bit is found when a file is opened, or where its rows are read; never a wrong sum.
TEST_F(FilmShards, AreRefusedWhereTheyAreDamaged) {
  const fs::path file = folder / "a.shard";
  save_film_shard(file, info_of({0, 5}), film_of(range_of({0, 5}, samples)));
  const std::string whole = read_file_bytes(file);
  const auto use = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    const std::vector<FilmShard> shards = {FilmShard(file)};
    (void)merged_info(shards);
    for (int band = 0; band < film_bands(height); ++band) (void)merged_band(shards, band);
  };
  EXPECT_NO_THROW(use(whole));
  for (std::size_t size = 0; size < whole.size(); size += size < 1000 ? 1 : 691)
    EXPECT_THROW(use(whole.substr(0, size)), FileError) << size << " bytes";
  EXPECT_THROW(use(whole + "x"), FileError);
  for (std::size_t at = 0; at < whole.size(); at += at < 600 ? 1 : 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    EXPECT_THROW(use(damaged), FileError) << "byte " << at;
  }
  std::string other_version = whole;
  other_version[14] = '1';
  EXPECT_THROW(use(other_version), FileError);
  EXPECT_TRUE(is_film_shard(file));
}

/// A sphere under a window, with nothing behind it.
Scene small_scene() {
  Scene scene;
  scene.film = {.width = 24, .height = 20};
  scene.camera = camera_above(10);
  scene.materials = {diffuse_material(0.5f)};
  scene.meshes = {make_sphere(3, 12)};
  scene.lights = {RectangleLight{
      .center = {5, 5, 20}, .edge_u = {4, 0, 0}, .edge_v = {0, 4, 0}, .radiance = {1, 1, 1}}};
  scene.render.samples_per_pixel = 11;
  scene.render.seed = 3;
  return scene;
}

TEST_F(FilmShards, OfARenderAddUpToItsPicture) {
  const Scene scene = small_scene();
  const RenderResult whole = render(scene);
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    std::vector<FilmShard> shards;
    for (const int i : {2, 0, 3, 1}) {
      const fs::path file = folder / (std::to_string(i) + ".shard");
      const RenderResult result =
          render(scene, {.part = RenderOptions::Part{{i, 4}, file, "1", {}}});
      EXPECT_TRUE(result.image.pixels.empty());
      shards.emplace_back(file);
    }
    EXPECT_TRUE(missing_shards(merged_info(shards)).empty());
    std::vector<float> pixels;
    for (int band = 0; band < film_bands(scene.film.height); ++band)
      std::ranges::copy(merged_band(shards, band).image().pixels, std::back_inserter(pixels));
    EXPECT_EQ(pixels, whole.image.pixels);
  }
  set_thread_count(0);
}

TEST_F(FilmShards, OfARenderGoOnFromTheirCheckpoint) {
  const Scene scene = small_scene();
  const RenderOptions::Part part{{1, 2}, folder / "a.shard", "1", {}};
  ASSERT_TRUE(render(scene, {.part = part}).statistics.is_complete);
  const std::string whole = read_file_bytes(part.file);
  fs::remove(part.file);
  const fs::path checkpoint = folder / "a.unfinished";
  const auto stop = [](double finished) { return finished < 0.5; };
  const RenderResult stopped = render(scene, {.checkpoint = checkpoint, .part = part}, stop);
  EXPECT_FALSE(stopped.statistics.is_complete);
  EXPECT_FALSE(fs::exists(part.file));
  const RenderOptions other{.checkpoint = checkpoint,
                            .resumes = true,
                            .part = RenderOptions::Part{{0, 2}, part.file, "1", {}}};
  EXPECT_THROW((void)render(scene, other), FileError);  // of another shard
  (void)render(scene, {.checkpoint = checkpoint, .resumes = true, .part = part});
  const std::vector<FilmShard> shards = {FilmShard(part.file)};
  const FilmAccumulator rows = merged_band(shards, 0);
  std::ofstream(folder / "b.shard", std::ios::binary) << whole;
  const std::vector<FilmShard> before = {FilmShard(folder / "b.shard")};
  EXPECT_TRUE(std::ranges::equal(rows.pixels(), merged_band(before, 0).pixels()));
}

TEST_F(FilmShards, OfARenderAreRefusedWhereTheyCannotBe) {
  Scene scene = small_scene();
  const auto shard = [&](Shard which) {
    return RenderOptions{.part = RenderOptions::Part{which, folder / "a.shard", "1", {}}};
  };
  EXPECT_THROW((void)render(scene, shard({0, 12})), InvalidInput);  // more than samples
  EXPECT_THROW((void)render(scene, shard({2, 2})), InvalidInput);
  scene.render.noise = 0.01f;
  EXPECT_THROW((void)render(scene, shard({0, 2})), InvalidInput);
}

}  // namespace
}  // namespace lamina
