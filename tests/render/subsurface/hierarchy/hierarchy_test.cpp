// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/render/subsurface/hierarchy/internal/inner_blockers.h"
#include "lamina/render/subsurface/hierarchy/internal/irradiance_tree.h"
#include "lamina/render/subsurface/profiles/gather_table.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// A mesh of the material in even light.
Scene scene_of(Mesh mesh, Material material) {
  return translucent_scene(RenderSettings::Method::hierarchy, std::move(mesh), std::move(material),
                           EnvironmentLight{});
}

TEST(SurfaceCells, ShareOutTheWholeSurface) {
  const std::vector<Mesh> meshes = {make_sphere(5.0f, 24)};
  const SurfaceCells cells = make_surface_cells(meshes, 0, 0.4f, 7);
  const double area = surface_area(meshes, 0);
  EXPECT_NEAR(area, 4.0 * std::numbers::pi * 25.0, 0.01 * area);  // facets lie within the sphere
  EXPECT_NEAR(cells.area, area, 1e-4 * area);
  // The spacing is the square root of a cell's mean area.
  EXPECT_NEAR(static_cast<double>(cells.cells.size()), area / 0.16, 0.05 * area / 0.16);
  double of_elements = 0.0, largest = 0.0;
  for (const SurfaceCell& cell : cells.cells) {
    for (const SurfaceElement& e : cells.elements_of(cell))
      of_elements += static_cast<double>(e.area);
    largest = std::max(largest, static_cast<double>(cell.area));
    EXPECT_NEAR(length(cell.position), 5.0f, 0.05f);
    EXPECT_GT(dot(cell.normal, normalize(cell.position)), 0.98f);
  }
  EXPECT_NEAR(of_elements, area, 1e-4 * area);
  EXPECT_LT(largest, 2.5 * 0.16);  // blue noise: no cell is much larger than the others
}

TEST(SurfaceCells, AreTheSameOnAnyNumberOfThreads) {
  const std::vector<Mesh> meshes = {make_sphere(5.0f, 24)};
  set_thread_count(1);
  const SurfaceCells one = make_surface_cells(meshes, 0, 0.2f, 7);
  set_thread_count(2);
  const SurfaceCells two = make_surface_cells(meshes, 0, 0.2f, 7);
  set_thread_count(0);
  ASSERT_EQ(one.cells.size(), two.cells.size());
  ASSERT_GT(one.cells.size(), 5000u);  // several batches
  for (std::size_t i = 0; i < one.cells.size(); ++i) {
    const SurfaceCell &a = one.cells[i], &b = two.cells[i];
    ASSERT_TRUE(a.position.x == b.position.x && a.position.y == b.position.y &&
                a.position.z == b.position.z && a.area == b.area && a.first == b.first &&
                a.count == b.count)
        << i;
  }
  for (std::size_t i = 0; i < one.elements.size(); ++i) {
    const SurfaceElement &a = one.elements[i], &b = two.elements[i];
    ASSERT_TRUE(a.mesh == b.mesh && a.triangle == b.triangle && a.u == b.u && a.v == b.v) << i;
  }
}

std::vector<IrradianceSample<4>> random_samples(int count) {
  Random random(3);
  std::vector<IrradianceSample<4>> samples;
  for (int i = 0; i < count; ++i) {
    const float z = 2.0f * random.uniform_float() - 1.0f, phi = 2.0f * pi * random.uniform_float();
    const float s = std::sqrt(1.0f - z * z);
    const Vec3f n{s * std::cos(phi), s * std::sin(phi), z};
    IrradianceSample<4> sample{.position = 10.0f * n, .normal = n, .area = 0.05f};
    for (int b = 0; b < 4; ++b) sample.irradiance[b] = std::max(n.z, 0.0f) + 0.1f;
    samples.push_back(sample);
  }
  return samples;
}

