// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/run_item.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/write_places.h"
#include "lamina/reproduction/expression.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) {
  write_file_bytes(file, std::as_bytes(std::span(text)), Lasting::process);
}

/// The part of a path up to the next '.' or '[', which is taken off it.
std::string_view next_step(std::string_view& path) {
  const std::size_t end = std::min(path.find_first_of(".[", 1), path.size());
  const std::string_view step = path.substr(0, end);
  path.remove_prefix(end);
  return step;
}

/// The numbers that a path leads to: `[:]` stands for all elements.
void collect(const JsonInput& value, std::string_view path, ExpressionValue& numbers) {
  if (path.empty()) {
    if (value.is_number()) return numbers.push_back(value.number());
    if (value.is_null()) return numbers.push_back(std::nan(""));
    if (value.is_boolean()) return numbers.push_back(value.boolean() ? 1.0 : 0.0);
    for (const JsonInput& element : value.array()) collect(element, "", numbers);
    return;
  }
  const std::string_view step = next_step(path);
  if (step.starts_with('.')) {
    const auto inner = value.peek(step.substr(1));
    if (!inner) value.fail("has no key \"" + std::string(step.substr(1)) + "\"");
    return collect(*inner, path, numbers);
  }
  const std::string_view index = step.substr(1, step.size() - 2);
  const std::vector<JsonInput> elements = value.array();
  if (index == ":") {
    for (const JsonInput& element : elements) collect(element, path, numbers);
    return;
  }
  std::size_t i = 0;
  const auto [stopped, error] = std::from_chars(index.data(), index.data() + index.size(), i);
  if (error != std::errc() || stopped != index.data() + index.size() || i >= elements.size())
    value.fail("has no element " + std::string(step));
  collect(elements[i], path, numbers);
}

/// What expressions of an item can name: its values, and results of its runs.
class Results {
 public:
  Results(const ReproductionItem& item, const fs::path& folder)
      : item_(item),
        folder_(folder),
        sources_{.value = [this](std::string_view path) { return value(path); },
                 .runs = [this](const std::string& prefix,
                                const std::string& path) { return of_runs(prefix, path); },
                 .pixels =
                     [this](const std::string& file, const std::string& channel, double left,
                            double top, double right, double bottom) {
                       return pixels(file, channel, {left, top, right, bottom});
                     }} {}
  Results(const Results&) = delete;

  void add(const std::string& run, const std::string& json) {
    runs_.emplace(run, parse_json(json, item_.id + ", " + run));
  }

  [[nodiscard]] ExpressionValue list(const std::string& expression) const {
    return evaluate_expression(expression, sources_);
  }
  [[nodiscard]] double number(const std::string& expression) const {
    return evaluate_number(expression, sources_);
  }

 private:
  ExpressionValue value(std::string_view path) const {
    std::string_view rest = path;
    const std::string name(next_step(rest));
    if (const auto run = runs_.find(name); run != runs_.end()) {
      ExpressionValue numbers;
      collect(run->second.root(), rest, numbers);
      return numbers;
    }
    const auto named = std::ranges::find(item_.values, name, [](const auto& v) { return v.first; });
    if (named == item_.values.end())
      throw InvalidInput(item_.id + ": there is no value or run \"" + name + "\"");
    if (!being_evaluated_.insert(name).second)
      throw InvalidInput(item_.id + ": value \"" + name + "\" must not need itself");
    ExpressionValue result = list(named->second);
    being_evaluated_.erase(name);
    if (rest.empty()) return result;
    ExpressionValue element;
    collect(parse_json(JsonOutput(result).text(), name).root(), rest, element);
    return element;
  }

  ExpressionValue of_runs(const std::string& prefix, const std::string& path) const {
    ExpressionValue numbers;
    for (const ReproductionRun& run : item_.runs)
      if (run.name.starts_with(prefix)) collect(runs_.at(run.name).root(), "." + path, numbers);
    if (numbers.empty()) throw InvalidInput(item_.id + ": there is no run \"" + prefix + "...\"");
    return numbers;
  }

  ExpressionValue pixels(const std::string& file, const std::string& channel,
                         const std::array<double, 4>& part) const {
    auto found = pictures_.find(file);
    if (found == pictures_.end()) found = pictures_.emplace(file, load_image(folder_ / file)).first;
    const Image picture = select_channels(found->second, {channel});
    const auto edge = [](double share, int size) {
      return std::clamp(static_cast<int>(std::lround(share * size)), 0, size);
    };
    ExpressionValue values;
    for (int y = edge(part[1], picture.height); y < edge(part[3], picture.height); ++y)
      for (int x = edge(part[0], picture.width); x < edge(part[2], picture.width); ++x)
        values.push_back(static_cast<double>(*picture.at(x, y)));
    return values;
  }

  const ReproductionItem& item_;
  const fs::path& folder_;
  ExpressionSources sources_;
  std::map<std::string, JsonDocument> runs_;
  mutable std::map<std::string, Image> pictures_;
  mutable std::set<std::string> being_evaluated_;
};

