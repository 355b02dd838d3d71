// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/method_settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/render/planning/method_choice.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

using Method = RenderSettings::Method;

const fs::path root = LAMINA_SOURCE_DIR;

/// What a key changes: a material with it and without, or what "render" says.
struct Sample {
  std::string key, without, with;
  std::string render = {};  ///< that a key of a material needs to have an effect
};

std::string in_file(const std::string& inside) {
  return R"("subsurface": {"lamina": "material", "version": 1, "length_unit": "mm", )" + inside +
         "}";
}

// Red goes through some millimetres, so that thin parts differ from thick ones.
const std::string one_medium =
    R"("sigma_a": [0.01, 0.1, 0.3], "sigma_s": 2, "g": 0, "ior": 1.3, "thickness": )";
const std::string wax = in_file(R"("bands": "rgb", "layers": [{)" + one_medium + R"("infinite"}])");
const std::string slab_of_wax =
    R"("bands": "rgb", "ior_below": 1.3, "layers": [{)" + one_medium + "2}]";
const std::string recipe = R"("bands": [450, 540, 640], "skin": {)";
const std::string skin = in_file(recipe + "}");

const std::vector<Sample>& material_samples() {
  static const std::vector<Sample> samples = {
      {"subsurface", wax, in_file(R"("bands": "rgb", "layers": [{"sigma_a": 0.2, "sigma_s": 1,
                                     "g": 0, "ior": 1.3, "thickness": "infinite"}])")},
      {"color", wax, wax + R"(, "color": [1, 0.2, 0.1])"},
      {"color_use", wax + R"(, "color": [0.6, 0.2, 0.1])",
       wax + R"(, "color": [0.6, 0.2, 0.1], "color_use": "invert")"},
      {"thickness", wax, wax + R"(, "thickness": 0.5)"},
      {"single_scattering_weight", wax, wax + R"(, "single_scattering_weight": 0.5)",
       R"("single_scattering": "straight")"},
      {"single_scattering_blur", wax, wax + R"(, "single_scattering_blur": 0.2)",
       R"("single_scattering": "straight")"},
      {"maps", wax, wax + R"(, "maps": {"0.sigma_a": 5})"},
      {"over", wax, wax + R"(, "over": [{"material": "jade", "thickness": 0.2, "coverage": 0.7}])"},
      {"coat", wax, wax + R"(, "coat": {"roughness": 0.5})"},
      {"bump", wax, wax + R"(, "bump": {"noise": {"size": 0.5}, "scale": 0.1})"},
      {"normal_map", wax, wax + R"(, "normal_map": "checker.png")"},
      {"subsurface.maps", skin,
       in_file(recipe + R"("melanin": {"map": "checker.png", "scale": 0.1, "offset": 0.01}})")},
      {"subsurface.skin.dermis_thickness", skin,
       in_file(R"("ior_below": 1, )" + recipe + R"("dermis_thickness": 0.5})")},
      {"subsurface.ground", in_file(slab_of_wax),
       in_file(slab_of_wax + R"(, "ground": {"reflectance": 0.9})")},
      {"subsurface.layers", wax, in_file(slab_of_wax)},  // of which the last is finite
      {"subsurface.surface", wax,
       in_file(R"("surface": {"roughness": 0.5}, "bands": "rgb", "layers": [{)" + one_medium +
               R"("infinite"}])")},
  };
  return samples;
}

/// The same of texture_space, which takes skin only.
const std::vector<Sample>& skin_samples() {
  static const std::vector<Sample> samples = [] {
    std::vector<Sample> of_skin;
    for (Sample sample : material_samples()) {
      if (sample.key.starts_with("subsurface")) continue;
      for (std::string* text : {&sample.without, &sample.with})
        if (text->starts_with(wax)) *text = skin + text->substr(wax.size());
      of_skin.push_back(sample);
      if (sample.key == "maps") of_skin.back().with = skin + R"(, "maps": {"melanin": 0.1})";
    }
    of_skin.push_back({"subsurface", skin, in_file(recipe + R"("melanin": 0.1})")});
    of_skin.push_back(
        {"subsurface.surface", skin, in_file(R"("surface": {"roughness": 0.5}, )" + recipe + "}")});
    for (const Sample& sample : material_samples())
      if (sample.key == "subsurface.maps" || sample.key == "subsurface.skin.dermis_thickness")
        of_skin.push_back(sample);
    return of_skin;
  }();
  return samples;
}

