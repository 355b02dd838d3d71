// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"
#include "lamina/render/subsurface/irradiance_fireflies.h"
#include "lamina/render/subsurface/texture_space/internal/texel_samples.h"
#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

const MappableNumber melanin_number{
    .of = MappableNumber::Of::skin, .part = 0, .name = "skin.melanin"};

Material uniform_skin() {
  return parse_material(
      R"({ "lamina": "material", "version": 1, "name": "skin", "length_unit": "mm",
           "bands": [450, 540, 640], "skin": { "constants": "calibrated_diffusion" } })",
      "test");
}

Scene lit_scene(Mesh mesh, Material material, double view) {
  Scene scene;
  scene.camera = camera_above(view);
  scene.film = {.width = 24, .height = 24};
  scene.render = {.method = RenderSettings::Method::texture_space, .samples_per_pixel = 8};
  scene.render.max_bounces = 0;
  scene.render.texture_space = {.texel = 0.35f, .irradiance_samples = 4};
  scene.materials = {
      {.name = "skin",
       .surface = SubsurfaceSurface{.material = std::move(material), .thickness = {.value = 0}}}};
  scene.meshes = {std::move(mesh)};
  scene.lights = {
      DirectionalLight{.direction = normalize(Vec3{0.7, 0.2, 1.0}), .irradiance = {3, 3, 3}}};
  return scene;
}

/// Sum over links of conductance times the squared difference of a function: the integral of its
/// squared gradient over the surface.
template <class Function>
double squared_gradient(const TextureAtlas::Cells& cells, const Function& f) {
  double sum = 0.0;
  for (const CellLink& link : cells.links) {
    const double d = f(cells.cells[link.to].position) - f(cells.cells[link.from].position);
    sum += static_cast<double>(link.conductance) * d * d;
  }
  return sum;
}

// Laplace's operator on a sphere whose texture is pinched at the poles and cut along a meridian:
// the gradient of each coordinate has a mean square of 2/3.
TEST(TextureAtlas, LinksKnowTheMetricOfTheSurfaceAndCrossItsSeams) {
  const std::vector<Mesh> meshes = {make_sphere(10.0f, 48)};
  const TextureAtlas atlas(meshes, 0, 0.25f);
  double area = 0.0;
  for (const AtlasTexel& texel : atlas.texels()) area += static_cast<double>(texel.area);
  EXPECT_NEAR(area, 4.0 * pi * 100.0, 0.01 * area);
  const TextureAtlas::Cells cells = atlas.cells();
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(
        squared_gradient(cells, [&](const Vec3f& p) { return static_cast<double>(p[axis]); }),
        2.0 / 3.0 * area, 0.03 * area)
        << axis;
  // A hill of 1.5 mm whose steepest slope is on the seam is as steep as one elsewhere.
  const auto hill_at = [&](const Vec3f& middle) {
    return squared_gradient(cells, [&](const Vec3f& p) {
      const Vec3f d = p - middle;
      return std::exp(-static_cast<double>(dot(d, d)) / (1.5 * 1.5));
    });
  };
  EXPECT_NEAR(hill_at({9.95f, 1, 0}), hill_at({-1, 9.95f, 0}), 0.05 * hill_at({-1, 9.95f, 0}));
}

