// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/html_page.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lamina/base/plot/correlation_picture.h"

namespace lamina {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

TEST(HtmlPage, NeedsNothingElseAndKeepsTextAsText) {
  const std::string page =
      html_page("a < b & \"c\"", html_plot("<svg xmlns=\"http://www.w3.org/2000/svg\"/>", "none"));
  EXPECT_NE(page.find("<title>a &lt; b &amp; &quot;c&quot;</title>"), std::string::npos);
  EXPECT_NE(page.find("data:image/svg+xml;base64,PHN2Zy"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);
}

TEST(HtmlPage, TablesHaveNumbersToTheRight) {
  const std::vector<HtmlColumn> columns = {{"name"}, {"value", true}};
  const std::vector<std::vector<std::string>> rows = {{"a", "1"}, {"b", "2"}};
  const std::string table = html_table(columns, rows);
  EXPECT_EQ(occurrences(table, "<tr>"), 3U);
  EXPECT_NE(table.find("<td>b</td><td class=\"n\">2</td>"), std::string::npos);
}

TEST(HtmlPage, CommandLinesAreAsOneTypesThem) {
  const std::vector<std::string> arguments = {"fit", "a.json", "--set", "layers[0].g=0.8"};
  EXPECT_EQ(lamina_command_line(arguments), "lamina fit a.json --set 'layers[0].g=0.8'");
}

TEST(CorrelationPicture, HasACellForEachPairWithItsNumber) {
  DenseMatrix correlation(3, 3);
  correlation.values = {1.0, 0.5, -0.997, 0.5, 1.0, 0.001, -0.997, 0.001, 1.0};
  const std::vector<std::string> names = {"sigma_a", "sigma_s", "g"};
  const std::string svg = format_correlations(names, correlation);
  EXPECT_EQ(occurrences(svg, "stroke=\"#ffffff\" stroke-width=\"1\""), 6U);
  for (const char* part : {">.50<", ">−.997<", ">0<", "sigma_s · 2"})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  EXPECT_NE(svg.find("fill=\"#ea"), std::string::npos);  // halfway from white to vermilion
}

}  // namespace
}  // namespace lamina
