// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What renderers' fits of the albedo make of a color, by radiative transfer: the table and the plot
// of docs/albedo_inversion.md. `albedo_fits FILE.svg`
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "lamina/base/plot/plot.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"
#include "lamina/solve/albedo_inversion/renderer_albedos.h"

namespace {

using namespace lamina;

/// The albedo whose reduced form is albedo_prime.
double with_mean_cosine(double albedo_prime, double g) {
  return albedo_prime / (1.0 - g + g * albedo_prime);
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

struct Fit {
  std::string name;
  double (*albedo)(double color, double g);
};
const std::vector<Fit> fits = {{"OpenPBR 1.1.1, glTF (van de Hulst)", van_de_hulst_albedo},
                               {"OpenPBR drafts, by authors of Arnold", open_pbr_draft},
                               {"Blender 3.0 to 5.1 (Wrenninge 2017)", wrenninge_albedo},
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