/// A cube of 10 mm, each face of it a chart of its own.
Mesh cube_of_charts() {
  Mesh mesh{.name = "cube"};
  for (int face = 0; face < 6; ++face) {
    const float out = face % 2 == 0 ? 5.0f : -5.0f;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [s, t] : {std::pair(0.0f, 0.0f), {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}}) {
      Vec3f position, normal;
      position[face / 2] = out;
      position[(face / 2 + 1) % 3] = 2.0f * out * (s - 0.5f);
      position[(face / 2 + 2) % 3] = 10.0f * (t - 0.5f);
      normal[face / 2] = out / 5.0f;
      mesh.positions.push_back(position);
      mesh.normals.push_back(normal);
      mesh.uvs.push_back({s + 1.1f * static_cast<float>(face), t});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  mesh.material.assign(mesh.triangles.size(), 0);
  return mesh;
}

// Light goes over edges of 90° as easily as within a face: one conductance for each step of a texel
// along all twelve of them.
TEST(TextureAtlas, LinksGoOverSharpEdges) {
  for (const float spacing : {0.41f, 0.37f}) {
    const TextureAtlas atlas({cube_of_charts()}, 0, spacing);
    const TextureAtlas::Cells cells = atlas.cells();
    double across = 0.0;
    for (const CellLink& link : cells.links)
      if (cells.cells[link.from].chart != cells.cells[link.to].chart)
        across += static_cast<double>(link.conductance);
    const double steps = 12.0 * 10.0 / static_cast<double>(spacing);
    EXPECT_NEAR(across, steps, 0.15 * steps) << spacing;
  }
}

TEST(TextureAtlas, RefusesMeshesWithoutCoordinatesOrWithSomeThatOverlap) {
  const auto message_of = [](Mesh mesh) {
    try {
      const TextureAtlas atlas({std::move(mesh)}, 0, 0.1f);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Mesh bare = make_square(5.0f);
  bare.uvs.clear();
  EXPECT_NE(message_of(bare).find("needs texture coordinates"), std::string::npos);
  Mesh folded = make_square(5.0f);
  folded.uvs[3] = {1.0f, 0.1f};
  folded.uvs[2] = {0.4f, 0.9f};
  folded.uvs[0] = {0.6f, 0.0f};
  EXPECT_NE(message_of(folded).find("overlap"), std::string::npos);
  Mesh far = make_square(5.0f);
  for (Vec2f& uv : far.uvs) uv.x -= 1e6f;  // where single precision still tells its corners apart
  EXPECT_NE(message_of(far).find("lie too far from 0"), std::string::npos) << message_of(far);
  Mesh sliver = make_square(5.0f);
  sliver.uvs = {{0, 0}, {1e-6f, 0}, {1, 1}, {1, 1}};
  EXPECT_NE(message_of(sliver).find("spread too far"), std::string::npos) << message_of(sliver);
}

// The far corner of the second triangle leans back over the first: on a fifth of the texels.
TEST(TextureAtlas, GivesTexelsThatLieOnTwoFacesToOneAndSaysHowMany) {
  Mesh mesh = make_square(5.0f);
  mesh.uvs[3] = {0.75f, 0.55f};
  const TextureAtlas atlas({mesh}, 0, 0.1f);
  ASSERT_EQ(atlas.warnings().size(), 1u);
  int shared = 0, all = 0;
  ASSERT_EQ(
      std::sscanf(atlas.warnings()[0].c_str(),
                  "mesh \"square\": texture coordinates overlap: %d of %d texels", &shared, &all),
      2)
      << atlas.warnings()[0];
  EXPECT_EQ(static_cast<std::size_t>(all), atlas.texels().size());
  EXPECT_NEAR(static_cast<double>(shared) / all, 0.2, 0.04);
  for (const AtlasTexel& texel : atlas.texels()) EXPECT_EQ(texel.triangle, 0u);
  EXPECT_EQ(TextureAtlas({make_square(5.0f)}, 0, 0.1f).warnings().size(), 0u);
}

// Two solvers of uniform skin, one by texels and one by a cloud of samples. Their closed forms
// start light in the epidermis at different depths, so each is taken over its own reflectance.
TEST(TextureSpace, UniformSkinOnASphereLooksAsByHierarchy) {
  Scene scene = lit_scene(make_sphere(10.0f, 48), uniform_skin(), 14.0);
  const Image by_texels = render(scene).image;
  scene.render.method = RenderSettings::Method::hierarchy;
  scene.render.profile = RenderSettings::Profile::diffusion;
  scene.render.hierarchy = {.spacing = 0.3f, .irradiance_samples = 8};
  const Image by_points = render(scene).image;
  for (const std::string name : {"R", "G", "B"}) {
    const std::size_t channel = *channel_index(by_points, "subsurface." + name);
    const std::size_t albedo = *channel_index(by_points, "albedo." + name);
    const double scale = mean_of(by_points, albedo) / mean_of(by_texels, albedo);
    double square = 0.0, mean = 0.0;
    const double pixels = by_points.width * by_points.height;
    for (int y = 0; y < by_points.height; ++y)
      for (int x = 0; x < by_points.width; ++x) {
        const double a = scale * static_cast<double>(by_texels.at(x, y)[channel]);
        const auto b = static_cast<double>(by_points.at(x, y)[channel]);
        square += (a - b) * (a - b) / pixels;
        mean += b / pixels;
      }
    EXPECT_GT(mean, 0.01);
    EXPECT_LT(std::sqrt(square) / mean, 0.06) << name;
  }
}

// What `lamina slab` gives of even light for many wavelengths, from eight: through tables,
// transport and weights.
TEST(TextureSpace, UniformMapsOnAPlateHaveTheColorOfTheSlab) {
  constexpr double melanin = 0.012;
  Material skin = parse_material(
      R"({ "lamina": "material", "version": 1, "name": "skin", "length_unit": "mm", "skin": {} })",
      "test");
  skin.specular_roughness.reset();  // the light comes from where the camera is
  Image map = make_image(4, 4, {"Y"});
  std::ranges::fill(map.pixels, static_cast<float>(melanin));
  Scene scene = lit_scene(make_square(16.0f), std::move(skin), 16.0);
  std::get<SubsurfaceSurface>(scene.materials[0].surface).material_maps = {{melanin_number, map}};
  scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {3, 3, 3}}};
  const Image image = render(scene).image;

  std::vector<double> wavelengths, slab;
  for (int nm = 380; nm <= 780; nm += 10) {
    wavelengths.push_back(nm);
    const SlabTotals totals = adding_doubling(skin_layer_stack({.melanin = melanin}, nm),
                                              {.is_diffuse = true}, {.accuracy = 1e-3})
                                  .totals;
    slab.push_back(totals.diffuse_reflectance / (1.0 - totals.specular_reflectance));
  }
  const LinearSrgb wanted = linear_srgb(make_band_weights(BandSet(wavelengths)), slab);
  // Lit and seen from above, where the boundary lets more through than on average.
  const double seen = std::pow(1.0 - fresnel(1.0, 1.4), 2) / (1.0 - fresnel_diffuse(1.4));
  for (const std::size_t c : {0, 1, 2})
    EXPECT_NEAR(pi / 3.0 * static_cast<double>(image.at(12, 12)[c]), seen * wanted[c],
                0.01 * wanted[c])
        << c;
}

// A convex body under a sky of which a part is bright: hardly anything hides it, so what it gives
// is known.
TEST(TextureSpace, AnOpenSkyMakesNoNoise) {
  Scene scene = lit_scene(make_sphere(4.0f, 24), uniform_skin(), 6.0);
  scene.render.texture_space = {.texel = 0.3f, .irradiance_samples = 2};
  Image map = make_image(32, 16, {"R", "G", "B"});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c) map.at(x, y)[c] = x / 6 == 1 && y / 3 == 1 ? 20.0f : 0.1f;
  scene.images = {std::move(map)};
  scene.lights = {EnvironmentLight{.image = 0}};
  std::array<Image, 2> image;
  for (const std::size_t k : {0U, 1U}) {
    scene.render.seed = k;
    image[k] = render(scene).image;
  }
  const std::size_t green = *channel_index(image[0], "subsurface.G");
  double squares = 0.0, sum = 0.0;
  for (int y = 6; y < 18; ++y)
    for (int x = 6; x < 18; ++x) {
      const double a = image[0].at(x, y)[green], b = image[1].at(x, y)[green];
      squares += 0.5 * (a - b) * (a - b);
      sum += 0.5 * (a + b);
    }
  EXPECT_GT(sum / 144.0, 0.05);
  EXPECT_LT(std::sqrt(squares / 144.0), 0.02 * sum / 144.0);
}