/// Mean brightness of a ball of the material in a band, seen from above, with an opaque ball
/// inside.
double ball_with_core(Scene scene, float radius, float core_radius, float core_height,
                      float reflectance, std::size_t band) {
  scene.meshes = {make_sphere(radius, 24), make_sphere(core_radius, 16, 1)};
  scene.materials.push_back(diffuse_material(reflectance));
  for (Vec3f& p : scene.meshes[1].positions) p.z += core_height;
  return mean_of(render(scene).image, band);
}

// A black ball inside takes light away, most where it is near; a white one takes less, and one
// outside has nothing to do with the light inside.
TEST(Hierarchy, OpaqueObjectsInsideStopLight) {
  const Scene scene = scene_of(make_square(1.0f), half_space({0.02, 0.02, 0.02}, 1.0, 1.3));
  const auto brightness = [&](float reflectance, float center) {
    return ball_with_core(scene, 6.0f, 2.0f, center, reflectance, 1);
  };
  const double without = brightness(0.0f, -40.0f), far = brightness(0.0f, -2.0f);
  EXPECT_EQ(brightness(1.0f, -40.0f), without);
  EXPECT_LT(far, 0.99 * without);
  const double near = brightness(0.0f, 3.0f);
  EXPECT_LT(near, 0.97 * far);
  EXPECT_GT(near, 0.2 * without);
  EXPECT_GT(brightness(1.0f, 3.0f), 1.2 * near);
}

// Light from behind: what share of it a ball inside leaves, against paths that are followed.
TEST(Hierarchy, OpaqueObjectsInsideStopLightFromBehindAsPathsShow) {
  Scene scene = scene_of(make_square(1.0f), half_space({0.02, 0.02, 0.02}, 1.0, 1.3));
  scene.camera = camera_above(4.0);
  scene.lights = {RectangleLight{
      .center = {0, 0, -40}, .edge_u = {40, 0, 0}, .edge_v = {0, 40, 0}, .radiance = {8, 8, 8}}};
  const auto share = [&](float reflectance) {
    return ball_with_core(scene, 6.0f, 2.5f, 0.0f, reflectance, 0) /
           ball_with_core(scene, 6.0f, 2.5f, -80.0f, reflectance, 0);
  };
  // By random_walk with 256 samples of 150 pixels: 0.36 and 0.54, standard error 0.01.
  EXPECT_NEAR(share(0.0f), 0.36, 0.08);
  EXPECT_NEAR(share(0.7f), 0.54, 0.08);
  // What is lost through the surface of the ball counts most where light is absorbed: 0.47.
  std::get<SubsurfaceSurface>(scene.materials[0].surface).material.layers[0].sigma_a = {0.1, 0.1,
                                                                                        0.1};
  EXPECT_NEAR(share(0.0f), 0.47, 0.08);
}

// What would come to a place where there is nothing to stop it: no patch, no change.
TEST(InnerBlockers, FarFromTheLightTakeNothing) {
  const auto samples = random_samples(500);
  const IrradianceTree<4> tree(samples);
  const DiffusionMedium<4> medium =
      make_diffusion_medium<4>(half_space({0.02, 0.1, 0.5}, 1.0, 1.3));
  EXPECT_TRUE(InnerBlockers<4>({}, {}, medium, tree, 0.1f).empty());
  std::vector<InnerBlockers<4>::Patch> ball;
  for (const IrradianceSample<4>& s : random_samples(200))
    ball.push_back({.position = 0.2f * s.position,
                    .normal = s.normal,
                    .area = 4.0f * pi * 4.0f / 200.0f,
                    .reflectance = BandValues<4>::filled(0.1f)});
  const InnerBlockers<4> blockers(ball, {}, medium, tree, 0.05f);
  const Vec3f top{0, 0, 1};
  const BandValues<4> share = blockers.unblocked_fraction(10.0f * top, top, tree);
  for (int b = 0; b < 3; ++b) {
    EXPECT_GT(share[b], 0.8f) << b;  // of light that is near, the ball is 8 mm below
    EXPECT_LE(share[b], 1.001f) << b;
  }
  EXPECT_LT(share[0], share[2]);
}

