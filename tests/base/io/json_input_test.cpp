// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/json_input.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/io/renamed_names.h"

namespace lamina {
namespace {

/// What the error says, or "" if there is none.
std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::string refusal(const std::string& text) {
  return message_of([&] { (void)parse_json(text, "f.json"); });
}

int line_of(const std::string& text, std::string_view key) {
  const JsonDocument document = parse_json(text, "f.json");
  return document.root().peek(key).value().line();
}

TEST(JsonInput, ReadsEveryTypeOfValue) {
  const JsonDocument document = parse_json(
      R"({"n": -2.5e-1, "i": 7, "b": true, "s": "a\n\"é", "a": [1, 2.0, 3], "o": {"x": null}})",
      "f.json");
  const JsonObject object = document.root().object({"n", "i", "b", "s", "a", "o", "unused"});
  EXPECT_EQ(object.required("n").number(), -0.25);
  EXPECT_EQ(object.required("i").integer(0, 10), 7);
  EXPECT_TRUE(object.required("b").boolean());
  EXPECT_EQ(object.required("s").string(), "a\n\"é");
  EXPECT_EQ(object.required("a").numbers(3), (std::vector{1.0, 2.0, 3.0}));
  EXPECT_EQ(object.required("a").array().size(), 3U);
  EXPECT_EQ(object.required("a").array()[1].integer(0, 3), 2);
  EXPECT_TRUE(object.required("o").object({"x"}).required("x").is_null());
  EXPECT_FALSE(object.optional("unused").has_value());
  EXPECT_TRUE(object.has("n"));
  EXPECT_EQ(object.required("n").number_or_numbers(2), (std::vector{-0.25, -0.25}));
  EXPECT_EQ(object.required("a").number_or_numbers(3), (std::vector{1.0, 2.0, 3.0}));
}

TEST(JsonInput, KeepsTheOrderOfEntries) {
  const JsonDocument document = parse_json(R"({"z": 1, "a": 2, "m": 3})", "f.json");
  std::string keys;
  for (const auto& [key, value] : document.root().entries()) keys += key;
  EXPECT_EQ(keys, "zam");
}

TEST(JsonInput, SaysWhereANumberIsOutOfRange) {
  const JsonDocument document = parse_json(
      "{ \"layers\": [\n  {},\n  { \"sigma_a\": -3,\n    \"g\": [0, 1] } ] }", "head.json");
  const JsonInput layer = document.root().peek("layers")->array()[1];
  EXPECT_EQ(message_of([&] { (void)layer.peek("sigma_a")->number(at_least(0.0, "1/mm")); }),
            "head.json:3: layers[1].sigma_a must be >= 0 [1/mm], but is -3");
  EXPECT_EQ(message_of([&] { (void)layer.peek("g")->numbers(2, open_interval(-1.0, 1.0)); }),
            "head.json:4: layers[1].g[1] must lie in (-1, 1), but is 1");
  EXPECT_EQ(
      message_of([&] { (void)layer.peek("g")->numbers(2, closed_interval(200.0, 3000.0, "nm")); }),
      "head.json:4: layers[1].g[0] must lie in [200, 3000] nm, but is 0");
  EXPECT_EQ(message_of([&] { (void)layer.peek("g")->numbers(3); }),
            "head.json:4: layers[1].g must hold 3 values, but holds 2");
  EXPECT_EQ(message_of([&] { (void)layer.peek("g")->number(); }),
            "head.json:4: layers[1].g must be a number, but is an array");
  EXPECT_EQ(message_of([&] { (void)layer.peek("sigma_a")->string(); }),
            "head.json:3: layers[1].sigma_a must be a string, but is -3");
  EXPECT_EQ(message_of([&] { (void)layer.peek("sigma_a")->integer(1, 8); }),
            "head.json:3: layers[1].sigma_a must be a whole number in [1, 8], but is -3");
  EXPECT_EQ(message_of([&] { (void)document.root().array(); }),
            "head.json:1: the file must be an array, but is an object");
}

TEST(JsonInput, WhatIsNoNumberIsCalledThatWithTheRangeBesideIt) {
  const JsonDocument document = parse_json("[\"0.1\", null, 16777217, -1]", "f.json");
  const std::vector<JsonInput> values = document.root().array();
  EXPECT_EQ(message_of([&] { (void)values[0].number(closed_interval(0.0, 0.5)); }),
            "f.json:1: [0] must be a number in [0, 0.5], but is \"0.1\"");
  EXPECT_EQ(message_of([&] { (void)values[1].number(at_least(0.0, "1/mm")); }),
            "f.json:1: [1] must be a number >= 0 [1/mm], but is null");
  EXPECT_EQ(message_of([&] { (void)values[1].number(open_interval(0.0, 180.0, "deg")); }),
            "f.json:1: [1] must be a number in (0, 180) deg, but is null");
  EXPECT_EQ(message_of([&] { (void)values[2].integer(1, 1 << 24); }),
            "f.json:1: [2] must be a whole number in [1, 2^24], but is 16777217");
  EXPECT_EQ(message_of([&] { (void)values[3].integer(0, std::int64_t{1} << 53); }),
            "f.json:1: [3] must be a whole number in [0, 2^53], but is -1");
}

