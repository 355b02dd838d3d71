// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Fits the recipe of leaves, and PROSPECT-D beside it, to reflectance and transmittance of measured
// leaves; the table of docs/fit_accuracy.md.
//
//   leaf_spectra LEAVES.csv PROSPECT.csv [LONGEST]
//
// from 400 to LONGEST nm, 800 if not given; beyond 900 water is fitted, too. The tables are those
// of [Noda2013]: nm, then R and T of the upper side and R and T of the lower side of each leaf; and
// of [Feret2017]: nm, index, absorption by chlorophyll, carotenoids, anthocyanins, brown pigments,
// water and dry matter.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace {

using namespace lamina;

constexpr double reading_error = 0.01;  // of R and T; it weighs both alike
constexpr double water_from = 900.0;    // [nm]: light that shorter waves hardly see
constexpr double usual_water = 0.012;   // [cm]

struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
};

Table load(const char* file, double longest) {
  std::ifstream in(file);
  Table table;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream cells(line);
    const bool is_head = table.names.empty();
    if (!is_head) table.rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');)
      if (is_head)
        table.names.push_back(cell);
      else
        table.rows.back().push_back(std::atof(cell.c_str()));
  }
  // Every 10 nm
  std::erase_if(table.rows, [&](const std::vector<double>& row) {
    return row[0] < 400.0 || row[0] > longest || std::fmod(row[0], 10.0) != 0.0;
  });
  return table;
}

struct Spectrum {
  std::vector<double> reflectance, transmittance;  ///< [wavelength]
};

struct Leaf {
  std::string name;
  Spectrum upper, lower;
};

std::vector<Leaf> leaves_of(const Table& table) {
  std::vector<Leaf> leaves;
  for (std::size_t first = 1; first + 3 < table.names.size(); first += 4) {
    Leaf leaf{.name = table.names[first].substr(0, table.names[first].find(':')),
              .upper = {},
              .lower = {}};
    for (const std::vector<double>& row : table.rows) {
      leaf.upper.reflectance.push_back(row[first]);
      leaf.upper.transmittance.push_back(row[first + 1]);
      leaf.lower.reflectance.push_back(row[first + 2]);
      leaf.lower.transmittance.push_back(row[first + 3]);
    }
    // In one leaf the columns of the lower side are exchanged: where chlorophyll lets no light
    // pass.
    if (leaf.lower.transmittance[0] > leaf.lower.reflectance[0])
      std::swap(leaf.lower.reflectance, leaf.lower.transmittance);
    leaves.push_back(std::move(leaf));
  }
  return leaves;
}

/// In percent of the incident light.
struct Misfit {
  double reflectance = 0.0, transmittance = 0.0;
};

double root_mean_square(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += std::pow(a[i] - b[i], 2);
  return 100.0 * std::sqrt(squares / static_cast<double>(a.size()));
}

Misfit misfit(const Spectrum& model, const Spectrum& measured) {
  return {root_mean_square(model.reflectance, measured.reflectance),
          root_mean_square(model.transmittance, measured.transmittance)};
}

/// Seven numbers of the recipe, all from the upper side.
struct FittedLeaf {
  Spectrum upper, lower;
  std::vector<FittedNumber> numbers;
};