const std::vector<Sample>& render_samples() {
  static const std::vector<Sample> samples = {
      {"profile", "", R"("profile": "dipole")"},
      {"single_scattering", "", R"("single_scattering": "straight")"},
      {"exit_angle", "", R"("exit_angle": "printed")"},
      {"correct", "", R"("correct": true)"},
      {"orders", "", R"("orders": "first")"},
      {"factors", "", R"("factors": ["phase"])"},
      {"samples_per_pixel", "", R"("samples_per_pixel": 6)"},
      {"noise", R"("samples_per_pixel": 64)", R"("samples_per_pixel": 64, "noise": 0.9)"},
      {"max_bounces", "", R"("max_bounces": 0)"},
      {"seed", "", R"("seed": 3)"},
  };
  return samples;
}

/// A ball of the material over a matte floor, in uneven light.
std::string scene_text(const std::string& material, const std::string& render, Method method) {
  std::string settings = render;
  const auto add = [&](const std::string& key, const std::string& value) {
    if (settings.find('"' + key + '"') == std::string::npos)
      settings += (settings.empty() ? "" : ", ") + ('"' + key + "\": ") + value;
  };
  if (!method.is_open() && method->uses_profile) add("profile", R"("diffusion")");  // at once
  add("samples_per_pixel", "4");
  add("max_bounces", "2");
  add("hierarchy", R"({"spacing_mm": 0.5, "irradiance_samples": 4})");
  add("shadow_map", R"({"resolution": 32, "lamp_views": 4, "dome_views": 8})");
  add("texture_space", R"({"texel_mm": 0.4, "irradiance_samples": 2})");
  return R"({"lamina": "scene", "version": 1, "mm_per_unit": 1,
    "camera": {"position": [0, 3, 10], "look_at": [0, 0, 0], "horizontal_fov": 30},
    "film": {"width": 8, "height": 8},
    "materials": {"ball": {)" +
         material + R"(}, "floor": {"diffuse": [0.5, 0.4, 0.3]}},
    "meshes": [{"shape": "sphere", "radius": 2, "tessellation": 24, "material": "ball"},
               {"shape": "disk", "radius": 8, "material": "floor",
                "transform": {"rotate": [-90, 0, 0], "translate": [0, -2.2, 0]}}],
    "lights": [{"type": "environment", "radiance": [0.5, 0.45, 0.4]},
               {"type": "rectangle", "position": [8, 8, 8], "look_at": [0, 0, 0], "size": 3,
                "radiance": 20}],
    "render": {"method": ")" +
         std::string(method.name()) + "\", " + settings + "}}";
}

Scene scene_of(const std::string& material, const std::string& render, Method method) {
  const fs::path folder = fs::path(testing::TempDir()) / "method_settings";
  fs::create_directories(folder);
  fs::copy_file(root / "tests/inputs/scene/good/checker.png", folder / "checker.png",
                fs::copy_options::overwrite_existing);
  std::ofstream(folder / "scene.json") << scene_text(material, render, method);
  return load_scene(folder / "scene.json");
}

/// The pixels; each scene is rendered once.
const std::vector<float>& picture(const std::string& material, const std::string& render,
                                  Method method) {
  static std::map<std::string, std::vector<float>> known;
  const auto [entry, is_new] = known.try_emplace(scene_text(material, render, method));
  if (is_new) {
    entry->second = lamina::render(scene_of(material, render, method)).image.pixels;
    for (const float value : entry->second) EXPECT_FALSE(std::isnan(value));
  }
  return entry->second;
}

/// A key that is honoured changes the picture, any other is refused by its name.
void expect_honoured_or_refused(const std::string& path, bool is_honoured, Method method,
                                const Sample& sample, bool is_material) {
  const std::string of_material = is_material ? sample.with : wax;
  const std::string of_render = is_material ? "" : sample.with;
  const std::string name(method.name());
  if (!is_honoured) {
    const std::string message =
        message_of([&] { (void)render(scene_of(of_material, of_render, method)); });
    // Maps lie somewhere in the material, which is what the message names.
    const std::string maps = ".maps";
    const std::string place =
        path.ends_with("subsurface" + maps) ? path.substr(0, path.size() - maps.size()) : path;
    EXPECT_NE(message.find(place + ": method \"" + name + "\" does not honour it"),
              std::string::npos)
        << path << " with " << name << ": " << message;
    EXPECT_NE(message.find("scene.json:"), std::string::npos) << message;  // its line is named
    return;
  }
  try {
    EXPECT_NE(picture(of_material, is_material ? sample.render : of_render, method),
              picture(is_material ? sample.without : wax,
                      is_material ? sample.render : sample.without, method))
        << path << " changes nothing with " << name;
  } catch (const Error& error) {
    ADD_FAILURE() << path << " with " << name << ": " << error.what();
  }
}

template <class Settings>
bool is_honoured(const Settings& settings, const std::string& key, Method method) {
  for (const auto& setting : settings)
    if (setting.key == key) return method->honours_key(key);
  return true;
}

// The rule of scenes, for every key of a translucent material and every method.
TEST(MethodSettings, KeysOfMaterialsChangeThePictureOrAreRefused) {
  for (const Method method : subsurface_methods())
    for (const Sample& sample :
         method == Method::texture_space ? skin_samples() : material_samples()) {
      // Where no color is honoured, its use is refused by the color.
      const bool is_refused_before =
          sample.key == "color_use" && !is_honoured(material_settings, "color", method);
      expect_honoured_or_refused("materials.ball." + (is_refused_before ? "color" : sample.key),
                                 is_honoured(material_settings, sample.key, method), method, sample,
                                 true);
    }
}

TEST(MethodSettings, LayeredBsdfTakesMapsOfSkinFromTheRecipeAsFromItsOwn) {
  const std::string map = R"("melanin": {"map": "checker.png", "channel": "R", "scale": 0.5})";
  EXPECT_EQ(picture(in_file(recipe + map + "}"), "", Method::layered_bsdf),
            picture(skin + R"(, "maps": {)" + map + "}", "", Method::layered_bsdf));
  const std::string both = in_file(recipe + map + "}") + R"(, "maps": {)" + map + "}";
  EXPECT_NE(message_of([&] {
              (void)scene_of(both, "", Method::layered_bsdf);
            }).find("is a map in the recipe \"skin\" already"),
            std::string::npos);
}

TEST(MethodSettings, KeysOfRenderChangeThePictureOrAreRefused) {
  for (const Method method : subsurface_methods())
    for (const Sample& sample : render_samples()) {
      if (method == Method::texture_space && is_honoured(render_settings, sample.key, method))
        continue;  // below, on skin
      expect_honoured_or_refused("render." + sample.key,
                                 is_honoured(render_settings, sample.key, method), method, sample,
                                 false);
    }
  for (const Sample& sample : render_samples()) {
    if (!is_honoured(render_settings, sample.key, Method::texture_space)) continue;
    EXPECT_NE(picture(skin, sample.with, Method::texture_space),
              picture(skin, sample.without, Method::texture_space))
        << sample.key;
  }
}

TEST(MethodSettings, ObjectsNamedAfterAMethodSpeakToItAlone) {
  const std::map<std::string, std::string> objects = {
      {"hierarchy", R"("hierarchy": {"spacing_mm": 0.9, "irradiance_samples": 4})"},
      {"shadow_map", R"("shadow_map": {"resolution": 16, "lamp_views": 4, "dome_views": 8})"},
      {"texture_space", R"("texture_space": {"texel_mm": 0.7, "irradiance_samples": 2})"}};
  for (const auto& [object, given] : objects)
    for (const Method method : subsurface_methods()) {
      const std::string& material = method == Method::texture_space ? skin : wax;
      EXPECT_EQ(picture(material, given, method) != picture(material, "", method),
                method.name() == object)
          << object << " with " << method.name();
    }
}

// What light does not enter is the same for all methods.
TEST(MethodSettings, OtherMaterialsAreHonouredByAll) {
  const std::string leaf =
      R"("thin": {"lamina": "material", "version": 1, "length_unit": "mm", "bands": "rgb",
         "ior_below": 1, "layers": [{"sigma_a": 0.2, "sigma_s": 9, "g": 0.5, "ior": 1.4,
         "thickness": 0.2}]})";
  const std::string glass = R"("dielectric": {"ior": 1.5)";
  const std::vector<Sample> samples = {
      {"diffuse", R"("diffuse": 0.5)", R"("diffuse": 0.7)"},
      {"opacity", R"("diffuse": 0.5)", R"("diffuse": 0.5, "opacity": 0.5)"},
      {"thin.color", leaf, leaf + R"(, "color": [1, 0.5, 0.2])"},
      {"thin.thickness", leaf, leaf + R"(, "thickness": 0.1)"},
      {"thin.opacity", leaf, leaf + R"(, "opacity": 0.5)"},
      {"dielectric.ior", glass + "}", R"("dielectric": {"ior": 1.2})"},
      {"dielectric.roughness", glass + "}", glass + R"(, "roughness": 0.4})"},
      {"dielectric.distribution", glass + R"(, "roughness": 0.4})",
       glass + R"(, "roughness": 0.4, "distribution": "ggx"})"},
      {"dielectric.scattering", glass + R"(, "roughness": 0.4})",
       glass + R"(, "roughness": 0.4, "scattering": "multiple"})"},
  };
  for (const Method method : subsurface_methods())
    for (const Sample& sample : samples)
      EXPECT_NE(picture(sample.with, "", method), picture(sample.without, "", method))
          << sample.key << " with " << method.name();
}

