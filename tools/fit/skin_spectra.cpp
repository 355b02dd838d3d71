// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Fits measured spectra of skin, prints the table of docs/fit_accuracy.md, and what
// forearm_population knows, as src/lamina/skin/fit/skin/internal/skin_population_table.h.
//
//   skin_spectra SPECTRA.csv [TABLE|POPULATION.json] [--others OTHERS.csv]
//
// SPECTRA.csv as that of [Cooksey2017], doi 10.18434/M38597: nm, then three columns of total
// reflectance per person. POPULATION.json is what measurement files take as "population".
// OTHERS.csv, of other people: a heading with wavelengths, then a row for each spectrum after its
// number; they are fitted with constants and prior of the first.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/symmetric_eigen.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/skin/fit/skin/skin_fit.h"

namespace {

using namespace lamina;

constexpr double reading_error = 0.005;  // of the mean of three readings, of incident light
constexpr Incidence beam{.theta = 8.0 * std::numbers::pi / 180.0};

struct Spectra {
  std::vector<double> wavelengths;
  std::vector<std::vector<double>> people;  ///< [person][wavelength] mean of three
};

Spectra load(const char* file) {
  std::ifstream in(file);
  Spectra spectra;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::atof(cell.c_str()));
    if (row.size() < 4 || row[0] < 400.0 || row[0] > 700.0) continue;
    spectra.wavelengths.push_back(row[0]);
    spectra.people.resize((row.size() - 1) / 3);
    for (std::size_t p = 0; p < spectra.people.size(); ++p)
      spectra.people[p].push_back((row[3 * p + 1] + row[3 * p + 2] + row[3 * p + 3]) / 3.0);
  }
  return spectra;
}

