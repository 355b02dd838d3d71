// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/corrected_transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

/// A ball of skin1 of 10 mm in light of radiance 1 all around, over the flat profile.
Scene ball_to_correct(double density) {
  Material skin = find_material("jensen_skin1");
  MaterialLayer& layer = skin.layers[0];
  layer.ior = skin.ior_below = {1.33, 1.33, 1.33};
  for (double& sigma : layer.sigma_a) sigma *= density;
  for (double& sigma : layer.sigma_s) sigma *= density;
  Scene scene;
  scene.camera = camera_above(20.0);
  scene.film = {.width = 64, .height = 64};
  scene.render.method = RenderSettings::Method::hierarchy;
  scene.render.profile = RenderSettings::Profile::diffusion;
  scene.render.is_corrected = true;
  scene.render.samples_per_pixel = 4;
  scene.materials = {{.name = "skin", .surface = SubsurfaceSurface{.material = std::move(skin)}}};
  scene.meshes = {make_sphere(10.0f, 96)};
  scene.meshes[0].is_closed = true;
  scene.lights = {EnvironmentLight{}};
  return scene;
}

// What photons one by one find (random_walk_test.cpp). The flat profile has .50 .23 .12 and is off
// by up to a tenth. The walks of a picture of this size know the mean to .3 %.
TEST(CorrectedTransport, BallOfSkinHasTheAlbedoOfPhotons) {
  const double expected[2][3] = {{0.5447, 0.2399, 0.1220}, {0.4258, 0.2061, 0.1115}};
  for (int dense = 0; dense < 2; ++dense) {
    Scene scene = ball_to_correct(dense == 0 ? 1.0 : 10.0);
    scene.film = {.width = 128, .height = 128};
    const RenderResult result = render(scene);
    const char* names[] = {"subsurface.R", "subsurface.G", "subsurface.B"};
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(4.0 / std::numbers::pi *
                      mean_of(result.image, channel_index(result.image, names[c]).value()),
                  expected[dense][c], 0.01 * expected[dense][c])
          << dense << ' ' << c;
    ASSERT_EQ(result.statistics.corrections.size(), 1u);
    EXPECT_GT(result.statistics.corrections[0].walks, 10'000u);
    EXPECT_LT(result.statistics.corrections[0].error_left, 0.1);
  }
}

/// Light from below the surface over that of the planar method, where a camera sees a ball of 10 mm
/// around the origin.
class RatioPicture {
 public:
  RatioPicture(Scene scene, double angle) : film_(scene.film), camera_(scene.camera) {
    camera_.position = {0.0, length(camera_.position) * std::sin(angle),
                        length(camera_.position) * std::cos(angle)};
    camera_.up = {1.0, 0.0, 0.0};
    scene.camera = camera_;
    corrected_ = render(scene).image;
    scene.render.is_corrected = false;
    planar_ = render(scene).image;
  }
  /// Linear between pixels, of one channel; nothing where the point is not seen well.
  [[nodiscard]] std::optional<double> at(const Vec3& point, const std::string& channel) const {
    const Vec3 view = normalize(camera_.position), y = normalize(cross(view, camera_.up));
    const Vec3 from_eye = point - camera_.position;
    if (dot(from_eye, point) > -0.3 * length(from_eye) * length(point)) return {};
    const double pixel = 2.0 * std::tan(0.5 * camera_.horizontal_fov) / film_.width;
    const double scale = 1.0 / (-dot(from_eye, view) * pixel);
    const double right = -scale * dot(from_eye, y) + 0.5 * film_.width - 0.5;
    const double down = -scale * dot(from_eye, camera_.up) + 0.5 * film_.height - 0.5;
    const double column = std::floor(right), row = std::floor(down);
    const std::size_t c = channel_index(planar_, channel).value();
    const auto ratio = [&](double x, double y_of_pixel) {
      const auto i = static_cast<int>(x), j = static_cast<int>(y_of_pixel);
      return static_cast<double>(corrected_.at(i, j)[c] / planar_.at(i, j)[c]);
    };
    const double fx = right - column, fy = down - row;
    return (1.0 - fy) * ((1.0 - fx) * ratio(column, row) + fx * ratio(column + 1.0, row)) +
           fy * ((1.0 - fx) * ratio(column, row + 1.0) + fx * ratio(column + 1.0, row + 1.0));
  }

 private:
  Film film_;
  Camera camera_;
  Image corrected_, planar_;
};

/// Root mean square over points of a ball of how pictures differ there, over their mean.
double difference(const RatioPicture& a, const RatioPicture& b, const std::string& channel) {
  double squares = 0.0, sum = 0.0, count = 0.0;
  for (int i = 0; i < 3000; ++i) {  // a Fibonacci lattice
    const double z = 1.0 - 2.0 * (i + 0.5) / 3000.0, turn = 2.39996 * i;
    const double across = std::sqrt(1.0 - z * z);
    const Vec3 point = 10.0 * Vec3{across * std::cos(turn), across * std::sin(turn), z};
    const auto at_a = a.at(point, channel), at_b = b.at(point, channel);
    if (!at_a || !at_b) continue;
    squares += (*at_a - *at_b) * (*at_a - *at_b);
    sum += *at_a;
    ++count;
  }
  EXPECT_GT(count, 500.0);
  return std::sqrt(squares * count) / sum;
}

// A camera that turns by a degree finds nearly the same correction on the surface. By another seed
// it differs by the error of its walks, which it would for any camera if places were strewn anew.
TEST(CorrectedTransport, StandsStillWhenTheCameraTurns) {
  Scene scene = ball_to_correct(1.0);
  scene.film = {.width = 40, .height = 40};
  scene.render.hierarchy = {.spacing = 1.0f, .irradiance_samples = 4};
  scene.lights.push_back(RectangleLight{.center = {-20.0, 15.0, 25.0},
                                        .edge_u = {0.0, 10.0, 0.0},
                                        .edge_v = {10.0, 0.0, 0.0},
                                        .radiance = {50.0f, 50.0f, 50.0f}});
  const RatioPicture before(scene, 0.0), turned(scene, 0.0175);
  scene.render.seed = 7;
  const RatioPicture other(scene, 0.0);
  for (const char* channel : {"subsurface.R", "subsurface.G", "subsurface.B"}) {
    const double by_turn = difference(before, turned, channel);
    const double by_seed = difference(before, other, channel);
    EXPECT_LT(by_turn, 0.005) << channel;
    EXPECT_LT(by_turn, 0.5 * by_seed) << channel;
  }
}

// Light that is kept without a correction gets one, beside it; then nothing is made anew.
TEST(CorrectedTransport, IsKeptWithTheLight) {
  Scene scene = ball_to_correct(1.0);
  scene.film = {.width = 8, .height = 8};
  scene.render.hierarchy = {.spacing = 1.0f, .irradiance_samples = 2};
  RenderOptions options{.cache = std::filesystem::path(testing::TempDir()) / "correction.ply"};
  std::filesystem::remove(options.cache);
  scene.render.is_corrected = false;
  const Image planar = render(scene, options).image;
  scene.render.is_corrected = true;
  std::vector<std::string> notices;
  options.on_notice = [&](const std::string& line) {
    if (line.find("anew") != std::string::npos) notices.push_back(line);
  };
  const RenderResult made = render(scene, options);
  EXPECT_EQ(notices.size(), 1u);
  options.needs_cache = true;
  const RenderResult kept = render(scene, options);
  EXPECT_EQ(notices.size(), 1u);
  EXPECT_EQ(made.image.pixels, kept.image.pixels);
  EXPECT_EQ(made.statistics.corrections[0].walks, kept.statistics.corrections[0].walks);
  scene.render.is_corrected = false;
  EXPECT_EQ(render(scene, options).image.pixels, planar.pixels);
}

// Progress goes up while light is corrected. Asked to stop meanwhile, the ratios so far make a
// picture, of few samples.
TEST(CorrectedTransport, MakesAPictureOfTheWalksSoFar) {
  Scene scene = ball_to_correct(1.0);
  scene.film = {.width = 16, .height = 16};
  scene.render.hierarchy = {.spacing = 1.0f, .irradiance_samples = 2};
  scene.render.samples_per_pixel = 16;
  set_thread_count(1);
  double last = 0.0;
  const RenderResult result = render(scene, {}, [&](double finished) {
    EXPECT_GE(finished, 0.98 * last);
    last = finished;
    return finished < 0.4;
  });
  set_thread_count(0);
  EXPECT_FALSE(result.statistics.is_complete);
  EXPECT_EQ(result.statistics.samples_per_pixel, 4.0);
  ASSERT_EQ(result.statistics.corrections.size(), 1u);
  EXPECT_GT(result.statistics.corrections[0].share, 0.1);
  EXPECT_LT(result.statistics.corrections[0].share, 0.9);
  EXPECT_GT(result.statistics.corrections[0].walks, 10'000u);
}

/// Of a ball in which light hardly gets round, in light of radiance 1 all around.
void expect_flat_reflectance(const Scene& scene, double error) {
  const Material& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  const Image image = render(scene).image;
  const char* names[] = {"subsurface.R", "subsurface.G", "subsurface.B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const double flat =
        adding_doubling(layer_stack(skin, c), {.is_diffuse = true}, {.accuracy = 1e-4})
            .totals.diffuse_reflectance;
    EXPECT_NEAR(4.0 / std::numbers::pi * mean_of(image, channel_index(image, names[c]).value()),
                flat, error * flat)
        << c;
  }
}

// Walks take a rough boundary as smooth, and flat layers make up for it: by them the ball, in which
// light hardly gets round, reflects 5 to 9 % more than under a smooth one.
TEST(CorrectedTransport, HasTheLightOfRoughBoundaries) {
  Scene scene = ball_to_correct(20.0);
  Material& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  skin.layers[0].top.roughness = 0.4;
  expect_flat_reflectance(scene, 0.02);
}

// Walks through maps take light as scattered evenly after some events, in layers of one index. If
// all of it were, the ball, in which light hardly gets round, would be up to 15 % brighter.
TEST(CorrectedTransport, HasTheLightOfMapsThatScatterForward) {
  Scene scene = ball_to_correct(1.0);
  Material& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  skin = material_of({layer_of({0.45, 1.16, 3.16}, {14.2, 17.3, 27.0}, 0.77, 0.25),
                      layer_of({0.01, 0.1, 1.18}, {7.1, 8.7, 13.5}, 0.77, infinite)});
  skin.layers[1].ior = skin.ior_below = {1.38, 1.38, 1.38};
  MaterialMap thickness{{.of = MappableNumber::Of::thickness, .layer = 0}, make_image(4, 2, {"Y"})};
  for (float& value : thickness.values.pixels) value = 0.25f;
  std::get<SubsurfaceSurface>(scene.materials[0].surface).material_maps = {thickness};
  scene.render.method = RenderSettings::Method::texture_space;
  scene.render.profile.reset();
  scene.meshes = {make_sphere(60.0f, 96)};
  scene.meshes[0].is_closed = true;
  scene.camera = camera_above(120.0);
  expect_flat_reflectance(scene, 0.035);
}

// Whoever computes it, and however many.
TEST(CorrectedTransport, IsTheSameByAnyNumberOfThreads) {
  Scene scene = ball_to_correct(1.0);
  scene.film = {.width = 8, .height = 8};
  scene.render.hierarchy = {.spacing = 1.0f, .irradiance_samples = 2};
  const Image many = render(scene).image;
  set_thread_count(1);
  const Image one = render(scene).image;
  set_thread_count(0);
  EXPECT_EQ(one.pixels, many.pixels);
}

TEST(CorrectedTransport, RefusesWhatRandomWalksCannotFollow) {
  Scene scene = ball_to_correct(1.0);
  scene.meshes[0].is_closed = false;
  try {
    (void)render(scene);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("render.correct: "), std::string::npos)
        << error.what();
  }
  scene = ball_to_correct(1.0);
  scene.render.single_scattering = RenderSettings::SingleScattering::straight;
  EXPECT_THROW((void)render(scene), InvalidInput);
  scene = ball_to_correct(1.0);
  scene.render.method = RenderSettings::Method::probe;
  EXPECT_THROW((void)render(scene), InvalidInput);
}

}  // namespace
}  // namespace lamina