/// The keys of an object of the schema.
std::set<std::string> keys_of(const JsonInput& properties) {
  std::set<std::string> keys;
  for (const auto& [key, value] : properties.entries()) keys.insert(key);
  return keys;
}

// So a key that is added cannot be forgotten above.
TEST(MethodSettings, EveryKeyOfTheSchemaIsCrossedWithEveryMethod) {
  const JsonDocument schema = load_json(root / "schema/scene.schema.json");
  const JsonInput of_material =
      schema.root().peek("definitions")->peek("material")->peek("oneOf")->array()[0];
  std::set<std::string> sampled;
  for (const Sample& sample : material_samples()) sampled.insert(sample.key);
  for (const std::string& key : keys_of(*of_material.peek("properties")))
    EXPECT_TRUE(sampled.contains(key)) << key;
  for (const MaterialSetting& setting : material_settings)
    EXPECT_TRUE(sampled.contains(std::string(setting.key))) << setting.key;
  // The quality chooses others of them, clamp is of the film.
  std::set<std::string> of_render = {"method", "quality", "clamp"};
  for (const Method method : subsurface_methods())
    if (!method->numbers.empty()) of_render.insert(std::string(method.name()));
  for (const Sample& sample : render_samples()) of_render.insert(sample.key);
  const JsonInput render = *schema.root().peek("properties")->peek("render");
  EXPECT_EQ(keys_of(*render.peek("properties")), of_render);
}