double median(std::vector<double> values, double share = 0.5) {
  std::ranges::sort(values);
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

/// Of each person.
struct Misfit {
  std::vector<double> rms;         ///< of reflectance, percent
  std::vector<double> difference;  ///< CIEDE2000 under D65
};

struct Study {
  Spectra spectra;
  SkinReflectanceTable table;
  BandWeights weights;

  [[nodiscard]] Misfit misfit(const std::vector<std::vector<double>>& fitted,
                              const std::vector<std::size_t>& people) const {
    Misfit misfit;
    for (std::size_t i = 0; i < people.size(); ++i) {
      const std::vector<double>& truth = spectra.people[people[i]];
      double squares = 0.0;
      for (std::size_t w = 0; w < truth.size(); ++w)
        squares += std::pow(fitted[i][w] - truth[w], 2);
      misfit.rms.push_back(100.0 * std::sqrt(squares / static_cast<double>(truth.size())));
      misfit.difference.push_back(
          color_difference(lab(linear_srgb(weights, fitted[i])), lab(linear_srgb(weights, truth))));
    }
    return misfit;
  }
};

void print_row(const std::string& name, const Misfit& misfit) {
  const auto three = [](const std::vector<double>& values) {
    char text[64];
    std::snprintf(text, sizeof text, "%.2f / %.2f / %.2f", median(values), median(values, 0.95),
                  *std::ranges::max_element(values));
    return std::string(text);
  };
  std::printf("| %s | %s | %s |\n", name.c_str(), three(misfit.rms).c_str(),
              three(misfit.difference).c_str());
  std::fflush(stdout);
}

std::vector<std::size_t> everyone(const Study& study) {
  std::vector<std::size_t> people(study.spectra.people.size());
  for (std::size_t i = 0; i < people.size(); ++i) people[i] = i;
  return people;
}

/// Each person on their own.
std::vector<SkinFit> fit_each(const Study& study, const std::vector<std::size_t>& people,
                              const SkinParameters& skin, const std::vector<SkinFitNumber>& numbers,
                              const SkinPopulation* population = nullptr,
                              bool has_specular = true) {
  std::vector<SkinFit> fits(people.size());
  parallel_for(people.size(), [&](std::size_t i) {
    const std::vector<double>& spectrum = study.spectra.people[people[i]];
    const std::vector<double> error(spectrum.size(), reading_error);
    fits[i] =
        fit_skin(study.table,
                 {.measured = spectrum, .standard_deviation = error, .has_specular = has_specular},
                 skin, numbers, population, {.tolerance = 1e-6});
  });
  return fits;
}

Misfit misfit(const Study& study, const std::vector<SkinFit>& fits,
              const std::vector<std::size_t>& people) {
  std::vector<std::vector<double>> fitted;
  for (const SkinFit& fit : fits) fitted.push_back(fit.spectrum);
  return study.misfit(fitted, people);
}

/// The first five: the values of a person; the other three are constants of all.
constexpr std::size_t own_values = 5;

/// The constants with which the spectra of these people are met best, by five values for each.
SkinParameters shared_constants(const Study& study, const std::vector<std::size_t>& people,
                                const SkinParameters& start) {
  const std::vector<SkinFitNumber> all = skin_fit_numbers(start);
  const std::vector<SkinFitNumber> own(all.begin(), all.begin() + own_values),
      shared(all.begin() + own_values, all.end());
  std::vector<FitParameter> parameters;
  for (const SkinFitNumber& number : shared) parameters.push_back(number.parameter);
  const auto with = [&](std::span<const double> values) {
    SkinParameters skin = start;
    for (std::size_t i = 0; i < shared.size(); ++i)
      for (double SkinParameters::*const value : shared[i].values) skin.*value = values[i];
    return skin;
  };
  FitData data;
  for (const std::size_t person : people)
    data.measured.insert(data.measured.end(), study.spectra.people[person].begin(),
                         study.spectra.people[person].end());
  data.standard_deviation.assign(data.measured.size(), reading_error);
  const FitModel model{.predict = [&](std::span<const double> values) {
    std::vector<double> predicted;
    for (const SkinFit& fit : fit_each(study, people, with(values), own)) {
      predicted.insert(predicted.end(), fit.spectrum.begin(), fit.spectrum.end());
    }
    return predicted;
  }};
  const FitResult result = fit_parameters(parameters, data, model,
                                          {.max_iterations = 20, .tolerance = 1e-4, .step = 1e-2});
  std::vector<double> values;
  for (const FittedParameter& parameter : result.parameters) values.push_back(parameter.value);
  return with(values);
}

/// Parts of what the model misses that are kept.
constexpr std::size_t components = 6;

/// What fits leave, [person][wavelength], as a mean and the largest components about it.
void set_missed(const std::vector<std::vector<double>>& left, SkinPopulation& population) {
  const std::size_t points = left[0].size();
  const auto count = static_cast<double>(left.size());
  population.missed.assign(points, 0.0);
  for (const std::vector<double>& each : left)
    for (std::size_t w = 0; w < points; ++w) population.missed[w] += each[w] / count;
  DenseMatrix covariance(points, points);
  for (const std::vector<double>& each : left)
    for (std::size_t v = 0; v < points; ++v)
      for (std::size_t w = 0; w < points; ++w)
        covariance(v, w) +=
            (each[v] - population.missed[v]) * (each[w] - population.missed[w]) / count;
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  population.missed_components = DenseMatrix(components, points);
  for (std::size_t c = 0; c < components; ++c)
    for (std::size_t w = 0; w < points; ++w)
      population.missed_components(c, w) =
          std::sqrt(std::max(0.0, eigen.values[points - 1 - c])) * eigen.vectors(w, points - 1 - c);
}

/// The Gaussian from which the people most probably come: what is expected of each by what is known
/// of all, and again. Source: [Dempster1977].
SkinPopulation learn(const Study& study, const std::vector<std::size_t>& people,
                     const SkinParameters& skin) {
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers(skin);
  const std::size_t n = numbers.size(), points = study.spectra.wavelengths.size();
  SkinPopulation known{.correlation = DenseMatrix(n, n),
                       .wavelengths = study.spectra.wavelengths,
                       .missed = std::vector<double>(points, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    known.names.push_back(numbers[i].parameter.name);
    known.priors.push_back({.mean = numbers[i].parameter.start, .standard_deviation = 1.0});
    known.correlation(i, i) = 1.0;
  }
  const auto count = static_cast<double>(people.size());
  constexpr int rounds = 25;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<SkinFit> fits = fit_each(study, people, skin, numbers, &known);
    DenseMatrix u(fits.size(), n);
    std::vector<double> mean(n, 0.0);
    for (std::size_t p = 0; p < fits.size(); ++p)
      for (std::size_t i = 0; i < n; ++i) {
        u(p, i) = fit_coordinate(numbers[i].parameter, fits[p].fit.parameters[i].value);
        mean[i] += u(p, i) / count;
      }
    DenseMatrix covariance(n, n);
    for (std::size_t p = 0; p < fits.size(); ++p)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
          const FitResult& fit = fits[p].fit;
          covariance(i, j) += ((u(p, i) - mean[i]) * (u(p, j) - mean[j]) +
                               fit.correlation(i, j) * fit.parameters[i].standard_deviation *
                                   fit.parameters[j].standard_deviation) /
                              count;
        }
    for (std::size_t i = 0; i < n; ++i)
      known.priors[i] = {.mean = fit_value(numbers[i].parameter, mean[i]),
                         .standard_deviation = std::sqrt(covariance(i, i))};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        known.correlation(i, j) =
            i == j ? 1.0
                   : 0.999 * covariance(i, j) /
                         (known.priors[i].standard_deviation * known.priors[j].standard_deviation);
    if (round + 1 < rounds) continue;
    std::vector<std::vector<double>> left;
    for (std::size_t p = 0; p < fits.size(); ++p) {
      left.push_back(study.spectra.people[people[p]]);
      for (std::size_t w = 0; w < points; ++w) left.back()[w] -= fits[p].spectrum[w];
    }
    set_missed(left, known);
  }
  return known;
}