CellGraph square_graph(int size) {
  std::vector<GraphCell> cells;
  std::vector<CellLink> links;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto i = static_cast<std::uint32_t>(y * size + x);
      cells.push_back({{static_cast<float>(x), static_cast<float>(y), 0.0f}, 1.0f, 0, x, y});
      if (x > 0) links.push_back({i - 1, i, 1.0f});
      if (y > 0) links.push_back({i - static_cast<std::uint32_t>(size), i, 1.0f});
    }
  return make_cell_graph(cells, links, 400.0);
}

/// Texels on a square grid, whose light has some deviation from sample to sample.
template <class Deviation>
std::vector<TexelSamples<4>> sampled(int size, const Deviation& deviation) {
  std::vector<TexelSamples<4>> samples(static_cast<std::size_t>(size * size));
  for (int i = 0; i < size * size; ++i)
    for (const float sign : {-1.0f, 1.0f})
      samples[static_cast<std::size_t>(i)].add(
          {.irradiance = BandValues<4>::filled(1.0f + sign * deviation(i % size))});
  return samples;
}

// Where samples differ three times as much three times as many are taken in all; where they do
// not, and where none may be, no more.
TEST(TexelSamples, MoreAreTakenWhereTheyDiffer) {
  constexpr int size = 64;
  const CellGraph graph = square_graph(size);
  std::vector<TexelSamples<4>> samples = sampled(size, [](int x) {
    return x < 16 ? 0.3f : x < 32 ? 0.1f : 0.0f;
  });
  for (int y = 0; y < size; ++y)
    for (int x = 48; x < size; ++x)
      samples[static_cast<std::size_t>(y * size + x)].may_have_more = false;
  const std::vector<float> shares(samples.size());
  const std::vector<int> more = more_samples<4>(graph, samples, shares, 4.0f);
  const auto mean = [&](int from, int to) {
    double sum = 0.0;
    for (int y = 0; y < size; ++y)
      for (int x = from; x < to; ++x) sum += more[static_cast<std::size_t>(y * size + x)];
    return sum / (size * (to - from));
  };
  // Four more for each of 48 texels in a row are 192, with the two of each of 32 that have no even
  // light 256: three parts to one for 16 texels each are 12 and 4.
  EXPECT_NEAR(mean(0, 16), 10.0, 0.4);
  EXPECT_NEAR(mean(16, 32), 2.0, 0.4);
  EXPECT_EQ(mean(32, 64), 0.0);
}

