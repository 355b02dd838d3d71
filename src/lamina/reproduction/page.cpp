// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/io/base64.h"
#include "lamina/io/file_bytes.h"
#include "lamina/reproduction/internal/papers.h"

namespace lamina {
namespace {

using detail::Paper;
using detail::papers;

constexpr std::string_view style = R"css(
:root { color-scheme: light dark; --ink: #1b1d21; --soft: #5b6270; --paper: #fff; --line: #d9dde3;
  --good: #1f7a44; --shape: #8a6100; --bad: #b3261e; --none: #5b6270; --tint: #f4f5f7; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e8ec; --soft: #a2a9b5; --paper: #15171b;
  --line: #343941; --good: #6fd197; --shape: #e2b84f; --bad: #ff8a80; --none: #a2a9b5; --tint: #1e2127; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 60rem; padding: 1.5rem 1rem 4rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { margin: 3rem 0 .2rem; font-size: 1.35rem;
  border-bottom: 1px solid var(--line); padding-bottom: .3rem; } h3 { margin: 2rem 0 .3rem; font-size: 1.05rem; }
p { margin: .4rem 0; } .soft { color: var(--soft); } a { color: inherit; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; margin: .6rem 0; }
th, td { text-align: left; padding: .25rem .6rem .25rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.n, th.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; } .overview th { padding-top: 1rem; }
.verdict { font-weight: 600; white-space: nowrap; } .agrees { color: var(--good); }
.agrees_in_shape { color: var(--shape); } .differs { color: var(--bad); } .not_made { color: var(--none); }
.pictures { display: grid; gap: .6rem; } figure { margin: 0; } figure img { width: 100%; }
figure img, .plot img { max-width: 100%; height: auto; display: block; background: #fff; } figcaption { font-size: .8rem; color: var(--soft); text-align: center; }
.plot { margin: .6rem 0; } code, pre { font: .82rem/1.45 ui-monospace, monospace; }
pre { overflow-x: auto; background: var(--tint); padding: .6rem; margin: .3rem 0; }
details { margin: .4rem 0; } summary { cursor: pointer; color: var(--soft); }
article { break-inside: avoid; } @media (max-width: 40rem) { .pictures { grid-template-columns: 1fr 1fr !important; }
  .plot { overflow-x: auto; } .plot img { max-width: none; width: max(100%, 36rem); }
  .overview tr { display: grid; grid-template-columns: 1fr auto; border-bottom: 1px solid var(--line); }
  .overview th, .overview td { border: 0; } .overview td:nth-child(3) { grid-column: 1 / -1; } }
@media print { details > * { display: block; } body { max-width: none; } }
)css";

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string said(Verdict verdict) {
  std::string text(name_of(verdict));
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string verdict_html(Verdict verdict) {
  return "<span class=\"verdict " + std::string(name_of(verdict)) + "\">" + said(verdict) +
         "</span>";
}

/// Quotes what a shell would cut or change.
std::string command_line(const ReproductionRun& run) {
  std::string line = "lamina";
  for (const std::string& argument : run.arguments) {
    const bool is_plain = argument.find_first_of(" '\"[]{}()*?$&;|<>#~") == std::string::npos;
    line += is_plain ? ' ' + argument : " '" + argument + "'";
  }
  return line;
}

std::string data_uri(const std::string& kind, const std::string& bytes) {
  return "data:" + kind + ";base64," + base64(std::as_bytes(std::span(bytes)));
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
    html += "<tr><td>" + escaped(check.text) + "</td><td class=\"n\">" +
            printf_text("%.5g", found.value) + "</td><td class=\"n\">" +
            printf_text("%.5g", check.expected) + "</td><td class=\"n " +
            (found.holds ? "agrees" : "differs") + "\">" + difference(found.value, check.expected) +
            "</td><td class=\"n\">±" + printf_text("%.2g", check.tolerance) + "</td><td>" +
            escaped(check.from) + "</td></tr>";
  }
  html += "</table></div>";
  if (item.features.empty()) return html;
  html += "<ul>";
  for (std::size_t i = 0; i < item.features.size(); ++i) {
    const CheckedFeature& found = result.features[i];
    html += std::string("<li>") + escaped(item.features[i].text) +
            (found.measure ? " (" + printf_text("%.3g", *found.measure) + ")" : "") +
            ": <span class=\"" + (found.holds ? "agrees\">holds" : "differs\">does not hold") +
            "</span></li>";
  }
  return html + "</ul>";
}

std::string article(const ReproductionResult& result) {
  const ReproductionItem& item = result.item;
  std::string html = "<article id=\"" + escaped(item.id) + "\"><h3>" + escaped(item.title) +
                     " <span class=\"soft\">" + escaped(item.id) + "</span> — " +
                     verdict_html(result.verdict) + "</h3><p>" + escaped(item.shows) + "</p>";
  if (result.verdict == Verdict::not_made)
    return html + "<p class=\"soft\">" + escaped(result.why_not_made) + "</p></article>";
  if (!result.plot.panels.empty())
    html += "<div class=\"plot\"><img alt=\"" + escaped(item.title) + "\" src=\"" +
            data_uri("image/svg+xml", format_svg(result.plot)) + "\"></div>";
  if (!item.pictures.empty()) {
    const int columns = std::min(item.picture_columns, static_cast<int>(item.pictures.size()));
    html += "<div class=\"pictures\" style=\"grid-template-columns: repeat(" +
            std::to_string(columns) + ", 1fr)\">";
    for (const ReproductionPicture& picture : item.pictures)
      html += "<figure><img alt=\"" + escaped(picture.caption) + "\" src=\"" +
              data_uri("image/png", read_file_bytes(result.folder / picture.file)) +
              "\"><figcaption>" + escaped(picture.caption) + "</figcaption></figure>";
    html += "</div>";
  }
  if (!item.table.rows.empty()) {
    html += "<div class=\"scroll\"><table><tr>";
    for (std::size_t i = 0; i < item.table.columns.size(); ++i)
      html += std::string(i > 0 ? "<th class=\"n\">" : "<th>") + escaped(item.table.columns[i]) +
              "</th>";
    html += "</tr>";
    for (const auto& row : result.cells) {
      html += "<tr>";
      for (std::size_t i = 0; i < row.size(); ++i)
        html += std::string(i > 0 ? "<td class=\"n\">" : "<td>") + escaped(row[i]) + "</td>";
      html += "</tr>";
    }
    html += "</table></div>";
  }
  html += checks_html(result);
  if (result.verdict == Verdict::differs && !item.differs_because.empty())
    html += "<p><b>Why it differs.</b> " + escaped(item.differs_because) + "</p>";
  html += "<details><summary>inputs</summary><ul>";
  for (const ReproductionInput& input : item.inputs)
    html += "<li>" + escaped(input.what) +
            (input.is_chosen ? " — <b>chosen by us</b>: " + escaped(input.why)
                             : std::string(" — given by the paper")) +
            "</li>";
  html += "</ul></details><details><summary>commands</summary><pre>";
  for (const ReproductionFile& file : item.files)
    html += "cat > " + escaped(file.name) + " &lt;&lt;'END'\n" + escaped(file.text) + "END\n";
  for (const ReproductionRun& run : item.runs) html += escaped(command_line(run)) + "\n";
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

std::string paper_title(std::string_view paper) {
  const auto found = std::ranges::find(papers, paper, &Paper::name);
  return std::string(found == papers.end() ? paper : found->title);
}

std::string format_page(std::span<const ReproductionResult> results, ReproductionQuality quality) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>lamina: the five papers</title><style>" +
      std::string(style) + "</style></head><body><h1>The five papers, made again</h1><p>" +
      counts_text(results) + ". Made by <code>lamina reproduce --quality " +
      std::string(name_of(quality)) +
      "</code>. A verdict follows from numbers and features that are checked, never from a "
      "setting.</p><table class=\"overview\">";
  for (const Paper& paper : papers) {
    std::string rows;
    for (const ReproductionResult& result : results)
      if (result.item.paper == paper.name)
        rows += "<tr><td><a href=\"#" + escaped(result.item.id) + "\">" +
                escaped(result.item.title) + "</a></td><td>" + verdict_html(result.verdict) +
                "</td><td class=\"soft\">" + escaped(short_reason(result)) + "</td></tr>";
    if (!rows.empty())
      html += "<tr><th colspan=\"3\">" + escaped(paper.title) + "</th></tr>" + rows;
  }
  html += "</table>";
  for (const Paper& paper : papers) {
    if (std::ranges::none_of(results, [&](const auto& r) { return r.item.paper == paper.name; }))
      continue;
    html +=
        "<h2>" + escaped(paper.title) + "</h2><p class=\"soft\">" + escaped(paper.subject) + "</p>";
    for (const ReproductionResult& result : results)
      if (result.item.paper == paper.name) html += article(result) + "\n";
  }
  return html + "</body></html>\n";
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
