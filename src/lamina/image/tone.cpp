// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/image/tone.h"

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
    const LinearSrgb shown = view == View::filmic ? filmic(light) : clamped(light);
    for (std::size_t c = 0; c < color_count; ++c) pixel[c] = static_cast<float>(shown[c]);
  }
  return result;
}

}  // namespace lamina