// One texel found light by a rare path: those around share it. One that is as bright by all of its
// samples keeps it.
TEST(TexelSamples, RareLightIsSpreadAndNotLost) {
  constexpr int size = 32;
  const CellGraph graph = square_graph(size);
  std::vector<TexelSamples<4>> samples = sampled(size, [](int) { return 0.01f; });
  constexpr std::size_t rare = 10 * size + 10, bright = 20 * size + 20;
  samples[rare].add({.irradiance = BandValues<4>::filled(20.0f)});
  samples[bright].irradiance *= 4.0f;
  samples[bright].irradiance2 *= 16.0f;
  std::vector<BandValues<4>> light;
  for (const TexelSamples<4>& of : samples)
    light.push_back((1.0f / static_cast<float>(of.count)) * of.irradiance);
  const auto sum = [&] {
    double all = 0.0;
    for (const BandValues<4>& of : light) all += static_cast<double>(of[0]);
    return all;
  };
  const double before = sum();
  EXPECT_GT(light[rare][0], 6.0f);
  spread_rare_light<4>(graph, samples, std::vector<float>(samples.size()), light);
  EXPECT_LT(light[rare][0], 1.3f);
  EXPECT_NEAR(light[bright][0], 4.0f, 0.1f);
  EXPECT_NEAR(sum(), before, 1e-5 * before);
}

