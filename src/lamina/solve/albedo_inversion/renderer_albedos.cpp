// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/renderer_albedos.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>

namespace lamina {
namespace {

double polynomial(double x, std::initializer_list<double> coefficients) {
  double sum = 0.0, power = 1.0;
  for (const double coefficient : coefficients) {
    sum += coefficient * power;
    power *= x;
  }
  return sum;
}

}  // namespace

double van_de_hulst_color(double albedo, double g) {
  assert(0.0 <= albedo && albedo <= 1.0 && -1.0 < g && g < 1.0);
  const double s = std::sqrt((1.0 - albedo) / (1.0 - g * albedo));
  return (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
}

double van_de_hulst_albedo(double color, double g) {
  assert(0.0 <= color && color <= 1.0 && -1.0 < g && g < 1.0);
  const double s =
      4.09712 + 4.20863 * color - std::sqrt(9.59217 + color * (41.6808 + color * 17.7126));
  return std::clamp((1.0 - s * s) / (1.0 - g * s * s), 0.0, 1.0);
}

double wrenninge_albedo(double color, double g) {
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

}  // namespace lamina