FittedLeaf fit_recipe(const Leaf& leaf, const std::vector<double>& wavelengths) {
  const auto free = [](const std::string& name, double start, double high) {
    return FreeNumber{{.name = "leaf." + name, .start = start, .low = 0.0, .high = high}};
  };
  Measurement measurement{
      .material =
          {R"({ "lamina": "material", "version": 1, "length_unit": "mm", "ior_below": 1, "leaf": {} })",
           "leaf"},
      .bands = BandSet(wavelengths),
      .free = {free("chlorophyll", 30, 200), free("carotenoids", 6, 60),
               free("anthocyanins", 3, 60), free("brown_pigments", 0.05, 5),
               free("dry_matter", 0.003, 0.05), free("structure", 1.6, 50),
               free("palisade_share", 0.6, 1)}};
  measurement.free[5].parameter.low = 0.1;
  if (wavelengths.back() > water_from) measurement.free.push_back(free("water", usual_water, 0.1));
  MeasuredSeries series;
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    const auto add = [&](MeasuredQuantity quantity, double value) {
      series.points.push_back(
          {.band = w, .quantity = quantity, .value = value, .standard_deviation = reading_error});
    };
    add(MeasuredQuantity::reflectance, leaf.upper.reflectance[w]);
    add(MeasuredQuantity::transmittance, leaf.upper.transmittance[w]);
  }
  measurement.series = {series};
  const MeasurementFit fit = fit_measurement(measurement);
  FittedLeaf fitted{.upper = {}, .lower = {}, .numbers = fit.numbers};
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    fitted.upper.reflectance.push_back(fit.predicted[0][2 * w]);
    fitted.upper.transmittance.push_back(fit.predicted[0][2 * w + 1]);
  }
  for (const LayerStack& stack : layer_stacks(material_with(measurement, fit.values))) {
    const SlabTotals below = adding_doubling(flipped(stack), {}).totals;
    fitted.lower.reflectance.push_back(below.specular_reflectance + below.diffuse_reflectance);
    fitted.lower.transmittance.push_back(below.transmittance);
  }
  return fitted;
}

/// What a smooth surface lets through of light from all directions within a cone.
/// Source: the model PROSPECT of Jacquemoud and Baret 1990.
double mean_transmission(double cone, double index) {
  double through = 0.0;
  const Quadrature rule = gauss_legendre(64, 0.0, cone);
  for (std::size_t i = 0; i < rule.nodes.size(); ++i)
    through += rule.weights[i] * std::sin(2.0 * rule.nodes[i]) *
               (1.0 - fresnel(std::cos(rule.nodes[i]), index));
  return through / std::pow(std::sin(cone), 2);
}

/// A plate and N - 1 more below it. Source: the model PROSPECT of
/// Jacquemoud and Baret 1990; light arrives on the first plate in a cone of 40 degrees [Feret2017].
Misfit prospect(double plates, double absorption, double index) {
  const double k = absorption / plates;
  const double passed = k > 0.0 ? (1.0 - k) * std::exp(-k) - k * k * std::expint(-k) : 1.0;
  const double enters = mean_transmission(40.0 * std::numbers::pi / 180.0, index);
  const double t12 = mean_transmission(0.5 * std::numbers::pi, index), t21 = t12 / (index * index);
  const double r12 = 1.0 - t12, r21 = 1.0 - t21;
  const double echoes = 1.0 - r21 * r21 * passed * passed;
  const double t_first = enters * passed * t21 / echoes;
  const double r_first = 1.0 - enters + r21 * passed * t_first;
  const double t = t12 * passed * t21 / echoes, r = r12 + r21 * passed * t;
  double r_rest = 0.0, t_rest = 0.0;
  if (r + t < 1.0) {
    const double d = std::sqrt((1 + r + t) * (1 + r - t) * (1 - r + t) * (1 - r - t));
    const double a = (1 + r * r - t * t + d) / (2 * r), b = (1 - r * r + t * t + d) / (2 * t);
    const double p = std::pow(b, plates - 1.0), q = a * a * p * p - 1.0;
    r_rest = a * (p * p - 1.0) / q;
    t_rest = p * (a * a - 1.0) / q;
  } else {
    t_rest = t / (t + (1.0 - t) * (plates - 1.0));
    r_rest = 1.0 - t_rest;
  }
  const double between = 1.0 - r_rest * r;
  return {r_first + t_first * r_rest * t / between, t_first * t_rest / between};
}

