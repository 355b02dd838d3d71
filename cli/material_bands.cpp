// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "material_bands.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina::cli {
namespace {

constexpr double most_bands = 10'000;

[[noreturn]] void refuse_bands(const std::string& text) {
  throw InvalidInput(fmt::format(
      "--bands: must be ascending wavelengths in [200, 3000] nm as in 400:700:10 (first, last, "
      "step) or 400,540,575, but is {}",
      text));
}

std::vector<double> numbers_between(const std::string& text, char separator) {
  std::vector<double> numbers;
  std::string_view rest = text;
  while (true) {
    const std::size_t end = std::min(rest.find(separator), rest.size());
    double value = 0.0;
    const auto read = std::from_chars(rest.data(), rest.data() + end, value);
    if (read.ec != std::errc() || read.ptr != rest.data() + end) refuse_bands(text);
    numbers.push_back(value);
    if (end == rest.size()) return numbers;
    rest.remove_prefix(end + 1);
  }
}

/// The wavelengths of first:last:step or a list.
std::vector<double> wavelengths_of(const std::string& text) {
  if (text.find(':') == std::string::npos) return numbers_between(text, ',');
  const std::vector<double> range = numbers_between(text, ':');
  if (range.size() != 3 || !(range[2] > 0.0) || !(range[1] >= range[0])) refuse_bands(text);
  const double steps = std::floor((range[1] - range[0]) / range[2] + 1e-9);
  if (!(steps < most_bands)) refuse_bands(text);
  std::vector<double> wavelengths(static_cast<std::size_t>(steps) + 1);
  for (std::size_t i = 0; i < wavelengths.size(); ++i)
    wavelengths[i] = range[0] + static_cast<double>(i) * range[2];
  return wavelengths;
}

std::vector<double> parse_bands(const std::string& text) {
  if (text.empty()) return {};
  std::vector<double> wavelengths = wavelengths_of(text);
  try {
    (void)BandSet(wavelengths);
  } catch (const InvalidInput&) {
    refuse_bands(text);
  }
  return wavelengths;
}

}  // namespace

void add_material_options(const Command& command, std::string& bands,
                          std::vector<std::string>& settings) {
  command
      .add_option("--bands", bands,
                  "wavelengths in place of those of the file: first:last:step, or a list [nm]")
      .type_name("NM");
  add_settings_option(command, settings, "material", "skin.melanin or layers[0].thickness");
}

Material find_unnamed_material_at(const MaterialChoice& choice, const MemoryBudget& memory) {
  return find_sampled_material(choice.name, parse_bands(choice.bands), memory, choice.settings);
}

Material find_material_at(const MaterialChoice& choice, const MemoryBudget& memory) {
  Material material = find_unnamed_material_at(choice, memory);
  if (material.name.empty())
    material.name =
        choice.name == "-" ? "material" : std::filesystem::path(choice.name).stem().string();
  return material;
}

JsonOutput bands_json(const BandSet& bands) {
  auto list = JsonOutput::array();
  for (std::size_t band = 0; band < bands.size(); ++band) {
    if (bands.is_rgb())
      list.push_back(band_name(bands, band));
    else
      list.push_back(bands.wavelengths()[band]);
  }
  return list;
}

JsonOutput table_json(std::span<const double> table, std::size_t columns) {
  auto rows = JsonOutput::array();
  for (std::size_t i = 0; i < table.size(); i += columns)
    rows.push_back(std::vector<double>(table.begin() + static_cast<std::ptrdiff_t>(i),
                                       table.begin() + static_cast<std::ptrdiff_t>(i + columns)));
  return rows;
}

}  // namespace lamina::cli
