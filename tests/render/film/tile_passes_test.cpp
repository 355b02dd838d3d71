// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/tile_passes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/io/file_bytes.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// A file that is not there, and is not left there.
struct ScratchFile {
  fs::path path =
      fs::temp_directory_path() / ("lamina_checkpoint_" + std::to_string(getpid()) + ".unfinished");
  ScratchFile() { fs::remove(path); }
  ~ScratchFile() { fs::remove(path); }
};

/// Brightness 1 with noise that grows from nothing on the left to `noise` on the right.
CameraSample noisy_sample(int x, int y, int i, float noise) {
  const auto key = static_cast<std::uint64_t>((y * 1000 + x) * 4096 + i);
  Random random = make_random(7, key);
  const float value =
      1.0f + noise * static_cast<float>(x) / 64.0f * (2.0f * random.uniform_float() - 1.0f);
  return {.beauty = {value, value, value}, .is_hit = true};
}

TEST(TilePasses, StopAndResumeGiveTheSameImage) {
  const auto sample = [](int x, int y, int i) { return noisy_sample(x, y, i, 0.5f); };
  const ScratchFile file;
  TilePassOptions options{.samples = 40, .noise = 0.02f, .key = 5};
  FilmAccumulator whole(70, 50);
  ASSERT_TRUE(add_tile_passes(sample, options, {}, whole));

  options.checkpoint = file.path;
  options.resumes = true;
  int stops = 0;
  bool is_complete = false;
  FilmAccumulator last(1, 1);
  while (!is_complete && stops < 1000) {  // each time in a new film, after some more tiles
    FilmAccumulator film(70, 50);
    double first = -1.0;
    const auto stop_after_some = [&](double finished) {
      if (first < 0.0) first = finished;
      return finished < first + 0.02;
    };
    is_complete = add_tile_passes(sample, options, stop_after_some, film);
    EXPECT_EQ(fs::exists(file.path), !is_complete);
    stops += !is_complete;
    last = film;
  }
  EXPECT_GT(stops, 5);
  EXPECT_TRUE(std::ranges::equal(last.bytes(), whole.bytes()));
}

TEST(TilePasses, MoreSamplesMakeTheImageOfAllAtOnce) {
  const auto sample = [](int x, int y, int i) { return noisy_sample(x, y, i, 0.5f); };
  const ScratchFile file;
  FilmAccumulator once(70, 50);
  ASSERT_TRUE(add_tile_passes(sample, {.samples = 40, .key = 5}, {}, once));
  TilePassOptions options{
      .samples = 10, .checkpoint = file.path, .key = 5, .resumes = true, .keeps = true};
  FilmAccumulator film(70, 50);
  for (const int samples : {10, 13, 40}) {
    options.samples = samples;
    film = FilmAccumulator(70, 50);
    ASSERT_TRUE(add_tile_passes(sample, options, {}, film));
    EXPECT_EQ(film.least_samples(), samples);
  }
  EXPECT_TRUE(std::ranges::equal(film.pixels(), once.pixels()));
  options.samples = 39;
  EXPECT_THROW((void)add_tile_passes(sample, options, {}, film), FileError);
  options = {.samples = 50, .checkpoint = file.path, .key = 5, .light = 1, .resumes = true};
  EXPECT_THROW((void)add_tile_passes(sample, options, {}, film), FileError);
}

