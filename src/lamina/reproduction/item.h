// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/base/plot/plot.h"

// One table, figure or plate of a paper as data: what it shows, from which inputs, by which
// commands of lamina, and how agreement is judged. docs/reproduction.md describes the format.

namespace lamina {

enum class ReproductionQuality { draft, full };

template <>
inline constexpr auto enum_names<ReproductionQuality> =
    std::to_array<EnumName<ReproductionQuality>>({{"draft", ReproductionQuality::draft},
                                                  {"full", ReproductionQuality::full}});

/// A number or condition that goes in, and where it is from.
struct ReproductionInput {
  std::string what;
  bool is_chosen = false;  ///< by us, because the paper omits it
  std::string why;         ///< of what is chosen
};

/// A file that the commands read.
struct ReproductionFile {
  std::string name;  ///< without a folder
  std::string text;
};

/// A call of lamina, in a folder of the item's own.
struct ReproductionRun {
  std::string name;
  std::vector<std::string> arguments;  ///< without "lamina" and --json
};

/// A number of the paper, or of something else that is known, against ours.
struct NumberCheck {
  std::string text;   ///< what the number is
  std::string value;  ///< expression
  double expected = 0.0;
  std::string from;        ///< where `expected` is from
  double tolerance = 0.0;  ///< absolute
};

/// A feature of a figure that can be seen in it, as a condition.
struct FeatureCheck {
  std::string text;
  std::string condition;  ///< expression: holds if all its elements are not 0
  std::string measure;    ///< expression of a number that tells how clearly; may be empty
};

struct ReproductionCurve {
  std::string name;
  std::string x, y, error;  ///< expressions; an error may be empty
  CurveStyle style = CurveStyle::line;
  std::string color;
};

struct ReproductionPanel {
  PlotPanel axes;  ///< without curves
  std::vector<ReproductionCurve> curves;
};

struct ReproductionPicture {
  std::string file;  ///< PNG, as a run writes it
  std::string caption;
};

struct ReproductionTable {
  std::vector<std::string> columns;
  struct Row {
    std::string name;
    std::vector<std::string> cells;  ///< expressions; text if it starts with "="
  };
  std::vector<Row> rows;
};

struct ReproductionItem {
  std::string paper;  ///< as in donner_jensen_2005
  std::string id;     ///< as in dj05.table1
  std::string title;
  std::string shows;
  std::vector<ReproductionInput> inputs;
  std::vector<std::string> needs;  ///< files and folders below the sources of lamina
  std::vector<ReproductionFile> files;
  std::vector<ReproductionRun> runs;
  std::vector<std::pair<std::string, std::string>> values;  ///< names of expressions
  std::vector<NumberCheck> numbers;
  std::vector<FeatureCheck> features;
  std::vector<ReproductionPanel> panels;
  int panel_columns = 0;
  std::vector<ReproductionPicture> pictures;
  int picture_columns = 3;
  ReproductionTable table;
  std::string differs_because;  ///< said if it differs
};

/// An item from its file. In all strings `{a|b}` is a in draft and b in full quality, and an
/// element of a list that has "for": { "x": [...], ... } stands for one element per combination,
/// with `{x}` replaced in its strings.
/// @throws InvalidInput with file, line and rule.
[[nodiscard]] ReproductionItem decode_reproduction(const JsonInput& file,
                                                   ReproductionQuality quality);

/// A command line as a shell would cut it: at spaces outside of quotes.
/// @throws InvalidInput if a quote is not closed.
[[nodiscard]] std::vector<std::string> split_command(const std::string& line);

/// The items that come with lamina, by paper in the order of their years, as text of files.
struct BuiltinReproduction {
  const char* name;  ///< as in donner_jensen_2005/table_1.json
  const char* text;
};
[[nodiscard]] std::span<const BuiltinReproduction> builtin_reproductions();

}  // namespace lamina
