// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Light that is kept for other pictures: used where it is the light of the scene, and only there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;
using Method = RenderSettings::Method;

/// Layers of which profiles are made quickly.
Material plate(double sigma_s) {
  Material material = half_space({0.1, 0.3, 1.0}, sigma_s, 1.3);
  material.layers[0].thickness = 5.0;
  return material;
}

fs::path fresh_file(const std::string& name) {
  const fs::path file = fs::path(testing::TempDir()) / ("light_cache_" + name + ".ply");
  fs::remove(file);
  return file;
}

SubsurfaceSurface& skin_of(Scene& s) { return std::get<SubsurfaceSurface>(s.materials[0].surface); }
EnvironmentLight& sky_of(Scene& s) { return std::get<EnvironmentLight>(s.lights[0]); }
DielectricSurface& glass_of(Scene& s) {
  return std::get<DielectricSurface>(s.materials[2].surface);
}

/// A coated ball of a translucent material on a floor, with a ball of glass between it and a lamp.
Scene ball_and_glass(Method method, Material material) {
  Scene scene = translucent_scene(method, make_sphere(2.0f, 16), std::move(material),
                                  EnvironmentLight{.scale = {0.3f, 0.3f, 0.4f}});
  scene.camera = camera_above(3.0);
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = 2;
  scene.render.max_bounces = 2;
  scene.render.hierarchy = {.spacing = 0.5f, .irradiance_samples = 2};
  scene.render.texture_space = {.texel = 0.4f, .irradiance_samples = 2};
  scene.images = {make_image(2, 2, {"R", "G", "B"})};
  for (float& value : scene.images[0].pixels) value = 0.5f;
  scene.materials[0].coat = Coat{.roughness = {.value = 0.0f}};  // smooth ones are made at once
  scene.materials[0].bump = TextureMap{.source = NoiseMap{.size = 1.0f}, .scale = 0.05f};
  scene.materials.push_back(diffuse_material(0.5f));
  std::get<DiffuseSurface>(scene.materials[1].surface).color.map = TextureMap{.source = ImageMap{}};
  scene.materials.push_back({.name = "glass", .surface = DielectricSurface{}});
  Mesh floor = make_square(20.0f, 1), glass = make_sphere(0.5f, 8, 2);
  for (Vec3f& p : floor.positions) p.z -= 2.0f;
  for (Vec3f& p : glass.positions) p += Vec3f{3.0f, 0.0f, 3.0f};
  scene.meshes.push_back(floor);
  scene.meshes.push_back(glass);
  scene.lights.push_back(RectangleLight{
      .center = {6, 0, 6}, .edge_u = {0, 2, 0}, .edge_v = {-1, 0, 1}, .radiance = {4, 4, 4}});
  return scene;
}

struct Change {
  std::string key;
  std::function<void(Scene&)> apply;
};

/// What the light that enters surfaces follows from, and the part of the scene that a message
/// names.
const std::vector<std::pair<std::string, std::vector<Change>>> of_the_light = {
    {"meshes",
     {{"vertex", [](Scene& s) { s.meshes[1].positions[0].z += 0.1f; }},
      {"normal",
       [](Scene& s) {
         s.meshes[0].normals[40] = normalize(Vec3f{1, 1, 1});
       }},
      {"face's material", [](Scene& s) { s.meshes[2].material[3] = 1; }}}},
    {"materials",
     {{"absorption", [](Scene& s) { skin_of(s).material.layers[0].sigma_a[0] *= 1.5; }},
      {"coat roughness", [](Scene& s) { s.materials[0].coat->roughness.value = 0.3f; }},
      {"coat ior", [](Scene& s) { s.materials[0].coat->ior = 1.6f; }},
      {"coat weight", [](Scene& s) { s.materials[0].coat->weight.value = 0.5f; }},
      {"bump", [](Scene& s) { s.materials[0].bump->scale = 0.1f; }},
      {"color of the floor", [](Scene& s) { s.materials[1] = diffuse_material(0.7f); }},
      {"opacity", [](Scene& s) { s.materials[1].opacity = ScalarParameter{.value = 0.5f}; }},
      {"ior of the glass", [](Scene& s) { glass_of(s).ior = 1.8f; }}}},
    {"maps", {{"texel", [](Scene& s) { s.images[0].pixels[3] = 0.6f; }}}},
    {"lights",
     {{"radiance", [](Scene& s) { std::get<RectangleLight>(s.lights[1]).radiance.x = 5.0f; }},
      {"sky", [](Scene& s) { sky_of(s).scale.z = 0.5f; }},
      {"a sun",
       [](Scene& s) {
         s.lights.push_back(DirectionalLight{{0, 0, 1}, {1, 1, 1}});
       }}}},
    {"settings", {{"bounces", [](Scene& s) { s.render.max_bounces = 1; }}, {"seed", [](Scene& s) {
                                                                              s.render.seed = 9;
                                                                            }}}}};

