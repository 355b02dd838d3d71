// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"
#include "lamina/solve/scattering/monte_carlo/mcml_output.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

const fs::path corpus = fs::path(LAMINA_SOURCE_DIR) / "tests/inputs";

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// What parse_mcml says about a text; empty if it takes it.
std::string complaint(const std::string& text) {
  try {
    static_cast<void>(parse_mcml(text, "x.mci"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(McmlInput, ReadsSeveralRunsInCentimetres) {
  const auto runs = load_mcml(corpus / "mcml/good/two_runs.mci");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].output_file, "skin.mco");
  EXPECT_EQ(runs[0].photons, 20000u);
  EXPECT_EQ(runs[0].layers.size(), 3u);
  EXPECT_EQ(runs[0].nz, 12);
  EXPECT_EQ(runs[0].nr, 11);
  EXPECT_EQ(runs[0].na, 6);
  EXPECT_DOUBLE_EQ(runs[0].dr, 0.004);
  EXPECT_DOUBLE_EQ(runs[1].layers[1].g, -0.2);
  EXPECT_DOUBLE_EQ(runs[1].layers[1].mua, 0.5);
  const LayerStack stack = layer_stack(runs[0]);
  EXPECT_DOUBLE_EQ(stack.layers()[0].medium.sigma_s, 48.0);  // 480 / cm
  EXPECT_DOUBLE_EQ(stack.layers()[0].thickness, 0.03);       // 0.003 cm
  EXPECT_TRUE(is_semi_infinite(stack));
  EXPECT_FALSE(is_semi_infinite(layer_stack(runs[1])));
}

TEST(McmlInput, ReadsTheGoodCorpus) {
  for (const auto& entry : fs::directory_iterator(corpus / "mcml/good"))
    if (entry.path().extension() == ".mci") {
      EXPECT_NO_THROW(static_cast<void>(load_mcml(entry.path()))) << entry.path();
    }
}

TEST(McmlInput, RefusesTheBadCorpusNamingTheLine) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(corpus / "mcml/bad")) {
    const std::string message = complaint(read(entry.path()));
    EXPECT_TRUE(message.starts_with("x.mci:")) << entry.path() << ": " << message;
    EXPECT_EQ(message.find('\n'), message.npos) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 35);
  EXPECT_THROW(static_cast<void>(load_mcml(corpus / "mcml/bad/no_such_file.mci")), FileError);
}

TEST(McmlInput, SaysWhatIsWrongInTheUsersWords) {
  const auto bad = [&](const char* name) {
    return complaint(read(corpus / "mcml/bad" / (std::string(name) + ".mci")));
  };
  EXPECT_EQ(bad("mua_negative"),
            "x.mci:9: run 1, layer 1: mua must be a number >= 0 [1/cm], but is \"-10\"");
  EXPECT_EQ(bad("d_zero"), "x.mci:9: run 1, layer 1: d must be a number > 0 [cm], but is \"0\"");
  EXPECT_EQ(bad("dr_missing"), "x.mci:5: run 1: dr is missing; it must be a number > 0 [cm]");
  EXPECT_EQ(bad("cut_after_9_lines"), "x.mci:10: run 1: n below is missing: the file ends");
}

// g of 1 does not turn light, and MCML reads no further than the last run.
TEST(McmlInput, TakesWhatMcmlTakes) {
  const auto straight = load_mcml(corpus / "mcml/good/g_one.mci");
  const LayerStack stack = layer_stack(straight[0]);
  EXPECT_DOUBLE_EQ(stack.layers()[0].medium.sigma_a, 1.0);
  EXPECT_EQ(stack.layers()[0].medium.sigma_s, 0.0);
  EXPECT_EQ(load_mcml(corpus / "mcml/good/goes_on.mci").size(), 1u);
  EXPECT_NE(complaint("1\n1\na\x01.mco A\n"), "");
}

// Files of old editors: with a mark of their encoding, with line ends of Macs or Windows, and
// without the format of the output, all come to the layers of the plain file.
TEST(McmlInput, TakesMarksLineEndsAndMissingFormats) {
  const std::string plain = read(corpus / "mcml/good/g_one.mci");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = plain;
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  };
  for (const std::string& text : {"\xef\xbb\xbf" + plain, with("\n", "\r"), with("\n", "\r\n"),
                                  with("a.mco A", "a.mco"), with("a.mco A", "a.mco # A")}) {
    const auto runs = parse_mcml(text, "x.mci");
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0].output_file, "a.mco");
    EXPECT_EQ(runs[0].layers[0].mua, 10.0);
    EXPECT_EQ(runs[0].nr, 2);
  }
  EXPECT_EQ(complaint(with("0.1 0.1", "0.1 x")), complaint(with("0.1 0.1\n", "0.1 x\r")));
}

