// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "lamina/base/core/number_text.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/optics/absorbing_sheet.h"

namespace lamina::material_file {
namespace {

std::string short_number(double value) {
  PlainTextStream text;
  text << value;
  return text.str();
}

/// A map's means, one for each band.
std::vector<double> means_of_map(const JsonInput& value, const MappableNumber& number,
                                 const Context& context) {
  std::vector<double> means = context.maps(number, value);
  means.resize(context.bands, means.front());
  return means;
}

/// Coefficients of `value` in the file's unit, turned to 1/mm.
std::vector<double> decode_coefficients(const JsonInput& value, MappableNumber number,
                                        const Context& context) {
  if (is_spectral(value)) return decode_spectral_coefficients(value, context);
  if (is_map(value, context)) {
    number.high = largest_number;
    number.unit = 1.0 / context.mm_per_unit;
    return means_of_map(value, number, context);
  }
  if (value.is_object())
    value.fail("must have \"spectrum\", \"chromophore\", \"a\" and \"b\", or \"sum\"");
  require_own_bands(value, context);
  const std::string unit = "1/" + context.length_unit;
  const double largest = largest_number * context.mm_per_unit;
  std::vector<double> values = value.number_or_numbers(context.bands, at_least(0.0, unit));
  (void)value.number_or_numbers(context.bands, {.high = largest, .unit = unit});
  for (double& x : values) x /= context.mm_per_unit;
  return values;
}

/// The keys "sigma_a", "sigma_s" or "sigma_s_prime", "g" and "phase" of a MaterialLayer or a
/// MixturePart.
///
/// @param layer  of which coefficients may be maps; of parts they may not
void decode_substance(const JsonObject& object, const Context& context,
                      std::optional<std::size_t> layer, auto& substance) {
  Context own = context;
  if (!layer) own.maps = {};
  const auto number = [&](MappableNumber::Of of, const char* key) {
    return MappableNumber{.of = of,
                          .layer = layer.value_or(0),
                          .name = "layers[" + std::to_string(layer.value_or(0)) + "]." + key,
                          .channels = context.channels};
  };
  using Of = MappableNumber::Of;
  substance.sigma_a =
      decode_coefficients(object.required("sigma_a"), number(Of::sigma_a, "sigma_a"), own);
  const auto reduced = object.optional("sigma_s_prime");
  if (!reduced)
    substance.sigma_s =
        decode_coefficients(object.required("sigma_s"), number(Of::sigma_s, "sigma_s"), own);
  if (const auto phase = object.optional("phase")) substance.phase = phase->choice<ParticlePhase>();
  if (substance.phase == ParticlePhase::rayleigh) {
    substance.g.assign(context.bands, 0.0);
    if (const auto g = object.optional("g"))
      if (g->number_or_numbers(context.bands) != substance.g)
        g->fail("must be 0 or missing where phase is \"rayleigh\"");
  } else {
    const JsonInput g = object.required("g");
    MappableNumber mapped = number(Of::g, "g");
    mapped.low = -0.999, mapped.high = 0.999;
    substance.g = !is_spectral(g) && is_map(g, own)
                      ? means_of_map(g, mapped, own)
                      : decode_numbers(g, open_interval(-1.0, 1.0), context);
  }
  if (!reduced) return;
  if (const auto other = object.optional("sigma_s"))
    other->fail("there is \"sigma_s_prime\" already; a layer has one of the two");
  for (const auto& given : {reduced, object.optional("g")})
    if (given && !is_spectral(*given) && is_map(*given, own))
      given->fail("cannot be a map where there is \"sigma_s_prime\"; \"sigma_s\" and \"g\" can");
  substance.sigma_s = decode_coefficients(*reduced, number(Of::sigma_s, "sigma_s_prime"), own);
  for (std::size_t band = 0; band < context.bands; ++band)
    substance.sigma_s[band] /= 1.0 - substance.g[band];
}

std::vector<MixturePart> decode_mixture(const JsonInput& value, std::size_t layer, bool has_base,
                                        const Context& context) {
  std::vector<MixturePart> parts;
  double sum = 0.0;
  for (const JsonInput& element : value.array(1)) {
    const JsonObject object =
        element.object({"name", "fraction", "sigma_a", "sigma_s", "sigma_s_prime", "g", "phase"});
    MixturePart& part = parts.emplace_back();
    if (const auto name = object.optional("name")) part.name = name->string();
    const JsonInput fraction = object.required("fraction");
    if (!has_base && is_map(fraction, context))
      fraction.fail("cannot be a map where nothing fills the rest of the volume");
    part.fraction = mappable_number(fraction,
                                    {.of = MappableNumber::Of::fraction,
                                     .layer = layer,
                                     .part = parts.size() - 1,
                                     .name = "layers[" + std::to_string(layer) + "].mixture[" +
                                             std::to_string(parts.size() - 1) + "].fraction",
                                     .low = 0.0,
                                     .high = 1.0},
                                    context);
    decode_substance(object, context, std::nullopt, part);
    sum += part.fraction;
  }
  if (has_base && sum > 1.0 + mixture_tolerance)
    value.fail("fractions must sum to at most 1, but sum to " + short_number(sum));
  if (!has_base && std::abs(sum - 1.0) > mixture_tolerance)
    value.fail("fractions must sum to 1, but sum to " + short_number(sum) +
               "; give the layer sigma_a, sigma_s and g for what fills the rest");
  return parts;
}

double decode_thickness(const JsonInput& value, std::size_t layer, const Context& context) {
  if (is_map(value, context))
    return mappable_length(value,
                           {.of = MappableNumber::Of::thickness,
                            .layer = layer,
                            .name = "layers[" + std::to_string(layer) + "].thickness",
                            .low = 1e-6,
                            .high = largest_number},
                           context);
  if (value.is_string() && value.string() == "infinite")
    return std::numeric_limits<double>::infinity();
  if (!value.is_number()) value.refuse("must be a number or \"infinite\"");
  (void)value.number(greater_than(0.0, context.length_unit));
  const double thickness =
      value.number({.high = largest_number / context.mm_per_unit, .unit = context.length_unit});
  return thickness * context.mm_per_unit;
}

/// A film without thickness: its optical density in place of thickness and coefficients.
void decode_sheet(const JsonObject& object, const Context& context, MaterialLayer& layer) {
  for (const char* key :
       {"sigma_a", "sigma_s", "sigma_s_prime", "g", "phase", "mixture", "thickness"})
    if (const auto given = object.optional(key))
      given->fail("there is \"optical_density\" already: a sheet has that in its place");
  constexpr double most = 100.0;
  for (const double density :
       decode_numbers(object.required("optical_density"), closed_interval(0.0, most), context))
    layer.sigma_a.push_back(absorbing_sheet(density, 1.0).medium.sigma_a);
  layer.sigma_s.assign(context.bands, 0.0);
  layer.g.assign(context.bands, 0.0);
  layer.thickness = sheet_thickness;
}

MaterialLayer decode_layer(const JsonInput& value, std::size_t index, bool is_bottom,
                           const Context& context) {
  const bool is_top = index == 0;
  const JsonObject object =
      value.object({"name", "sigma_a", "sigma_s", "sigma_s_prime", "g", "phase", "ior", "thickness",
                    "mixture", "optical_density", "roughness", "distribution"});
  MaterialLayer layer;
  if (const auto name = object.optional("name")) layer.name = name->string();
  const bool is_film = object.has("optical_density");
  if (is_film) decode_sheet(object, context, layer);
  const auto mixture = object.optional("mixture");
  const bool has_base = !mixture || object.has("sigma_a") || object.has("sigma_s") ||
                        object.has("sigma_s_prime") || object.has("g") || object.has("phase");
  if (has_base && !is_film) decode_substance(object, context, index, layer);
  if (mixture) layer.mixture = decode_mixture(*mixture, index, has_base, context);
  layer.ior = decode_ior(object.required("ior"), context);
  if (!is_film) {
    const JsonInput thickness = object.required("thickness");
    layer.thickness = decode_thickness(thickness, index, context);
    if (std::isinf(layer.thickness) && !is_bottom)
      thickness.fail("only the last layer may be infinite");
  }
  if (is_top)
    for (const char* key : {"roughness", "distribution"})
      if (const auto given = object.optional(key))
        given->fail("the roughness of the lit surface stands under \"surface\", not in layers[0]");
  if (!is_top) layer.top = decode_interface(object);
  return layer;
}

}  // namespace

Interface decode_interface(const JsonObject& object, const Context* context) {
  Interface interface;
  if (const auto roughness = object.optional("roughness"))
    interface.roughness = context ? mappable_number(*roughness,
                                                    {.of = MappableNumber::Of::roughness,
                                                     .name = "surface.roughness",
                                                     .low = 0.0,
                                                     .high = 1.0},
                                                    *context)
                                  : plain_number(*roughness, closed_interval(0.0, 1.0));
  if (const auto distribution = object.optional("distribution")) {
    interface.distribution = distribution->choice<MicrofacetDistribution>();
    (void)object.required("roughness");
  }
  return interface;
}

std::vector<double> decode_ior(const JsonInput& value, const Context& context) {
  return decode_numbers(value, closed_interval(0.1, 10.0), context);
}

std::vector<MaterialLayer> decode_layers(const JsonInput& layers, const Context& context) {
  const std::vector<JsonInput> values = layers.array(1, 1000);
  std::vector<MaterialLayer> decoded;
  for (std::size_t i = 0; i < values.size(); ++i)
    decoded.push_back(decode_layer(values[i], i, i + 1 == values.size(), context));
  return decoded;
}

}  // namespace lamina::material_file