TEST(JsonInput, RangesHoldTheirEndsAsTheySay) {
  const JsonDocument document = parse_json("[0, 1]", "f.json");
  const JsonInput zero = document.root().array()[0], one = document.root().array()[1];
  EXPECT_EQ(zero.number(at_least(0.0)), 0.0);
  EXPECT_THROW((void)zero.number(greater_than(0.0)), InvalidInput);
  EXPECT_EQ(one.number(closed_interval(0.0, 1.0)), 1.0);
  EXPECT_THROW((void)one.number(open_interval(0.0, 1.0)), InvalidInput);
  EXPECT_THROW((void)zero.number(open_interval(0.0, 1.0)), InvalidInput);
}

TEST(JsonInput, UnknownKeySuggestsTheNearestOne) {
  const JsonDocument document = parse_json("{\n\"sigma_s\": 1,\n\"sigmaa\": 2,\n\"zzz\": 3}", "f");
  EXPECT_EQ(message_of([&] {
              (void)document.root().object({"sigma_a", "sigma_s", "zzz"});
            }),
            "f:3: unknown key \"sigmaa\"; did you mean \"sigma_a\"?");
  EXPECT_EQ(message_of([&] {
              (void)document.root().object({"sigmaa", "sigma_s"});
            }),
            "f:4: unknown key \"zzz\"");
  EXPECT_EQ(
      message_of([&] {
        (void)document.root().object({"$schema", "sigmaa", "sigma_s", "g", "ior", "thickness"});
      }),
      "f:4: unknown key \"zzz\"; it can be \"g\", \"ior\" or \"thickness\"");
}

TEST(JsonInput, MissingKeyIsNamedWithItsObject) {
  const JsonDocument document = parse_json("{\"layers\":\n[{}]}", "f");
  const JsonObject layer = document.root().peek("layers")->array()[0].object({"g"});
  EXPECT_EQ(message_of([&] { (void)layer.required("g"); }),
            "f:2: layers[0]: \"g\" is required, but missing");
}

TEST(JsonInput, ChoiceNamesTheOptions) {
  const JsonDocument document = parse_json("{\"unit\": \"mmm\", \"good\": \"cm\"}", "f");
  const auto unit = [](const JsonInput& value) {
    return value.choice<double>({{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}});
  };
  EXPECT_EQ(unit(*document.root().peek("good")), 10.0);
  EXPECT_EQ(message_of([&] { (void)unit(*document.root().peek("unit")); }),
            "f:1: unit must be \"mm\", \"cm\" or \"m\", but is \"mmm\"; did you mean \"mm\"?");
}

TEST(JsonInput, FileOfAnotherKindOrVersionIsCalledThat) {
  const auto open = [](const std::string& text) {
    return message_of([&] {
      const JsonDocument document = parse_json(text, "f");
      (void)document.root().file_object("material", 1, {"name"});
    });
  };
  EXPECT_EQ(open(R"({"lamina": "material", "version": 1, "name": ""})"), "");
  EXPECT_EQ(open(R"({"$schema": "s.json", "lamina": "material", "version": 1})"), "");
  EXPECT_EQ(open(R"({"$schema": 3, "lamina": "material", "version": 1})"),
            "f:1: $schema must be a string, but is 3");
  EXPECT_EQ(
      open(R"({"lamina": "scene", "camera": 1})"),
      "f:1: lamina must be \"material\", but is \"scene\": a scene, which lamina render and info "
      "take");
  EXPECT_EQ(open(R"({"lamina": "material", "version": 2})"), "f:1: version must be 1, but is 2");
  EXPECT_EQ(open(R"({"lamina": "material"})"), "f:1: \"version\" is required, but missing");
  EXPECT_EQ(open(R"({})"), "f:1: \"lamina\" is required, but missing");
  EXPECT_EQ(open(R"([])"), "f:1: the file must be an object, but is an array");
}

