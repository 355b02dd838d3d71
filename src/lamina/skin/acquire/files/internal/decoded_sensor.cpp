// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/internal/decoded_sensor.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "lamina/base/core/number_text.h"
#include "lamina/base/spectrum/cie_1931.h"
#include "lamina/base/spectrum/spectrum_table.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/lookup/skin_lookup.h"

namespace lamina::acquire_detail {
namespace {

void require_channels(const JsonInput& value, std::size_t bands,
                      const std::vector<std::string>& channels) {
  if (bands == channels.size()) return;
  std::string names;
  for (const std::string& name : channels) names += (names.empty() ? "" : ", ") + name;
  value.fail("must be a sensor of as many bands as the image has channels, but has " +
             std::to_string(bands) + " for " + names);
}

DecodedSensor decode_srgb(const JsonInput& value, const std::vector<std::string>& channels) {
  require_channels(value, 3, channels);
  const auto& [nm, weights] = srgb_sensor();
  DecodedSensor sensor{.names = {"R", "G", "B"}};
  for (std::size_t c = 0; c < 3; ++c) {
    BandWeightsOverWavelengths& band = sensor.bands.emplace_back();
    for (std::size_t w = 0; w < nm.size(); ++w) band.push_back({nm[w], weights(c, w)});
  }
  return sensor;
}

DecodedSensor decode_bands(const JsonObject& object, const std::vector<std::string>& channels) {
  const JsonInput wavelengths = object.required("wavelength_nm");
  constexpr std::size_t most_bands = 64;
  std::vector<CandidateBand> bands;
  const NumberRange range = closed_interval(350.0, 1000.0, "nm");
  if (wavelengths.is_array())
    for (const JsonInput& each : wavelengths.array(1, most_bands))
      bands.push_back({each.number(range)});
  else
    bands.push_back({wavelengths.number(range)});
  require_channels(wavelengths, bands.size(), channels);
  if (const auto widths = object.optional("width_nm")) {
    const std::vector<double> given =
        widths->number_or_numbers(bands.size(), closed_interval(0.0, 200.0, "nm"));
    for (std::size_t b = 0; b < bands.size(); ++b) bands[b].width = given[b];
  }
  DecodedSensor sensor;
  for (const CandidateBand& band : bands) {
    sensor.names.push_back(number_text(band.wavelength) + "nm");
    sensor.bands.push_back(band_samples(band));
  }
  return sensor;
}

/// The light that falls on the skin, as one of the named or as a table of its spectrum.
struct Light {
  Illuminant named = Illuminant::d65;
  std::optional<SpectrumTable> table;
  [[nodiscard]] double at(double nm) const {
    if (!table) return illuminant_power(named, nm);
    return table->covers(nm) ? interpolate(*table, nm) : 0.0;
  }
};
Light decode_light(const JsonObject& object) {
  Light light;
  const auto given = object.optional("illuminant");
  if (!given) return light;
  const std::string name = given->string();
  if (name.ends_with(".csv"))
    light.table = read_spectrum(load_csv(given->file_path(), given->memory()), "", at_least(0.0));
  else
    light.named = given->choice<Illuminant>({{"d65", Illuminant::d65},
                                             {"a", Illuminant::a},
                                             {"equal_energy", Illuminant::equal_energy}});
  return light;
}

/// Wavelengths as channels are called: "540nm".
DecodedSensor decode_channels(const JsonInput& value, const std::vector<std::string>& channels) {
  DecodedSensor sensor{.names = channels};
  for (const std::string& name : channels) {
    double nm = 0.0;
    const char* end = name.data() + name.size();
    const auto read = std::from_chars(name.data(), end, nm);
    if (read.ec != std::errc() || std::string_view(read.ptr, end) != "nm" ||
        !(350.0 <= nm && nm <= 1000.0))
      value.fail(
          "takes wavelengths of 350 to 1000 nm from names of channels as 540nm, but one is " +
          name);
    sensor.bands.push_back({{nm, 1.0}});
  }
  return sensor;
}

DecodedSensor decode_curves(const JsonObject& object, const std::vector<std::string>& channels) {
  const JsonInput file = object.required("curves");
  const CsvTable table = load_csv(file.file_path(), file.memory());
  std::vector<std::string> columns = channels;
  if (const auto given = object.optional("columns")) {
    columns.clear();
    for (const JsonInput& each : given->array(1)) columns.push_back(each.string());
    require_channels(*given, columns.size(), channels);
  }
  const Light light = decode_light(object);
  DecodedSensor sensor{.names = columns};
  for (const std::string& column : columns) {
    const SpectrumTable curve = read_spectrum(table, column, {});
    BandWeightsOverWavelengths& band = sensor.bands.emplace_back();
    double sum = 0.0;
    for (const double nm : srgb_sensor().wavelengths) {
      const double weight = (curve.covers(nm) ? interpolate(curve, nm) : 0.0) * light.at(nm);
      band.push_back({nm, weight});
      sum += weight;
    }
    if (!(sum > 0.0)) file.fail("column " + column + " sees no light between 400 and 700 nm");
    for (auto& [nm, weight] : band) weight /= sum;
  }
  return sensor;
}

}  // namespace

DecodedSensor decode_sensor(const JsonInput& value, const std::vector<std::string>& channels) {
  if (value.is_string()) {
    return value.choice<bool>({{"srgb", true}, {"channels", false}})
               ? decode_srgb(value, channels)
               : decode_channels(value, channels);
  }
  if (value.peek("curves"))
    return decode_curves(value.object({"curves", "columns", "illuminant"}), channels);
  return decode_bands(value.object({"wavelength_nm", "width_nm"}), channels);
}

}  // namespace lamina::acquire_detail