TEST(SurfaceCells, DoNotReachAroundAnEdge) {
  // A plate thinner than the spacing: front and back keep cells of their own.
  Mesh plate = make_square(10.0f);
  for (std::size_t i = 0; i < 4; ++i) {
    plate.positions.push_back(plate.positions[i] - Vec3f{0, 0, 0.01f});
    plate.normals.push_back({0, 0, -1});
    plate.uvs.push_back(plate.uvs[i]);
  }
  plate.triangles.push_back({4, 6, 5});
  plate.triangles.push_back({4, 7, 6});
  plate.material.assign(4, 0);
  const SurfaceCells cells = make_surface_cells({plate}, 0, 0.5f, 1);
  double front = 0.0;
  for (const SurfaceCell& cell : cells.cells) {
    EXPECT_NEAR(std::abs(cell.normal.z), 1.0f, 1e-5f);
    if (cell.normal.z > 0.0f) front += static_cast<double>(cell.area);
  }
  EXPECT_NEAR(front, 100.0, 1e-2);
}

// The profile of a point source near the surface; power alone at d = 0.
float point_source(float d2) { return std::exp(-0.5f * std::sqrt(d2)) / (d2 + 0.2f); }

float gathered(const IrradianceTree<4>& tree, const Vec3f& point, float error) {
  float total = 0.0f;
  tree.gather(point, 1e3f, error, 0.4f,
              [&](const auto& node, const BandValues<4>&, const Vec3f&, float d2) {
                total += point_source(d2) * node.power[0];
              });
  return total;
}

