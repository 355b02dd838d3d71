// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/shell_text.h"
#include "lamina/base/plot/html_page.h"
#include "lamina/reproduction/internal/papers.h"

namespace lamina {
namespace {

using detail::Paper;
using detail::papers;

constexpr std::string_view reproduction_style = R"css(
:root { --shape: #8a6100; --none: var(--soft); }
@media (prefers-color-scheme: dark) { :root { --shape: #e2b84f; } }
.overview th { padding-top: 1rem; }
.verdict { font-weight: 600; white-space: nowrap; } .agrees { color: var(--good); }
.agrees_in_shape { color: var(--shape); } .differs { color: var(--bad); } .not_made { color: var(--none); }
.pictures { display: grid; gap: .6rem; }
article { break-inside: avoid; } @media (max-width: 40rem) { .pictures { grid-template-columns: 1fr 1fr !important; }
  .overview tr { display: grid; grid-template-columns: 1fr auto; border-bottom: 1px solid var(--line); }
  .overview th, .overview td { border: 0; } .overview td:nth-child(3) { grid-column: 1 / -1; } }
)css";

std::string said(Verdict verdict) {
  std::string text(name_of(verdict));
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string verdict_html(Verdict verdict) {
  return "<span class=\"verdict " + std::string(name_of(verdict)) + "\">" + said(verdict) +
         "</span>";
}

std::string difference(double value, double expected) {
  if (expected == 0.0) return printf_text("%+.2g", value);
  return printf_text("%+.2g %%", 100.0 * (value / expected - 1.0));
}

/// What a reader wants to know at a glance.
std::string short_reason(const ReproductionResult& result) {
  const ReproductionItem& item = result.item;
  if (result.verdict == Verdict::not_made) return result.why_not_made;
  if (result.verdict == Verdict::differs && !item.differs_because.empty())
    return item.differs_because;
  if (result.verdict == Verdict::agrees_in_shape) return item.features[0].text;
  for (std::size_t i = 0; i < item.features.size(); ++i)
    if (!result.features[i].holds) return "not so: " + item.features[i].text;
  std::string worst;
  double largest = -1.0;
  for (std::size_t i = 0; i < item.numbers.size(); ++i) {
    const double off = std::abs(result.numbers[i].value - item.numbers[i].expected) /
                       std::max(item.numbers[i].tolerance, 1e-300);
    if (!(off <= largest)) {
      largest = off;
      worst = item.numbers[i].text + ": " + printf_text("%.4g", result.numbers[i].value) + ", " +
              printf_text("%.4g", item.numbers[i].expected) + " expected";
    }
  }
  return worst;
}

std::string checks_html(const ReproductionResult& result) {
  const ReproductionItem& item = result.item;
  std::string html = "<div class=\"scroll\"><table>";
  if (!item.numbers.empty())
    html +=
        "<tr><th>number</th><th class=\"n\">lamina</th><th class=\"n\">expected</th>"
        "<th class=\"n\">difference</th><th class=\"n\">allowed</th><th>from</th></tr>";
  for (std::size_t i = 0; i < item.numbers.size(); ++i) {
    const NumberCheck& check = item.numbers[i];
    const CheckedNumber& found = result.numbers[i];
    html += "<tr><td>" + html_escaped(check.text) + "</td><td class=\"n\">" +
            printf_text("%.5g", found.value) + "</td><td class=\"n\">" +
            printf_text("%.5g", check.expected) + "</td><td class=\"n " +
            (found.holds ? "agrees" : "differs") + "\">" + difference(found.value, check.expected) +
            "</td><td class=\"n\">±" + printf_text("%.2g", check.tolerance) + "</td><td>" +
            html_escaped(check.from) + "</td></tr>";
  }
  html += "</table></div>";
  if (item.features.empty()) return html;
  html += "<ul>";
  for (std::size_t i = 0; i < item.features.size(); ++i) {
    const CheckedFeature& found = result.features[i];
    html += std::string("<li>") + html_escaped(item.features[i].text) +
            (found.measure ? " (" + printf_text("%.3g", *found.measure) + ")" : "") +
            ": <span class=\"" + (found.holds ? "agrees\">holds" : "differs\">does not hold") +
            "</span></li>";
  }
  return html + "</ul>";
}

/// The commands of a shell that write a file, whatever its name and lines are.
std::string written_by_shell(const ReproductionFile& file) {
  const std::string text = file.text.ends_with('\n') ? file.text : file.text + "\n";
  std::string end = "END";
  while (("\n" + text).find("\n" + end + "\n") != std::string::npos) end += "_";
  return "cat > " + shell_quoted(file.name) + " <<'" + end + "'\n" + text + end + "\n";
}

std::string article(const ReproductionResult& result) {
  const ReproductionItem& item = result.item;
  std::string html = "<article id=\"" + html_escaped(item.id) + "\"><h3>" +
                     html_escaped(item.title) + " <span class=\"soft\">" + html_escaped(item.id) +
                     "</span> — " + verdict_html(result.verdict) + "</h3><p>" +
                     html_escaped(item.shows) + "</p>";
  if (result.verdict == Verdict::not_made)
    return html + "<p class=\"soft\">" + html_escaped(result.why_not_made) + "</p></article>";
  if (!result.plot.panels.empty()) html += html_plot(format_svg(result.plot), item.title);
  if (!item.pictures.empty()) {
    const int columns = std::min(item.picture_columns, static_cast<int>(item.pictures.size()));
    html += "<div class=\"pictures\" style=\"grid-template-columns: repeat(" +
            std::to_string(columns) + ", 1fr)\">";
    for (const ReproductionPicture& picture : item.pictures)
      html += "<figure><img alt=\"" + html_escaped(picture.caption) + "\" src=\"" +
              data_address("image/png", read_file_bytes(result.folder / picture.file)) +
              "\"><figcaption>" + html_escaped(picture.caption) + "</figcaption></figure>";
    html += "</div>";
  }
  if (!item.table.rows.empty()) {
    std::vector<HtmlColumn> columns;
    for (const std::string& name : item.table.columns)
      columns.push_back({.name = html_escaped(name), .is_number = !columns.empty()});
    std::vector<std::vector<std::string>> rows = result.cells;
    for (auto& row : rows)
      for (std::string& cell : row) cell = html_escaped(cell);
    html += html_table(columns, rows);
  }
  html += checks_html(result);
  if (result.verdict == Verdict::differs && !item.differs_because.empty())
    html += "<p><b>Why it differs.</b> " + html_escaped(item.differs_because) + "</p>";
  html += "<details><summary>inputs</summary><ul>";
  for (const ReproductionInput& input : item.inputs)
    html += "<li>" + html_escaped(input.what) +
            (input.is_chosen ? " — <b>chosen by us</b>: " + html_escaped(input.why)
                             : std::string(" — given by the paper")) +
            "</li>";
  html += "</ul></details><details><summary>commands</summary><pre>";
  for (const ReproductionFile& file : item.files) html += html_escaped(written_by_shell(file));
  for (const ReproductionRun& run : item.runs)
    html += html_escaped(lamina_command_line(run.arguments)) + "\n";
  return html + "</pre></details><p class=\"soft\">" + printf_text("%.1f s", result.seconds) +
         "</p></article>";
}

std::string counts_text(std::span<const ReproductionResult> results) {
  std::string text;
  for (const auto& verdict : enum_names<Verdict>) {
    const auto count = std::ranges::count(results, verdict.value, &ReproductionResult::verdict);
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' +
            (verdict.value == Verdict::agrees            ? "agree"
             : verdict.value == Verdict::agrees_in_shape ? "agree in shape"
             : verdict.value == Verdict::differs         ? "differ"
                                                         : "not made");
  }
  return text;
}

}  // namespace

std::string format_page(std::span<const ReproductionResult> results, ReproductionQuality quality) {
  std::string html =
      "<h1>The five papers, made again</h1><p>" + counts_text(results) +
      ". Made by <code>lamina reproduce --quality " + std::string(name_of(quality)) +
      "</code>. A verdict follows from numbers and features that are checked, never from a "
      "setting.</p><table class=\"overview\">";
  for (const Paper& paper : papers) {
    std::string rows;
    for (const ReproductionResult& result : results)
      if (result.item.paper == paper.name)
        rows += "<tr><td><a href=\"#" + html_escaped(result.item.id) + "\">" +
                html_escaped(result.item.title) + "</a></td><td>" + verdict_html(result.verdict) +
                "</td><td class=\"soft\">" + html_escaped(short_reason(result)) + "</td></tr>";
    if (!rows.empty())
      html += "<tr><th colspan=\"3\">" + html_escaped(paper.title) + "</th></tr>" + rows;
  }
  html += "</table>";
  for (const Paper& paper : papers) {
    if (std::ranges::none_of(results, [&](const auto& r) { return r.item.paper == paper.name; }))
      continue;
    html += "<h2>" + html_escaped(paper.title) + "</h2><p class=\"soft\">" +
            html_escaped(paper.subject) + "</p>";
    for (const ReproductionResult& result : results)
      if (result.item.paper == paper.name) html += article(result) + "\n";
  }
  return html_page("lamina: the five papers", html, reproduction_style);
}

JsonOutput reproduction_json(std::span<const ReproductionResult> results,
                             ReproductionQuality quality) {
  JsonOutput items = JsonOutput::object();
  for (const ReproductionResult& result : results) {
    JsonOutput& entry = items[result.item.id];
    entry["paper"] = result.item.paper;
    entry["title"] = result.item.title;
    entry["verdict"] = std::string(name_of(result.verdict));
    entry["reason"] = short_reason(result);
    for (std::size_t i = 0; i < result.numbers.size(); ++i)
      entry["numbers"].push_back({{"text", result.item.numbers[i].text},
                                  {"value", result.numbers[i].value},
                                  {"expected", result.item.numbers[i].expected},
                                  {"tolerance", result.item.numbers[i].tolerance},
                                  {"holds", result.numbers[i].holds}});
    for (std::size_t i = 0; i < result.features.size(); ++i) {
      JsonOutput& feature = entry["features"].emplace_back();
      feature["text"] = result.item.features[i].text;
      if (result.features[i].measure) feature["measure"] = *result.features[i].measure;
      feature["holds"] = result.features[i].holds;
    }
  }
  return {{"lamina", "reproduction_summary"},
          {"version", 1},
          {"quality", std::string(name_of(quality))},
          {"items", items}};
}

std::vector<std::string> worse_verdicts(std::span<const ReproductionResult> results,
                                        const JsonInput& before) {
  const JsonObject file = before.file_object("reproduction_summary", 1, {"quality", "items"});
  const auto items = file.required("items");
  std::vector<std::string> worse;
  for (const ReproductionResult& result : results) {
    const auto known = items.peek(result.item.id);
    if (!known || result.verdict == Verdict::not_made) continue;
    const auto verdict = known->peek("verdict");
    if (!verdict) known->fail("has no \"verdict\"");
    const Verdict was = verdict->choice<Verdict>();
    if (was != Verdict::not_made && result.verdict > was)
      worse.push_back(result.item.id + ": " + said(result.verdict) + ", and was: " + said(was));
  }
  return worse;
}

}  // namespace lamina