const std::vector<Change> of_the_light_of_hierarchy = {
    {"profile", [](Scene& s) { s.render.profile = RenderSettings::Profile::dipole; }},
    {"spacing", [](Scene& s) { s.render.hierarchy.spacing = 0.6f; }},
    {"paths", [](Scene& s) { s.render.hierarchy.irradiance_samples = 3; }},
    {"refinement", [](Scene& s) { s.render.hierarchy.refine = 0.5f; }}};

/// What it does not follow from.
const std::vector<Change> of_the_picture = {
    {"eye", [](Scene& s) { s.camera.position.x += 20.0; }},
    {"target", [](Scene& s) { s.camera.look_at.y += 0.2; }},
    {"fov", [](Scene& s) { s.camera.horizontal_fov *= 0.8; }},
    {"aperture", [](Scene& s) { s.camera.aperture_diameter = 3.0; }},
    {"width", [](Scene& s) { s.film.width = 11; }},
    {"exposure", [](Scene& s) { s.film.exposure = 2.0f; }},
    {"samples", [](Scene& s) { s.render.samples_per_pixel = 3; }},
    {"noise", [](Scene& s) { s.render.noise = 0.5f; }},
    {"visible sky", [](Scene& s) { sky_of(s).is_visible = false; }},
    {"name", [](Scene& s) { s.materials[0].name = skin_of(s).material.source = "another"; }},
    {"roughness of the glass", [](Scene& s) { glass_of(s).roughness.value = 0.3f; }},
    {"shadow maps", [](Scene& s) { s.render.shadow_map.resolution = 99; }}};

const std::vector<Change> of_the_picture_by_hierarchy = {
    {"error of the sum", [](Scene& s) { s.render.hierarchy.error = 0.1f; }},
    {"single scattering",
     [](Scene& s) { s.render.single_scattering = RenderSettings::SingleScattering::straight; }},
    {"texels", [](Scene& s) { s.render.texture_space.texel = 0.7f; }}};

/// Checks a change against the light that is kept of the scene before.
///
/// @param reference  how the picture is made that it must be equal to
void expect_kept(const Scene& before, const fs::path& kept, const Change& change, bool is_used,
                 const std::string& part, const std::function<Image(const Scene&)>& reference) {
  SCOPED_TRACE(change.key);
  Scene scene = before;
  change.apply(scene);
  const fs::path file = fresh_file("one");
  fs::copy_file(kept, file);
  std::vector<std::string> notices;
  RenderOptions options{.cache = file, .needs_cache = true};
  options.on_notice = [&](const std::string& line) {
    if (line.find("anew") != std::string::npos) notices.push_back(line);
  };
  if (!is_used) {
    try {
      (void)render(scene, options);
      ADD_FAILURE() << "light that is not its own was used";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("made for other " + part), std::string::npos)
          << error.what();
    }
    options.needs_cache = false;
  }
  const Image picture = render(scene, options).image;
  ASSERT_EQ(notices.size(), is_used ? 0u : 1u);
  if (!is_used) {
    EXPECT_NE(notices[0].find("made for other " + part), std::string::npos) << notices[0];
  }
  EXPECT_EQ(picture.pixels, reference(scene).pixels);
}