// The lexer reads one character beyond a number; that must not move it to the next line.
TEST(JsonInput, LineOfAValueIsTheLineItStandsIn) {
  EXPECT_EQ(line_of("{\"x\": 1\n}", "x"), 1);
  EXPECT_EQ(line_of("{\"x\":\n1\n}", "x"), 2);
  EXPECT_EQ(line_of("{\"x\": 1\n,\n\"y\": 2.5e3\n\n}", "y"), 3);
  EXPECT_EQ(line_of("{\"x\": 1\r\n,\r\n\"y\": 2\r\n}", "y"), 3);
  EXPECT_EQ(line_of("{ // a comment\n\"x\": 1, // another\n\"y\": true }", "y"), 3);
  EXPECT_EQ(line_of("{ /* a\nlong\ncomment */ \"x\": 1 }", "x"), 3);
  EXPECT_EQ(line_of("{\"x\": \"a\\nb\\u000a\",\n\"y\": \"\\\\\"\n}", "y"), 2);
  EXPECT_EQ(line_of("\xEF\xBB\xBF{\n\"x\": 1\n}", "x"), 2);
  EXPECT_EQ(line_of("{\"x\":\n[\n1,\n2\n]}", "x"), 2);  // arrays and objects: where they start
  EXPECT_EQ(parse_json("7", "f").root().line(), 1);
  EXPECT_EQ(parse_json("\n\n7\n", "f").root().line(), 3);
}

TEST(JsonInput, LineOfEveryElementIsRightWhateverStandsBetween) {
  rc::check("lines", [] {
    const auto gaps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 6));
    std::string text = "[";
    std::vector<int> lines;
    int line = 1;
    for (const int gap : gaps) {
      const char* const fillers[] = {"", "\n", "\r\n", "// 1\n", "/* \n\n */", " "};
      const int newlines[] = {0, 1, 1, 1, 2, 0};
      text += fillers[gap];
      line += newlines[gap];
      lines.push_back(line);
      text += gap % 2 == 0 ? "12" : gap == 3 ? "\"\\n\"" : "-1.5e2";
      const auto after = static_cast<std::size_t>((gap + 1) % 6);
      text += fillers[after];
      line += newlines[after];
      text += ",";
    }
    text += "0]";
    const JsonDocument document = parse_json(text, "f");
    const auto elements = document.root().array();
    for (std::size_t i = 0; i < lines.size(); ++i) RC_ASSERT(elements[i].line() == lines[i]);
  });
}

TEST(JsonInput, MalformedTextIsRefusedWithItsLine) {
  EXPECT_EQ(refusal(""), "f.json:1: is empty");
  EXPECT_EQ(refusal(" \n\t\n"), "f.json:1: is empty");
  EXPECT_TRUE(refusal("{\n\"a\": 1,\n}").starts_with("f.json:3: is not valid JSON: unexpected '}'"))
      << refusal("{\n\"a\": 1,\n}");
  EXPECT_TRUE(refusal("{\"a\": NaN}").starts_with("f.json:1: is not valid JSON: invalid literal"));
  EXPECT_TRUE(
      refusal("{\n\"a\": 1e999}").starts_with("f.json:2: is not valid JSON: number overflow"))
      << refusal("{\n\"a\": 1e999}");
  EXPECT_EQ(refusal("{\"a\": 1,\n\"b\": 2,\n\"a\": 3}"),
            "f.json:3: key \"a\" is here and in line 1");
  EXPECT_NE(refusal("{\"a\": [1, 2"), "");        // cut off
  EXPECT_NE(refusal("{\"a\": 1} trailing"), "");  // more than one value
  EXPECT_NE(refusal("{\"a\": \"\xff\xfe\"}"), "");
  EXPECT_NE(refusal(std::string("\x7f"
                                "ELF\x01\x00\x00\x80",
                                8)),
            "");
  EXPECT_EQ(refusal("{\"a\": 0x10}"),
            "f.json:1: is not valid JSON: invalid literal; expected '}', near 0x");
  EXPECT_EQ(refusal("{'a': 1}"),
            "f.json:1: is not valid JSON: invalid literal; expected string literal, near {'");
  EXPECT_EQ(refusal("// A comment.\nint main() {"), "f.json:2: is not valid JSON: invalid literal");
  EXPECT_NE(refusal("{\"a\": 'b'}"), "");
  EXPECT_NE(refusal("{\"a\": +1}"), "");
  EXPECT_NE(refusal("{\"a\": \"\n\"}"), "");
  EXPECT_NE(refusal("/* never ends"), "");
  EXPECT_NE(refusal(std::string(1, '\0')), "");
}

TEST(JsonInput, MessagesAreOnePrintableLineWhateverTheBytes) {
  rc::check("any bytes", [](const std::string& bytes) {
    const std::string message = refusal(bytes);
    RC_ASSERT(message.size() < 400U);
    for (const char c : message) RC_ASSERT(c >= 32 && c < 127);
  });
}

TEST(JsonInput, DeepBracketsAreRefusedAtOnce) {
  for (const std::string bracket : {"[", "{\"a\":"}) {
    std::string text;
    for (int i = 0; i < 1'000'000; ++i) text += bracket;
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(refusal(text), "f.json:1: brackets are nested deeper than 64 levels");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  }
  EXPECT_EQ(refusal(std::string(64, '[') + std::string(64, ']')), "");
  EXPECT_NE(refusal(std::string(65, '[') + std::string(65, ']')), "");
}

