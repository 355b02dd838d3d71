// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/reproduction/item.h"
#include "lamina/reproduction/page.h"
#include "lamina/reproduction/run_item.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// A slab that reflects as much as its file says, twice.
// clang-format off
constexpr const char* item_text = R"json({
  "lamina": "reproduction", "version": 1,
  "paper": "hery_2003", "id": "h03.test", "title": "Slabs & sums", "shows": "Twice.",
  "inputs": [ { "what": "r", "chosen": "at will" } ],
  "files": [ { "for": { "r": [0.25, 0.5] }, "name": "slab_{r}.json", "content": { "r": "{r}", "n": "n = {r}" } } ],
  "runs": [ { "for": { "r": [0.25, 0.5] }, "name": "slab_{r}", "command": "slab slab_{r}.json --photons {10|1000}" } ],
  "values": { "both": "[a.r, b.r[0]]" },
  "numbers": [ { "text": "sum", "value": "sum(both)", "expected": 1.5, "from": "arithmetic", "within_relative": 0.01 } ],
  "features": [ { "text": "grows", "holds": "both[1] > both[0]", "measure": "both[1] / both[0]" } ],
  "figure": { "panels": [ { "curves": [ { "name": "both", "x": "[1, 2]", "y": "both" } ] } ] },
  "table": { "columns": ["what", "value", "CPU seconds"], "rows": [ { "name": "a", "cells": ["both[0]", 77] } ] },
  "differs_because": "the slab is not there"
})json";
// clang-format on

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Names of runs must be names of expressions.
std::string named() {
  std::string text =
      replaced(item_text, R"("name": "slab_{r}", "command")", R"("name": "{n}", "command")");
  return replaced(
      text, R"("runs": [ { "for": { "r": [0.25, 0.5] })",
      R"("runs": [ { "name": "a", "command": "slab slab_0.25.json --photons {10|1000}" }, { "for": { "r": [0.5], "n": ["b"] })");
}

ReproductionItem decode(const std::string& text,
                        ReproductionQuality quality = ReproductionQuality::draft) {
  return decode_reproduction(parse_json(text, "item.json").root(), quality);
}