TEST(LightCache, OfHierarchyIsMadeAnewWhereTheLightChangesAndUsedElsewhere) {
  const Scene scene = ball_and_glass(Method::hierarchy, plate(5.0));
  const fs::path kept = fresh_file("of_hierarchy");
  const auto without = [](const Scene& s) { return render(s).image; };
  EXPECT_EQ(render(scene, {.cache = kept}).image.pixels, without(scene).pixels);
  for (const auto& [part, changes] : of_the_light)
    for (const Change& change : changes) expect_kept(scene, kept, change, false, part, without);
  for (const Change& change : of_the_light_of_hierarchy)
    expect_kept(scene, kept, change, false, "settings", without);
  for (const auto& changes : {of_the_picture, of_the_picture_by_hierarchy})
    for (const Change& change : changes) expect_kept(scene, kept, change, true, "", without);
}

// Without a cache, texels that do not show get fewer paths: another cache is the witness here.
TEST(LightCache, OfTextureSpaceIsMadeAnewWhereTheLightChangesAndUsedElsewhere) {
  const Material skin = parse_material(
      R"({ "lamina": "material", "version": 1, "name": "skin", "length_unit": "mm",
           "bands": [450, 540, 640], "skin": { "constants": "calibrated_diffusion" } })",
      "test");
  const Scene scene = ball_and_glass(Method::texture_space, skin);
  const fs::path kept = fresh_file("of_texture_space");
  const auto with_fresh_cache = [](const Scene& s) {
    return render(s, {.cache = fresh_file("fresh")}).image;
  };
  (void)render(scene, {.cache = kept});
  for (const auto& [part, changes] : of_the_light)
    if (part == "lights" || part == "settings")
      for (const Change& change : changes)
        expect_kept(scene, kept, change, false, part, with_fresh_cache);
  for (const Change& change :
       {Change{"texel", [](Scene& s) { s.render.texture_space.texel = 0.5f; }},
        Change{"interlayer_bounces",
               [](Scene& s) { s.render.texture_space.interlayer_bounces = 1; }}})
    expect_kept(scene, kept, change, false, "settings", with_fresh_cache);
  for (const Change& change : of_the_picture)
    expect_kept(scene, kept, change, true, "", with_fresh_cache);
}

// Light that is too coarse for a camera that comes close is made anew.
TEST(LightCache, ServesCamerasThatSeeNoFinerLight) {
  Scene scene = ball_and_glass(Method::hierarchy, plate(50.0));
  scene.render.hierarchy.spacing = 0.0f;
  const fs::path kept = fresh_file("coarse");
  const auto samples = [&](double fov, std::string& notice) {
    scene.camera.horizontal_fov = fov;
    RenderOptions options{.cache = kept};
    notice.clear();
    options.on_notice = [&](const std::string& line) {
      if (line.find("anew") != std::string::npos) notice += line;
    };
    return render(scene, options).statistics.light_samples.at(0).count;
  };
  std::string notice;
  const double fov = scene.camera.horizontal_fov;
  const std::size_t first = samples(fov, notice);
  EXPECT_EQ(samples(0.6 * fov, notice), first);
  EXPECT_EQ(notice, "");
  EXPECT_GT(samples(0.3 * fov, notice), first);
  EXPECT_NE(notice.find("sees light as fine as"), std::string::npos) << notice;
  const std::size_t finer = samples(fov, notice);  // finer light serves all
  EXPECT_GT(finer, first);
  EXPECT_EQ(notice, "");
}