TEST(IrradianceTree, SumsNodesAsItWouldTheirSamples) {
  const auto samples = random_samples(20'000);
  const IrradianceTree<4> tree(samples);
  for (const Vec3f& point : {Vec3f{0, 0, 10}, Vec3f{7, 0, 7.1f}, Vec3f{0, -10, 0}}) {
    double exact = 0.0;
    for (const auto& s : samples) {
      const Vec3f offset = s.position - point;
      exact += static_cast<double>(s.area * s.irradiance[0] * point_source(dot(offset, offset)));
    }
    EXPECT_NEAR(gathered(tree, point, 1e-6f), exact, 1e-4 * exact);  // every sample by itself
    EXPECT_NEAR(gathered(tree, point, 0.06f), exact, 5e-3 * exact);
  }
}

TEST(IrradianceTree, ReachesNoFurtherThanAsked) {
  const IrradianceTree<4> tree(random_samples(5'000));
  tree.gather({0, 0, 10}, 3.0f, 1e-6f, 0.1f,
              [&](const auto&, const BandValues<4>&, const Vec3f&, float d2) {
                EXPECT_LE(d2, 9.0f * 1.0001f);
              });
}

TEST(IrradianceTree, TakesSamplesAtOnePlaceAndNone) {
  std::vector<IrradianceSample<4>> samples(9, random_samples(1)[0]);
  const IrradianceTree<4> tree(samples);
  const float one = samples[0].area * samples[0].irradiance[0] * point_source(0.0f);
  EXPECT_NEAR(gathered(tree, samples[0].position, 1e-6f), 9.0f * one, 1e-4f * one);
  EXPECT_EQ(gathered(IrradianceTree<4>(std::span<const IrradianceSample<4>>{}), {}, 0.1f), 0.0f);
}

TEST(RadialTable, IsALineInTheSquareOfTheRadius) {
  RadialTable<4> table(1e-4f, 100.0f);
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = BandValues<4>::filled(3.0f * table.node_r2(i) + 1.0f);
  for (const float r2 : {2e-4f, 0.03f, 1.0f, 77.0f})
    EXPECT_NEAR(table.at(r2)[0], 3.0f * r2 + 1.0f, 1e-5f * (3.0f * r2 + 1.0f)) << r2;
  EXPECT_EQ(table.at(0.0f)[0], table[0][0]);
}

// Spreading a profile keeps what it reflects, and changes nothing far from its middle. A profile
// much narrower than the blur turns into the Gaussian itself.
TEST(GatherTable, SpreadsAProfileByAGaussian) {
  const Profile wide = diffusion_profile(half_space({0.01, 0.3, 3.0}, 10.0, 1.4));
  const ProfileTable<4> from(wide, make_radius_grid({wide}), BandValues<4>::filled(1.0f));
  const auto total = [](const RadialTable<4>& table, int b) {
    double sum = std::numbers::pi * static_cast<double>(table.node_r2(0) * table[0][b]);
    for (std::size_t i = 0; i + 1 < table.size(); ++i)
      sum += 0.5 * std::numbers::pi *
             static_cast<double>((table.node_r2(i + 1) - table.node_r2(i)) *
                                 (table[i][b] + table[i + 1][b]));
    return sum;
  };
  for (const float blur : {0.02f, 0.3f}) {
    const auto tables = make_gather_tables<4>(std::span(&from, 1), blur);
    for (int b = 0; b < 3; ++b) {
      const double all = static_cast<double>(from.total_reflectance()[b]);
      EXPECT_NEAR(total(tables[0].reflectance, b), all, 5e-3 * all) << blur << ' ' << b;
    }
    const float far = 0.5f * from.support_radius();
    EXPECT_NEAR(tables[0].reflectance.at(far * far)[0], from.reflectance_profile(far)[0],
                0.02f * from.reflectance_profile(far)[0]);
  }
  const Profile narrow = diffusion_profile(half_space({300, 300, 300}, 3000.0, 1.4));
  const ProfileTable<4> point(narrow, make_radius_grid({narrow}), BandValues<4>::filled(1.0f));
  const auto spread = make_gather_tables<4>(std::span(&point, 1), 0.1f);
  for (const float r : {0.01f, 0.1f, 0.2f}) {
    const float gaussian = std::exp(-0.5f * r * r / 0.01f) / (2.0f * pi * 0.01f);
    const float all = point.total_reflectance()[0];
    EXPECT_NEAR(spread[0].reflectance.at(r * r)[0], all * gaussian, 0.01f * all * gaussian) << r;
  }
}

TEST(Hierarchy, WhiteMatchedPatchReturnsAllLight) {
  Scene scene = scene_of(make_square(40.0f), half_space({0, 0, 0}, 50.0, 1.0));
  scene.render.hierarchy = {.spacing = 0.25f, .irradiance_samples = 8};
  const Image image = render(scene).image;
  // 1.67 mean free paths over 20 mm are lost at the patch's border, 2e-3.
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean_of(image, c), 1.0, 4e-3) << c;
}

/// Largest difference of two pictures' smooth parts, over the mean of the second.
double difference(const Image& a, const Image& b, std::size_t c) {
  double worst = 0.0;
  const int block = 4;
  for (int y = 0; y < a.height; y += block)
    for (int x = 0; x < a.width; x += block) {
      double d = 0.0;
      for (int j = 0; j < block; ++j)
        for (int i = 0; i < block; ++i)
          d += static_cast<double>(a.at(x + i, y + j)[c]) -
               static_cast<double>(b.at(x + i, y + j)[c]);
      worst = std::max(worst, std::abs(d) / (block * block));
    }
  return worst / mean_of(b, c);
}

// Two ways to the same integral: what ProbeTransport draws at random is summed here. Lit from the
// side, so that light is seen beyond the terminator and through the thin end of an egg.
TEST(Hierarchy, GivesThePictureOfTheProfileMethod) {
  Mesh egg = make_sphere(3.0f, 32);
  for (Vec3f& p : egg.positions) p.z *= 0.4f;
  for (Vec3f& n : egg.normals) n = normalize(Vec3f{n.x, n.y, n.z / 0.4f});
  Scene scene = scene_of(std::move(egg), half_space({0.02, 0.1, 0.5}, 4.0, 1.3));
  scene.camera = camera_above(5.0);
  scene.film = {.width = 24, .height = 24};
  scene.lights = {
      DirectionalLight{.direction = normalize(Vec3{1, 0.3, 0.2}), .irradiance = {3, 3, 3}}};
  scene.render.samples_per_pixel = 16;
  scene.render.hierarchy.spacing = 0.11f;  // the thin end is narrow
  const Image summed = render(scene).image;
  scene.render.method = RenderSettings::Method::probe;
  scene.render.samples_per_pixel = 512;
  const Image drawn = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean_of(summed, c), mean_of(drawn, c), 0.01 * mean_of(drawn, c)) << c;
    EXPECT_LT(difference(summed, drawn, c), 0.05) << c;
  }
}