// Of two lights one is blocked: what the other gives is found without noise, by one sample.
TEST(TextureSpace, ALightThatIsBlockedIsNoNoiseOnAnother) {
  Scene scene = lit_scene(make_square(8.0f), uniform_skin(), 6.0);
  scene.render.texture_space.irradiance_samples = 1;
  scene.lights = {
      DirectionalLight{.direction = normalize(Vec3{1, 0, 1}), .irradiance = {3, 3, 3}},
      DirectionalLight{.direction = normalize(Vec3{-1, 0, 1}), .irradiance = {3, 3, 3}}};
  Mesh wall = make_square(20.0f, 1);
  for (Vec3f& p : wall.positions) p = {20.0f, p.y, p.x + 20.0f};
  for (Vec3f& n : wall.normals) n = {-1, 0, 0};
  scene.meshes.push_back(wall);
  scene.materials.push_back(diffuse_material(0.0f));
  const Image image = render(scene).image;
  const std::size_t green = *channel_index(image, "subsurface.G");
  const float middle = image.at(12, 12)[green];
  EXPECT_GT(middle, 0.05f);
  for (int y = 6; y < 18; ++y)
    for (int x = 6; x < 18; ++x) ASSERT_NEAR(image.at(x, y)[green], middle, 1e-3f * middle);
}

// Half a plate of dark skin: the border is where the map has it, and light bleeds over it.
TEST(TextureSpace, MapsDarkenTheSkinWhereTheyHaveMelanin) {
  Material skin = uniform_skin();
  Image melanin = make_image(64, 64, {"Y"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) *melanin.at(x, y) = y < 32 ? 0.15f : 0.01f;  // dark above
  Scene scene = lit_scene(make_square(16.0f), std::move(skin), 16.0);
  std::get<SubsurfaceSurface>(scene.materials[0].surface).material_maps = {
      {melanin_number, melanin}};
  scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {3, 3, 3}}};
  const Image image = render(scene).image;
  const std::size_t green = *channel_index(image, "subsurface.G");
  const float dark = image.at(12, 2)[green], light = image.at(12, 21)[green];
  EXPECT_LT(dark, 0.45f * light);
  EXPECT_GT(dark, 0.02f * light);
  EXPECT_LT(image.at(12, 12)[green], light);  // within reach of the border
  scene.render.method = RenderSettings::Method::probe;
  EXPECT_THROW((void)render(scene), InvalidInput);
}

// A coat of two thicknesses on stone: each half as adding-doubling has it, lit and seen from above.
TEST(TextureSpace, CoatsMayVaryInThicknessOverAnyMaterial) {
  const Material coated = parse_material(
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": "rgb",
           "layers": [ { "sigma_a": [0.02, 0.02, 0.03], "sigma_s": 60, "g": 0.8, "ior": 1.5,
                         "thickness": 0.1 },
                       { "sigma_a": [0.3, 0.06, 0.2], "sigma_s": 8, "g": 0.5, "ior": 1.5,
                         "thickness": "infinite" } ] })",
      "test");
  Image thickness = make_image(64, 64, {"Y"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) *thickness.at(x, y) = y < 32 ? 0.25f : 0.02f;  // thick above
  Scene scene = lit_scene(make_square(16.0f), coated, 16.0);
  auto& surface = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  surface.material_maps = {
      {{.of = MappableNumber::Of::thickness, .name = "layers[0].thickness"}, thickness}};
  scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {3, 3, 3}}};
  const Image image = render(scene).image;
  const double seen = std::pow(1.0 - fresnel(1.0, 1.5), 2) / (1.0 - fresnel_diffuse(1.5));
  for (const auto& [y, mm] : {std::pair{2, 0.25}, {21, 0.02}})
    for (const std::size_t c : {0, 1, 2}) {
      Material uniform = coated;
      uniform.layers[0].thickness = mm;
      const SlabTotals totals =
          adding_doubling(layer_stack(uniform, c), {.is_diffuse = true}).totals;
      const double wanted = totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
      EXPECT_NEAR(pi / 3.0 * static_cast<double>(image.at(12, y)[c]), seen * wanted, 0.03 * wanted)
          << mm << " mm, channel " << c;
    }
  // A map by band for other bands than those of the scene.
  Image by_band = make_image(4, 4, {"a", "b"});
  surface.material_maps[0].values = by_band;
  EXPECT_THROW((void)render(scene), InvalidInput);
}

