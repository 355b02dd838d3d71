// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/color_chart.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/internal/chart_lattice.h"
#include "lamina/skin/acquire/calibration/internal/convex_polygon.h"
#include "lamina/skin/acquire/calibration/internal/homography.h"

namespace lamina {
namespace {

constexpr std::array<ChartColor, chart_patches> colors_before_2014 = {
    {{"dark skin", {37.986, 13.555, 14.059}},
     {"light skin", {65.711, 18.13, 17.81}},
     {"blue sky", {49.927, -4.88, -21.905}},
     {"foliage", {43.139, -13.095, 21.905}},
     {"blue flower", {55.112, 8.844, -25.399}},
     {"bluish green", {70.719, -33.397, -0.199}},
     {"orange", {62.661, 36.067, 57.096}},
     {"purplish blue", {40.02, 10.41, -45.964}},
     {"moderate red", {51.124, 48.239, 16.248}},
     {"purple", {30.325, 22.976, -21.587}},
     {"yellow green", {72.532, -23.709, 57.255}},
     {"orange yellow", {71.941, 19.363, 67.857}},
     {"blue", {28.778, 14.179, -50.297}},
     {"green", {55.261, -38.342, 31.37}},
     {"red", {42.101, 53.378, 28.19}},
     {"yellow", {81.733, 4.039, 79.819}},
     {"magenta", {51.935, 49.986, -14.574}},
     {"cyan", {51.038, -28.631, -28.638}},
     {"white", {96.539, -0.425, 1.186}},
     {"neutral 8", {81.257, -0.638, -0.335}},
     {"neutral 6.5", {66.766, -0.734, -0.504}},
     {"neutral 5", {50.867, -0.153, -0.27}},
     {"neutral 3.5", {35.656, -0.421, -1.231}},
     {"black", {20.461, -0.079, -0.973}}}};

constexpr std::array<ChartColor, chart_patches> colors_from_2014 = {
    {{"dark skin", {37.54, 14.37, 14.92}},     {"light skin", {64.66, 19.27, 17.50}},
     {"blue sky", {49.32, -3.82, -22.54}},     {"foliage", {43.46, -12.74, 22.72}},
     {"blue flower", {54.94, 9.61, -24.79}},   {"bluish green", {70.48, -32.26, -0.37}},
     {"orange", {62.73, 35.83, 56.50}},        {"purplish blue", {39.43, 10.75, -45.17}},
     {"moderate red", {50.57, 48.64, 16.67}},  {"purple", {30.10, 22.54, -20.87}},
     {"yellow green", {71.77, -24.13, 58.19}}, {"orange yellow", {71.51, 18.24, 67.37}},
     {"blue", {28.37, 15.42, -49.80}},         {"green", {54.38, -39.72, 32.27}},
     {"red", {42.43, 51.05, 28.62}},           {"yellow", {81.80, 2.67, 80.41}},
     {"magenta", {50.63, 51.28, -14.12}},      {"cyan", {49.57, -29.71, -28.32}},
     {"white", {95.19, -1.03, 2.93}},          {"neutral 8", {81.29, -0.57, 0.44}},
     {"neutral 6.5", {66.89, -0.75, -0.06}},   {"neutral 5", {50.76, -0.13, 0.14}},
     {"neutral 3.5", {35.63, -0.46, -0.48}},   {"black", {20.64, 0.07, -0.46}}}};

/// The white of D50 with Y = 1. Source: [CIE015] Table 11.3, from x = .34567, y = .35850.
constexpr Xyz d50_white = {0.96422, 1.0, 0.82521};

/// The inverse of lab(Xyz, Xyz).
Xyz xyz_of(const Lab& color, const Xyz& white) {
  const auto inverse = [](double f) {
    constexpr double delta = 6.0 / 29.0;
    return f > delta ? f * f * f : 3.0 * delta * delta * (f - 4.0 / 29.0);
  };
  const double y = (color.lightness + 16.0) / 116.0;
  return {white[0] * inverse(y + color.a / 500.0), white[1] * inverse(y),
          white[2] * inverse(y - color.b / 200.0)};
}

constexpr double half_of_middle = 0.2;  // of the patch that is read, in distances between patches

PatchReading read_patch(const Image& rgb, const Matrix3& place, const Matrix3& back, Vec2 centre,
                        double saturation) {
  double left = 1e9, right = 0.0, top = 1e9, bottom = 0.0;
  for (const double i : {-half_of_middle, half_of_middle})
    for (const double j : {-half_of_middle, half_of_middle}) {
      const Vec2 corner = seen_at(place, centre + Vec2{i, j});
      left = std::min(left, corner.x), right = std::max(right, corner.x);
      top = std::min(top, corner.y), bottom = std::max(bottom, corner.y);
    }
  PatchReading reading;
  std::array<double, 3> squares{};
  const auto begin = [](double low) { return std::max(0, static_cast<int>(std::floor(low))); };
  const int x_end = static_cast<int>(std::min(std::ceil(right), double(rgb.width)));
  const int y_end = static_cast<int>(std::min(std::ceil(bottom), double(rgb.height)));
  for (int y = begin(top); y < y_end; ++y)
    for (int x = begin(left); x < x_end; ++x) {
      const Vec2 on_chart = seen_at(back, {x + 0.5, y + 0.5});
      if (std::abs(on_chart.x - centre.x) > half_of_middle ||
          std::abs(on_chart.y - centre.y) > half_of_middle)
        continue;
      const float* pixel = rgb.at(x, y);
      ++reading.pixels;
      bool is_saturated = false;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(pixel[c]);
        is_saturated = is_saturated || !(value < saturation);
        reading.mean[c] += value;
        squares[c] += value * value;
      }
      reading.saturated += is_saturated ? 1 : 0;
    }
  const auto count = static_cast<double>(std::max<std::size_t>(reading.pixels, 1));
  for (std::size_t c = 0; c < 3; ++c) {
    reading.mean[c] /= count;
    reading.deviation[c] =
        std::sqrt(std::max(0.0, squares[c] / count - reading.mean[c] * reading.mean[c]));
  }
  return reading;
}

}  // namespace