TEST(MethodSettings, ThePageOfScenesSaysWhatHonoursAKey) {
  std::ifstream file(root / "docs/scene.md");
  std::stringstream page;
  page << file.rdbuf();
  const auto expect_row = [&](const auto& settings) {
    for (const auto& setting : settings) {
      std::string row = "| `" + std::string(setting.key) + "` | ";
      std::string separator;
      for (const Method method : subsurface_methods())
        if (method->honours_key(setting.key)) {
          row += separator + '`' + std::string(method.name()) + '`';
          separator = ", ";
        }
      EXPECT_NE(page.str().find(row + " |\n"), std::string::npos) << row;
    }
  };
  expect_row(material_settings);
  expect_row(render_settings);
}

/// What a scene asks for by keys that only some methods honour, and the methods that honour all.
std::string asked_of(const Scene& scene) {
  std::string text;
  for (const AskedSetting& one : asked_settings(scene)) text += one.path + ' ';
  return text;
}
bool scene_refuses_coverings(const Scene& scene) {
  const auto refused = refusal(scene, Method::automatic);
  return refused && refused->find("takes the surface as bare") != std::string::npos;
}
std::size_t count_of_able(const Scene& scene) {
  return static_cast<std::size_t>(std::ranges::count_if(subsurface_methods(), [&](Method method) {
    return std::ranges::all_of(asked_settings(scene), [&](const AskedSetting& one) {
      return method->honours_key(one.key);
    });
  }));
}

