// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/tone.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamina {
namespace {

constexpr double contrast = 1.2;  // n
constexpr double white = 16.0;    // w
constexpr double mid_grey = 0.18;

/// s, from f(mid_grey) = mid_grey.
double half_saturation() {
  const double grey = std::pow(mid_grey, contrast), top = std::pow(white, contrast);
  return (1.0 - mid_grey) * grey * top / (mid_grey * top - grey);
}

LinearSrgb product(const Matrix3& m, const LinearSrgb& v) {
  LinearSrgb result{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) result[r] += m[r][c] * v[c];
  return result;
}

/// AgX's primaries in linear Rec.709, each row of sum 1.
Matrix3 agx_primaries() {
  Matrix3 m = {{{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                {0.0423756549057051, 0.0784336, 0.879142973793104}}};
  for (auto& row : m) {
    const double total = row[0] + row[1] + row[2];
    for (double& value : row) value /= total;
  }
  return m;
}

LinearSrgb clamped(const LinearSrgb& light) {
  LinearSrgb result{};
  for (std::size_t c = 0; c < 3; ++c)
    result[c] = light[c] > 0.0 ? std::min(light[c], 1.0) : 0.0;  // NaN is 0
  return result;
}

}  // namespace

double filmic_curve(double light) {
  if (!(light > 0.0)) return 0.0;
  if (light >= white) return 1.0;
  static const double s = half_saturation();
  static const double scale = 1.0 + s / std::pow(white, contrast);  // 1 / y(w)
  const double x = std::pow(light, contrast);
  return scale * x / (x + s);
}

LinearSrgb filmic(const LinearSrgb& light) {
  LinearSrgb positive{};
  for (std::size_t c = 0; c < 3; ++c) positive[c] = light[c] > 0.0 ? std::min(light[c], 1e30) : 0.0;
  std::array<std::size_t, 3> order = {0, 1, 2};
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return positive[a] < positive[b]; });
  const double low = positive[order[0]], middle = positive[order[1]], high = positive[order[2]];
  const double place = high > low ? (middle - low) / (high - low) : 0.0;
  LinearSrgb result{};
  result[order[0]] = filmic_curve(low);
  result[order[2]] = filmic_curve(high);
  result[order[1]] = result[order[0]] + place * (result[order[2]] - result[order[0]]);
  return result;
}

double agx_curve(double stops) {
  constexpr double below = 10.0, range = 16.5, grey = 0.5, slope = 2.0, toe = 3.0, shoulder = 3.25;
  const double x = std::clamp((stops + below) / range, 0.0, 1.0), middle = below / range;
  // Such that the toe ends in (0, 0) and the shoulder, seen from there, in (1, 1).
  const auto hyperbola = [&](double from_middle, double width, double height, double power) {
    const double steep = slope * width / height;
    const double scale = height * steep / std::pow(std::pow(steep, power) - 1.0, 1.0 / power);
    const double t = slope * from_middle / scale;
    return scale * t / std::pow(1.0 + std::pow(t, power), 1.0 / power);
  };
  return x < middle ? grey - hyperbola(middle - x, middle, grey, toe)
                    : grey + hyperbola(x - middle, 1.0 - middle, 1.0 - grey, shoulder);
}

LinearSrgb agx(const LinearSrgb& light) {
  static const Matrix3 inward = agx_primaries(), outward = inverse(inward);
  constexpr double mid = 0.18, gamma = 2.2, least = 1e-10, most = 1e30;
  LinearSrgb positive{};
  for (std::size_t c = 0; c < 3; ++c) positive[c] = light[c] > 0.0 ? std::min(light[c], most) : 0.0;
  LinearSrgb code = product(inward, positive);
  for (double& value : code) value = agx_curve(std::log2(std::max(value, least) / mid));
  LinearSrgb shown = product(outward, code);
  for (double& value : shown) value = std::pow(std::clamp(value, 0.0, 1.0), gamma);
  return shown;
}

Image view_image(const Image& image, View view, double exposure) {
  const bool is_grey = !channel_index(image, "R") && channel_index(image, "Y");
  std::vector<std::string> names =
      is_grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  const std::size_t color_count = names.size();
  if (channel_index(image, "A")) names.emplace_back("A");
  Image result = select_channels(image, names);
  const double scale = std::exp2(exposure);
  for (std::size_t at = 0; at < result.pixels.size(); at += names.size()) {
    float* pixel = result.pixels.data() + at;
    LinearSrgb light{};
    for (std::size_t c = 0; c < 3; ++c)
      light[c] = scale * static_cast<double>(pixel[is_grey ? 0 : c]);
    const LinearSrgb shown = view == View::filmic ? filmic(light)
                             : view == View::agx  ? agx(light)
                                                  : clamped(light);
    for (std::size_t c = 0; c < color_count; ++c) pixel[c] = static_cast<float>(shown[c]);
  }
  return result;
}

}  // namespace lamina
