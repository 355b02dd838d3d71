// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class TransferProfileCacheTest : public testing::Test {
 protected:
  ~TransferProfileCacheTest() override { fs::remove_all(cache.folder); }
  DiskCache cache{fs::temp_directory_path() / ("lamina profiles " + std::to_string(getpid()))};
  std::vector<Layer> layers = {
      {.medium = {.sigma_a = 1.0, .sigma_s = 9.0, .ior = 1.4}, .thickness = 0.3}};
  RadialGrid grid{.first = 0.01, .last = 10.0, .size = 20};
  TransferProfileOptions options{.accuracy = 0.1};
};

TEST_F(TransferProfileCacheTest, GivesBackEveryDigit) {
  const std::vector<LayerStack> stacks = {LayerStack(layers)};
  const auto solved = cached_transfer_profile(cache, stacks, grid, options);
  const auto kept = cached_transfer_profile(cache, stacks, grid, options);
  EXPECT_FALSE(solved.was_cached);
  EXPECT_TRUE(kept.was_cached);
  const TransferProfile &a = solved.result, &b = kept.result;
  EXPECT_EQ(a.profile.per, b.profile.per);
  EXPECT_EQ(a.profile.bands, b.profile.bands);
  EXPECT_EQ(a.profile.r, b.profile.r);
  EXPECT_EQ(a.profile.reflectance_profile, b.profile.reflectance_profile);
  EXPECT_EQ(a.profile.transmittance_profile, b.profile.transmittance_profile);
  EXPECT_EQ(a.profile.total_reflectance, b.profile.total_reflectance);
  EXPECT_EQ(a.profile.total_transmittance, b.profile.total_transmittance);
  EXPECT_EQ(a.relative_error, b.relative_error);
  EXPECT_EQ(a.estimated_error, b.estimated_error);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.modes, b.modes);
  EXPECT_EQ(a.is_accurate, b.is_accurate);
  EXPECT_FALSE(cached_transfer_profile(std::nullopt, stacks, grid, options).was_cached);
}

TEST_F(TransferProfileCacheTest, GivesBackEveryDigitOfSlabs) {
  layers.front().thickness = std::numeric_limits<double>::infinity();
  const LayerStack stack(layers, 1.0, 1.4);
  const ThicknessRange range{.thinnest = 0.1, .thickest = 0.3};
  const auto solved = cached_thickness_profiles(cache, {&stack, 1}, range, grid);
  const auto kept = cached_thickness_profiles(cache, {&stack, 1}, range, grid, [](double) {
    return false;  // nothing is left to interrupt
  });
  EXPECT_EQ(solved.thickness, kept.thickness);
  ASSERT_EQ(kept.slabs.size(), 4u);
  EXPECT_EQ(solved.half_space.reflectance_profile, kept.half_space.reflectance_profile);
  for (std::size_t s = 0; s < kept.slabs.size(); ++s) {
    EXPECT_EQ(solved.slabs[s].transmittance_profile, kept.slabs[s].transmittance_profile);
    EXPECT_EQ(solved.slabs[s].total_reflectance, kept.slabs[s].total_reflectance);
  }
  const auto ends = [&](const ThicknessRange& other) {
    return cached_thickness_profiles(cache, {&stack, 1}, other, grid).slabs.size();
  };
  EXPECT_EQ(ends({.thinnest = 0.1, .thickest = 0.2}), 2u);
  EXPECT_EQ(ends({.thinnest = 0.05, .thickest = 0.09}), 2u);
}

TEST_F(TransferProfileCacheTest, SolvesAgainWhatIsDamaged) {
  const std::vector<LayerStack> stacks = {LayerStack(layers)};
  const TransferProfile right = cached_transfer_profile(cache, stacks, grid, options).result;
  const fs::path file = fs::directory_iterator(cache.folder)->path();
  const std::string whole = read_file_bytes(file);
  for (std::size_t at = 5; at < whole.size(); at += whole.size() / 6) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x04);
    write_file_bytes(file, std::as_bytes(std::span(damaged)));
    const auto solved = cached_transfer_profile(cache, stacks, grid, options);
    EXPECT_FALSE(solved.was_cached) << at;
    EXPECT_EQ(solved.result.profile.reflectance_profile, right.profile.reflectance_profile) << at;
  }
}

// What is kept for one question must not answer another.
TEST_F(TransferProfileCacheTest, TellsAllQuestionsApart) {
  const auto is_known = [&](const LayerStack& stack) {
    return cached_transfer_profile(cache, std::vector{stack}, grid, options).was_cached;
  };
  EXPECT_FALSE(is_known(LayerStack(layers)));
  EXPECT_FALSE(is_known(LayerStack(layers, 1.1)));
  EXPECT_FALSE(is_known(LayerStack(layers, 1.0, 1.1)));
  EXPECT_FALSE(is_known(LayerStack(layers, 1.0, 1.0, {.reflectance = 0.5})));
  for (double* value : {&layers[0].medium.sigma_a, &layers[0].medium.sigma_s, &layers[0].medium.g,
                        &layers[0].medium.ior, &layers[0].thickness}) {
    *value += 1e-3;
    EXPECT_FALSE(is_known(LayerStack(layers)));
  }
  layers[0].medium.g = 0.0;
  EXPECT_FALSE(is_known(LayerStack(layers)));
  layers[0].phase = Rayleigh{};
  EXPECT_FALSE(is_known(LayerStack(layers)));
  layers[0].phase = PhaseMixture{{{0.5, Rayleigh{}}, {0.5, HenyeyGreenstein{}}}};
  EXPECT_FALSE(is_known(LayerStack(layers)));
  layers.push_back(layers[0]);
  EXPECT_FALSE(is_known(LayerStack(layers)));
  grid.size = 21;
  EXPECT_FALSE(is_known(LayerStack(layers)));
  options.accuracy = 0.09;
  EXPECT_FALSE(is_known(LayerStack(layers)));
  EXPECT_TRUE(is_known(LayerStack(layers)));
}

}  // namespace
}  // namespace lamina