TEST(Hierarchy, InvertedColorIsTheReflectanceThatComesOut) {
  Scene scene = scene_of(make_square(30.0f), half_space({0.05, 0.3, 2.0}, 10.0, 1.0));
  scene.render.hierarchy = {.spacing = 0.2f, .irradiance_samples = 8};
  auto& surface = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  surface.color_use = SubsurfaceSurface::ColorUse::invert;
  surface.color.value = {0.7f, 0.4f, 0.1f};
  const Image image = render(scene).image;
  const double expected[3] = {0.7, 0.4, 0.1};
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(mean_of(image, c), expected[c], 0.015 * expected[c]) << c;
}

TEST(Hierarchy, HasNoNoiseUnderTheSurface) {
  Scene scene = scene_of(make_sphere(4.0f, 64), half_space({0.05, 0.3, 2.0}, 5.0, 1.0));
  scene.render.hierarchy.spacing = 0.2f;
  scene.camera = camera_above(4.0);
  scene.film = {.width = 48, .height = 48};
  scene.lights = {RectangleLight{
      .center = {8, 0, 8}, .edge_u = {0, 4, 0}, .edge_v = {3, 0, -3}, .radiance = {10, 10, 10}}};
  EXPECT_LT(render(scene).statistics.relative_noise.value(), 0.01);
}

// Samples get closer until the light hardly changes; what is left is less than that, for the error
// falls with the square of the spacing.
TEST(Hierarchy, RefinesItsSamplesUntilTheLightHardlyChanges) {
  Scene scene = scene_of(make_sphere(4.0f, 48), half_space({0.05, 0.3, 2.0}, 5.0, 1.0));
  scene.lights = {
      DirectionalLight{.direction = normalize(Vec3{1, 0.2, 1}), .irradiance = {3, 3, 3}}};
  scene.render.samples_per_pixel = 4;
  const auto settled = [&](float refine, int max_points) {
    scene.render.hierarchy = {
        .spacing = 0.6f, .max_points = max_points, .irradiance_samples = 8, .refine = refine};
    const RenderResult result = render(scene);
    EXPECT_EQ(result.statistics.light_samples.size(), 1u);
    return result;
  };
  const RenderResult loose = settled(0.2f, 100'000), strict = settled(0.03f, 100'000);
  const LightSamples &coarse = loose.statistics.light_samples[0],
                     &fine = strict.statistics.light_samples[0];
  EXPECT_LE(coarse.change.value(), 0.2);
  EXPECT_LE(fine.change.value(), 0.03);
  EXPECT_LT(fine.spacing, 0.6 * coarse.spacing);
  EXPECT_GT(fine.count, 3 * coarse.count);
  scene.render.hierarchy = {.spacing = 0.5f * static_cast<float>(fine.spacing),
                            .irradiance_samples = 32};
  const RenderResult finest = render(scene);
  EXPECT_FALSE(finest.statistics.light_samples[0].change);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(mean_of(strict.image, c), mean_of(finest.image, c), 0.03 * mean_of(finest.image, c))
        << c;
  // There is an end to it.
  const RenderResult bounded = settled(1e-6f, 2000);
  EXPECT_LT(bounded.statistics.light_samples[0].count, 2400u);
  EXPECT_GT(bounded.statistics.light_samples[0].change.value(), 1e-6);
}

}  // namespace
}  // namespace lamina
