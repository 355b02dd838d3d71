// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/io/bad_files.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// Files in a folder of their own, and what is read of them.
class JsonChanges : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder_ / "below");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] std::string read(const std::string& name,
                                 const std::vector<std::string>& settings = {}) const {
    MemoryBudget memory;
    return JsonOutput(load_json(folder_ / name, memory, settings).root()).text();
  }
  /// What is wrong, without the folder.
  [[nodiscard]] std::string error(const std::string& name,
                                  const std::vector<std::string>& settings = {}) const {
    try {
      return "read: " + read(name, settings);
    } catch (const Error& error) {
      std::string text = error.what();
      const std::string start = folder_.string() + "/";
      for (std::size_t at; (at = text.find(start)) != std::string::npos;)
        text.erase(at, start.size());
      return text;
    }
  }

  fs::path folder_;
};

TEST_F(JsonChanges, MergeObjectsAndReplaceAllElse) {
  write("a.json", R"({"lamina":"scene","camera":{"position":[1,2],"fov":3},"lights":[1,2],"x":1})");
  write("b.json",
        R"({"lamina":"scene","base":"a.json","camera":{"fov":4,"up":5},"lights":[7],"x":null})");
  EXPECT_EQ(read("b.json"),
            R"({"lamina":"scene","camera":{"position":[1,2],"fov":4,"up":5},"lights":[7]})");
}

TEST_F(JsonChanges, BasesStandOnBasesAndInsideOfOtherFiles) {
  write("below/a.json", R"({"lamina":"material","g":1,"ior":2,"name":"a"})");
  write("below/b.json", R"({"lamina":"material","base":"a.json","g":3})");
  write(
      "c.json",
      R"({"lamina":"scene","skin":{"lamina":"material","base":"below/b.json","name":"c"},"y":0})");
  EXPECT_EQ(read("c.json"),
            R"({"lamina":"scene","skin":{"lamina":"material","g":3,"ior":2,"name":"c"},"y":0})");
  write("d.json", R"({"lamina":"scene","base":"c.json","skin":{"ior":9}})");
  EXPECT_EQ(read("d.json"),
            R"({"lamina":"scene","skin":{"lamina":"material","g":3,"ior":9,"name":"c"},"y":0})");
}

TEST_F(JsonChanges, FilesAndMessagesGoByTheFileThatSaysAValue) {
  write("below/a.json", "{\"lamina\":\"scene\",\n\"map\":\"a.png\",\"own\":\"x\"}");
  write("b.json", "{\"lamina\":\"scene\",\"base\":\"below/a.json\",\n\n\"own\":\"b.png\"}");
  MemoryBudget memory;
  const std::vector<std::string> settings = {"set=c.png"};
  const JsonDocument document = load_json(folder_ / "b.json", memory, settings);
  const auto value = [&](const char* key) { return *document.root().peek(key); };
  EXPECT_EQ(value("map").file_path(), folder_ / "below/a.png");
  EXPECT_EQ(value("own").file_path(), folder_ / "b.png");
  EXPECT_EQ(value("set").file_path(), "c.png");
  EXPECT_EQ(value("map").where(), (folder_ / "below/a.json").string() + ":2: map");
  EXPECT_EQ(value("own").where(), (folder_ / "b.json").string() + ":3: own");
  EXPECT_EQ(value("set").where(), "--set set");
}

TEST_F(JsonChanges, RefuseBasesThatAreWrong) {
  write("loop.json", R"({"lamina":"scene","base":"loop2.json"})");
  write("loop2.json", R"({"lamina":"scene","base":"loop.json"})");
  EXPECT_EQ(error("loop.json"), "loop2.json:1: base: the file is a base of itself: loop.json");
  write("missing.json", R"({"lamina":"scene","base":"none.json"})");
  EXPECT_TRUE(error("missing.json").starts_with("missing.json:1: base: none.json: "));
  write("material.json", R"({"lamina":"material"})");
  write("kind.json", R"({"lamina":"scene","base":"material.json"})");
  EXPECT_EQ(error("kind.json"),
            "kind.json:1: base: must be a file of the same kind, \"lamina\": \"scene\", but is "
            "\"material\"");
  write("removes.json", "{\"lamina\":\"material\",\"base\":\"full.json\",\n\"naem\":null}");
  write("full.json", R"({"lamina":"material","name":"x"})");
  EXPECT_EQ(error("removes.json"),
            "removes.json:2: naem: removes what the base does not have; did you mean \"name\"?");
  write("0.json", R"({"lamina":"scene"})");
  for (int i = 1; i < 12; ++i)
    write(std::to_string(i) + ".json",
          R"({"lamina":"scene","base":")" + std::to_string(i - 1) + ".json\"}");
  EXPECT_EQ(read("8.json"), R"({"lamina":"scene"})");
  EXPECT_NE(error("11.json").find("more than 8 times"), std::string::npos);
}

const fs::path inputs = fs::path(LAMINA_SOURCE_DIR) / "tests/inputs/changes";

TEST(JsonChangesCorpus, GoodFilesAreTheirBasesButForWhatTheySay) {
  const JsonDocument scene = load_json(inputs / "good/warmer.json");
  EXPECT_FALSE(scene.root().peek("name"));
  EXPECT_EQ(scene.root().peek("lights")->array().size(), 1u);
  EXPECT_TRUE(scene.root().peek("camera")->peek("position"));
  const JsonDocument material = load_json(inputs / "good/darker.json");
  EXPECT_EQ(material.root().peek("skin")->peek("melanin")->number(), 0.2);
  EXPECT_TRUE(material.root().peek("length_unit"));
}