// A cache that is damaged anywhere gives the picture that there is without it.
TEST(LightCache, DamageNeverShowsInThePicture) {
  Scene scene = ball_and_glass(Method::hierarchy, plate(5.0));
  scene.render.hierarchy.spacing = 1.5f;
  scene.film = {.width = 4, .height = 4};
  const fs::path file = fresh_file("damaged");
  const Image right = render(scene, {.cache = file}).image;
  const std::string whole = read_file_bytes(file);
  for (std::size_t i = 80; i < whole.size(); i += whole.size() / 8) {  // behind what it is
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    std::ofstream(file, std::ios::binary) << damaged;
    EXPECT_THROW((void)render(scene, {.cache = file, .needs_cache = true}), InvalidInput) << i;
    EXPECT_EQ(render(scene, {.cache = file}).image.pixels, right.pixels) << i;
    EXPECT_TRUE(read_file_bytes(file) == whole) << i;
  }
  std::ofstream(file) << "holiday";
  EXPECT_THROW((void)render(scene, {.cache = file}), FileError);
  EXPECT_EQ(read_file_bytes(file), "holiday");
}

/// The file of a cache with other irradiance: `factor` times what it has.
std::string with_light_times(float factor, std::string bytes) {
  const std::string end_of_header = "end_header\n";
  const std::size_t numbers = bytes.find(end_of_header) + end_of_header.size();
  std::size_t properties = 0, first = 0;
  for (std::size_t at = bytes.find("property float "); at < numbers;
       at = bytes.find("property float ", at + 1), ++properties)
    if (first == 0 && bytes.compare(at + 15, 11, "irradiance_") == 0) first = properties;
  const std::size_t stride = properties * sizeof(float);
  for (std::size_t vertex = numbers; vertex < bytes.size(); vertex += stride)
    for (std::size_t k = first; k < properties; ++k) {
      float value = 0.0f;
      char* const at = bytes.data() + vertex + k * sizeof(float);
      std::memcpy(&value, at, sizeof value);
      value *= factor;
      std::memcpy(at, &value, sizeof value);
    }
  return bytes;
}

// [Hery2003] 4: any engine may find the light. What leaves is linear in it, and a factor of 2 is
// exact in floats.
TEST(LightCache, ForeignLightIsTakenAndLeftAlone) {
  Scene scene = ball_and_glass(Method::hierarchy, plate(5.0));
  scene.materials[0].coat.reset();
  scene.render.max_bounces = 0;  // the rest of the light below the surface is not the cloud's
  const fs::path file = fresh_file("foreign");
  const auto light_below = [](const Image& image) {
    return select_channels(image, {"subsurface.R", "subsurface.G", "subsurface.B"}).pixels;
  };
  std::vector<float> wanted = light_below(render(scene, {.cache = file}).image);
  EXPECT_GT(std::ranges::max(wanted), 0.0f);
  for (float& value : wanted) value *= 2.0f;
  const std::string foreign = with_light_times(2.0f, read_file_bytes(file));
  std::ofstream(file, std::ios::binary) << foreign;
  const RenderOptions takes{.cache = file, .takes_foreign_light = true};
  EXPECT_EQ(light_below(render(scene, takes).image), wanted);
  EXPECT_TRUE(read_file_bytes(file) == foreign);
  // Of another scene, too: another seed has other samples, were they made anew.
  Scene other = scene;
  std::get<RectangleLight>(other.lights[1]).radiance = {9, 9, 9};
  const Image of_other = render(other, takes).image;
  EXPECT_EQ(light_below(of_other), wanted);
  EXPECT_TRUE(read_file_bytes(file) == foreign);
  // What it lacks is refused, not made.
  std::ofstream(file, std::ios::binary) << foreign.substr(0, foreign.size() - 4);
  EXPECT_THROW((void)render(scene, takes), InvalidInput);
  std::ofstream(file, std::ios::binary) << with_light_times(-1.0f, foreign);
  EXPECT_THROW((void)render(scene, takes), InvalidInput);
  fs::remove(file);
  EXPECT_THROW((void)render(scene, takes), InvalidInput);
  EXPECT_FALSE(fs::exists(file));
}

}  // namespace
}  // namespace lamina
