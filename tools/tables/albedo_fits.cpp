// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What renderers' fits of the albedo make of a color, by radiative transfer: the table and the plot
// of docs/albedo_inversion.md. `albedo_fits FILE.svg`
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "lamina/exchange/albedo_inversion/half_space_color.h"
#include "lamina/plot/plot.h"

namespace {

using namespace lamina;

double polynomial(double x, std::initializer_list<double> coefficients) {
  double sum = 0.0, power = 1.0;
  for (const double coefficient : coefficients) {
    sum += coefficient * power;
    power *= x;
  }
  return sum;
}

/// The albedo whose reduced form is albedo_prime.
double with_mean_cosine(double albedo_prime, double g) {
  return albedo_prime / (1.0 - g + g * albedo_prime);
}

/// [OpenPBR] 1.1.1, [KullaConty2017]: van de Hulst's fit, inverted.
double van_de_hulst(double color, double g) {
  const double s =
      4.09712 + 4.20863 * color - std::sqrt(9.59217 + color * (41.6808 + color * 17.7126));
  return (1.0 - s * s) / (1.0 - g * s * s);
}

/// Drafts of [OpenPBR] by authors of Arnold, until 2024.
double open_pbr_draft(double color, double g) {
  return with_mean_cosine(1.0 - std::exp(color * (-11.43 + color * (15.38 - color * 13.91))), g);
}

/// [Chiang2016] Eq. 1; without a mean cosine.
double chiang(double color, double g) {
  return with_mean_cosine(1.0 - std::exp(color * (-5.09406 + color * (2.61188 - color * 4.31805))),
                          g);
}

/// [Wrenninge2017], as Blender has it from 3.0 on.
double wrenninge(double color, double g) {
  const double a = polynomial(g, {1.8260523782, -1.28451056436, -1.79904629312, 9.19393289202,
                                  -22.8215585862, 32.0234874259, -23.6264803333, 7.21067002658});
  const double b =
      4.98511194385 +
      0.127355959438 *
          std::exp(polynomial(g, {0.0, 31.1491581433, -201.847017512, 841.576016723, -2018.09288505,
                                  2731.71560286, -1935.41424244, 559.009054474}));
  const double c = polynomial(g, {1.09686102424, -0.394704063468, 1.05258115941, -8.83963712726,
                                  28.8643230661, -46.8802913581, 38.5402837518, -12.7181042538});
  const double d = polynomial(g, {0.496310210422, 0.360146581622, -2.15139309747, 17.8896899217,
                                  -55.2984010333, 82.065982243, -58.5106008578, 15.8478295021});
  const double e =
      4.23190299701 +
      0.00310603949088 *
          std::exp(polynomial(g, {0.0, 76.7316253952, -594.356773233, 2448.8834203, -5576.68528998,
                                  7116.60171912, -4763.54467887, 1303.5318055}));
  const double f = polynomial(g, {2.40602999408, -2.51814844609, 9.18494908356, -79.2191708682,
                                  259.082868209, -403.613804597, 302.85712436, -87.4370473567});
  const double blend = std::pow(color, 0.25);
  const double albedo = (1.0 - blend) * a * std::pow(std::atan(b * color), c) +
                        blend * d * std::pow(std::atan(e * color), f);
  return std::clamp(albedo, 0.0, 0.999999);
}

struct Fit {
  std::string name;
  double (*albedo)(double color, double g);
};
const std::vector<Fit> fits = {{"OpenPBR 1.1.1, glTF (van de Hulst)", van_de_hulst},
                               {"OpenPBR drafts, by authors of Arnold", open_pbr_draft},
                               {"Blender 3.0 to 5.1 (Wrenninge 2017)", wrenninge},
                               {"Chiang 2016", chiang}};

std::vector<double> wanted_colors() {
  std::vector<double> colors;
  for (int i = 0; i <= 40; ++i) {
    const double x = static_cast<double>(i) / 40.0;
    colors.push_back(0.01 + 0.98 * x * x * (3.0 - 2.0 * x));  // closer at the ends
  }
  return colors;
}

/// The color that comes out over the one wanted, less 1 [%].
template <class Albedo>
PlotCurve errors(const std::string& name, const HalfSpaceLook& look, const Albedo& albedo) {
  PlotCurve curve{.name = name};
  const HalfSpaceColor reached(look);
  for (const double color : wanted_colors()) {
    if (!reached.is_reachable(color)) continue;
    curve.x.push_back(color);
    curve.y.push_back(100.0 * (solve_color(look, albedo(color)).color / color - 1.0));
  }
  return curve;
}

/// The largest one [%].
std::string extreme(const PlotCurve& curve) {
  double largest = 0.0;
  for (const double error : curve.y)
    if (std::abs(error) > std::abs(largest)) largest = error;
  char text[32];
  std::snprintf(text, sizeof text, std::abs(largest) < 0.1 ? " %+.2f |" : " %+.0f |", largest);
  return text;
}

}  // namespace

int main(int count, char** arguments) {
  struct Case {
    std::string title;
    HalfSpaceLook look;
    bool is_drawn;
  };
  using enum ColorDefinition;
  const std::vector<Case> cases = {
      {"diffuse, n 1, g 0", {.ior = 1.0, .g = 0.0, .definition = diffuse}, true},
      {"diffuse, n 1, g .8", {.ior = 1.0, .g = 0.8, .definition = diffuse}, false},
      {"openpbr, n 1, g 0", {.ior = 1.0, .g = 0.0, .definition = openpbr}, true},
      {"openpbr, n 1.4, g 0", {.ior = 1.4, .g = 0.0, .definition = openpbr}, true},
      {"openpbr, n 1.4, g .8", {.ior = 1.4, .g = 0.8, .definition = openpbr}, true},
      {"diffuse, n 1.4, g 0", {.ior = 1.4, .g = 0.0, .definition = diffuse}, false}};
  Plot plot{.title = "Colors that fits of the albedo give, by radiative transfer"};
  plot.columns = 2;
  std::vector<std::string> rows(fits.size() + 1);
  for (const Case& one : cases) {
    PlotPanel panel{.title = one.title};
    panel.x = {.label = "color wanted", .low = 0.0, .high = 1.0};
    panel.y = {.label = "color obtained: too bright by [%]", .low = -100.0, .high = 100.0};
    for (std::size_t f = 0; f < fits.size(); ++f) {
      panel.curves.push_back(errors(
          fits[f].name, one.look, [&](double color) { return fits[f].albedo(color, one.look.g); }));
      rows[f] += extreme(panel.curves.back());
    }
    const HalfSpaceColor table(one.look);
    panel.curves.push_back(
        errors("lamina invert", one.look, [&](double color) { return table.albedo(color); }));
    panel.curves.back().color = "#000000";
    panel.curves.back().style = CurveStyle::dashed;
    rows.back() += extreme(panel.curves.back());
    if (!one.is_drawn) continue;
    if (plot.panels.size() != 1)  // one legend, at the upper right
      for (PlotCurve& curve : panel.curves) curve.name.clear();
    plot.panels.push_back(panel);
  }
  std::string head = "| fit |", line = "|---|";
  for (const Case& one : cases) {
    head += " " + one.title + " |";
    line += "---|";
  }
  std::printf("%s\n%s\n", head.c_str(), line.c_str());
  for (std::size_t f = 0; f < rows.size(); ++f)
    std::printf("| %s |%s\n", f < fits.size() ? fits[f].name.c_str() : "`lamina invert`",
                rows[f].c_str());
  if (count > 1) save_svg(plot, arguments[1]);
}