/// Spectra by a few numbers that a sensor makes of each.
Misfit by_sensor(const Study& study, const std::vector<std::size_t>& people,
                 const DenseMatrix& sensor, double error, const SkinParameters& skin,
                 const SkinPopulation& known, bool has_specular = true) {
  std::vector<std::vector<double>> fitted(people.size());
  parallel_for(people.size(), [&](std::size_t i) {
    const std::vector<double>& truth = study.spectra.people[people[i]];
    std::vector<double> seen(sensor.rows, 0.0);
    for (std::size_t s = 0; s < sensor.rows; ++s)
      for (std::size_t w = 0; w < sensor.columns; ++w) seen[s] += sensor(s, w) * truth[w];
    fitted[i] = fit_skin(study.table,
                         {.measured = seen,
                          .standard_deviation = std::vector<double>(sensor.rows, error),
                          .sensor = sensor,
                          .has_specular = has_specular},
                         skin, skin_fit_numbers(skin), &known)
                    .spectrum;
  });
  return study.misfit(fitted, people);
}

void write_list(std::FILE* file, const char* name, const std::vector<double>& values) {
  std::fprintf(file, "inline constexpr std::array<double, %zu> %s = {", values.size(), name);
  for (std::size_t i = 0; i < values.size(); ++i)
    std::fprintf(file, "%s%.4g", i == 0 ? "" : ", ", values[i]);
  std::fprintf(file, "};\n");
}

/// As a header, or as a file for users where the name ends in .json.
bool write_table(const std::string& name, const SkinPopulation& known) {
  if (name.ends_with(".json")) {
    std::ofstream out(name);
    out << format_skin_population(known, "tools/fit/skin_spectra");
    return static_cast<bool>(out.flush());
  }
  std::FILE* file = std::fopen(name.c_str(), "w");
  if (!file) return false;
  constexpr std::size_t every = 2;  // wavelengths
  const auto thinned = [&](std::span<const double> curve) {
    std::vector<double> values;
    for (std::size_t w = 0; w < curve.size(); w += every) values.push_back(curve[w]);
    return values;
  };
  std::fprintf(file,
               "// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0\n"
               "#pragma once\n\n#include <array>\n#include <string_view>\n\n"
               "// Made by tools/fit/skin_spectra from [Cooksey2017].\n\n"
               "namespace lamina::fit_detail::forearms {\n\n"
               "inline constexpr std::array<std::string_view, %zu> names = {",
               known.names.size());
  for (std::size_t i = 0; i < known.names.size(); ++i)
    std::fprintf(file, "%s\"%s\"", i == 0 ? "" : ", ", known.names[i].c_str());
  std::fprintf(file, "};\n");
  std::vector<double> means, deviations, correlations;
  for (std::size_t i = 0; i < known.priors.size(); ++i) {
    means.push_back(known.priors[i].mean);
    deviations.push_back(known.priors[i].standard_deviation);
    for (std::size_t j = 0; j < i; ++j) correlations.push_back(known.correlation(i, j));
  }
  write_list(file, "means", means);
  write_list(file, "deviations", deviations);
  std::fprintf(file, "/// Below the diagonal, row by row.\n");
  write_list(file, "correlations", correlations);
  std::fprintf(file,
               "inline constexpr double first_wavelength = %g, wavelength_step = %g;  // [nm]\n",
               known.wavelengths[0], known.wavelengths[every] - known.wavelengths[0]);
  write_list(file, "missed", thinned(known.missed));
  std::fprintf(file, "inline constexpr std::array<std::array<double, %zu>, %zu> components = {{",
               thinned(known.missed).size(), components);
  for (std::size_t c = 0; c < components; ++c) {
    std::fprintf(file, "%s{", c == 0 ? "" : ", ");
    const std::vector<double> values = thinned(known.missed_components.row(c));
    for (std::size_t w = 0; w < values.size(); ++w)
      std::fprintf(file, "%s%.3g", w == 0 ? "" : ", ", values[w]);
    std::fprintf(file, "}");
  }
  std::fprintf(file, "}};\n\n}  // namespace lamina::fit_detail::forearms\n");
  return std::fclose(file) == 0;
}

