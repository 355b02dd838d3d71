// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/format_text.h"

#include <algorithm>

#include "lamina/base/core/number_text.h"
#include "lamina/base/io/utf8_text.h"
#include "lamina/exchange/misfit_json.h"

namespace lamina::detail {
namespace {

std::string light_text(const LightMisfit& misfit) {
  std::string text =
      printf_text("wanted %.5f, obtained %.5f", misfit.wanted_total, misfit.obtained_total);
  if (misfit.spread)
    text += printf_text("; mean square radius wanted %.4g, obtained %.4g mm^2; profile rms %.3f",
                        misfit.spread->wanted_mean_square_radius,
                        misfit.spread->obtained_mean_square_radius, misfit.spread->profile_rms);
  return text;
}

}  // namespace

std::string channels_text(const ExportInput& input) {
  if (input.channels.are_converted)
    return "channels: R, G, B of linear sRGB, from " + std::to_string(input.material.bands.size()) +
           " wavelengths: the colors of its light under D65";
  return input.channels.wavelengths.empty() ? "channels: R, G, B of linear sRGB"
                                            : "channels: wavelengths in nm";
}

std::string one_line(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const std::size_t size = printable_bytes(text);
    line += size > 0 ? text.substr(0, size) : " ";
    text.remove_prefix(std::max<std::size_t>(1, size > 0 ? size : utf8_bytes(text)));
  }
  return line;
}

std::vector<std::string> head_lines(const ExportInput& input, std::string_view written_for) {
  std::vector<std::string> lines{input.material.name + ", written by lamina for " +
                                 std::string(written_for)};
  if (!input.material.source.empty()) lines.push_back("source: " + input.material.source);
  lines.push_back(channels_text(input));
  return lines;
}

std::vector<std::string> misfit_lines(std::span<const ChannelMisfit> misfits) {
  std::vector<std::string> lines;
  for (const ChannelMisfit& misfit : misfits) {
    lines.push_back("misfit " + misfit.channel +
                    ", reflectance: " + light_text(misfit.reflectance));
    if (misfit.transmittance)
      lines.push_back("misfit " + misfit.channel +
                      ", transmittance: " + light_text(*misfit.transmittance));
  }
  return lines;
}

std::string comment(std::span<const std::string> lines, std::string_view mark) {
  std::string text;
  for (const std::string& line : lines) text += std::string(mark) + one_line(line) + "\n";
  return text;
}

std::string xml_comment(std::span<const std::string> lines) {
  std::string text = comment(lines, "  ");
  for (std::size_t i = 1; i < text.size(); ++i)
    if (text[i] == '-' && text[i - 1] == '-') text[i] = '~';
  return "<!--\n" + text + "-->\n";
}

std::string python_head(std::string_view written_for, std::span<const std::string> lines) {
  return "# -*- coding: utf-8 -*-\n# written by lamina for " + std::string(written_for) + "\n" +
         comment(lines, "# ");
}

std::string python_literal(std::string_view text) { return json_quoted(text); }

std::string numbers_text(std::span<const double> values, std::string_view separator) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += separator;
    text += number_text(value);
  }
  return text;
}

JsonOutput head_json(const ExportInput& input, std::string_view format) {
  JsonOutput json = {{"lamina", "export"},
                     {"format", format},
                     {"material", input.material.name},
                     {"source", input.material.source},
                     {"channels", input.channels.names},
                     {"mm_per_unit", input.options.mm_per_unit}};
  if (!input.channels.wavelengths.empty()) json["wavelengths_nm"] = input.channels.wavelengths;
  if (input.channels.are_converted)
    json["channels_from"] = "the colors of its light at its wavelengths, under D65";
  return json;
}

}  // namespace lamina::detail
