// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The names that schemas allow are those of the tables that decoders read.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

namespace lamina {
namespace {

using Names = std::set<std::string, std::less<>>;

/// What a schema allows for a key, wherever it has the key or defines it.
void collect_names(const JsonInput& value, std::string_view key, std::vector<Names>& found) {
  if (value.is_array())
    for (const JsonInput& element : value.array()) collect_names(element, key, found);
  if (!value.is_object()) return;
  for (const auto& [name, inner] : value.entries()) {
    if (name == key && inner.is_object())
      if (const auto allowed = inner.peek("enum")) {
        Names& names = found.emplace_back();
        for (const JsonInput& element : allowed->array()) names.insert(element.string());
      }
    collect_names(inner, key, found);
  }
}

template <NamedEnum E>
void expect_names(const std::string& kind, std::string_view key) {
  const auto file = std::filesystem::path(LAMINA_SOURCE_DIR) / "schema" / (kind + ".schema.json");
  const JsonDocument schema = load_json(file);
  std::vector<Names> found;
  collect_names(schema.root(), key, found);
  EXPECT_FALSE(found.empty()) << kind << " has no names for " << key;
  const auto names = names_of<E>();
  for (const Names& allowed : found)
    EXPECT_EQ(allowed, Names(names.begin(), names.end())) << kind << ": " << key;
}

/// @param has_colors  whether some of them are of colors
void expect_encodings(const std::string& kind, bool has_colors) {
  const JsonDocument schema =
      load_json(std::filesystem::path(LAMINA_SOURCE_DIR) / "schema" / (kind + ".schema.json"));
  std::vector<Names> found;
  collect_names(schema.root(), "encoding", found);
  const auto names = names_of<ColorEncoding>();
  const Names all(names.begin(), names.end());
  bool has_all = false;
  for (const Names& allowed : found) {
    has_all = has_all || allowed == all;
    EXPECT_TRUE(allowed == all || allowed == (Names{"srgb", "linear"})) << kind;
  }
  EXPECT_FALSE(found.empty());
  EXPECT_EQ(has_all, has_colors) << kind;
}

TEST(EnumNames, AreThoseThatSchemasAllow) {
  expect_names<MicrofacetDistribution>("material", "distribution");
  expect_names<MicrofacetDistribution>("scene", "distribution");
  expect_names<ParticlePhase>("material", "phase");
  for (const char* kind : {"material", "maps", "patch"})
    expect_names<SkinConstants>(kind, "constants");
  // Colors have all encodings, quantities two.
  for (const char* kind : {"capture", "maps", "scene"}) expect_encodings(kind, true);
  for (const char* kind : {"material", "patch"}) expect_encodings(kind, false);
  expect_names<View>("scene", "view");
  expect_names<OperatorTotals>("patch", "totals");
  expect_names<ProfileAt>("patch", "profile");
}

}  // namespace
}  // namespace lamina
