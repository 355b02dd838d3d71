// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/mcml_output.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

std::string column(const std::string& head, const std::vector<double>& values) {
  std::string text = head + "\n";
  for (const double value : values) text += printf_text("%12.4E\n", value);
  return text + "\n";
}

/// A table as MCML writes it: five numbers a line whatever the rows are.
std::string table(const std::string& head, const std::vector<double>& values) {
  std::string text = head;
  std::size_t i = 0;
  for (const double value : values) {
    text += printf_text("%12.4E ", value);
    if (++i % 5 == 0) text += "\n";
  }
  return text + "\n";
}

std::vector<double> scaled(std::span<const Estimate> estimates, double factor) {
  std::vector<double> values;
  for (const Estimate& estimate : estimates) values.push_back(estimate.value * factor);
  return values;
}

std::string input_section(const McmlRun& run) {
  std::string text = "InParm \t\t\t# Input parameters. cm is used.\n";
  text += run.output_file + " \tA\t\t# output file name, ASCII.\n";
  text += std::to_string(run.photons) + " \t\t\t# No. of photons\n";
  text += printf_text("%G\t%G\t\t# dz, dr [cm]\n", run.dz, run.dr);
  text += printf_text("%d\t%d\t%d\t# No. of dz, dr, da.\n\n", run.nz, run.nr, run.na);
  text += printf_text("%zu\t\t\t\t\t# Number of layers\n", run.layers.size());
  text += "#n\tmua\tmus\tg\td\t# One line for each layer\n";
  text += printf_text("%G\t\t\t\t\t# n for medium above\n", run.n_above);
  for (std::size_t i = 0; i < run.layers.size(); ++i) {
    const McmlRun::Layer& layer = run.layers[i];
    text += printf_text("%G\t%G\t%G\t%G\t%G\t# layer %zu\n", layer.n, layer.mua, layer.mus, layer.g,
                        layer.d, i + 1);
  }
  return text + printf_text("%G\t\t\t\t\t# n for medium below\n\n", run.n_below);
}

/// Absorbed fraction per depth [1/cm], summed over the rings.
std::vector<double> absorbed_per_depth(const McmlRun& run, const MonteCarloResult& result) {
  std::vector<double> sums(static_cast<std::size_t>(run.nz), 0.0);
  for (std::size_t cell = 0; cell < result.absorption.size(); ++cell) {
    const std::size_t ring = cell / sums.size();
    const double area =  // [mm²]
        100.0 * std::numbers::pi * run.dr * run.dr * (2.0 * static_cast<double>(ring) + 1.0);
    sums[cell % sums.size()] += 10.0 * area * result.absorption[cell].value;
  }
  return sums;
}

std::string radius_and_angle(const std::string& kind) {
  return "# " + kind + "[r][angle]. [1/(cm2sr)].\n# " + kind + "[0][0], [0][1],..[0][na-1]\n# " +
         kind + "[1][0], [1][1],..[1][na-1]\n# ...\n# " + kind +
         "[nr-1][0], [nr-1][1],..[nr-1][na-1]\n" + kind + "_ra\n";
}

}  // namespace

std::string format_mcml(const McmlRun& run, const MonteCarloResult& result, double seconds) {
  std::string text = "A1 \t# Version number of the file format.\n\n####\n";
  text +=
      "# Data categories include: \n# InParm, RAT, \n# A_l, A_z, Rd_r, Rd_a, Tt_r, Tt_a, \n"
      "# A_rz, Rd_ra, Tt_ra \n####\n\n";
  text += printf_text("# User time: %8.0f sec = %8.2f hr.   Simulation time of this run.\n\n",
                      seconds, seconds / 3600.0);
  text += input_section(run);

  double absorbed = 0.0;
  for (const Estimate& layer : result.absorptance) absorbed += layer.value;
  text += "RAT #Reflectance, absorption, transmission. \n";
  text += printf_text("%-14G \t#Specular reflectance [-]\n", result.specular_reflectance.value);
  text += printf_text("%-14G \t#Diffuse reflectance [-]\n", result.diffuse_reflectance.value);
  text += printf_text("%-14G \t#Absorbed fraction [-]\n", absorbed);
  text += printf_text("%-14G \t#Transmittance [-]\n\n", result.transmittance.value);

  text += "A_l #Absorption as a function of layer. [-]\n";
  for (const Estimate& layer : result.absorptance) text += printf_text("%12.4G\n", layer.value);
  text += "\n";
  text += column("A_z #A[0], [1],..A[nz-1]. [1/cm]", absorbed_per_depth(run, result));
  text += column("Rd_r #Rd[0], [1],..Rd[nr-1]. [1/cm2]", scaled(result.radial.reflection, 100.0));
  text += column("Rd_a #Rd[0], [1],..Rd[na-1]. [sr-1]", scaled(result.angular.reflection, 1.0));
  text += column("Tt_r #Tt[0], [1],..Tt[nr-1]. [1/cm2]", scaled(result.radial.transmission, 100.0));
  text += column("Tt_a #Tt[0], [1],..Tt[na-1]. [sr-1]", scaled(result.angular.transmission, 1.0));
  text += table(
      "# A[r][z]. [1/cm3]\n# A[0][0], [0][1],..[0][nz-1]\n# A[1][0], [1][1],..[1][nz-1]\n# ...\n"
      "# A[nr-1][0], [nr-1][1],..[nr-1][nz-1]\nA_rz\n",
      scaled(result.absorption, 1000.0));
  // The exact integral over a bin of solid angle and cosine is smaller than MCML's middle by this.
  const double to_middle = std::cos(0.25 * std::numbers::pi / run.na);
  text +=
      table(radius_and_angle("Rd"), scaled(result.radial_angular.reflection, 100.0 * to_middle));
  text +=
      table(radius_and_angle("Tt"), scaled(result.radial_angular.transmission, 100.0 * to_middle));
  return text;
}

}  // namespace lamina