Plot make_plot(const ReproductionItem& item, const Results& results) {
  Plot plot{.title = item.title, .columns = item.panel_columns};
  for (const ReproductionPanel& panel : item.panels) {
    plot.panels.push_back(panel.axes);
    for (const ReproductionCurve& given : panel.curves) {
      PlotCurve& curve = plot.panels.back().curves.emplace_back();
      curve.name = given.name;
      curve.x = results.list(given.x);
      curve.y = results.list(given.y);
      if (!given.error.empty()) curve.error = results.list(given.error);
      curve.style = given.style;
      curve.color = given.color;
    }
  }
  return plot;
}

/// The curves of a plot, the rows of a table and the checks as numbers: the same on every run, so
/// without columns of seconds.
std::string numbers_csv(const ReproductionResult& result) {
  std::string csv = "what,name,x,y,error\n";
  for (std::size_t i = 0; i < result.numbers.size(); ++i)
    csv += "number," + csv_cell(result.item.numbers[i].text) + ",," +
           number_text(result.numbers[i].value) + ",\n";
  for (std::size_t i = 0; i < result.features.size(); ++i)
    if (result.features[i].measure)
      csv += "feature," + csv_cell(result.item.features[i].text) + ",," +
             number_text(*result.features[i].measure) + ",\n";
  for (const auto& row : result.cells)
    for (std::size_t column = 1; column < row.size(); ++column) {
      if (result.item.table.columns[column].find("seconds") != std::string::npos) continue;
      csv += "table," + csv_cell(row[0] + ", " + result.item.table.columns[column]) + ",," +
             csv_cell(row[column]) + ",\n";
    }
  for (std::size_t p = 0; p < result.plot.panels.size(); ++p)
    for (const PlotCurve& curve : result.plot.panels[p].curves)
      for (std::size_t i = 0; i < curve.x.size(); ++i)
        csv += "panel " + std::to_string(p + 1) + "," + csv_cell(curve.name) + "," +
               number_text(curve.x[i]) + "," + number_text(curve.y[i]) + "," +
               (curve.error.empty() ? "" : number_text(curve.error[i])) + "\n";
  return csv;
}

}  // namespace

Verdict judge(const ReproductionResult& result) {
  if (!result.why_not_made.empty()) return Verdict::not_made;
  const bool features_hold = std::ranges::all_of(result.features, &CheckedFeature::holds);
  const bool numbers_hold = std::ranges::all_of(result.numbers, &CheckedNumber::holds);
  if (numbers_hold && features_hold && !result.numbers.empty()) return Verdict::agrees;
  return features_hold && !result.features.empty() ? Verdict::agrees_in_shape : Verdict::differs;
}

ReproductionResult make_reproduction(const ReproductionItem& item, const fs::path& folder,
                                     const fs::path& sources, const RunLamina& run) {
  const auto started = std::chrono::steady_clock::now();
  ReproductionResult result{.item = item, .folder = folder};
  for (const std::string& need : item.needs)
    if (!fs::exists(sources / need)) {
      result.why_not_made = need + " is not there";
      return result;
    }
  make_folder(folder);
  for (const ReproductionFile& file : item.files) {
    std::string text = file.text;
    const std::string_view place = "{sources}";
    for (std::size_t at = 0; (at = text.find(place, at)) != std::string::npos;)
      text.replace(at, place.size(), sources.string());
    if (!is_inside(folder / file.name, folder))  // a link that was there
      throw InvalidInput(item.id + ": " + file.name + " must be inside of its folder");
    write_text(folder / file.name, text);
  }
  Results results(item, folder);
  for (const ReproductionRun& each : item.runs) {
    std::vector<std::string> arguments = each.arguments;
    for (std::string& argument : arguments)
      if (const std::size_t at = argument.find("{sources}"); at != std::string::npos)
        argument.replace(at, std::string_view("{sources}").size(), sources.string());
    results.add(each.name, run(arguments, folder));
  }
  for (const NumberCheck& check : item.numbers) {
    const double value = results.number(check.value);
    result.numbers.push_back({value, std::abs(value - check.expected) <= check.tolerance});
  }
  for (const FeatureCheck& check : item.features) {
    const ExpressionValue holds = results.list(check.condition);
    CheckedFeature& checked = result.features.emplace_back();
    checked.holds = !holds.empty() && std::ranges::count(holds, 0.0) == 0;
    if (!check.measure.empty()) checked.measure = results.number(check.measure);
  }
  result.plot = make_plot(item, results);
  for (const ReproductionTable::Row& row : item.table.rows) {
    std::vector<std::string>& cells = result.cells.emplace_back(1, row.name);
    for (const std::string& cell : row.cells)
      cells.push_back(cell.starts_with('=') ? cell.substr(1)
                                            : printf_text("%.4g", results.number(cell)));
  }
  write_text(folder / "numbers.csv", numbers_csv(result));
  if (!result.plot.panels.empty()) write_text(folder / "figure.svg", format_svg(result.plot));
  result.verdict = judge(result);
  result.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return result;
}

}  // namespace lamina
