// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Numbers of bands that a law, a table in a file or a substance gives.
#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/base/spectrum/spectrum_table.h"
#include "lamina/layers/materials/chromophores.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina::material_file {
namespace {

constexpr std::array<std::string_view, 4> source_keys = {"spectrum", "chromophore", "a", "sum"};

void require_spectral_bands(const JsonInput& value, const Context& context) {
  if (context.wavelengths.empty())
    value.fail("a spectrum needs wavelengths [nm] in \"bands\", not \"rgb\"");
}

/// The bands must lie in what is known.
void require_known(const JsonInput& value, const Context& context, const std::string& what,
                   double shortest, double longest) {
  for (const double wavelength : context.wavelengths) {
    if (shortest <= wavelength && wavelength <= longest) continue;
    PlainTextStream message;
    message << what << " is known from " << shortest << " to " << longest
            << " nm, but \"bands\" has " << wavelength;
    value.fail(message.str());
  }
}

/// The keys "spectrum" and "column".
SpectrumTable load_column(const JsonObject& object, const NumberRange& range) {
  const JsonInput file = object.required("spectrum");
  std::string column;
  if (const auto given = object.optional("column")) column = given->string();
  return read_spectrum(load_csv(file.file_path(), file.memory()), column, range);
}

/// A column of a file, [band].
std::vector<double> decode_column(const JsonObject& object, const Context& context,
                                  const NumberRange& range) {
  const SpectrumTable table = load_column(object, range);
  const JsonInput file = object.required("spectrum");
  require_known(file, context, file.string(), table.wavelengths.front(), table.wavelengths.back());
  std::vector<double> values;
  for (const double wavelength : context.wavelengths)
    values.push_back(interpolate(table, wavelength));
  return values;
}

/// What a volume full of it absorbs, [band] [1/mm].
std::vector<double> decode_chromophore(const JsonInput& name, const Context& context) {
  std::vector<std::string_view> names;
  for (const Chromophore& known : chromophores()) names.push_back(known.name);
  const Chromophore& chromophore = chromophores()[name.choice(names)];
  require_known(name, context, std::string(chromophore.name), chromophore.shortest,
                chromophore.longest);
  std::vector<double> values;
  for (const double wavelength : context.wavelengths)
    values.push_back(chromophore.absorption(wavelength));
  return values;
}

/// Scattering as [Jacques2013] writes it (Eqs. 1, 2), [1/mm]:
/// a (f (nm / 500)^-4 + (1 - f) (nm / 500)^-b).
std::vector<double> decode_law(const JsonObject& object, const Context& context) {
  const double largest = largest_number * context.mm_per_unit;
  const double a =
      object.required("a").number(closed_interval(0.0, largest, "1/" + context.length_unit)) /
      context.mm_per_unit;
  const double b = object.required("b").number(closed_interval(-10.0, 10.0));
  double rayleigh = 0.0;
  if (const auto given = object.optional("rayleigh_fraction"))
    rayleigh = given->number(closed_interval(0.0, 1.0));
  std::vector<double> values;
  for (const double wavelength : context.wavelengths) {
    const double x = wavelength / 500.0;
    values.push_back(a * (rayleigh * std::pow(x, -4.0) + (1.0 - rayleigh) * std::pow(x, -b)));
  }
  return values;
}

std::vector<double> decode_sum(const JsonInput& terms, const Context& context) {
  std::vector<double> sum(context.bands, 0.0);
  for (const JsonInput& term : terms.array(1, 100)) {
    if (!is_spectral(term))
      term.refuse("must have \"spectrum\", \"chromophore\" or \"a\" and \"b\"");
    if (term.peek("sum")) term.fail("cannot be a sum itself");
    const std::vector<double> values = decode_spectral_coefficients(term, context);
    for (std::size_t band = 0; band < context.bands; ++band) sum[band] += values[band];
  }
  return sum;
}

}  // namespace

void require_own_bands(const JsonInput& value, const Context& context) {
  if (value.is_array() && !context.has_own_bands)
    value.fail(
        "has a number for each band of its file, and cannot be had at other wavelengths; a table "
        "in a CSV file can");
}

bool is_spectral(const JsonInput& value) {
  return value.is_object() &&
         std::ranges::any_of(source_keys, [&](auto key) { return value.peek(key).has_value(); });
}

std::vector<double> decode_spectral_coefficients(const JsonInput& value, const Context& context) {
  require_spectral_bands(value, context);
  std::vector<double> values;
  std::optional<JsonInput> factor;
  double largest_factor = largest_number;
  if (value.peek("spectrum")) {
    const JsonObject object = value.object({"spectrum", "column", "unit", "factor"});
    const JsonInput unit = object.required("unit");
    const double mm =
        unit.choice<double>({{"1/mm", 1.0}, {"1/cm", 10.0}, {"1/m", 1000.0}, {"1/um", 1e-3}});
    values =
        decode_column(object, context, closed_interval(0.0, largest_number * mm, unit.string()));
    for (double& x : values) x /= mm;
    factor = object.optional("factor");
  } else if (value.peek("chromophore")) {
    const JsonObject object = value.object({"chromophore", "fraction"});
    values = decode_chromophore(object.required("chromophore"), context);
    factor = object.required("fraction");
    largest_factor = 1.0;
  } else if (value.peek("a")) {
    values = decode_law(value.object({"a", "b", "rayleigh_fraction"}), context);
  } else {
    values = decode_sum(value.object({"sum"}).required("sum"), context);
  }
  if (factor) {
    const double times = factor->number(closed_interval(0.0, largest_factor));
    for (double& x : values) x *= times;
  }
  return values;
}

std::vector<double> decode_numbers(const JsonInput& value, const NumberRange& range,
                                   const Context& context) {
  if (!is_spectral(value)) {
    require_own_bands(value, context);
    return value.number_or_numbers(context.bands, range);
  }
  require_spectral_bands(value, context);
  return decode_column(value.object({"spectrum", "column"}), context, range);
}

SpectrumTable decode_table(const JsonInput& value, const NumberRange& range) {
  return load_column(value.object({"spectrum", "column"}), range);
}

}  // namespace lamina::material_file