TEST(JsonInput, TooManyValuesAreRefused) {
  std::string text = "[";
  for (std::size_t i = 0; i < json_max_values; ++i) text += "1,";
  EXPECT_EQ(refusal(text + "1]"), "f.json:1: holds more than 2000000 values");
}

TEST(JsonInput, FileThatCannotBeReadIsAFileError) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "lamina_json_input_test";
  fs::create_directories(folder);
  EXPECT_THROW((void)load_json(folder / "missing.json"), FileError);
  EXPECT_THROW((void)load_json(folder), FileError);
  EXPECT_EQ(message_of([&] { (void)load_json("missing.json"); }),
            "missing.json: there is no such file");
  const fs::path file = folder / "good.json";
  std::ofstream(file) << "{\"image\": \"maps/a.exr\", \"absolute\": \"/b.exr\", \"none\": \"\"}";
  const JsonDocument document = load_json(file);
  EXPECT_EQ(document.root().peek("image")->file_path(), folder / "maps/a.exr");
  EXPECT_EQ(document.root().peek("absolute")->file_path(), "/b.exr");
  EXPECT_THROW((void)document.root().peek("none")->file_path(), InvalidInput);
  std::ofstream(file) << R"({"material": "pipe"})";
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const JsonDocument waits = load_json(file);  // whoever opened the pipe would wait for ever
  EXPECT_EQ(message_of([&] { (void)waits.root().peek("material")->file_path(); }),
            file.string() +
                ":1: material must be the path of a file, not of a pipe or device, "
                "but is \"pipe\"");
  fs::remove_all(folder);
}

TEST(NearestName, ForgivesSlipsButDoesNotGuess) {
  constexpr std::array<std::string_view, 4> known = {"sigma_a", "sigma_s", "g", "thickness"};
  EXPECT_EQ(nearest_name("simga_a", known), "sigma_a");
  EXPECT_EQ(nearest_name("thikness", known), "thickness");
  EXPECT_EQ(nearest_name("Thickness", known), "thickness");
  EXPECT_EQ(nearest_name("sigma_S", known), "sigma_s");  // though sigma_a is one letter away, too
  EXPECT_EQ(nearest_name("sigma_s ", known), "sigma_s");
  EXPECT_EQ(nearest_name("thick", known), "thickness");
  EXPECT_FALSE(nearest_name("melanin", known).has_value());
  EXPECT_FALSE(nearest_name(std::string(1'000'000, 'x'), known).has_value());
  EXPECT_EQ(did_you_mean("melanin", known), "");
}

TEST(NearestName, AnOldSpellingNamesTheNewOneThatIsKnownThere) {
  constexpr std::array<std::string_view, 3> methods = {"radiative_transfer", "diffusion", "exist"};
  EXPECT_EQ(nearest_name("exact", methods), "radiative_transfer");  // though "exist" is near
  EXPECT_EQ(nearest_name("exact_profile", methods), "radiative_transfer");
  constexpr std::array<std::string_view, 2> totals = {"radiative_transfer",
                                                      "radiative_transfer_profile"};
  EXPECT_EQ(nearest_name("exact_profile", totals), "radiative_transfer_profile");
  constexpr std::array<std::string_view, 2> others = {"sigma_a", "g"};
  EXPECT_FALSE(nearest_name("exact", others).has_value());
}

TEST(NearestName, RenamedNamesAreSorted) {
  EXPECT_TRUE(std::ranges::is_sorted(renamed_names, {}, &RenamedName::before));
}

enum class Fruit { apple, pear };

}  // namespace

template <>
inline constexpr auto enum_names<Fruit> = std::to_array<EnumName<Fruit>>({{"apple", Fruit::apple},
                                                                          {"pear", Fruit::pear}});

namespace {

TEST(EnumNames, OneTableReadsWritesAndRefuses) {
  EXPECT_EQ(name_of(Fruit::pear), "pear");
  EXPECT_EQ(find_enum_value<Fruit>("apple"), Fruit::apple);
  EXPECT_FALSE(find_enum_value<Fruit>("Apple").has_value());
  EXPECT_EQ(parse_json("\"pear\"", "f.json").root().choice<Fruit>(), Fruit::pear);
  EXPECT_EQ(
      message_of([] { (void)parse_json("\"paer\"", "f.json").root().choice<Fruit>(); }),
      "f.json:1: the file must be \"apple\" or \"pear\", but is \"paer\"; did you mean \"pear\"?");
  static_assert(!NamedEnum<std::byte>);
}

}  // namespace
}  // namespace lamina
