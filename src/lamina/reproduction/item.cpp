// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/item.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "lamina/base/core/error.h"
#include "lamina/base/io/json_output.h"
#include "lamina/reproduction/internal/expansion.h"
#include "lamina/reproduction/internal/papers.h"

namespace lamina {
namespace {

std::string optional_string(const JsonObject& object, std::string_view key) {
  const auto value = object.optional(key);
  return value ? value->string() : std::string();
}

/// An expression may be written as a number.
std::string expression(const JsonInput& value) {
  if (value.is_string()) return value.string();
  if (value.is_number()) return JsonOutput(value).text();
  value.refuse("must be an expression: a string or a number");
}

std::string optional_expression(const JsonObject& object, std::string_view key) {
  const auto value = object.optional(key);
  return value ? expression(*value) : std::string();
}

/// Names of files are free of folders: a run stays in the folder of its item.
std::string file_name(const JsonInput& value) {
  const std::string name = value.string();
  if (name.empty() || name.starts_with('.') ||
      name.find_first_of(std::string_view("/\0", 2)) != std::string::npos)
    value.refuse("must be the name of a file, without a folder");
  return name;
}

/// The name of an item is that of its folder, too.
std::string item_id(const JsonInput& value) {
  const std::string id = value.string();
  const auto is_letter_or_digit = [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9');
  };
  if (id.empty() || !is_letter_or_digit(id[0]) || !std::ranges::all_of(id, [&](char c) {
        return is_letter_or_digit(c) || c == '.' || c == '_' || c == '-';
      }))
    value.refuse("must be of letters, digits, '.', '_' and '-', and begin with a letter or digit");
  return id;
}

ReproductionInput decode_input(const JsonInput& input) {
  const JsonObject object = input.object({"what", "chosen"});
  ReproductionInput result{.what = object.required("what").string(), .is_chosen = false, .why = {}};
  if (const auto why = object.optional("chosen")) {
    result.is_chosen = true;
    result.why = why->string();
  }
  return result;
}

NumberCheck decode_number(const JsonInput& input) {
  const JsonObject object =
      input.object({"text", "value", "expected", "from", "within", "within_relative"});
  NumberCheck check{.text = object.required("text").string(),
                    .value = expression(object.required("value")),
                    .expected = object.required("expected").number(),
                    .from = object.required("from").string(),
                    .tolerance = 0.0};
  const auto absolute = object.optional("within"), relative = object.optional("within_relative");
  if (absolute.has_value() == relative.has_value())
    object.value().fail("needs either \"within\" or \"within_relative\"");
  check.tolerance = absolute ? absolute->number(at_least(0.0))
                             : relative->number(at_least(0.0)) * std::abs(check.expected);
  return check;
}

FeatureCheck decode_feature(const JsonInput& input) {
  const JsonObject object = input.object({"text", "holds", "measure"});
  return {.text = object.required("text").string(),
          .condition = expression(object.required("holds")),
          .measure = optional_expression(object, "measure")};
}

PlotAxis decode_axis(const JsonInput& input) {
  const JsonObject object = input.object({"label", "log", "low", "high"});
  PlotAxis axis{.label = optional_string(object, "label")};
  if (const auto log = object.optional("log"))
    axis.scale = log->boolean() ? AxisScale::logarithmic : AxisScale::linear;
  if (const auto low = object.optional("low")) axis.low = low->number();
  if (const auto high = object.optional("high")) axis.high = high->number();
  return axis;
}

ReproductionCurve decode_curve(const JsonInput& input) {
  const JsonObject object = input.object({"name", "x", "y", "error", "style", "color"});
  ReproductionCurve curve{.name = optional_string(object, "name"),
                          .x = expression(object.required("x")),
                          .y = expression(object.required("y")),
                          .error = optional_expression(object, "error"),
                          .color = optional_string(object, "color")};
  if (const auto style = object.optional("style"))
    curve.style = style->choice<CurveStyle>({{"line", CurveStyle::line},
                                             {"dashed", CurveStyle::dashed},
                                             {"dotted", CurveStyle::dotted},
                                             {"points", CurveStyle::points},
                                             {"line_and_points", CurveStyle::line_and_points}});
  return curve;
}

ReproductionPanel decode_panel(const JsonInput& input) {
  const JsonObject object = input.object({"title", "polar", "x", "y", "curves", "arrow"});
  ReproductionPanel panel;
  panel.axes.title = optional_string(object, "title");
  if (const auto polar = object.optional("polar"))
    panel.axes.kind = polar->boolean() ? PlotPanelKind::polar : PlotPanelKind::cartesian;
  if (const auto x = object.optional("x")) panel.axes.x = decode_axis(*x);
  if (const auto y = object.optional("y")) panel.axes.y = decode_axis(*y);
  if (const auto arrow = object.optional("arrow")) panel.axes.arrow_angle = arrow->number();
  for (const JsonInput& curve : object.required("curves").array(1))
    panel.curves.push_back(decode_curve(curve));
  return panel;
}

ReproductionTable decode_table(const JsonInput& input) {
  const JsonObject object = input.object({"columns", "rows"});
  ReproductionTable table;
  for (const JsonInput& column : object.required("columns").array(1))
    table.columns.push_back(column.string());
  for (const JsonInput& given : object.required("rows").array(1)) {
    const JsonObject row = given.object({"name", "cells"});
    ReproductionTable::Row& added = table.rows.emplace_back();
    added.name = row.required("name").string();
    for (const JsonInput& cell :
         row.required("cells").array(table.columns.size() - 1, table.columns.size() - 1))
      added.cells.push_back(expression(cell));
  }
  return table;
}

ReproductionRun decode_run(const JsonInput& input) {
  const JsonObject object = input.object({"name", "command"});
  const JsonInput command = object.required("command");
  ReproductionRun run{.name = object.required("name").string(), .arguments = {}};
  try {
    run.arguments = split_command(command.string());
  } catch (const InvalidInput& error) {
    command.fail(error.what());
  }
  if (run.arguments.empty()) command.refuse("must name a subcommand");
  // They would start other programs, or write for other folders.
  for (const std::string_view refused : {"submit", "status", "reproduce"})
    if (run.arguments[0] == refused)
      command.fail("must be a command that computes, but is \"" + run.arguments[0] + "\"");
  return run;
}

ReproductionItem decode_expanded(const JsonInput& root) {
  const JsonObject file = root.file_object(
      "reproduction", 1,
      {"paper", "id", "title", "shows", "inputs", "needs", "files", "runs", "values", "numbers",
       "features", "figure", "pictures", "picture_columns", "table", "differs_because"});
  ReproductionItem item;
  std::vector<std::string_view> papers;
  for (const detail::Paper& paper : detail::papers) papers.push_back(paper.name);
  item.paper = std::string(papers[file.required("paper").choice(papers)]);
  item.id = item_id(file.required("id"));
  item.title = file.required("title").string();
  item.shows = file.required("shows").string();
  for (const JsonInput& input : file.required("inputs").array())
    item.inputs.push_back(decode_input(input));
  if (const auto needs = file.optional("needs"))
    for (const JsonInput& need : needs->array()) item.needs.push_back(need.string());
  if (const auto files = file.optional("files"))
    for (const JsonInput& given : files->array()) {
      const JsonObject object = given.object({"name", "content"});
      item.files.push_back({file_name(object.required("name")),
                            JsonOutput(object.required("content")).text(1) + "\n"});
    }
  for (const JsonInput& run : file.required("runs").array(1)) {
    item.runs.push_back(decode_run(run));
    const std::string& name = item.runs.back().name;
    if (std::ranges::count(item.runs, name, &ReproductionRun::name) > 1)
      run.refuse("must have a name of its own");
  }
  if (const auto values = file.optional("values"))
    for (const auto& [name, value] : values->entries())
      item.values.emplace_back(name, expression(value));
  if (const auto numbers = file.optional("numbers"))
    for (const JsonInput& check : numbers->array()) item.numbers.push_back(decode_number(check));
  if (const auto features = file.optional("features"))
    for (const JsonInput& check : features->array()) item.features.push_back(decode_feature(check));
  if (item.numbers.empty() && item.features.empty())
    root.fail("needs \"numbers\" or \"features\": what is not judged is no reproduction");
  if (const auto figure = file.optional("figure")) {
    const JsonObject object = figure->object({"columns", "panels"});
    if (const auto columns = object.optional("columns"))
      item.panel_columns = static_cast<int>(columns->integer(1, 20));
    for (const JsonInput& panel : object.required("panels").array(1))
      item.panels.push_back(decode_panel(panel));
  }
  if (const auto pictures = file.optional("pictures"))
    for (const JsonInput& given : pictures->array()) {
      const JsonObject object = given.object({"file", "caption"});
      item.pictures.push_back(
          {file_name(object.required("file")), object.required("caption").string()});
    }
  if (const auto columns = file.optional("picture_columns"))
    item.picture_columns = static_cast<int>(columns->integer(1, 12));
  if (const auto table = file.optional("table")) item.table = decode_table(*table);
  item.differs_because = optional_string(file, "differs_because");
  return item;
}

}  // namespace

ReproductionItem decode_reproduction(const JsonInput& file, ReproductionQuality quality) {
  const std::string where = file.where();
  const std::string name = where.substr(0, where.find_last_of(':'));
  return decode_expanded(
      parse_json(detail::expanded(file, quality == ReproductionQuality::full).text(1), name)
          .root());
}

std::vector<std::string> split_command(const std::string& line) {
  std::vector<std::string> words;
  char quote = '\0';
  bool is_in_word = false;
  for (const char c : line) {
    if (quote != '\0') {
      if (c == quote)
        quote = '\0';
      else
        words.back() += c;
    } else if (c == ' ' || c == '\n') {
      is_in_word = false;
    } else {
      if (!is_in_word) words.emplace_back();
      is_in_word = true;
      if (c == '\'' || c == '"')
        quote = c;
      else
        words.back() += c;
    }
  }
  if (quote != '\0') throw InvalidInput(std::string("must have a closing ") + quote);
  return words;
}

}  // namespace lamina
