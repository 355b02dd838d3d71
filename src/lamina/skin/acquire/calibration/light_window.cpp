// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/light_window.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/bilinear.h"
#include "lamina/skin/acquire/calibration/internal/connected_regions.h"
#include "lamina/skin/acquire/calibration/internal/convex_polygon.h"

namespace lamina {
namespace {

/// The mean over the channels; 0 where it is no number.
struct GrayImage {
  int width = 0, height = 0;
  std::vector<float> pixels;

  /// Between pixels, bilinear.
  [[nodiscard]] double at(Vec2 place) const {
    return bilinear_clamped(place.x, place.y, width, height).interpolate([&](int x, int y) {
      return static_cast<double>(
          pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)]);
    });
  }
};

GrayImage gray_image(const Image& image) {
  GrayImage gray{image.width, image.height, {}};
  const std::size_t channels = image.channel_count();
  for (std::size_t i = 0; i < image.pixels.size(); i += channels) {
    float sum = 0.0f;
    for (std::size_t c = 0; c < channels; ++c) sum += image.pixels[i + c];
    gray.pixels.push_back(std::isfinite(sum) ? sum / static_cast<float>(channels) : 0.0f);
  }
  return gray;
}

/// The threshold between two classes of numbers that lie furthest apart for their scatter.
/// Source: [Otsu1979] Eq. 18.
float otsu_threshold(const std::vector<float>& numbers) {
  constexpr std::size_t bins = 512;
  const auto [low, high] = std::ranges::minmax(numbers);
  if (!(high > low)) return high;
  std::vector<double> counts(bins);
  const float scale = static_cast<float>(bins) / (high - low);
  for (const float v : numbers)
    counts[std::min(bins - 1, static_cast<std::size_t>((v - low) * scale))] += 1.0;
  double all = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < bins; ++i) {
    all += counts[i];
    sum += counts[i] * static_cast<double>(i);
  }
  double below = 0.0, sum_below = 0.0, widest = -1.0;
  std::size_t best = 0;
  for (std::size_t i = 0; i + 1 < bins; ++i) {
    below += counts[i];
    sum_below += counts[i] * static_cast<double>(i);
    if (below == 0.0 || below == all) continue;
    const double apart = sum_below / below - (sum - sum_below) / (all - below);
    const double between = below * (all - below) * apart * apart;
    if (between <= widest) continue;
    widest = between;
    best = i;
  }
  return low + (static_cast<float>(best) + 1.0f) / scale;
}

/// Where light passes the middle between bright and dark on the way out across a side.
std::optional<Vec2> edge_point(const GrayImage& image, Vec2 on_side, Vec2 outward, double reach) {
  constexpr double step = 0.25;  // [pixel]
  std::vector<double> values;
  for (double d = -reach; d <= reach; d += step) values.push_back(image.at(on_side + d * outward));
  const std::size_t quarter = values.size() / 4;
  double bright = 0.0, dark = 0.0;
  for (std::size_t i = 0; i < quarter; ++i) {
    bright += values[i] / static_cast<double>(quarter);
    dark += values[values.size() - 1 - i] / static_cast<double>(quarter);
  }
  const double middle = 0.5 * (bright + dark);
  if (!(bright > dark)) return std::nullopt;
  // The crossing nearest to the side as it is known so far.
  std::optional<double> nearest;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    if (!(values[i] >= middle && values[i + 1] < middle)) continue;
    const double part = (values[i] - middle) / (values[i] - values[i + 1]);
    const double d = -reach + step * (static_cast<double>(i) + part);
    if (!nearest || std::abs(d) < std::abs(*nearest)) nearest = d;
  }
  if (!nearest) return std::nullopt;
  return on_side + *nearest * outward;
}

struct Line {
  Vec2 point{}, direction{};
  double error = 0.0;  ///< standard deviation across it, of its middle [pixel]
  double squares = 0.0;
  std::size_t points = 0;
};

/// Total least squares with Cauchy's weights, so that dirt on an edge does not turn it.
Line fitted_side(const std::vector<Vec2>& points, Vec2 direction) {
  constexpr double limit = 0.5;  // [pixel]
  Line line{points[0], direction};
  for (int i = 0; i < 12; ++i) {
    double weights = 0.0;
    Vec2 mean{};
    std::vector<double> weight;
    for (const Vec2 p : points) {
      const Vec2 d = p - line.point;
      const double across = i == 0 ? 0.0 : d.x * line.direction.y - d.y * line.direction.x;
      weight.push_back(1.0 / (1.0 + across * across / (limit * limit)));
      weights += weight.back();
      mean = mean + weight.back() * p;
    }
    mean = (1.0 / weights) * mean;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 d = points[k] - mean;
      xx += weight[k] * d.x * d.x, xy += weight[k] * d.x * d.y, yy += weight[k] * d.y * d.y;
    }
    const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
    line.point = mean;
    line.direction = {std::cos(angle), std::sin(angle)};
  }
  line.points = points.size();
  // Neighbouring points err alike, by what is seen beside them: blocks of them are independent.
  constexpr std::size_t block_length = 16;
  double block = 0.0, blocks = 0.0, block_squares = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec2 d = points[k] - line.point;
    const double across = d.x * line.direction.y - d.y * line.direction.x;
    line.squares += across * across;
    block += across;
    if ((k + 1) % block_length != 0 && k + 1 != points.size()) continue;
    block_squares += block * block;
    blocks += 1.0;
    block = 0.0;
  }
  const double lost = blocks > 2.0 ? blocks / (blocks - 2.0) : 3.0;  // to the fit
  line.error = std::sqrt(lost * block_squares) / static_cast<double>(points.size());
  return line;
}

