// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"
#include "lamina/layers/materials/builtin_texts.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/skin/fit/measured/decoded_free.h"
#include "lamina/skin/fit/measured/decoded_series.h"
#include "lamina/skin/fit/measured/decoded_timed_series.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {
namespace {

using fit_detail::decode_free;
using fit_detail::decode_population;
using fit_detail::DecodedSeries;

/// Inline, of a file, or of a built-in material.
MeasuredMaterial decode_measured_material(const JsonInput& value, const std::string& file) {
  if (value.is_object()) {
    (void)decode_material(value);  // so that messages have the lines of this file
    if (value.peek("base")) return {JsonOutput(material_with_base(value).root()).text(), file};
    return {JsonOutput(value).text(), file};
  }
  const std::string name = value.string();
  if (std::ranges::count(builtin_material_names(), name) > 0)
    return {builtin_material_text(name), name};
  const std::filesystem::path path = value.file_path();
  return {read_file_bytes(path, value.memory()), path.string()};
}

void add_stated_numbers(const JsonInput& value, std::vector<StatedNumber>& numbers) {
  if (value.is_number()) {
    numbers.push_back({value.path(), {value.number()}});
  } else if (value.is_array()) {
    const std::vector<JsonInput> elements = value.array();
    if (elements.empty() || !std::ranges::all_of(elements, &JsonInput::is_number)) {
      for (const JsonInput& element : elements) add_stated_numbers(element, numbers);
      return;
    }
    StatedNumber& number = numbers.emplace_back(StatedNumber{value.path(), {}});
    for (const JsonInput& element : elements) number.values.push_back(element.number());
  } else if (value.is_object()) {
    for (const auto& [key, entry] : value.entries())
      if (key != "version" && key != "bands") add_stated_numbers(entry, numbers);
  }
}

/// The bands of all entries: their wavelengths, or without such those of the material.
void set_bands(const JsonInput& measured, std::vector<DecodedSeries> entries,
               Measurement& measurement) {
  const std::vector<JsonInput> places = measured.array();
  std::vector<double> all;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].wavelengths.empty() != entries[0].wavelengths.empty())
      places[i].fail("must have wavelengths if others have");
    all.insert(all.end(), entries[i].wavelengths.begin(), entries[i].wavelengths.end());
  }
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  const Material own = measurement.material.with({});
  measurement.bands = all.empty() ? own.bands : BandSet(all);
  if (!all.empty() && own.bands.is_rgb())
    places[0].fail("has wavelengths, but the material has the bands R, G and B");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    auto& [series, wavelengths] = entries[i];
    std::size_t rows = 1;
    for (const MeasuredPoint& point : series.points) rows = std::max(rows, point.band + 1);
    const bool has_rows_for_bands = series.kind == MeasurementKind::totals;
    if (wavelengths.empty() && (has_rows_for_bands ? rows : 1) != own.bands.size())
      places[i].fail("has no wavelengths; it must have a row for each band of the material, " +
                     std::to_string(own.bands.size()) + ", but has " +
                     std::to_string(has_rows_for_bands ? rows : 1));
    for (std::size_t p = 0; p < wavelengths.size(); ++p)
      series.points[p].band =
          static_cast<std::size_t>(std::ranges::lower_bound(all, wavelengths[p]) - all.begin());
    measurement.series.push_back(std::move(series));
  }
}

