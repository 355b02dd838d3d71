// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Small pictures, one for each kind of surface and each method of subsurface transport, against
// references within their noise: a net under changes that should not change pictures.
//
// The references were rendered by a version before the renderer's rooms were arranged, with the
// seeds 1 to 12 (image_reference.cpp). Where a picture should change, and only there, render it
// again so, and say in the commit why.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lamina/base/image/compare.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/scene.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

const fs::path folder = fs::path(LAMINA_SOURCE_DIR) / "tests/images";
constexpr double reference_renders = 12.0;
constexpr double significance = 1e-3;  // of each picture
constexpr int block = 4;               // pixels along a side

const std::vector<std::string> reference_channels = {"R",           "G",           "B",
                                                     "deviation.R", "deviation.G", "deviation.B"};

/// A channel in blocks of pixels, whose means are closer to normal than pixels are.
/// @param estimate_at  (x, y) gives mean and variance of a pixel
template <class EstimateAt>
RenderEstimate block_estimate(const Image& size, const EstimateAt& estimate_at) {
  constexpr double pixels = block * block;
  const Image empty = make_image(size.width / block, size.height / block, {"Y"});
  RenderEstimate blocks{empty, empty};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto [mean, variance] = estimate_at(x, y);
      *blocks.mean.at(x / block, y / block) += static_cast<float>(mean / pixels);
      *blocks.variance.at(x / block, y / block) += static_cast<float>(variance / (pixels * pixels));
    }
  return blocks;
}

ImageComparison compare_channel(const Image& picture, const Image& reference, std::size_t channel) {
  const auto expected = [&](int x, int y) {
    const auto mean = static_cast<double>(reference.at(x, y)[channel]);
    const auto deviation = static_cast<double>(reference.at(x, y)[3 + channel]);
    const double rounding = std::ldexp(mean, -12);  // references have 11 bits
    return std::pair(mean, deviation * deviation / reference_renders + rounding * rounding);
  };
  // A rare bright path in the picture shows in its own variance, whatever the reference has seen.
  const auto seen = [&](int x, int y) {
    const float* pixel = picture.at(x, y);
    const auto mean = static_cast<double>(pixel[channel]);
    const auto deviation = static_cast<double>(reference.at(x, y)[3 + channel]);
    const auto brightness = static_cast<double>(luminance({pixel[0], pixel[1], pixel[2]}));
    const double ratio = brightness > 0.0 ? mean / brightness : 0.0;
    return std::pair(
        mean, std::max(deviation * deviation, ratio * ratio * static_cast<double>(pixel[3])));
  };
  return compare_renders(block_estimate(picture, seen), block_estimate(picture, expected),
                         significance / 3.0);
}

/// Where the picture of a scene differs from the reference of that name; empty: nowhere.
std::string difference(Scene scene, const std::string& name) {
  scene.render.seed = 1000;
  const Image reference = select_channels(load_image(folder / (name + ".exr")), reference_channels);
  const Image picture = select_channels(render(scene).image, {"R", "G", "B", "variance"});
  for (std::size_t c = 0; c < 3; ++c) {
    const ImageComparison comparison = compare_channel(picture, reference, c);
    if (comparison.agrees) continue;
    const fs::path where = fs::temp_directory_path() / ("lamina_" + name);
    save_exr(picture, where.string() + ".exr");
    save_exr(comparison.p_values, where.string() + "_p_values.exr");
    return name + ", channel " + picture.channels[c] + ": " + comparison.report() + "; see " +
           where.string() + ".exr, " + where.string() + "_p_values.exr";
  }
  return {};
}

class Pictures : public testing::TestWithParam<const char*> {};

TEST_P(Pictures, AgreeWithTheirReferences) {
  const std::string name = GetParam();
  EXPECT_EQ(difference(load_scene(folder / (name + ".json")), name), "");
}

INSTANTIATE_TEST_SUITE_P(All, Pictures,
                         testing::Values("diffuse", "smooth_coat", "thin_sheet", "glass",
                                         "frosted_glass", "layered_bsdf", "layered_bsdf_walk",
                                         "probe", "probe_skin", "hierarchy", "shadow_map",
                                         "random_walk", "bodies"),
                         [](const auto& test) { return std::string(test.param); });

// The net is tight enough to catch light that is one part in twenty off.
TEST(PictureNet, FindsLightThatIsFivePercentBrighter) {
  for (const std::string name : {"diffuse", "probe", "hierarchy", "random_walk"}) {
    Scene scene = load_scene(folder / (name + ".json"));
    for (Light& light : scene.lights) {
      if (auto* rectangle = std::get_if<RectangleLight>(&light)) rectangle->radiance *= 1.05f;
      if (auto* point = std::get_if<PointLight>(&light)) point->intensity *= 1.05f;
      if (auto* environment = std::get_if<EnvironmentLight>(&light)) environment->scale *= 1.05f;
    }
    EXPECT_NE(difference(std::move(scene), name), "") << name;
  }
}

// It finds half a millimetre, a pixel or so, too.
TEST(PictureNet, FindsACameraThatMoved) {
  Scene scene = load_scene(folder / "glass.json");
  scene.camera.look_at.x += 0.5;
  EXPECT_NE(difference(std::move(scene), "glass"), "");
}

}  // namespace
}  // namespace lamina