// What is kept has spread already, so it is of that many bounces.
TEST(TextureSpace, KeptLightOfOtherTermsIsRefused) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "terms.ply";
  std::filesystem::remove(file);
  Scene scene = lit_scene(make_square(8.0f), uniform_skin(), 8.0);
  const Image made = render(scene, {.cache = file}).image;
  scene.camera = camera_above(4.0);
  EXPECT_NE(render(scene, {.cache = file}).image.pixels, made.pixels);
  scene.render.texture_space.interlayer_bounces = 3;
  try {
    (void)render(scene, {.cache = file, .needs_cache = true});
    FAIL() << "it was taken";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("was made for other settings"), std::string::npos)
        << error.what();
  }
}

// As if another version of lamina had cut the surface otherwise into as many texels.
TEST(TextureSpace, KeptLightOfOtherTexelsIsRefused) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "texels_elsewhere.ply";
  std::filesystem::remove(file);
  const Scene scene = lit_scene(make_square(8.0f), uniform_skin(), 8.0);
  const Image made = render(scene, {.cache = file}).image;
  EXPECT_EQ(render(scene, {.cache = file}).image.pixels, made.pixels);
  const LightFingerprint light = light_fingerprint(scene, scene.render, {});
  std::vector<IrradianceCloud> clouds = load_irradiance_clouds(file, light).clouds;
  clouds.at(0).points.at(0).position.x += 0.2f;
  save_irradiance_clouds(clouds, {}, light, file);
  try {
    (void)render(scene, {.cache = file});
    FAIL() << "it was taken";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("another version of lamina made the cache"),
              std::string::npos)
        << error.what();
  }
}

// A cell far brighter than all around it is dimmed; edges, small lights and what is dark stay.
TEST(TextureSpace, DimsSpecksAndNothingElse) {
  constexpr std::uint32_t size = 8;
  std::vector<GraphCell> cells;
  std::vector<CellLink> links;
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const std::uint32_t i = y * size + x;
      cells.push_back({.position = {static_cast<float>(x), static_cast<float>(y), 0.0f},
                       .area = 1.0f,
                       .x = static_cast<std::int32_t>(x),
                       .y = static_cast<std::int32_t>(y)});
      if (x + 1 < size) links.push_back({i, i + 1, 1.0f});
      if (y + 1 < size) links.push_back({i, i + size, 1.0f});
    }
  const CellGraph graph = make_cell_graph(cells, links, 25.0);
  CellField<4> light(cells.size());
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] = BandValues<4>::filled(i % size < 4 ? 10.0f : 0.5f);
  constexpr std::size_t speck = 6 + 2 * size, small = 5 + 5 * size;  // the small one has two cells
  for (const std::size_t i : {speck, small, small + 1}) light[i] = BandValues<4>::filled(5.0f);
  light[speck][3] = 9.0f;  // 6 in the mean of its bands, where 0.5 is around
  const CellField<4> before = light;
  clamp_fireflies(graph.levels.front(), light);
  for (std::size_t i = 0; i < light.size(); ++i)
    for (int b = 0; b < 4; ++b)
      EXPECT_FLOAT_EQ(light[i][b], before[i][b] * (i == speck ? 1.0f / 6.0f : 1.0f)) << i;
}

}  // namespace
}  // namespace lamina
