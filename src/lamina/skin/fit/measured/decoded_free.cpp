// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/decoded_free.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"

namespace lamina::fit_detail {
namespace {

FitPrior decode_prior(const JsonInput& value) {
  const JsonObject object = value.object({"mean", "sd"});
  return {.mean = object.required("mean").number(),
          .standard_deviation = object.required("sd").number(greater_than(0.0))};
}

/// A number that a recipe has where the file does not say it; not of lengths, which have a unit.
template <class Parameters, class Range>
std::optional<double> recipe_number(const std::string& path, const std::string& recipe,
                                    const Parameters& parameters, std::span<const Range> ranges) {
  for (const Range& range : ranges)
    if (!range.is_length && path == recipe + "." + std::string(range.name))
      return parameters.*range.value;
  return {};
}

std::optional<double> recipe_number(const std::string& path, const Material& material) {
  if (material.skin)
    return recipe_number(path, "skin", material.skin->skin, skin_parameter_ranges());
  if (material.leaf) return recipe_number(path, "leaf", *material.leaf, leaf_parameter_ranges());
  return {};
}

/// Without a "start": what the material has.
void start_where_the_material_is(const JsonInput& value, std::span<const StatedNumber> stated,
                                 const Measurement& measurement, FreeNumber& free) {
  const std::size_t bands = measurement.bands.size();
  const std::string& path = free.parameter.name;
  const auto found = std::ranges::find(stated, path, &StatedNumber::path);
  if (found == stated.end()) {
    if (const auto number = recipe_number(path, measurement.material.with({}))) {
      free.parameter.start = *number;
      return;
    }
    value.fail("\"start\" is required, since the material states no number at " + path);
  }
  const std::vector<double>& values = found->values;
  if (values.size() > 1 && !(free.is_per_band && values.size() == bands))
    value.fail("\"start\" is required: the material states " + std::to_string(values.size()) +
               " numbers at " + path + ", and " + std::to_string(free.is_per_band ? bands : 1) +
               (free.is_per_band && bands > 1 ? " are free" : " is free"));
  free.parameter.start = values[0];
  if (values.size() > 1) free.band_starts = values;
}

/// The paths of a number of skin, in the order of its values.
std::vector<std::string> paths_of(const SkinFitNumber& number) {
  std::vector<std::string> paths;
  for (double SkinParameters::*const value : number.values)
    for (const SkinParameterRange& range : skin_parameter_ranges())
      if (range.value == value) paths.push_back("skin." + std::string(range.name));
  return paths;
}

/// Where a population knows the number: its range, scale and prior.
/// @return whether it does
bool take_from(const SkinPopulation& population, FreeNumber& free) {
  for (const SkinFitNumber& number : skin_fit_numbers({})) {
    const auto known = std::ranges::find(population.names, number.parameter.name);
    if (known == population.names.end() ||
        !std::ranges::is_permutation(paths_of(number), free.paths()))
      continue;
    free.known = static_cast<std::size_t>(known - population.names.begin());
    const std::string path = free.parameter.name;
    free.parameter = number.parameter;
    free.parameter.name = path;
    free.parameter.prior = population.priors[*free.known];
    free.parameter.start = free.parameter.prior->mean;
    return true;
  }
  return false;
}

void decode_paths(const JsonInput& value, FreeNumber& free) {
  if (!value.is_array()) {
    free.parameter.name = value.string();
    return;
  }
  for (const JsonInput& path : value.array(1, 10)) free.further_paths.push_back(path.string());
  free.parameter.name = free.further_paths[0];
  free.further_paths.erase(free.further_paths.begin());
}

/// What the population does not give.
void decode_range(const JsonObject& object, FreeNumber& free) {
  FitParameter& parameter = free.parameter;
  parameter.low = object.required("low").number();
  parameter.high = object.required("high").number();
  if (const auto scale = object.optional("scale")) parameter.scale = scale->choice<FitScale>();
  if (const auto prior = object.optional("prior")) parameter.prior = decode_prior(*prior);
  if (const auto per_band = object.optional("per_band")) free.is_per_band = per_band->boolean();
}

}  // namespace

SkinPopulation decode_population(const JsonInput& value, const MeasuredMaterial& material) {
  if (!material.with({}).skin) value.fail("is of skin, which the material is not by its recipe");
  const std::string name = value.string();
  return find_skin_population(name == "forearms" ? name : value.file_path().string(),
                              value.memory());
}

FreeNumber decode_free(const JsonInput& value, std::span<const StatedNumber> stated,
                       const Measurement& measurement) {
  const JsonObject object =
      value.object({"parameter", "start", "low", "high", "scale", "prior", "per_band"});
  FreeNumber free;
  decode_paths(object.required("parameter"), free);
  const std::size_t bands = measurement.bands.size();
  if (measurement.population && take_from(*measurement.population, free)) {
    for (const char* key : {"low", "high", "scale", "prior", "per_band"})
      if (const auto given = object.optional(key))
        given->fail("must be missing, because the population knows " + free.parameter.name);
  } else {
    decode_range(object, free);
    if (measurement.population && !free.parameter.prior)
      value.fail("\"prior\" is required beside those of the population, which does not know " +
                 free.parameter.name);
  }
  if (const auto start = object.optional("start"))
    free.parameter.start = start->number();
  else if (!free.known)
    start_where_the_material_is(value, stated, measurement, free);
  try {
    FitParameter at = free.parameter;
    for (const double start : free.starts(bands)) {
      at.start = start;
      check_fit_parameter(at);
    }
  } catch (const InvalidInput& error) {
    value.fail(error.what());
  }
  return free;
}

}  // namespace lamina::fit_detail
