// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "base/io/bad_files.h"
#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/spectrum_table.h"
#include "lamina/layers/materials/material.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

const fs::path inputs = fs::path(LAMINA_SOURCE_DIR) / "tests/inputs";

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  return files;
}

void expect_equal(const Material& a, const Material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.bands, b.bands);
  EXPECT_EQ(a.ior_above, b.ior_above);
  EXPECT_EQ(a.ior_below, b.ior_below);
  EXPECT_EQ(a.ground.reflectance, b.ground.reflectance);
  EXPECT_EQ(a.ground.top, b.ground.top);
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.oiliness, b.oiliness);
}

TEST(MaterialFile, EveryBadFileIsRefusedInOneLineThatNamesTheFault) {
  const auto message = [](const fs::path& path) {
    return message_of([&] { (void)load_material(path); });
  };
  EXPECT_GT(expect_refusals(inputs / "material/bad", message), 60U);
}

TEST(MaterialFile, FilesThatAreNoneAreRefused) {
  const std::string folder = (inputs / "material/bad").string();
  EXPECT_EQ(message_of([&] { (void)load_material(folder); }),
            folder + ": is a folder, but must be a file");
  EXPECT_THROW((void)load_material("no/such/file.json"), FileError);
}

TEST(MaterialFile, MillionNestedBracketsAreRefusedAtOnce) {
  std::string text = R"({"lamina": "material", "version": 1, "layers": )";
  text.append(1'000'000, '[');
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(message_of([&] { (void)parse_material(text, "deep.json"); }),
            "deep.json:1: brackets are nested deeper than 64 levels");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

void damage(const std::string& file) {
  std::ifstream stream(inputs / "material/good" / file);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  ASSERT_FALSE(text.empty());
  for (std::size_t size = 0; size < text.size(); ++size) {
    const std::string cut = text.substr(0, size);
    (void)message_of([&] { (void)parse_material(cut, "f"); });
  }
  rc::check("damaged " + file, [&] {
    std::string damaged = text;
    for (int i = 0; i < 3; ++i)
      damaged[*rc::gen::inRange<std::size_t>(0, text.size())] =
          *rc::gen::elementOf(std::string("0123456789-.eE[]{},:\"/*x \n\xff"));
    const std::string message = message_of([&] {
      const Material material = parse_material(damaged, "f");
      for (std::size_t band = 0; band < material.bands.size(); ++band)
        (void)layer_stack(material, band);
    });
    RC_ASSERT(message.find('\n') == std::string::npos);
  });
}

// A file that loses its end, or has one of its characters replaced, is a material or an Error.
TEST(MaterialFile, DamagedTextNeverDoesHarm) {
  for (const char* file : {"every_key.json", "skin_fold.json", "leaf_every_key.json",
                           "paint_every_key.json", "snow_every_key.json"})
    damage(file);
}

TEST(MaterialFile, ReadsEveryKey) {
  const Material material = load_material(inputs / "material/good/every_key.json");
  EXPECT_EQ(material.name, "every key \u2014 \"quoted\"");
  EXPECT_EQ(material.source, "a test");
  EXPECT_EQ(material.bands, BandSet({400.0, 500.5, 600.0, 700.0}));
  EXPECT_EQ(material.ior_above, (std::vector{1.0, 1.0, 1.0, 1.1}));
  EXPECT_EQ(material.ior_below, (std::vector{1.33, 1.33, 1.33, 1.33}));
  EXPECT_EQ(material.ground.reflectance, 0.18);
  EXPECT_EQ(material.ground.top, (Interface{0.5, MicrofacetDistribution::beckmann}));
  ASSERT_EQ(material.layers.size(), 3U);
  const MaterialLayer &clear = material.layers[0], &haze = material.layers[1],
                      &mixed = material.layers[2];
  EXPECT_EQ(clear.name, "clear");
  EXPECT_EQ(clear.top, (Interface{0.25, MicrofacetDistribution::ggx}));
  EXPECT_DOUBLE_EQ(clear.thickness, 0.01);                     // 1e-3 cm
  EXPECT_EQ(haze.sigma_a, (std::vector{0.1, 0.2, 0.3, 0.4}));  // 1/mm
  EXPECT_EQ(haze.phase, ParticlePhase::rayleigh);
  EXPECT_EQ(haze.ior, (std::vector{1.4, 1.41, 1.42, 1.43}));
  EXPECT_EQ(haze.top, (Interface{0.125, MicrofacetDistribution::beckmann}));
  EXPECT_EQ(mixed.top, (Interface{1.0, MicrofacetDistribution::ggx}));
  EXPECT_EQ(mixed.g, (std::vector{0.9, 0.91, 0.92, -0.93}));
  ASSERT_EQ(mixed.mixture.size(), 2U);
  EXPECT_EQ(mixed.mixture[0].name, "large");
  EXPECT_EQ(mixed.mixture[0].fraction, 0.125);
  EXPECT_EQ(mixed.mixture[0].sigma_s, (std::vector{30.0, 30.0, 30.0, 30.0}));
  EXPECT_EQ(mixed.mixture[1].phase, ParticlePhase::rayleigh);
}

TEST(MaterialFile, UnitsChangeNumbersOnlyByTheirSize) {
  const auto in = [](const std::string& unit, const std::string& sigma, const std::string& d) {
    const Material material = parse_material(
        R"({"lamina": "material", "version": 1, "length_unit": ")" + unit +
            R"(", "bands": "rgb", "ior_below": 1, "layers": [{"g": 0, "ior": 1.4, "sigma_a": )" +
            sigma + R"(, "sigma_s": )" + sigma + R"(, "thickness": )" + d + "}]}",
        "f");
    const Layer layer = layer_stack(material, 1).layers()[0];
    EXPECT_DOUBLE_EQ(layer.medium.sigma_a, 2.5) << unit;
    EXPECT_DOUBLE_EQ(layer.medium.sigma_s, 2.5) << unit;
    EXPECT_DOUBLE_EQ(layer.thickness, 0.5) << unit;
  };
  in("mm", "2.5", "0.5");
  in("cm", "25", "0.05");
  in("um", "0.0025", "500");
  in("m", "2500", "0.0005");
}

TEST(MaterialFile, FormattedMaterialReadsBackToEqualNumbers) {
  std::vector<Material> materials = builtin_materials();
  for (const fs::path& file : files_in(inputs / "material/good"))
    materials.push_back(load_material(file));
  ASSERT_GT(materials.size(), 25U);
  for (const Material& material : materials) {
    SCOPED_TRACE(material.name);
    const std::string text = format_material(material);
    expect_equal(material, parse_material(text, "again"));
    EXPECT_EQ(text, format_material(parse_material(text, "again")));
  }
}

TEST(MaterialFile, AnyMaterialReadsBackToEqualNumbers) {
  rc::check("round trip", [] {
    const auto positive = [](double largest) {
      return largest * std::pow(*rc::gen::map(rc::gen::inRange(1, 1'000'000'000),
                                              [](int i) { return i * 1e-9; }),
                                6.0);
    };
    Material material;
    material.name = *rc::gen::container<std::string>(rc::gen::inRange<char>(0, 127));
    material.ior_above = {1.0, 1.0 + positive(0.5), 1.0};
    const int layers = *rc::gen::inRange(1, 4);
    for (int i = 0; i < layers; ++i) {
      MaterialLayer layer{.sigma_a = {positive(1e3), positive(1e3), 0.0},
                          .sigma_s = {positive(1e6), positive(1e3), 1.0},
                          .g = {0.5 - positive(1.0), positive(0.99), 0.0},
                          .ior = {1.0, 1.0 + positive(1.0), 1.5},
                          .thickness = positive(100.0)};
      if (*rc::gen::arbitrary<bool>()) layer.top.roughness = positive(1.0);
      if (*rc::gen::arbitrary<bool>())
        layer.mixture.push_back({.name = "part",
                                 .fraction = positive(1.0),
                                 .sigma_a = {1.0, 2.0, positive(1.0)},
                                 .sigma_s = {0.0, 1.0, 2.0},
                                 .g = {0.0, 0.0, 0.0},
                                 .phase = ParticlePhase::rayleigh});
      material.layers.push_back(layer);
    }
    material.ior_below = {1.0, 1.1, 1.2};
    if (*rc::gen::arbitrary<bool>()) {
      material.layers.back().thickness = std::numeric_limits<double>::infinity();
      material.ior_below = material.layers.back().ior;
    }
    const Material again = parse_material(format_material(material), "again");
    RC_ASSERT(again.name == material.name);
    RC_ASSERT(again.layers == material.layers);
    RC_ASSERT(again.ior_above == material.ior_above);
    RC_ASSERT(again.ior_below == material.ior_below);
  });
}

/// The ```jsonc blocks of docs/materials.md, and the page itself.
struct Page {
  std::string text;
  std::vector<std::string> examples;
};

Page read_page() {
  std::ifstream stream(fs::path(LAMINA_SOURCE_DIR) / "docs/materials.md");
  Page page{.text = std::string(std::istreambuf_iterator<char>(stream), {}), .examples = {}};
  const std::string open = "```jsonc\n", close = "```";
  for (std::size_t at = 0; (at = page.text.find(open, at)) != std::string::npos;) {
    at += open.size();
    page.examples.push_back(page.text.substr(at, page.text.find(close, at) - at));
  }
  return page;
}

TEST(MaterialPage, ExamplesAreMaterials) {
  const Page page = read_page();
  ASSERT_EQ(page.examples.size(), 8U);
  const fs::path beside_tables = inputs / "material/good/page.json";
  for (const std::string& example : page.examples) {
    const Material material = parse_material(example, beside_tables.string());
    for (std::size_t band = 0; band < material.bands.size(); ++band)
      EXPECT_NO_THROW((void)layer_stack(material, band)) << material.name;
  }
  const Medium wax = layer_stack(parse_material(page.examples[0], "wax"), 1).layers()[0].medium;
  EXPECT_NEAR(mfp(wax), 0.13, 0.005);  // as the text says
  EXPECT_NEAR(mfp_prime(wax), 0.66, 0.005);
}

TEST(MaterialPage, MessagesAreThoseOfTheDecoder) {
  const Page page = read_page();
  const auto message_after = [&](const std::string& from, const std::string& to) {
    std::string text = page.examples.at(0);
    text.replace(text.find(from), from.size(), to);
    return message_of([&] { (void)parse_material(text, "wax.json"); });
  };
  for (const std::string& message :
       {message_after("7.5", "-7.5"), message_after("\"sigma_s\"", "\"sigma_S\"")}) {
    EXPECT_NE(message, "");
    EXPECT_NE(page.text.find("    " + message + "\n"), std::string::npos) << message;
  }
  const std::size_t table = page.text.find("# dye.csv\n");
  const auto message_of_table = [&](const std::string& from, const std::string& to) {
    std::string text = page.text.substr(table, page.text.find("```", table) - table);
    text.replace(text.find(from), from.size(), to);
    MemoryBudget memory;
    return message_of([&] {
      (void)read_spectrum(parse_csv(text, "dye.csv", memory), "sigma_a_per_cm",
                          closed_interval(0.0, 1e10, "1/cm"));
    });
  };
  for (const std::string& message :
       {message_of_table("700,", "490,"), message_of_table(",6,", ",-6,"),
        message_of_table(",6,", ",6,5,")}) {
    EXPECT_NE(message, "");
    EXPECT_NE(page.text.find("    " + message + "\n"), std::string::npos) << message;
  }
}

TEST(MaterialPage, ListsEveryBuiltinMaterial) {
  const std::string text = read_page().text;
  for (const Material& material : builtin_materials())
    EXPECT_NE(text.find("`" + material.name + "`"), std::string::npos) << material.name;
}

TEST(MaterialFile, ABuiltInMaterialMayBeTheBase) {
  const Material made = parse_material(
      R"({"base": "skin_type_2", "skin": {"melanin": 0.1}, "surface": {"roughness": 0.3}})", "m");
  const Material builtin = find_material("skin_type_2");
  ASSERT_TRUE(made.skin && builtin.skin);
  EXPECT_EQ(made.skin->skin.melanin, 0.1);
  EXPECT_EQ(made.skin->skin.hemoglobin_dermis, builtin.skin->skin.hemoglobin_dermis);
  EXPECT_EQ(made.layers.front().top.roughness, 0.3);
  EXPECT_EQ(made.name, "skin_type_2");
  // The ones that are tables have a text, too; null removes a key of it.
  const Material jade =
      parse_material(R"({"lamina": "material", "base": "jade", "name": "b", "source": null})", "m");
  EXPECT_EQ(jade.name, "b");
  EXPECT_EQ(jade.source, "");
  EXPECT_EQ(message_of([] { (void)parse_material("{\n\"base\": \"jad\"}", "m"); }),
            "m:2: base: there is no built-in material and no file \"jad\"; did you mean \"jade\"?");
  EXPECT_EQ(message_of([] {
              (void)parse_material("{\"base\": \"skin_type_2\",\n\"skin\": {\"melanin\": 3}}", "m");
            }),
            "m:2: skin.melanin must lie in [0, 0.5], but is 3");
}

}  // namespace
}  // namespace lamina