/// Spectra of a row each.
Spectra load_rows(const std::string& file) {
  std::ifstream in(file);
  Spectra spectra;
  std::vector<std::size_t> columns;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::atof(cell.c_str()));
    if (columns.empty()) {
      for (std::size_t c = 1; c < row.size(); ++c)
        if (400.0 <= row[c] && row[c] <= 700.0) {
          columns.push_back(c);
          spectra.wavelengths.push_back(row[c]);
        }
      continue;
    }
    std::vector<double>& spectrum = spectra.people.emplace_back();
    for (const std::size_t c : columns) spectrum.push_back(row.at(c));
    if (std::ranges::any_of(spectrum, [](double r) { return !(0.005 < r && r < 0.95); }))
      spectra.people.pop_back();  // some readings failed
  }
  return spectra;
}

/// Other people, with the first ones' constants and prior. Whether their instrument counted what
/// the skin mirrors is not known: it does where that fits better.
void fit_others(const std::string& file, const SkinParameters& constants,
                const SkinPopulation& known) {
  const Spectra spectra = load_rows(file);
  if (spectra.people.empty()) return (void)std::fprintf(stderr, "%s: no spectra\n", file.c_str());
  const Study study{
      spectra, SkinReflectanceTable(spectra.wavelengths, {.is_diffuse = true}, skin_fit_range({})),
      make_band_weights(BandSet(spectra.wavelengths))};
  std::printf(
      "\n%s: %zu spectra\n\n| fitted | RMS, %% of incident light | CIEDE2000 |\n"
      "| --- | --- | --- |\n",
      file.c_str(), spectra.people.size());
  const std::vector<std::size_t> people = everyone(study);
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers({});
  const std::vector<SkinFitNumber> five(numbers.begin(), numbers.begin() + own_values);
  DenseMatrix rgb(3, spectra.wavelengths.size());
  for (std::size_t c = 0; c < rgb.rows; ++c)
    for (std::size_t w = 0; w < rgb.columns; ++w) rgb(c, w) = study.weights[w][c];
  for (const bool has_specular : {true, false}) {
    const std::string light = has_specular ? ", mirrored light included" : ", excluded";
    print_row("eight values" + light,
              misfit(study, fit_each(study, people, {}, numbers, nullptr, has_specular), people));
    print_row(
        "five values, constants of the first" + light,
        misfit(study, fit_each(study, people, constants, five, nullptr, has_specular), people));
    print_row("eight values, prior of the first" + light,
              misfit(study, fit_each(study, people, {}, numbers, &known, has_specular), people));
    print_row("RGB, eight values, prior of the first" + light,
              by_sensor(study, people, rgb, 0.002, {}, known, has_specular));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + 1, argv + argc);
  std::string others;
  if (files.size() > 2 && files[files.size() - 2] == "--others") {
    others = files.back();
    files.resize(files.size() - 2);
  }
  if (files.empty() || files.size() > 2)
    return std::fprintf(stderr,
                        "usage: skin_spectra SPECTRA.csv [TABLE.h|POPULATION.json] "
                        "[--others OTHERS.csv]\n"),
           2;
  const Spectra spectra = load(files[0].c_str());
  if (spectra.people.empty()) return std::fprintf(stderr, "%s: no spectra\n", files[0].c_str()), 1;
  const SkinParameters skin;
  const auto seconds = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const auto wall = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
  double from = seconds(), wall_from = wall();
  const Study study{spectra, SkinReflectanceTable(spectra.wavelengths, beam, skin_fit_range(skin)),
                    make_band_weights(BandSet(spectra.wavelengths))};
  std::printf("%zu people, %zu wavelengths; table %.1f CPU-s, %.1f s\n\n", spectra.people.size(),
              spectra.wavelengths.size(), seconds() - from, wall() - wall_from);
  std::printf("| fitted | RMS, %% of incident light | CIEDE2000 |\n| --- | --- | --- |\n");
  const std::vector<std::size_t> people = everyone(study);
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers(skin);
  from = seconds();
  const std::vector<SkinFit> eight = fit_each(study, people, skin, numbers);
  const double each = 1e3 * (seconds() - from) / static_cast<double>(people.size());
  print_row("eight values", misfit(study, eight, people));
  const SkinParameters printed = with_constants(skin, SkinConstants::paper);
  SkinParameters shared = shared_constants(study, people, skin);
  const std::vector<SkinFitNumber> five(numbers.begin(), numbers.begin() + own_values);
  print_row("five values, shared constants",
            misfit(study, fit_each(study, people, shared, five), people));

  print_row("five values, constants as [Donner2008] prints them",
            misfit(study, fit_each(study, people, printed, five), people));

  std::array<std::vector<std::size_t>, 2> half;
  for (const std::size_t person : people) half[person % 2].push_back(person);
  std::array<Misfit, 3> crossed;
  const auto add = [](Misfit& all, const Misfit& more) {
    all.rms.insert(all.rms.end(), more.rms.begin(), more.rms.end());
    all.difference.insert(all.difference.end(), more.difference.begin(), more.difference.end());
  };
  const std::size_t bands = spectra.wavelengths.size();
  DenseMatrix rgb(3, bands), six(6, bands);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t w = 0; w < bands; ++w) rgb(c, w) = study.weights[w][c];
  for (std::size_t s = 0; const double nm : {400.0, 420.0, 480.0, 520.0, 580.0, 700.0}) {
    const auto nearest = std::ranges::min_element(
        spectra.wavelengths, {}, [&](double other) { return std::abs(other - nm); });
    six(s++, static_cast<std::size_t>(nearest - spectra.wavelengths.begin())) = 1.0;
  }
  SkinPopulation known;
  for (int side = 0; side < 2; ++side) {
    const std::vector<std::size_t>& from_half = half[static_cast<std::size_t>(side)];
    const std::vector<std::size_t>& to_half = half[static_cast<std::size_t>(1 - side)];
    const SkinParameters constants = shared_constants(study, from_half, skin);
    add(crossed[0], misfit(study, fit_each(study, to_half, constants, five), to_half));
    known = learn(study, from_half, skin);
    add(crossed[1], by_sensor(study, to_half, rgb, 0.002, skin, known));
    add(crossed[2], by_sensor(study, to_half, six, 0.003, skin, known));
  }
  print_row("five values, constants of the other half", crossed[0]);
  print_row("RGB, eight values, prior of the other half", crossed[1]);
  print_row("six bands, eight values, prior of the other half", crossed[2]);
  std::printf(
      "\nconstants: baseline_scale %.4f, scattering_scale %.4f, saturation %.4f; one fit of eight "
      "values %.2f CPU-ms\n",
      shared.baseline_scale, shared.scattering_scale, shared.saturation_dermis, each);
  if (files.size() == 1 && others.empty()) return 0;
  const SkinPopulation all = learn(study, people, skin);
  if (!others.empty()) fit_others(others, shared, all);
  if (files.size() == 2 && !write_table(files[1], all))
    return std::fprintf(stderr, "%s: cannot be written\n", files[1].c_str()), 1;
  return 0;
}