// Every key that only some methods honour steers the choice, by itself and beside every other one:
// to a method that honours both, or to a message that names both.
TEST(MethodSettings, KeysThatFewHonourSteerTheChoice) {
  const auto expect_honoured = [](const Scene& scene) {
    if (count_of_able(scene) == 0) {
      const std::string message = message_of([&] { (void)choose_method(scene, {}); });
      EXPECT_NE(message.find(": no method honours it beside "), std::string::npos)
          << asked_of(scene) << message;
      EXPECT_NE(message.find("scene.json:"), std::string::npos) << message;
      return;
    }
    try {
      const Method chosen = choose_method(scene, {}).method;
      for (const AskedSetting& one : asked_settings(scene))
        EXPECT_TRUE(chosen->honours_key(one.key)) << chosen.name() << ": " << asked_of(scene);
    } catch (const Error& error) {
      ADD_FAILURE() << asked_of(scene) << ": " << error.what();
    }
  };
  std::set<std::string> asked;
  const auto check = [&](const std::string& material, const std::string& settings) {
    const Scene scene = scene_of(material, settings, Method::automatic);
    for (const AskedSetting& one : asked_settings(scene)) asked.insert(std::string(one.key));
    // Corrected light is of bare surfaces.
    if (!scene_refuses_coverings(scene)) expect_honoured(scene);
  };
  for (const Sample& of_material : material_samples()) {
    check(of_material.with, "");
    for (const Sample& of_render : render_samples()) check(of_material.with, of_render.with);
  }
  for (const Sample& a : render_samples())
    for (const Sample& b : render_samples())
      if (a.key < b.key && (a.with + b.with).find("samples_per_pixel") == std::string::npos)
        check(wax, a.with + (a.with.empty() || b.with.empty() ? "" : ", ") + b.with);
  for (const MaterialSetting& setting : material_settings)
    EXPECT_TRUE(asked.contains(std::string(setting.key))) << setting.key;
  for (const RenderSetting& setting : render_settings)
    EXPECT_TRUE(asked.contains(std::string(setting.key))) << setting.key;
}

TEST(MethodSettings, CorrectionWithoutAMethodIsHonoured) {
  const Scene scene = scene_of(wax, R"("correct": true)", Method::automatic);
  EXPECT_EQ(render(scene).statistics.method, Method::hierarchy);
  EXPECT_EQ(choose_method(scene_of(in_file(recipe + R"("melanin": {"map": "checker.png"}})"),
                                   R"("correct": true)", Method::automatic),
                          {})
                .method,
            Method::texture_space);
}