/// What the file asks for must be possible: each path in the material, and enough numbers.
void check_free(const JsonInput& free, Measurement& measurement) {
  const std::vector<JsonInput> places = free.array();
  const std::size_t bands = measurement.bands.size();
  std::size_t unknowns = 0, points = 0;
  std::string names;
  std::set<std::string> paths;
  std::vector<std::vector<double>> values;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const FreeNumber& number = measurement.free[i];
    for (const std::string& path : number.paths())
      if (!paths.insert(path).second) places[i].fail(path + " is free already");
    values.push_back(number.starts(bands));
    if (number.parameter.prior) continue;
    unknowns += number.is_per_band ? bands : 1;
    names += (names.empty() ? "" : ", ") + number.parameter.name;
  }
  for (const MeasuredSeries& series : measurement.series)
    points += series.points.size() -
              std::min(series.points.size(), fit_detail::count_unknown_factors(series));
  if (points < unknowns)
    free.fail(std::to_string(points) + " measured numbers cannot tell " + std::to_string(unknowns) +
              " free ones; " + std::to_string(unknowns - points) +
              " of them must have a \"prior\", or be fixed: " + names);
  try {
    const std::vector<LayerStack> stacks = layer_stacks(material_with(measurement, values));
    for (const MeasuredSeries& series : measurement.series)
      for (const MeasuredPoint& point : series.points)
        if (point.sphere && point.quantity == MeasuredQuantity::transmittance)
          (void)lit_from_below({&stacks[point.band], 1});  // as its sphere does
  } catch (const InvalidInput& error) {
    const std::string message = error.what();
    const std::string option = "--set ";
    free.fail("with all numbers at their start: " +
              (message.starts_with(option) ? message.substr(option.size()) : message));
  }
}

}  // namespace

Material MeasuredMaterial::with(std::span<const std::string> settings) const {
  MemoryBudget memory;
  const JsonDocument document = parse_json(text, name, memory, settings);
  return decode_material(document.root());
}

std::vector<StatedNumber> stated_numbers(const MeasuredMaterial& material) {
  MemoryBudget memory;
  const JsonDocument document = parse_json(material.text, material.name, memory);
  std::vector<StatedNumber> numbers;
  add_stated_numbers(document.root(), numbers);
  return numbers;
}

Material material_with(const Measurement& measurement,
                       std::span<const std::vector<double>> values) {
  const auto list = [](std::span<const double> numbers) {
    std::string text;
    for (const double number : numbers) text += (text.empty() ? "[" : ",") + number_text(number);
    return text + "]";
  };
  std::vector<std::string> settings;
  if (!measurement.bands.is_rgb())
    settings.push_back("bands=" + list(measurement.bands.wavelengths()));
  for (std::size_t i = 0; i < measurement.free.size(); ++i) {
    const FreeNumber& free = measurement.free[i];
    const std::string value =
        "=" + (free.is_per_band ? list(values[i]) : number_text(values[i][0]));
    for (const std::string& path : free.paths()) settings.push_back(path + value);
  }
  return measurement.material.with(settings);
}

Measurement load_measurement(const JsonFile& file, MemoryBudget memory,
                             std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  const JsonObject root = document.root().file_object(
      "measurement", 1,
      {"name", "source", "material", "population", "free", "measured", "starts", "robust_limit"});
  Measurement measurement;
  if (const auto name = root.optional("name")) measurement.name = name->string();
  if (const auto source = root.optional("source")) measurement.source = source->string();
  measurement.material = decode_measured_material(root.required("material"), file.path.string());
  if (const auto population = root.optional("population"))
    measurement.population = decode_population(*population, measurement.material);
  const std::vector<JsonInput> free_numbers = root.required("free").array(1, 100);
  if (const auto starts = root.optional("starts"))
    measurement.starts = static_cast<int>(starts->integer(1, 1000));
  if (const auto limit = root.optional("robust_limit"))
    measurement.robust_limit = limit->number(closed_interval(0.0, 100.0));
  std::vector<DecodedSeries> entries;
  for (const JsonInput& entry : root.required("measured").array(1, 100))
    entries.push_back(fit_detail::decode_series(entry));
  set_bands(root.required("measured"), std::move(entries), measurement);
  if (measurement.population && measurement.bands.is_rgb())
    root.required("population").fail("needs wavelengths, which were not measured");
  const std::vector<StatedNumber> stated = stated_numbers(measurement.material);
  for (const JsonInput& free : free_numbers)
    measurement.free.push_back(decode_free(free, stated, measurement));
  check_free(root.required("free"), measurement);
  return measurement;
}

}  // namespace lamina
