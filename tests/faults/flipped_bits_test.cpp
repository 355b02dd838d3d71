// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Every bit of small files of each format in which lamina keeps work, flipped in turn: the file is
// refused, counts as missing, or gives the very same.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/render/film/film_shard.h"
#include "lamina/render/film/internal/checkpoint.h"
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "photons_report.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// What a file gives as text that differs where its values do; absent where it is not taken.
using Reader = std::function<std::optional<std::string>(const fs::path&)>;

class FlippedBits : public testing::Test {
 protected:
  FlippedBits() { fs::create_directories(folder); }
  ~FlippedBits() override { fs::remove_all(folder); }
  FlippedBits(const FlippedBits&) = delete;
  FlippedBits& operator=(const FlippedBits&) = delete;

  /// Flips all bits of `file`, which is whole, one at a time.
  static void check(const fs::path& file, const Reader& read) {
    const std::string whole = read_file_bytes(file);
    // One byte is written in place: to write the file anew waits for the disk.
    const auto put_byte = [&](std::size_t at, char byte) {
      std::fstream(file, std::ios::binary | std::ios::in | std::ios::out)
          .seekp(static_cast<std::streamoff>(at))
          .put(byte);
    };
    const auto given = [&]() -> std::optional<std::string> {
      try {
        return read(file);
      } catch (const Error&) {
        return {};
      }
    };
    const std::optional<std::string> good = given();
    ASSERT_TRUE(good.has_value());
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      const std::size_t at = bit / 8;
      put_byte(at, static_cast<char>(whole[at] ^ (1 << bit % 8)));
      const std::optional<std::string> result = given();
      if (result)
        EXPECT_EQ(*result, *good) << "bit " << bit % 8 << " of byte " << at;
      else
        ++refused;
      put_byte(at, whole[at]);
    }
    ASSERT_EQ(given(), good);
    std::printf("%zu bits flipped, %zu refused\n", 8 * whole.size(), refused);
    EXPECT_GT(refused, 7 * whole.size());
  }

  fs::path folder = fs::temp_directory_path() / ("lamina_flipped_bits_" + std::to_string(getpid()));
};

template <class T>
void put(std::string& text, const T& values) {
  const auto bytes = std::as_bytes(std::span(values));
  text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

FilmAccumulator small_film() {
  FilmAccumulator film(3, 2);
  for (int i = 0; i < 12; ++i) {
    const float value = 0.3f * static_cast<float>(i);
    film.add(i % 3, i / 3 % 2,
             {.beauty = {value, 1.0f, 0.1f}, .subsurface = {0.0f, value, 0.0f}, .is_hit = i > 2});
  }
  return film;
}

TEST_F(FlippedBits, OfCaches) {
  const DiskCache cache{folder / "cache"};
  ASSERT_TRUE(save_cached(cache, "key", "any value of some length"));
  const fs::path file = fs::directory_iterator(cache.folder)->path();
  check(file, [&](const fs::path&) { return load_cached(cache, "key"); });
}

TEST_F(FlippedBits, OfUnfinishedPictures) {
  const fs::path file = folder / "a.unfinished";
  save_checkpoint(file, 7, small_film(), {.from = 2, .samples = {2}, .is_quiet = {0}});
  check(file, [](const fs::path& name) -> std::optional<std::string> {
    FilmAccumulator film(3, 2);
    const std::optional<TileProgress> tiles = load_checkpoint(name, 7, film);
    if (!tiles) return {};
    std::string text = std::to_string(tiles->from);
    put(text, tiles->samples);
    put(text, tiles->is_quiet);
    put(text, film.image().pixels);
    return text;
  });
}

TEST_F(FlippedBits, OfShardsOfPictures) {
  const fs::path file = folder / "a.shard";
  const FilmShardInfo info{.version = "1.2",
                           .program = 5,
                           .key = 6,
                           .method = "probe",
                           .seed = 7,
                           .width = 3,
                           .height = 2,
                           .samples = 4,
                           .shards = 2,
                           .ranges = {{0, 2}},
                           .exposure = -0.5,
                           .command = {"render", "a.json"},
                           .cpu_seconds = 1.5};
  save_film_shard(file, info, small_film());
  check(file, [](const fs::path& name) -> std::optional<std::string> {
    const FilmShard shard(name);
    std::string text = merged_info({&shard, 1}).method;
    put(text, merged_band({&shard, 1}, 0).image().pixels);
    return text;
  });
}

TEST_F(FlippedBits, OfLightOnSurfaces) {
  const fs::path file = folder / "light.ply";
  const LightFingerprint made_for{
      .meshes = 1, .materials = 2, .maps = 3, .lights = 4, .settings = 5};
  const CloudPoint point{.position = {1, 2, 3},
                         .normal = {0, 0, 1},
                         .uv = {0.25f, 0.5f},
                         .area = 0.1f,
                         .albedo = {0.5f, 0.6f, 0.7f},
                         .thickness = std::numeric_limits<float>::infinity()};
  save_irradiance_clouds({{.material = 1,
                           .bands = 2,
                           .spacing = 0.3f,
                           .points = {point, point},
                           .irradiance = {1, 2, 3, 4}}},
                         {}, made_for, file);
  check(file, [&](const fs::path& name) -> std::optional<std::string> {
    const KeptClouds kept = load_irradiance_clouds(name, made_for);
    if (!kept.why_unusable.empty()) return {};
    const IrradianceCloud& cloud = kept.clouds.at(0);
    std::string text =
        std::to_string(kept.clouds.size() + 10 * cloud.material) + std::to_string(cloud.spacing);
    put(text, cloud.irradiance);
    for (const CloudPoint& p : cloud.points) {
      put(text, std::array{p.position.x, p.position.y, p.position.z, p.normal.x, p.normal.y,
                           p.normal.z, p.uv.x, p.uv.y, p.area, p.thickness});
      put(text, std::array{p.albedo.x, p.albedo.y, p.albedo.z});
    }
    return text;
  });
}

TEST_F(FlippedBits, OfSumsOfPhotons) {
  const fs::path file = folder / "photons.json";
  MonteCarloOptions options{.photons = 100};
  options.tallies.angles = 2;
  const LayerStack stack(
      {{.medium = {.sigma_a = 0.1, .sigma_s = 1.0, .g = 0.5, .ior = 1.4}, .thickness = 2.0}});
  cli::save_photon_runs(
      {{.name = "slab", .bands = {""}, .counts = {count_photons(stack, options)}}}, file.string());
  check(file, [](const fs::path& name) -> std::optional<std::string> {
    return cli::counts_json(cli::load_photon_runs(name, {})).text();
  });
}

}  // namespace
}  // namespace lamina