// Every file that starts like a good one and ends anywhere is refused, or taken whole.
TEST(McmlInput, SurvivesTextCutAndSpoiltAnywhere) {
  const std::string text = read(corpus / "mcml/good/two_runs.mci");
  const std::size_t last = text.rfind('1') + 1;  // "1" is as good as "1.0"
  for (std::size_t i = 0; i < text.size(); ++i) {
    EXPECT_EQ(complaint(text.substr(0, i)).empty(), i >= last) << i;
    for (const char c : {'\0', '\xff', '-', 'e', '\n', '#'}) {
      std::string spoilt = text;
      spoilt[i] = c;
      static_cast<void>(complaint(spoilt));
    }
  }
}

/// The lines of a text as their words; numbers are replaced by "0", with their format kept.
std::vector<std::string> structure(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::string shape;
    bool in_number = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      const bool starts = (c >= '0' && c <= '9') || (c == '-' && i + 1 < line.size() &&
                                                     line[i + 1] >= '0' && line[i + 1] <= '9');
      const bool goes_on = in_number && (starts || c == '.' || c == 'E' || c == '+' || c == '-');
      if (goes_on) continue;
      in_number = starts;
      if (starts) {
        shape.push_back('0');
        continue;
      }
      if (c == ' ' && !shape.empty() && shape.back() == ' ') continue;  // widths follow the values
      shape.push_back(c);
    }
    lines.push_back(shape);
  }
  return lines;
}

std::string traced(const McmlRun& run) {
  return format_mcml(run, trace_photons(layer_stack(run), monte_carlo_options(run)), 1.0);
}

// A file of our own, whose numbers change with the generator, but not its shape.
TEST(McmlOutput, KeepsItsShape) {
  for (const McmlRun& run : load_mcml(corpus / "mcml/good/two_runs.mci")) {
    const fs::path stored = corpus / "mcml/good" / run.output_file;
    EXPECT_EQ(structure(traced(run)), structure(read(stored))) << stored;
  }
}

TEST(McmlOutput, HasTheLinesOfMcmlsOwnFiles) {
  const fs::path data = fs::path(LAMINA_SHARED_DATA) / "mcml";
  if (!fs::exists(data)) GTEST_SKIP() << "MCML's sample files are not here";
  for (const char* input : {"slab_matched.mci", "three_layers_two_runs.mci"})
    for (const McmlRun& run : load_mcml(data / input)) {
      const auto ours = structure(traced(run)), theirs = structure(read(data / run.output_file));
      ASSERT_EQ(ours.size(), theirs.size()) << run.output_file;
      for (std::size_t i = 0; i < ours.size(); ++i)
        ASSERT_EQ(ours[i], theirs[i]) << run.output_file << ":" << i + 1;
    }
}

/// All numbers of a section, from its head to the next blank line.
std::vector<double> section(const std::string& text, const std::string& head) {
  std::istringstream stream(text.substr(text.find("\n" + head) + 1));
  std::string line;
  std::getline(stream, line);
  std::vector<double> values;
  while (std::getline(stream, line) && !line.empty()) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (double value; words >> value;) values.push_back(value);
  }
  return values;
}

// Not for accuracy (MCML's generator is biased by 1e-3), but for units and normalisation.
TEST(McmlOutput, NumbersAreMcmlsToThePercent) {
  const fs::path data = fs::path(LAMINA_SHARED_DATA) / "mcml";
  if (!fs::exists(data)) GTEST_SKIP() << "MCML's sample files are not here";
  for (const char* input : {"slab_matched.mci", "three_layers_two_runs.mci"})
    for (McmlRun run : load_mcml(data / input)) {
      const std::string theirs = read(data / run.output_file);
      run.photons = 200'000;
      const std::string ours = traced(run);
      for (const char* head :
           {"RAT", "A_l", "A_z", "Rd_r", "Rd_a", "Tt_r", "Tt_a", "A_rz", "Rd_ra", "Tt_ra"}) {
        const auto a = section(ours, head), b = section(theirs, head);
        ASSERT_EQ(a.size(), b.size()) << run.output_file << " " << head;
        // MCML's 1e5 photons have this noise: totals and sums of the small cells, and single bins.
        double largest = 0.0, sum_a = 0.0, sum_b = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) {
          largest = std::max(largest, b[i]);
          sum_a += a[i];
          sum_b += b[i];
        }
        EXPECT_NEAR(sum_a, sum_b, 0.06 * sum_b) << run.output_file << " " << head;
        if (std::string(head).ends_with("_ra")) continue;
        for (std::size_t i = 0; i < a.size(); ++i)
          EXPECT_NEAR(a[i], b[i], 0.1 * largest)
              << run.output_file << " " << head << "[" << i << "]";
      }
    }
}

}  // namespace
}  // namespace lamina