Spectrum fit_prospect(const Leaf& leaf, const Table& source) {
  const auto predict = [&](std::span<const double> values) {
    std::vector<double> spectrum;
    for (const std::vector<double>& row : source.rows) {
      const double water = values.size() > 6 ? values[6] : usual_water;
      const double absorption = values[1] * row[2] + values[2] * row[3] + values[3] * row[4] +
                                values[4] * row[5] + water * row[6] + values[5] * row[7];
      const auto [reflectance, transmittance] = prospect(values[0], absorption, row[1]);
      spectrum.insert(spectrum.end(), {reflectance, transmittance});
    }
    return spectrum;
  };
  FitData data;
  for (std::size_t w = 0; w < source.rows.size(); ++w)
    data.measured.insert(data.measured.end(),
                         {leaf.upper.reflectance[w], leaf.upper.transmittance[w]});
  data.standard_deviation.assign(data.measured.size(), reading_error);
  std::vector<FitParameter> numbers = {
      {.name = "plates", .start = 1.5, .low = 1.0, .high = 4.0},
      {.name = "chlorophyll", .start = 30, .low = 0, .high = 200},
      {.name = "carotenoids", .start = 6, .low = 0, .high = 60},
      {.name = "anthocyanins", .start = 3, .low = 0, .high = 60},
      {.name = "brown", .start = 0.05, .low = 0, .high = 5},
      {.name = "dry matter", .start = 0.003, .low = 0, .high = 0.05}};
  if (source.rows.back()[0] > water_from)
    numbers.push_back({.name = "water", .start = usual_water, .low = 0, .high = 0.1});
  const FitResult fit = fit_parameters(numbers, data, {.predict = predict});
  Spectrum spectrum;
  for (std::size_t w = 0; w < source.rows.size(); ++w) {
    spectrum.reflectance.push_back(fit.prediction[2 * w]);
    spectrum.transmittance.push_back(fit.prediction[2 * w + 1]);
  }
  return spectrum;
}

void print_row(const char* name, const std::vector<Misfit>& misfits) {
  std::printf("| %s |", name);
  for (const auto quantity : {&Misfit::reflectance, &Misfit::transmittance}) {
    std::vector<double> sorted;
    for (const Misfit& each : misfits) sorted.push_back(each.*quantity);
    std::ranges::sort(sorted);
    const double middle = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
    const auto most =
        static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(sorted.size()))) - 1;
    std::printf(" %.2f / %.2f / %.2f |", middle, sorted[most], sorted.back());
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: leaf_spectra LEAVES.csv PROSPECT.csv [LONGEST]\n");
    return 2;
  }
  const double longest = argc > 3 ? std::atof(argv[3]) : 800.0;
  const Table table = load(argv[1], longest), source = load(argv[2], longest);
  std::vector<double> wavelengths;
  for (const std::vector<double>& row : table.rows) wavelengths.push_back(row[0]);
  std::vector<Misfit> upper, lower, plates;
  std::vector<double> left_r(wavelengths.size()), left_t = left_r;
  for (const Leaf& leaf : leaves_of(table)) {
    const FittedLeaf fitted = fit_recipe(leaf, wavelengths);
    upper.push_back(misfit(fitted.upper, leaf.upper));
    lower.push_back(misfit(fitted.lower, leaf.lower));
    plates.push_back(misfit(fit_prospect(leaf, source), leaf.upper));
    std::printf("%-32s upper R %.2f T %.2f, lower R %.2f T %.2f, PROSPECT-D R %.2f T %.2f |",
                leaf.name.c_str(), upper.back().reflectance, upper.back().transmittance,
                lower.back().reflectance, lower.back().transmittance, plates.back().reflectance,
                plates.back().transmittance);
    for (const FittedNumber& number : fitted.numbers) std::printf(" %.4g", number.fitted.value);
    std::printf("\n");
    for (std::size_t w = 0; w < wavelengths.size(); ++w) {
      left_r[w] += 10.0 * (leaf.upper.reflectance[w] - fitted.upper.reflectance[w]);
      left_t[w] += 10.0 * (leaf.upper.transmittance[w] - fitted.upper.transmittance[w]);
    }
  }
  std::printf("measured less fitted, mean of the leaves, percent: nm R T\n");
  for (std::size_t w = 0; w < wavelengths.size(); w += 2)
    std::printf("  %.0f %+.2f %+.2f\n", wavelengths[w], left_r[w], left_t[w]);
  std::printf(
      "| RMS, %% of incident light, median / 95th / worst | reflectance | transmittance |\n| --- | "
      "--- | --- |\n");
  const bool has_water = longest > water_from;
  print_row(has_water ? "recipe, 8 numbers, upper side" : "recipe, 7 numbers, upper side", upper);
  print_row("recipe, lower side foreseen from it", lower);
  print_row(has_water ? "PROSPECT-D, 7 numbers, upper side" : "PROSPECT-D, 6 numbers, upper side",
            plates);
}