// Though the scene has settings of texture_space, which honours none of these.
TEST(MethodSettings, TheMethodChosenForASceneHonoursWhatItAsksFor) {
  for (const char* asked : {R"(, "color": [1, 0.2, 0.1])", R"(, "thickness": 0.5)"}) {
    Scene scene = scene_of(wax + asked, "", Method::hierarchy);
    scene.render.method = Method::automatic;
    EXPECT_TRUE(leave_out_unhonoured(scene).empty());
    EXPECT_EQ(message_of([&] { (void)render(scene); }), "") << asked;
  }
}

// A default that is written down is asked for all the same.
TEST(MethodSettings, DefaultsThatAreGivenAreRefusedToo) {
  EXPECT_NE(message_of([&] {
              (void)render(scene_of(wax, R"("single_scattering": "none")", Method::random_walk));
            }).find("render.single_scattering: method \"random_walk\" does not honour it"),
            std::string::npos);
}

TEST(MethodSettings, WhatAnotherMethodIsNotAskedForIsLeftOutWithALine) {
  Scene scene =
      scene_of(wax, R"("profile": "dipole", "single_scattering": "straight")", Method::hierarchy);
  EXPECT_TRUE(leave_out_unhonoured(scene).empty());
  scene.render.method = Method::random_walk;
  const std::vector<std::string> lines = leave_out_unhonoured(scene);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[0].find("render.profile: left out, method \"random_walk\""), std::string::npos);
  EXPECT_FALSE(scene.render.profile);
  EXPECT_EQ(scene.render.single_scattering, RenderSettings::SingleScattering::none);
  EXPECT_NO_THROW(require_honoured(scene));
}

TEST(MethodSettings, RefusalsNameMethodsThatHonourTheKey) {
  const std::string message = message_of(
      [&] { (void)render(scene_of(wax + R"(, "thickness": 0.5)", "", Method::layered_bsdf)); });
  EXPECT_NE(message.find("leave it out, or take probe, hierarchy or shadow_map"), std::string::npos)
      << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

// A red ball by paths inside is as red as by a profile.
TEST(MethodSettings, RandomWalkShowsColors) {
  const auto ratio = [](const std::string& color) {  // of green over red of what leaves the inside
    Scene scene = scene_of(wax + color, R"("samples_per_pixel": 64)", Method::random_walk);
    scene.lights.resize(1);
    const Image image = render(scene).image;
    const auto sum = [&](const char* channel) {
      const std::size_t at = *channel_index(image, channel);
      double total = 0.0;
      for (std::size_t i = at; i < image.pixels.size(); i += image.channels.size())
        total += static_cast<double>(image.pixels[i]);
      return total;
    };
    return sum("subsurface.G") / sum("subsurface.R");
  };
  EXPECT_NEAR(ratio(R"(, "color": [1, 0.2, 0.2])") / ratio(""), 0.2, 0.02);
}

// On a wide plate in even light the medium of an inverted color reflects the color of the light
// that enters; straight up goes what it reflects of a beam from there.
TEST(MethodSettings, RandomWalkMeetsInvertedColors) {
  Mesh plate = make_plate(400.0f, 60.0f);
  Scene scene = translucent_scene(Method::random_walk, plate,
                                  half_space({0.01, 0.1, 0.3}, 2.0, 1.3), EnvironmentLight{});
  auto& surface = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  surface.color = {.value = {0.6f, 0.3f, 0.15f}};
  surface.color_use = SubsurfaceSurface::ColorUse::invert;
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = 64;
  const Image image = render(scene).image;
  const std::vector<double> color = {0.6, 0.3, 0.15};
  const Material medium = with_reflectance(half_space({0.01, 0.1, 0.3}, 2.0, 1.3), color);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(material_totals(layer_stack(medium, c)).reflectance, color[c], 1e-5);
    const auto channel = *channel_index(image, std::string("subsurface.") + "RGB"[c]);
    const double upward = adding_doubling(layer_stack(medium, c)).totals.diffuse_reflectance;
    EXPECT_NEAR(mean_of(image, channel), upward, 0.02 * upward);
  }
}

}  // namespace
}  // namespace lamina