const std::array<ChartColor, chart_patches>& chart_colors(ColorChartEdition edition) {
  return edition == ColorChartEdition::before_november_2014 ? colors_before_2014 : colors_from_2014;
}

std::array<LinearSrgb, chart_patches> chart_srgb(ColorChartEdition edition) {
  const Matrix3 to_srgb = xyz_to_linear_srgb() * bradford_adaptation(d50_white, srgb_white());
  std::array<LinearSrgb, chart_patches> colors{};
  for (std::size_t i = 0; i < chart_patches; ++i)
    colors[i] = to_srgb * xyz_of(chart_colors(edition)[i].lab, d50_white);
  return colors;
}

ChartReading read_color_chart(const Image& image, const ChartCorners& corners,
                              const std::string& name, const ChartOptions& options) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(name + ": the color chart's corners " + why);
  };
  for (const Vec2 corner : corners)
    if (!(corner.x >= 0.0 && corner.y >= 0.0 && corner.x <= image.width &&
          corner.y <= image.height))
      refuse("must lie in the image, but (" + number_text(corner.x) + ", " + number_text(corner.y) +
             ") does not");
  for (std::size_t i = 0; i < 4; ++i) {
    const double area = turn(corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]);
    if (!(area > 16.0))
      refuse(
          "must go clockwise around a convex quadrilateral: dark skin, bluish green, black, "
          "white");
  }
  const Image rgb = select_channels(image, {"R", "G", "B"});
  constexpr std::array<Vec2, 4> on_chart = {Vec2{0, 0}, {5, 0}, {5, 3}, {0, 3}};
  const Matrix3 place = fit_homography(on_chart, corners), back = inverse(place);
  ChartReading reading{.corners = corners, .patches = {}};
  for (std::size_t i = 0; i < chart_patches; ++i) {
    const Vec2 centre{static_cast<double>(i % chart_columns),
                      static_cast<double>(i / chart_columns)};
    reading.patches[i] = read_patch(rgb, place, back, centre, options.saturation);
    if (reading.patches[i].pixels < 9)
      refuse("are too near: patches must have 9 pixels in their middle, but " +
             std::string(chart_colors(options.edition)[i].name) + " has " +
             std::to_string(reading.patches[i].pixels));
    for (const double mean : reading.patches[i].mean)
      if (!std::isfinite(mean)) refuse("hold pixels that are not finite");
  }
  return reading;
}

ChartReading find_color_chart(const Image& image, const std::string& name,
                              const ChartOptions& options) {
  const Image rgb = select_channels(image, {"R", "G", "B"});
  const auto corners = find_chart_corners(rgb, chart_srgb(options.edition));
  if (!corners)
    throw InvalidInput(name +
                       ": no color chart is found: 24 patches in a lattice of 6 by 4 whose "
                       "colors are the chart's; give the centres of its corner patches");
  return read_color_chart(rgb, *corners, name, options);
}

std::array<Vec2, 4> chart_outline(const ChartCorners& corners) {
  constexpr double right = chart_columns - 1.0, down = chart_rows - 1.0, beyond = 0.75;
  const std::array<Vec2, 4> centres = {{{0.0, 0.0}, {right, 0.0}, {right, down}, {0.0, down}}};
  const Matrix3 homography = fit_homography(centres, corners);
  return {seen_at(homography, {-beyond, -beyond}), seen_at(homography, {right + beyond, -beyond}),
          seen_at(homography, {right + beyond, down + beyond}),
          seen_at(homography, {-beyond, down + beyond})};
}

std::vector<ColorSample> color_samples(const ChartReading& reading, ColorChartEdition edition) {
  const std::array<LinearSrgb, chart_patches> references = chart_srgb(edition);
  std::vector<ColorSample> samples;
  for (std::size_t i = 0; i < chart_patches; ++i) {
    const PatchReading& patch = reading.patches[i];
    if (100 * patch.saturated <= patch.pixels) samples.push_back({patch.mean, references[i]});
  }
  if (samples.size() < 12)
    throw InvalidInput("color chart: at least 12 patches must not be saturated, but only " +
                       std::to_string(samples.size()) + " are not: expose less");
  return samples;
}

}  // namespace lamina