std::optional<Vec2> crossing(const Line& a, const Line& b) {
  const double sine = a.direction.x * b.direction.y - a.direction.y * b.direction.x;
  if (std::abs(sine) < 0.1) return std::nullopt;
  const Vec2 d = b.point - a.point;
  return a.point + ((d.x * b.direction.y - d.y * b.direction.x) / sine) * a.direction;
}

/// One side after another: lines through their edge points. Absent if an edge is not found.
std::optional<LightWindow> refined(const GrayImage& image, const std::array<Vec2, 4>& corners,
                                   double reach) {
  std::array<Line, 4> sides;
  LightWindow window;
  double squares = 0.0, points_of_all = 0.0;
  for (std::size_t s = 0; s < 4; ++s) {
    const Vec2 from = corners[s], to = corners[(s + 1) % 4], along = to - from;
    const double length = std::hypot(along.x, along.y);
    if (length < 8.0) return std::nullopt;
    const Vec2 outward{along.y / length, -along.x / length};  // of clockwise corners
    const double rim = std::max(0.1 * length, std::min(reach, 0.25 * length));
    std::vector<Vec2> points;
    for (double d = rim; d <= length - rim; d += 1.0)
      if (const auto point = edge_point(image, from + (d / length) * along, outward, reach))
        points.push_back(*point);
    if (static_cast<double>(points.size()) < 0.5 * (length - 2.0 * rim)) return std::nullopt;
    sides[s] = fitted_side(points, along);
    squares += sides[s].squares;
    points_of_all += static_cast<double>(points.size());
  }
  for (std::size_t s = 0; s < 4; ++s) {
    const Line &before = sides[(s + 3) % 4], &after = sides[s];
    const auto corner = crossing(before, after);
    if (!corner) return std::nullopt;
    window.corners[s] = *corner;
    // At its end a line is twice as uncertain as in its middle.
    window.error = std::max(window.error, 2.0 * std::hypot(before.error, after.error));
  }
  window.roughness = std::sqrt(squares / points_of_all);
  return window;
}

/// The first is nearest to the upper left.
void order(std::array<Vec2, 4>& corners) {
  const auto first =
      std::ranges::min_element(corners, {}, [](Vec2 corner) { return corner.x + corner.y; });
  std::ranges::rotate(corners, first);
}

}  // namespace

LightWindow find_light_window(const Image& image, const std::string& name,
                              const LightWindowOptions& options) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(name + ": no window of light is found: " + why + "; give its four corners");
  };
  const GrayImage gray = gray_image(image);
  const float threshold = otsu_threshold(gray.pixels);
  std::vector<bool> bright;
  for (const float v : gray.pixels) bright.push_back(v >= threshold);
  const std::vector<PixelRegion> regions = connected_regions(bright, image.width, image.height);
  const PixelRegion* largest = nullptr;
  for (const PixelRegion& region : regions)
    if (!region.touches_edge && (!largest || region.pixels > largest->pixels)) largest = &region;
  const auto all = static_cast<double>(gray.pixels.size());
  if (!largest || static_cast<double>(largest->pixels) < options.least_area * all)
    refuse("no bright region with a dark frame around it has " + number_text(options.least_area) +
           " of the image");
  const std::vector<Vec2> hull = convex_hull(largest->rim);
  std::optional<std::array<Vec2, 4>> corners = four_corners(hull);
  if (!corners || polygon_area(*corners) < 0.85 * polygon_area(hull) ||
      static_cast<double>(largest->pixels) < 0.75 * polygon_area(hull))
    refuse("the bright region has not four corners");
  std::optional<LightWindow> window;
  for (const double reach : {8.0, 4.0, 3.0}) {
    window = refined(gray, *corners, reach);
    if (!window) refuse("the bright region has no sharp sides");
    *corners = window->corners;
  }
  if (!(window->roughness <= options.most_roughness))
    refuse("the sides of the bright region are rough by " + printf_text("%.2f", window->roughness) +
           " pixels");
  order(window->corners);
  return *window;
}

}  // namespace lamina