TEST(TilePasses, ShowWholeImagesWhileTheyGrow) {
  const auto sample = [](int, int, int i) {
    const timespec pause{.tv_nsec = i == 0 ? 0 : 20'000};
    nanosleep(&pause, nullptr);
    return CameraSample{.beauty = {1.0f, 1.0f, 1.0f}};
  };
  int shown = 0;
  float last = 0.0f;
  FilmAccumulator film(64, 64);
  const auto look = [&](const Image& image) {
    ++shown;
    const std::size_t of_samples = *channel_index(image, "samples");
    float sum = 0.0f;
    for (std::size_t at = 0; at < image.pixels.size(); at += image.channel_count()) {
      EXPECT_EQ(image.pixels[at], 1.0f);
      sum += image.pixels[at + of_samples];
    }
    EXPECT_GE(sum, last);
    last = sum;
  };
  const auto stop = [&](double) { return shown < 2; };
  EXPECT_FALSE(add_tile_passes(
      sample,
      {.samples = 1 << 20, .on_image = look, .between_images = std::chrono::duration<double>(0.1)},
      stop, film));
  EXPECT_GE(shown, 2);
}

TEST(TilePasses, NoiseEndsWhereItIsReached) {
  const auto sample = [](int x, int y, int i) { return noisy_sample(x, y, i, 2.0f); };
  FilmAccumulator film(128, 64);
  ASSERT_TRUE(add_tile_passes(sample, {.samples = 4096, .noise = 0.05f}, {}, film));
  const Image image = film.image();
  const std::size_t samples = channel_index(image, "samples").value();
  EXPECT_EQ(image.at(0, 0)[samples], 16.0f);
  // The standard deviation on the right is 2 * 2 / sqrt(3): 2100 samples for 5 %.
  EXPECT_GE(image.at(127, 32)[samples], 1700.0f);
  EXPECT_LE(image.at(127, 32)[samples], 3200.0f);
  for (int x = 0; x < 128; x += 16) {
    const auto [mean, variance] = film.luminance_of(x, 0, x + 16, 16);
    EXPECT_NEAR(mean, 1.0, 0.02);
    EXPECT_LE(std::sqrt(variance), 0.05 * std::max(mean, 0.25));
  }
}

TEST(TilePasses, RefusesWhatIsNoCheckpointOfThisImage) {
  const auto sample = [](int x, int y, int i) { return noisy_sample(x, y, i, 0.5f); };
  const ScratchFile file;
  const auto stop_soon = [](double finished) { return finished == 0.0; };
  FilmAccumulator film(70, 50);
  TilePassOptions options{.samples = 40, .checkpoint = file.path, .key = 5, .resumes = true};
  ASSERT_FALSE(add_tile_passes(sample, options, stop_soon, film));
  const auto resume = [&] { return add_tile_passes(sample, options, {}, film); };
  options.key = 6;
  EXPECT_THROW((void)resume(), FileError);
  options.key = 5;

  std::string bytes = read_file_bytes(file.path);
  const auto write = [&](const std::string& text) {
    std::ofstream(file.path, std::ios::binary) << text;
  };
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{20}, bytes.size() / 2, bytes.size() - 1}) {
    write(bytes.substr(0, size));
    EXPECT_THROW((void)resume(), FileError) << size << " bytes";
  }
  for (std::size_t at = 0; at < bytes.size(); at += at < 400 ? 1 : 997) {  // the header is small
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    write(damaged);
    EXPECT_THROW((void)resume(), FileError) << "byte " << at;
  }
  EXPECT_TRUE(fs::exists(file.path));
  write(bytes);
  EXPECT_TRUE(resume());
}

TEST(TilePasses, AreEqualForRendersThatWereStopped) {
  Scene scene;
  scene.film = {.width = 40, .height = 40};
  scene.camera = camera_above(10);
  scene.materials = {diffuse_material(0.5f)};
  scene.meshes = {make_sphere(3, 12)};
  scene.lights = {RectangleLight{
      .center = {5, 5, 20}, .edge_u = {4, 0, 0}, .edge_v = {0, 4, 0}, .radiance = {1, 1, 1}}};
  scene.render.samples_per_pixel = 5;
  const ScratchFile file;
  const RenderResult whole = render(scene);
  const auto stop_late = [](double finished) { return finished < 0.3; };
  const RenderResult stopped = render(scene, {.checkpoint = file.path}, stop_late);
  ASSERT_FALSE(stopped.statistics.is_complete);
  const RenderResult resumed = render(scene, {.checkpoint = file.path, .resumes = true});
  EXPECT_TRUE(resumed.statistics.is_complete);
  EXPECT_EQ(resumed.image.pixels, whole.image.pixels);

  ASSERT_FALSE(fs::exists(file.path));
  (void)render(scene, {.checkpoint = file.path}, stop_late);
  ASSERT_TRUE(fs::exists(file.path));
  scene.camera.position.x += 1.0;
  EXPECT_THROW((void)render(scene, {.checkpoint = file.path, .resumes = true}), FileError);
}

// A black picture, or one with black tiles, is no picture.
TEST(TilePasses, MakeNoPictureBeforeEveryPixelHasASample) {
  Scene scene;
  scene.film = {.width = 64, .height = 64};
  scene.camera = camera_above(10);
  scene.lights = {EnvironmentLight{}};
  scene.render.samples_per_pixel = 8;
  const ScratchFile file;
  const auto stop_at = [&](double least) {
    return [=](double finished) { return finished < least; };
  };
  EXPECT_THROW((void)render(scene, {.checkpoint = file.path}, stop_at(0.0)), Interrupted);
  EXPECT_FALSE(fs::exists(file.path));  // there is nothing to go on from
  set_thread_count(1);                  // else all sixteen tiles may be in work at once
  EXPECT_THROW((void)render(scene, {.checkpoint = file.path}, stop_at(0.01)), Interrupted);
  set_thread_count(0);
  EXPECT_TRUE(fs::exists(file.path));
  const RenderResult resumed = render(scene, {.checkpoint = file.path, .resumes = true});
  EXPECT_EQ(resumed.image.pixels, render(scene).image.pixels);
}

// However long the tiles take, a stop is heard within a row of pixels.
TEST(TilePasses, HearAStopWithinATile) {
  std::atomic<int> samples = 0;
  const auto sample = [&](int x, int y, int i) {
    ++samples;
    return noisy_sample(x, y, i, 0.5f);
  };
  FilmAccumulator film(16, 16);  // one tile
  const auto stop_soon = [&](double) { return samples < 100; };
  EXPECT_FALSE(add_tile_passes(sample, {.samples = 1000}, stop_soon, film));
  EXPECT_LE(samples, 100 + 16);
}

}  // namespace
}  // namespace lamina
