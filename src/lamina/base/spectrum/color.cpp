// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/color.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

Xyz xyz_of_chromaticity(double x, double y) { return {x / y, 1.0, (1.0 - x - y) / y}; }

constexpr double pi = std::numbers::pi;

/// Degrees of an angle, in [0, 360).
double hue_degrees(double b, double a) {
  if (a == 0.0 && b == 0.0) return 0.0;
  const double degrees = std::atan2(b, a) * 180.0 / pi;
  return degrees < 0.0 ? degrees + 360.0 : degrees;
}

double cos_degrees(double angle) { return std::cos(angle * pi / 180.0); }
double sin_degrees(double angle) { return std::sin(angle * pi / 180.0); }

}  // namespace

std::array<double, 3> operator*(const Matrix3& matrix, const std::array<double, 3>& vector) {
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) result[i] += matrix[i][j] * vector[j];
  return result;
}

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) result[i][j] += a[i][k] * b[k][j];
  return result;
}

Matrix3 inverse(const Matrix3& m) {
  const auto minor = [&](std::size_t i, std::size_t j) {  // of the transposed matrix, with its sign
    const std::size_t r0 = (j + 1) % 3, r1 = (j + 2) % 3, c0 = (i + 1) % 3, c1 = (i + 2) % 3;
    return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(1, 0) + m[0][2] * minor(2, 0);
  Matrix3 result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) result[i][j] = minor(i, j) / determinant;
  return result;
}

Xyz srgb_white() {
  const auto [x, y] = rec709_primaries().white;
  return xyz_of_chromaticity(x, y);
}

Xyz white_point(Illuminant illuminant) {
  Xyz sum{};
  for (const ColorMatchingRow& row : color_matching_table()) {
    const double power = illuminant_power(illuminant, row.wavelength);
    sum[0] += power * row.x;
    sum[1] += power * row.y;
    sum[2] += power * row.z;
  }
  return {sum[0] / sum[1], 1.0, sum[2] / sum[1]};
}

RgbPrimaries rec709_primaries() {
  return {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
}

Matrix3 rgb_to_xyz(const RgbPrimaries& primaries) {
  if (!(primaries.white[1] > 0.0)) throw InvalidInput("white of RGB: its y must be above 0");
  // Columns of any length, which white then sets, so that a y may be 0 or below.
  Matrix3 matrix{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [x, y] = std::array{primaries.red, primaries.green, primaries.blue}[c];
    matrix[0][c] = x;
    matrix[1][c] = y;
    matrix[2][c] = 1.0 - x - y;
  }
  const std::array<double, 3> scale =
      inverse(matrix) * xyz_of_chromaticity(primaries.white[0], primaries.white[1]);
  for (auto& row : matrix)
    for (std::size_t c = 0; c < 3; ++c) {
      row[c] *= scale[c];
      if (!std::isfinite(row[c])) throw InvalidInput("primaries of RGB: must not lie on a line");
    }
  return matrix;
}

Matrix3 linear_srgb_to_xyz() { return rgb_to_xyz(rec709_primaries()); }

Matrix3 xyz_to_linear_srgb() { return inverse(linear_srgb_to_xyz()); }

Matrix3 bradford_adaptation(const Xyz& from_white, const Xyz& to_white) {
  constexpr Matrix3 to_cones = {
      {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
  const std::array<double, 3> from = to_cones * from_white, to = to_cones * to_white;
  Matrix3 scaled = to_cones;
  for (std::size_t i = 0; i < 3; ++i)
    for (double& value : scaled[i]) value *= to[i] / from[i];
  return inverse(to_cones) * scaled;
}

Lab lab(const Xyz& color, const Xyz& white) {
  const auto f = [](double t) {
    constexpr double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
  };
  const double x = f(color[0] / white[0]), y = f(color[1] / white[1]), z = f(color[2] / white[2]);
  return {.lightness = 116.0 * y - 16.0, .a = 500.0 * (x - y), .b = 200.0 * (y - z)};
}

Lab lab(const LinearSrgb& color) { return lab(linear_srgb_to_xyz() * color, srgb_white()); }

// Names and numbers of equations are those of [Sharma2005].
double color_difference(const Lab& first, const Lab& second) {
  const double mean_c = 0.5 * (std::hypot(first.a, first.b) + std::hypot(second.a, second.b));
  const auto chroma_ratio = [](double c) {
    return std::sqrt(std::pow(c, 7.0) / (std::pow(c, 7.0) + std::pow(25.0, 7.0)));
  };
  const double g = 0.5 * (1.0 - chroma_ratio(mean_c));                         // Eq. 4
  const double a1 = (1.0 + g) * first.a, a2 = (1.0 + g) * second.a;            // Eq. 5
  const double c1 = std::hypot(a1, first.b), c2 = std::hypot(a2, second.b);    // Eq. 6
  const double h1 = hue_degrees(first.b, a1), h2 = hue_degrees(second.b, a2);  // Eq. 7

  const double delta_l = second.lightness - first.lightness;  // Eq. 8
  const double delta_c = c2 - c1;                             // Eq. 9
  const bool is_grey = c1 * c2 == 0.0;
  double delta_h_angle = is_grey ? 0.0 : h2 - h1;  // Eq. 10
  if (delta_h_angle > 180.0) delta_h_angle -= 360.0;
  if (delta_h_angle < -180.0) delta_h_angle += 360.0;
  const double delta_h = 2.0 * std::sqrt(c1 * c2) * sin_degrees(0.5 * delta_h_angle);  // Eq. 11

  const double mean_l = 0.5 * (first.lightness + second.lightness);  // Eq. 12
  const double mean_c_prime = 0.5 * (c1 + c2);                       // Eq. 13
  double mean_h = h1 + h2;                                           // Eq. 14
  if (!is_grey) {
    if (std::abs(h1 - h2) > 180.0) mean_h += mean_h < 360.0 ? 360.0 : -360.0;
    mean_h *= 0.5;
  }
  const double t = 1.0 - 0.17 * cos_degrees(mean_h - 30.0) + 0.24 * cos_degrees(2.0 * mean_h) +
                   0.32 * cos_degrees(3.0 * mean_h + 6.0) -
                   0.20 * cos_degrees(4.0 * mean_h - 63.0);  // Eq. 15
  const double turn = (mean_h - 275.0) / 25.0;
  const double delta_theta = 30.0 * std::exp(-turn * turn);  // Eq. 16
  const double r_c = 2.0 * chroma_ratio(mean_c_prime);       // Eq. 17
  const double from_50 = (mean_l - 50.0) * (mean_l - 50.0);
  const double s_l = 1.0 + 0.015 * from_50 / std::sqrt(20.0 + from_50);  // Eq. 18
  const double s_c = 1.0 + 0.045 * mean_c_prime;                         // Eq. 19
  const double s_h = 1.0 + 0.015 * mean_c_prime * t;                     // Eq. 20
  const double r_t = -sin_degrees(2.0 * delta_theta) * r_c;              // Eq. 21
  const double l = delta_l / s_l, c = delta_c / s_c, h = delta_h / s_h;
  return std::sqrt(l * l + c * c + h * h + r_t * c * h);  // Eq. 22
}

}  // namespace lamina
