// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

// Pages of results: one HTML file that needs nothing else, no network and no script; light or dark
// as its reader has it, on a phone, and on paper.

namespace lamina {

/// Text with the characters that HTML keeps for itself replaced.
[[nodiscard]] std::string html_escaped(std::string_view text);

/// A whole page. Its style knows the classes `soft` (text beside the matter), `n` (cells of
/// numbers), `scroll` (wide tables), `good` and `bad`, and the colors --ink, --soft, --paper,
/// --line, --tint, --good and --bad.
/// @param title  plain text
/// @param body   HTML
/// @param style  CSS that follows the page's own
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body,
                                    std::string_view style = {});

/// A drawing on white, as format_svg makes it; darkened where the page is dark.
/// @param alt  what it shows, plain text
[[nodiscard]] std::string html_plot(std::string_view svg, std::string_view alt);

struct HtmlColumn {
  std::string name;        ///< HTML
  bool is_number = false;  ///< to the right
};

/// A table, which scrolls if it is wide.
/// @param rows  [row][column] HTML
[[nodiscard]] std::string html_table(std::span<const HtmlColumn> columns,
                                     std::span<const std::vector<std::string>> rows);

/// `lamina` with arguments as one types it, in quotes what a shell would cut or change. Plain text.
[[nodiscard]] std::string lamina_command_line(std::span<const std::string> arguments);

/// The address of a file that is within the page. @param kind  as in "image/png"
[[nodiscard]] std::string data_address(std::string_view kind, std::string_view bytes);

}  // namespace lamina
