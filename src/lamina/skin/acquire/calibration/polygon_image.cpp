// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/calibration/internal/convex_polygon.h"
#include "lamina/skin/acquire/calibration/light_window.h"

namespace lamina {
namespace {

/// Sums to the right of a side: each pixel gets the change of the covered area from its left
/// neighbour's, so that a running sum over the row is the area itself.
class CoverageSums {
 public:
  CoverageSums(int width, int height)
      : width_(width),
        height_(height),
        sums_(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height)) {}

  void add_side(Vec2 from, Vec2 to) {
    if (from.y == to.y) return;
    const double sign = from.y < to.y ? 1.0 : -1.0;
    if (from.y > to.y) std::swap(from, to);
    const double slope = (to.x - from.x) / (to.y - from.y);
    const int first = static_cast<int>(std::floor(std::clamp(from.y, 0.0, double(height_))));
    const int last = static_cast<int>(std::ceil(std::clamp(to.y, 0.0, double(height_))));
    for (int row = first; row < last; ++row) {
      const double y0 = std::max(from.y, double(row)), y1 = std::min(to.y, double(row + 1));
      if (y1 > y0)
        add_in_row(row, from.x + (y0 - from.y) * slope, from.x + (y1 - from.y) * slope,
                   sign * (y1 - y0));
    }
  }

  [[nodiscard]] Image image() const {
    Image image = make_image(width_, height_, {"Y"});
    for (int y = 0; y < height_; ++y) {
      double sum = 0.0;
      for (int x = 0; x < width_; ++x) {
        sum += sums_[index(x, y)];
        image.at(x, y)[0] = static_cast<float>(std::clamp(std::abs(sum), 0.0, 1.0));
      }
    }
    return image;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 2) +
           static_cast<std::size_t>(x);
  }

  /// A piece of a side within a row that covers what is right of it, `height` in all.
  void add_in_row(int row, double x0, double x1, double height) {
    if (x0 > x1) std::swap(x0, x1);
    const double end = width_;
    // What lies left of the image covers whole rows of it, what lies right nothing.
    const double length = x1 - x0;
    const auto share = [&](double a, double b) {  // of the piece, between a and b
      return length > 0.0        ? std::max(0.0, std::min(x1, b) - std::max(x0, a)) / length
             : x0 >= a && x0 < b ? 1.0
                                 : 0.0;
    };
    sums_[index(0, row)] += height * share(-1e300, 0.0);
    const int first = static_cast<int>(std::floor(std::clamp(x0, 0.0, end)));
    const int last = std::min(width_ - 1, static_cast<int>(std::floor(std::clamp(x1, 0.0, end))));
    for (int x = first; x <= last; ++x) {
      const double part = height * share(x, x + 1.0);
      const double middle = 0.5 * (std::max(x0, double(x)) + std::min(x1, x + 1.0));
      sums_[index(x, row)] += part * (x + 1.0 - middle);  // of this pixel
      sums_[index(x + 1, row)] += part * (middle - x);    // the rest, from the next one on
    }
  }

  int width_, height_;
  std::vector<double> sums_;  ///< [y][x], with two more at the end of each row
};

bool cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
}

void check_polygon(std::span<const Vec2> corners) {
  const std::size_t count = corners.size();
  if (count < 3 || count > 10000)
    throw InvalidInput("a polygon must have 3 to 10000 corners, but has " + std::to_string(count));
  constexpr double most = 1e7;  // [pixel]
  for (const Vec2 corner : corners)
    if (!(std::abs(corner.x) <= most && std::abs(corner.y) <= most))
      throw InvalidInput("the corners of a polygon must be finite and near to the image");
  for (std::size_t i = 0; count <= 1000 && i < count; ++i)
    for (std::size_t j = i + 2; j < count; ++j)
      if (cross(corners[i], corners[i + 1], corners[j], corners[(j + 1) % count]))
        throw InvalidInput("the sides of a polygon must not cross, but those after corners " +
                           std::to_string(i + 1) + " and " + std::to_string(j + 1) + " do");
  if (std::abs(polygon_area(corners)) < 1e-9)
    throw InvalidInput("a polygon must have an area, but its corners lie on a line");
}

}  // namespace

Image polygon_image(std::span<const Vec2> corners, int width, int height) {
  check_polygon(corners);
  CoverageSums sums(width, height);
  for (std::size_t i = 0; i < corners.size(); ++i)
    sums.add_side(corners[i], corners[(i + 1) % corners.size()]);
  return sums.image();
}

}  // namespace lamina