class Reproduction : public testing::Test {
 protected:
  ReproductionResult make(const std::string& text) {
    return make_reproduction(
        decode(text), folder_, fs::current_path(),
        [&](const std::vector<std::string>& arguments, const fs::path& folder) {
          EXPECT_EQ(arguments[0], "slab");
          const auto file = load_json(folder / arguments[1]);
          const double r = file.root().peek("r")->number();
          return "{ \"r\": [" + std::to_string(2.0 * r) + "] }";
        });
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "reproduction";
};

TEST(ReproductionItem, WritesOutLoopsAndQualities) {
  const ReproductionItem item = decode(item_text);
  ASSERT_EQ(item.runs.size(), 2u);
  EXPECT_EQ(item.runs[1].name, "slab_0.5");
  EXPECT_EQ(item.runs[1].arguments,
            (std::vector<std::string>{"slab", "slab_0.5.json", "--photons", "10"}));
  EXPECT_EQ(decode(item_text, ReproductionQuality::full).runs[0].arguments[3], "1000");
  EXPECT_EQ(item.files[1].name, "slab_0.5.json");
  EXPECT_EQ(parse_json(item.files[1].text, "").root().peek("r")->number(), 0.5);
  EXPECT_EQ(parse_json(item.files[1].text, "").root().peek("n")->string(), "n = 0.5");
  EXPECT_DOUBLE_EQ(item.numbers[0].tolerance, 0.015);
}

TEST(ReproductionItem, RefusesWhatIsWrong) {
  const auto refused = [](const std::string& from, const std::string& to) {
    EXPECT_THROW((void)decode(replaced(item_text, from, to)), InvalidInput) << to;
  };
  refused(R"("hery_2003")", R"("hery_2004")");
  refused(R"("shows")", R"("show")");
  refused(R"("within_relative": 0.01)", R"("within": 1, "within_relative": 0.01)");
  refused(R"(, "within_relative": 0.01)", "");
  refused(R"("slab_{r}.json", "content")", R"("../slab_{r}.json", "content")");
  refused(R"("cells": ["both[0]", 77])", R"("cells": ["1"])");
  refused(R"(--photons {10|1000}")", R"(--photons 'x")");
  refused(R"("name": "slab_{r}", "command")", R"("name": "slab", "command")");  // twice
  refused(R"("command": "slab slab_{r}.json --photons {10|1000}")", R"("command": " ")");
  std::string unjudged = replaced(item_text, R"("numbers": [ {)", R"("inputs_": [ {)");
  EXPECT_THROW((void)decode(unjudged), InvalidInput);
}

TEST_F(Reproduction, ListsAPathOfRunsByTheirPrefix) {
  const std::string text = replaced(item_text, "[a.r, b.r[0]]", "reverse(runs('slab_', 'r[0]'))");
  const ReproductionResult result =
      make(replaced(text, "both[1] > both[0]", "both == [1, runs('slab_0.25', 'r')]"));
  EXPECT_TRUE(result.features[0].holds);
  EXPECT_THROW((void)make(replaced(text, "'slab_'", "'plate_'")), InvalidInput);
}

TEST_F(Reproduction, JudgesByNumbersAndFeatures) {
  const ReproductionResult result = make(named());
  EXPECT_EQ(result.verdict, Verdict::agrees);
  EXPECT_DOUBLE_EQ(result.numbers[0].value, 1.5);
  EXPECT_DOUBLE_EQ(*result.features[0].measure, 2.0);
  EXPECT_EQ(result.cells[0], (std::vector<std::string>{"a", "0.5", "77"}));
  EXPECT_TRUE(fs::exists(folder_ / "figure.svg"));
  EXPECT_NE(read_file_bytes(folder_ / "numbers.csv").find("panel 1,both,2,1,"), std::string::npos);
  EXPECT_EQ(read_file_bytes(folder_ / "numbers.csv").find("77"), std::string::npos);  // time
}

TEST_F(Reproduction, FlipsItsVerdictWithItsInputs) {
  // The number misses, the feature holds.
  const std::string other = replaced(replaced(named(), R"("r": [0.25, 0.5] }, "name": "slab)",
                                              R"("r": [0.25, 0.75] }, "name": "slab)"),
                                     R"("r": [0.5], "n")", R"("r": [0.75], "n")");
  EXPECT_EQ(make(other).verdict, Verdict::agrees_in_shape);
  // Neither: both slabs alike.
  const std::string alike =
      replaced(named(), R"("content": { "r": "{r}")", R"("content": { "r": 0.25)");
  const ReproductionResult result = make(alike);
  EXPECT_EQ(result.verdict, Verdict::differs);
  EXPECT_NE(format_page({&result, 1}, ReproductionQuality::draft).find("the slab is not there"),
            std::string::npos);
  const ReproductionResult unexplained =
      make(replaced(alike, ",\n  \"differs_because\": \"the slab is not there\"", ""));
  const auto summary = reproduction_json({&unexplained, 1}, ReproductionQuality::draft).text(1);
  EXPECT_NE(summary.find(R"("reason": "not so: grows")"), std::string::npos) << summary;
}

TEST_F(Reproduction, IsNotMadeWithoutWhatItNeeds) {
  const ReproductionResult result =
      make(replaced(named(), R"("inputs")", R"("needs": ["no/such/file"], "inputs")"));
  EXPECT_EQ(result.verdict, Verdict::not_made);
  EXPECT_EQ(result.why_not_made, "no/such/file is not there");
}

TEST_F(Reproduction, NamesTheRunOrValueThatIsNotThere) {
  EXPECT_THROW((void)make(replaced(named(), "sum(both)", "sum(bath)")), InvalidInput);
  EXPECT_THROW((void)make(replaced(named(), "b.r[0]", "b.r[7]")), InvalidInput);
  EXPECT_THROW((void)make(replaced(named(), "b.r[0]", "b.s")), InvalidInput);
  EXPECT_THROW((void)make(replaced(named(), "[a.r, b.r[0]]", "both")), InvalidInput);  // itself
}

TEST_F(Reproduction, IsAPageOfItsOwn) {
  const ReproductionResult result = make(named());
  const std::string page = format_page({&result, 1}, ReproductionQuality::draft);
  EXPECT_NE(page.find("Slabs &amp; sums"), std::string::npos);
  EXPECT_NE(page.find("data:image/svg+xml;base64,"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);  // nothing from a network
  const std::string summary = reproduction_json({&result, 1}, ReproductionQuality::draft).text(1);
  EXPECT_NE(summary.find(R"("title": "Slabs & sums")"), std::string::npos);
  EXPECT_NE(summary.find(R"("paper": "hery_2003")"), std::string::npos);
}

TEST_F(Reproduction, ShowsFilesAsAShellWritesThem) {
  ReproductionResult result = make(named());
  result.item.files = {{"it's; echo <x>", "a\nEND\nrm b\n"}};
  const std::string page = format_page({&result, 1}, ReproductionQuality::draft);
  EXPECT_NE(page.find("cat &gt; 'it'\\''s; echo &lt;x&gt;' &lt;&lt;'END_'\na\nEND\nrm b\nEND_\n"),
            std::string::npos)
      << page.substr(page.find("cat"), 200);
}

TEST_F(Reproduction, FindsVerdictsThatBecameWorse) {
  const ReproductionResult good = make(named());
  ReproductionResult bad = good;
  bad.verdict = Verdict::differs;
  const auto summary = [](const ReproductionResult& result) {
    return parse_json(reproduction_json({&result, 1}, ReproductionQuality::draft).text(),
                      "summary.json");
  };
  EXPECT_TRUE(worse_verdicts({&good, 1}, summary(good).root()).empty());
  EXPECT_TRUE(worse_verdicts({&good, 1}, summary(bad).root()).empty());
  EXPECT_EQ(worse_verdicts({&bad, 1}, summary(good).root()),
            std::vector<std::string>{"h03.test: differs, and was: agrees"});
}

TEST(BuiltinReproductions, CanBeRead) {
  std::map<std::string, int> ids;
  for (const BuiltinReproduction& each : builtin_reproductions()) {
    const auto document = parse_json(each.text, each.name);
    for (const auto quality : {ReproductionQuality::draft, ReproductionQuality::full}) {
      const ReproductionItem item = decode_reproduction(document.root(), quality);
      EXPECT_TRUE(std::string(each.name).starts_with(item.paper + "/")) << each.name;
      ++ids[item.id];
    }
  }
  EXPECT_FALSE(ids.empty());
  for (const auto& [id, count] : ids) EXPECT_EQ(count, 2) << id;
}

TEST(ReproductionFiles, AreTakenAndRefusedAsTheyShould) {
  const fs::path inputs = fs::path(LAMINA_SOURCE_DIR) / "tests/inputs/reproduction";
  for (const auto& file : fs::directory_iterator(inputs / "good"))
    EXPECT_NO_THROW(
        (void)decode_reproduction(load_json(file.path()).root(), ReproductionQuality::full))
        << file.path();
  int refused = 0;
  for (const auto& file : fs::directory_iterator(inputs / "bad")) {
    if (file.path().extension() != ".json") continue;
    ++refused;
    EXPECT_THROW(
        (void)decode_reproduction(load_json(file.path()).root(), ReproductionQuality::full),
        InvalidInput)
        << file.path();
  }
  EXPECT_GE(refused, 5);
}

TEST(Commands, AreCutAsAShellDoes) {
  EXPECT_EQ(split_command("a  b 'c d' e=\"f 'g\""),
            (std::vector<std::string>{"a", "b", "c d", "e=f 'g"}));
  EXPECT_TRUE(split_command(" \n ").empty());
  EXPECT_THROW((void)split_command("a 'b"), InvalidInput);
}

}  // namespace
}  // namespace lamina
