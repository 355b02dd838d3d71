// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lamina/base/core/symmetric_eigen.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"
#include "lamina/skin/fit/skin/skin_population.h"

namespace lamina {
namespace {

constexpr std::size_t most_wavelengths = 2000, most_components = 50;

/// The rows below the diagonal.
DenseMatrix decode_correlation(const JsonInput& value, std::size_t size) {
  DenseMatrix correlation(size, size);
  for (std::size_t i = 0; i < size; ++i) correlation(i, i) = 1.0;
  const std::vector<JsonInput> rows = value.array(size - 1, size - 1);
  for (std::size_t i = 1; i < size; ++i) {
    const std::vector<double> row = rows[i - 1].numbers(i, open_interval(-1.0, 1.0));
    for (std::size_t j = 0; j < i; ++j) correlation(i, j) = correlation(j, i) = row[j];
  }
  if (symmetric_eigen(correlation).values[0] <= 0.0)
    value.fail("the numbers cannot go together so: the matrix must be positive definite");
  return correlation;
}

void decode_missed(const JsonInput& value, SkinPopulation& population) {
  const JsonObject object = value.object({"wavelength_nm", "mean", "components"});
  for (const JsonInput& nm : object.required("wavelength_nm").array(1, most_wavelengths)) {
    population.wavelengths.push_back(nm.number(closed_interval(350.0, 1000.0, "nm")));
    if (population.wavelengths.size() > 1 &&
        population.wavelengths.back() <= population.wavelengths.end()[-2])
      nm.refuse("must be greater than the wavelength before it");
  }
  const std::size_t size = population.wavelengths.size();
  const NumberRange share = closed_interval(-1.0, 1.0);
  population.missed = object.required("mean").numbers(size, share);
  std::vector<JsonInput> components;
  if (const auto given = object.optional("components"))
    components = given->array(0, most_components);
  population.missed_components = DenseMatrix(components.size(), size);
  for (std::size_t c = 0; c < components.size(); ++c)
    std::ranges::copy(components[c].numbers(size, share),
                      population.missed_components.row(c).begin());
}

}  // namespace

SkinPopulation load_skin_population(const std::filesystem::path& file, MemoryBudget memory) {
  const JsonDocument document = load_json(file, memory, {});
  const JsonObject root = document.root().file_object(
      "population", 1, {"name", "source", "numbers", "correlation", "missed"});
  SkinPopulation population;
  const std::vector<SkinFitNumber> known = skin_fit_numbers({});
  std::vector<std::string_view> names;
  for (const SkinFitNumber& number : known) names.push_back(number.parameter.name);
  for (const JsonInput& value : root.required("numbers").array(1, known.size())) {
    const JsonObject number = value.object({"name", "mean", "sd"});
    const FitParameter& parameter = known[number.required("name").choice(names)].parameter;
    if (std::ranges::count(population.names, parameter.name) > 0)
      value.fail(parameter.name + " is there already");
    population.names.push_back(parameter.name);
    population.priors.push_back(
        {.mean = number.required("mean").number(closed_interval(parameter.low, parameter.high)),
         .standard_deviation = number.required("sd").number(greater_than(0.0))});
  }
  if (const auto correlation = root.optional("correlation")) {
    population.correlation = decode_correlation(*correlation, population.names.size());
  } else {
    const std::size_t size = population.names.size();
    population.correlation = DenseMatrix(size, size);
    for (std::size_t i = 0; i < size; ++i) population.correlation(i, i) = 1.0;
  }
  if (const auto missed = root.optional("missed")) decode_missed(*missed, population);
  return population;
}

SkinPopulation find_skin_population(const std::string& name_or_path, MemoryBudget memory) {
  return name_or_path == "forearms" ? forearm_population()
                                    : load_skin_population(name_or_path, memory);
}

std::string format_skin_population(const SkinPopulation& population, const std::string& source) {
  JsonOutput json = {{"lamina", "population"}, {"version", 1}, {"source", source}};
  for (std::size_t i = 0; i < population.names.size(); ++i)
    json["numbers"].push_back(JsonOutput{{"name", population.names[i]},
                                         {"mean", population.priors[i].mean},
                                         {"sd", population.priors[i].standard_deviation}});
  for (std::size_t i = 1; i < population.names.size(); ++i)
    json["correlation"].push_back(JsonOutput(population.correlation.row(i).first(i)));
  if (population.names.size() == 1) json["correlation"] = JsonOutput::array();
  if (!population.wavelengths.empty()) {
    JsonOutput& missed = json["missed"];
    missed["wavelength_nm"] = JsonOutput(population.wavelengths);
    missed["mean"] = JsonOutput(population.missed);
    missed["components"] = JsonOutput::array();
    for (std::size_t c = 0; c < population.missed_components.rows; ++c)
      missed["components"].push_back(JsonOutput(population.missed_components.row(c)));
  }
  return json.text(1) + "\n";
}

}  // namespace lamina