TEST(JsonChangesCorpus, BadFilesAreRefusedByName) {
  const auto refusal = [](const fs::path& file) -> std::string {
    try {
      (void)load_json(file);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "(taken)";
  };
  EXPECT_EQ(expect_refusals(inputs / "bad", refusal), 5U);
}

TEST_F(JsonChanges, SettingsChangeOneValue) {
  write(
      "a.json",
      R"({"camera":{"fov":3},"lights":[{"scale":1},{"scale":2}],"maps":{"dermis.blood":4,"dermis":5}})");
  EXPECT_EQ(read("a.json", {"camera.fov=[1, 2]", "lights[1].scale=x", "lights.0=3", "lights[+]=4",
                            "maps.dermis.blood=6", "render.hierarchy.spacing=7", "name=\"8\""}),
            R"({"camera":{"fov":[1,2]},"lights":[3,{"scale":"x"},4],"maps":{"dermis.blood":6,)"
            R"("dermis":5},"render":{"hierarchy":{"spacing":7}},"name":"8"})");
  EXPECT_EQ(read("a.json", {"camera=null", "maps=null", "lights[0]=null"}),
            R"({"lights":[{"scale":2}]})");
}

TEST_F(JsonChanges, NumbersOfSettingsMayBeginOrEndWithTheirPoint) {
  write("a.json", "{}");
  EXPECT_EQ(read("a.json", {"a=.5", "b=-.25", "c=[.5, 2., \".5\"]", "d={\"scale\": .5}"}),
            R"({"a":0.5,"b":-0.25,"c":[0.5,2.0,".5"],"d":{"scale":0.5}})");
  EXPECT_EQ(read("a.json", {"a=v.5", "b=./.5/x.png", "c=."}),
            R"({"a":"v.5","b":"./.5/x.png","c":"."})");
}

TEST_F(JsonChanges, KeysBelowANameMakeItTheBase) {
  write("a.json", R"({"material":"jade","list":["jade"]})");
  EXPECT_EQ(read("a.json", {"material.name=b", "list=null"}),
            R"({"material":{"base":"jade","name":"b"}})");
  EXPECT_EQ(read("a.json", {"list[0].surface.roughness=.1"}),
            R"({"material":"jade","list":[{"base":"jade","surface":{"roughness":0.1}}]})");
  write("text.json", "\"jade\"");
  EXPECT_TRUE(error("text.json", {"a=1"}).ends_with("which has no keys"));
}

TEST_F(JsonChanges, ANameOfAMaterialStaysAsItsBase) {
  write("a.json", R"({"lamina":"material","base":"jade","name":"b"})");
  EXPECT_EQ(read("a.json"), R"({"lamina":"material","base":"jade","name":"b"})");
  EXPECT_EQ(read("a.json", {"surface=null"}),
            R"({"lamina":"material","base":"jade","name":"b","surface":null})");
  write("b.json", R"({"lamina":"material","base":"a.json","name":"c"})");
  EXPECT_EQ(read("b.json"), R"({"lamina":"material","base":"jade","name":"c"})");
  write("c.json", R"({"lamina":"scene","base":"jade"})");
  EXPECT_NE(error("c.json").find("jade"), std::string::npos);
  const JsonDocument changes = load_json(folder_ / "a.json");
  const JsonDocument whole =
      laid_over(R"({"lamina":"material","name":"x","layers":[1]})", "jade", changes.root());
  EXPECT_EQ(JsonOutput(whole.root()).text(), R"({"lamina":"material","name":"b","layers":[1]})");
  EXPECT_TRUE(whole.root().peek("name")->where().ends_with("a.json:1: name"));
  EXPECT_EQ(whole.root().peek("layers")->where(), "jade:1: layers");
}

TEST_F(JsonChanges, SettingsThatAreWrongAreNamed) {
  write("a.json", R"({"camera":{"fov":3},"lights":[{"scale":1}]})");
  EXPECT_EQ(error("a.json", {"lights[1].scale=3"}),
            "--set lights[1].scale: lights has 1 elements, counted from 0; [+] adds one");
  EXPECT_EQ(
      error("a.json", {"lights.scale=3"}),
      "--set lights.scale: lights is an array: go on with the number of an element, such as [0]");
  EXPECT_EQ(error("a.json", {"camera.fov.x=3"}),
            "--set camera.fov.x: camera.fov is 3, which has no keys");
  EXPECT_EQ(error("a.json", {"camera.fow=null"}),
            "--set camera.fow: there is nothing to remove; did you mean \"fov\"?");
  EXPECT_EQ(error("a.json", {"camera"}),
            "--set: must be KEY=VALUE, such as camera.look_at=[0,1,0], but is \"camera\"");
  EXPECT_TRUE(error("a.json", {"camera..fov=3"}).starts_with("--set camera..fov: must be a path"));
  MemoryBudget memory;
  const std::vector<std::string> settings = {"camera.fow=3", "camera.fov=[1, \"x\"]"};
  const JsonDocument document = load_json(folder_ / "a.json", memory, settings);
  const JsonInput camera = *document.root().peek("camera");
  try {
    (void)camera.object({"fov", "up"});
    FAIL() << "was taken";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "--set camera.fow: camera: unknown key \"fow\"; did you mean \"fov\"?");
  }
  try {
    (void)camera.peek("fov")->numbers(2);
    FAIL() << "was taken";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "--set camera.fov: camera.fov[1] must be a number, but is \"x\"");
  }
}

}  // namespace
}  // namespace lamina
