// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/html_page.h"

#include <span>

#include "lamina/base/io/base64.h"
#include "lamina/base/io/shell_text.h"

namespace lamina {
namespace {

constexpr std::string_view page_style = R"css(
:root { color-scheme: light dark; --ink: #1b1d21; --soft: #5b6270; --paper: #fff; --line: #d9dde3;
  --good: #1f7a44; --bad: #b3261e; --tint: #f4f5f7; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e8ec; --soft: #a2a9b5; --paper: #15171b;
  --line: #343941; --good: #6fd197; --bad: #ff8a80; --tint: #1e2127; }
  .plot img { filter: invert(.91) hue-rotate(180deg); } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 60rem; padding: 1.5rem 1rem 4rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { margin: 3rem 0 .2rem; font-size: 1.35rem;
  border-bottom: 1px solid var(--line); padding-bottom: .3rem; } h3 { margin: 2rem 0 .3rem; font-size: 1.05rem; }
p { margin: .4rem 0; } .soft { color: var(--soft); } a { color: inherit; }
.good { color: var(--good); } .bad { color: var(--bad); }
table { border-collapse: collapse; width: 100%; font-size: .9rem; margin: .6rem 0; }
th, td { text-align: left; padding: .25rem .6rem .25rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.n, th.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; } figure { margin: 0; } figure img { width: 100%; }
figure img, .plot img { max-width: 100%; height: auto; display: block; background: #fff; } figcaption { font-size: .8rem; color: var(--soft); text-align: center; }
.plot { margin: .6rem 0; } code, pre { font: .82rem/1.45 ui-monospace, monospace; }
pre { overflow-x: auto; background: var(--tint); padding: .6rem; margin: .3rem 0; }
details { margin: .4rem 0; } summary { cursor: pointer; color: var(--soft); }
@media (max-width: 40rem) { .plot { overflow-x: auto; } .plot img { max-width: none; width: max(100%, 36rem); } }
@media print { details > * { display: block; } details::details-content { content-visibility: visible; display: block; } body { max-width: none; font-size: 10.5pt; } h2, h3 { break-after: avoid; } pre { white-space: pre-wrap; } }
)css";

}  // namespace

std::string html_escaped(std::string_view text) {
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

std::string html_page(std::string_view title, std::string_view body, std::string_view style) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>" +
         html_escaped(title) + "</title><style>" + std::string(page_style) + std::string(style) +
         "</style></head><body>" + std::string(body) + "</body></html>\n";
}

std::string html_plot(std::string_view svg, std::string_view alt) {
  return "<div class=\"plot\"><img alt=\"" + html_escaped(alt) + "\" src=\"" +
         data_address("image/svg+xml", svg) + "\"></div>";
}

std::string html_table(std::span<const HtmlColumn> columns,
                       std::span<const std::vector<std::string>> rows) {
  const auto line = [&](const std::string& tag, const auto& cell) {
    std::string html = "<tr>";
    for (std::size_t i = 0; i < columns.size(); ++i)
      html +=
          "<" + tag + (columns[i].is_number ? " class=\"n\">" : ">") + cell(i) + "</" + tag + ">";
    return html + "</tr>";
  };
  std::string html =
      "<div class=\"scroll\"><table>" + line("th", [&](std::size_t i) { return columns[i].name; });
  for (const auto& row : rows) html += line("td", [&](std::size_t i) { return row[i]; });
  return html + "</table></div>";
}

std::string lamina_command_line(std::span<const std::string> arguments) {
  std::string line = "lamina";
  for (const std::string& argument : arguments) line += ' ' + shell_quoted(argument);
  return line;
}

std::string data_address(std::string_view kind, std::string_view bytes) {
  return "data:" + std::string(kind) + ";base64," + base64(std::as_bytes(std::span(bytes)));
}

}  // namespace lamina
