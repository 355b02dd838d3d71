// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The table of methods against what is written down of it.
#include "lamina/scene/description/subsurface_methods.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/scene/description/method_settings.h"

namespace lamina {
namespace {

const std::filesystem::path root = LAMINA_SOURCE_DIR;

TEST(SubsurfaceMethods, ThePageHasTheirTable) {
  EXPECT_NE(read_file_bytes(root / "docs/subsurface.md").find(methods_table()), std::string::npos)
      << "docs/subsurface.md must have\n\n"
      << methods_table();
}

/// All but descriptions is the same.
void expect_same(const JsonInput& given, const JsonInput& wanted) {
  if (!wanted.is_object()) {
    if (wanted.is_number())
      EXPECT_FLOAT_EQ(static_cast<float>(given.number()), static_cast<float>(wanted.number()))
          << given.where();
    else if (wanted.is_string())
      EXPECT_EQ(given.string(), wanted.string()) << given.where();
    else if (wanted.is_boolean())
      EXPECT_EQ(given.boolean(), wanted.boolean()) << given.where();
    else
      for (std::size_t i = 0; i < wanted.array().size(); ++i)
        expect_same(given.array(wanted.array().size(), wanted.array().size())[i],
                    wanted.array()[i]);
    return;
  }
  std::set<std::string> keys, wanted_keys;
  for (const auto& [key, value] : given.entries()) keys.insert(key);
  for (const auto& [key, value] : wanted.entries()) wanted_keys.insert(key);
  for (auto* set : {&keys, &wanted_keys}) set->erase("description");
  EXPECT_EQ(keys, wanted_keys) << given.where();
  for (const std::string& key : wanted_keys)
    if (keys.contains(key)) expect_same(*given.peek(key), *wanted.peek(key));
}

TEST(SubsurfaceMethods, TheSchemaHasTheirNamesAndNumbers) {
  const JsonDocument schema = load_json(root / "schema/scene.schema.json");
  const JsonDocument wanted = parse_json(methods_schema(), "wanted");
  const JsonInput render = *schema.root().peek("properties")->peek("render")->peek("properties");
  for (const auto& [key, value] : wanted.root().entries()) {
    ASSERT_TRUE(render.peek(key)) << key;
    expect_same(*render.peek(key), value);
  }
}

TEST(SubsurfaceMethods, HonourKeysThatSomeDoNot) {
  std::set<std::string_view> known;
  for (const MaterialSetting& setting : material_settings) known.insert(setting.key);
  for (const RenderSetting& setting : render_settings) known.insert(setting.key);
  for (const SceneMethod method : subsurface_methods())
    for (const std::string_view key : method->honours)
      EXPECT_TRUE(key.empty() || known.contains(key)) << method.name() << ": " << key;
}

TEST(SubsurfaceMethods, KnowTheNameThatProbeHad) {
  try {
    (void)parse_json(R"("profile")", "old").root().choice(method_names());
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"probe\"?"), std::string::npos)
        << error.what();
  }
}

TEST(SubsurfaceMethods, AreLeftOpenByDefault) {
  EXPECT_TRUE(SceneMethod().is_open());
  EXPECT_EQ(SceneMethod(), SceneMethod::automatic);
  EXPECT_EQ(find_method("auto"), SceneMethod::automatic);
  EXPECT_EQ(find_method("hierarchy"), SceneMethod::hierarchy);
}

}  // namespace
}  // namespace lamina
