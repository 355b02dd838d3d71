// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/gaussian_height_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/layers/optics/fresnel.h"

namespace lamina {
namespace {

using std::numbers::pi;

double sample_gaussian(Random& random) {
  const double r = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return r * std::cos(2.0 * pi * random.uniform());
}

/// Sums along the rows of a periodic square, with weights kernel[|distance|], and turns rows into
/// columns.
std::vector<double> filter_rows(const std::vector<double>& in, std::size_t n,
                                const std::vector<double>& kernel) {
  const std::size_t reach = kernel.size() - 1;
  std::vector<double> out(n * n), row(n + 2 * reach);
  for (std::size_t y = 0; y < n; ++y) {
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = in[y * n + (i + n - reach % n) % n];
    for (std::size_t x = 0; x < n; ++x) {
      double sum = kernel[0] * row[x + reach];
      for (std::size_t d = 1; d <= reach; ++d)
        sum += kernel[d] * (row[x + reach - d] + row[x + reach + d]);
      out[x * n + y] = sum;
    }
  }
  return out;
}

/// A ray in a triangle of the field. Each cell is cut from its corner (0, 0) to (1, 1).
struct Traveller {
  Vec3 direction;
  double x, y, z;  ///< in the cell, [0, 1] each; height
  int cell_x, cell_y;
  bool is_lower;  ///< in the triangle x >= y of the cell
  bool is_above;  ///< in the medium above
  double gap;     ///< distance from the surface along z, >= 0
};

/// Slopes of the triangle that the ray is over.
Vec2 slopes_at(const GaussianHeightField& field, const Traveller& ray) {
  const double h00 = field.height(ray.cell_x, ray.cell_y);
  const double h11 = field.height(ray.cell_x + 1, ray.cell_y + 1);
  if (ray.is_lower) {
    const double h10 = field.height(ray.cell_x + 1, ray.cell_y);
    return {h10 - h00, h11 - h10};
  }
  const double h01 = field.height(ray.cell_x, ray.cell_y + 1);
  return {h11 - h01, h01 - h00};
}

enum class Edge { x, y, diagonal, none };

/// The edge through which the ray leaves its triangle, and how far away.
std::pair<Edge, double> next_edge(const Traveller& ray) {
  const Vec3& d = ray.direction;
  std::pair<Edge, double> next = {Edge::none, std::numeric_limits<double>::infinity()};
  const auto consider = [&](Edge edge, double distance, double speed) {
    if (!(speed > 0.0)) return;
    const double t = std::max(distance, 0.0) / speed;
    if (t < next.second) next = {edge, t};
  };
  if (ray.is_lower) {
    consider(Edge::x, 1.0 - ray.x, d.x);
    consider(Edge::y, ray.y, -d.y);
    consider(Edge::diagonal, ray.x - ray.y, d.y - d.x);
  } else {
    consider(Edge::x, ray.x, -d.x);
    consider(Edge::y, 1.0 - ray.y, d.y);
    consider(Edge::diagonal, ray.y - ray.x, d.x - d.y);
  }
  return next;
}

void step_across(Traveller& ray, Edge edge, int size) {
  const int forward = ray.is_lower ? 1 : -1;  // the lower triangle ends at x = 1 and y = 0
  const auto wrapped = [&](int i) { return i < 0 ? i + size : i >= size ? i - size : i; };
  if (edge == Edge::x) {
    ray.cell_x = wrapped(ray.cell_x + forward);
    ray.x = ray.is_lower ? 0.0 : 1.0;
  } else if (edge == Edge::y) {
    ray.cell_y = wrapped(ray.cell_y - forward);
    ray.y = ray.is_lower ? 1.0 : 0.0;
  } else {
    ray.x = ray.y = 0.5 * (ray.x + ray.y);
  }
  ray.is_lower = !ray.is_lower;
}

/// Reflects or refracts at the triangle that was met.
void scatter(Traveller& ray, const Vec2& slopes, double eta, Random& random) {
  const Vec3 up = normalize(Vec3{-slopes.x, -slopes.y, 1.0});
  const Vec3 normal = ray.is_above ? up : -up;
  const double ratio = ray.is_above ? eta : 1.0 / eta;
  const Vec3 view = -ray.direction;
  const double reflectance = fresnel(std::clamp(dot(view, normal), 0.0, 1.0), ratio);
  ray.gap = 0.0;
  if (random.uniform() >= reflectance)
    if (const auto onward = refract(view, normal, ratio)) {
      ray.direction = *onward;
      ray.is_above = !ray.is_above;
      return;
    }
  ray.direction = reflect(view, normal);
}

}  // namespace

GaussianHeightField::GaussianHeightField(const HeightFieldShape& shape, Random& random) {
  const auto& [s, cells, across] = shape;
  if (!(s > 0.0 && std::isfinite(s)))
    throw InvalidInput("smoothness must be > 0 and finite, but is " + number_text(s));
  if (cells < 2 || across < 4 || cells > 4096 / across)
    throw InvalidInput(
        "a height field must have >= 2 cells per correlation length, >= 4 correlation lengths and "
        "<= 4096 cells across, but has " +
        std::to_string(cells) + " and " + std::to_string(across));
  size_ = cells * across;
  const auto n = static_cast<std::size_t>(size_);

  // The filter exp(-2 r^2 / tau^2) convolved with itself is the correlation. It is cut at 1e-16 and
  // scaled to unit output variance.
  std::vector<double> kernel;
  double norm2 = 0.0;
  for (int d = 0; d <= 4.3 * cells; ++d) {
    const double x = static_cast<double>(d) / cells;
    kernel.push_back(std::exp(-2.0 * x * x));
    norm2 += (d == 0 ? 1.0 : 2.0) * kernel.back() * kernel.back();
  }
  for (double& weight : kernel) weight /= std::sqrt(norm2);

  std::vector<double> noise(n * n);
  for (double& value : noise) value = sample_gaussian(random);
  const std::vector<double> heights = filter_rows(filter_rows(noise, n, kernel), n, kernel);
  const double sigma = cells / s;  // in cells
  heights_.reserve(heights.size());
  for (const double h : heights) heights_.push_back(static_cast<float>(sigma * h));
  const auto [low, high] = std::ranges::minmax(heights_);
  lowest_ = low, highest_ = high;
}

HeightFieldPath trace_path(const GaussianHeightField& field, double eta, const Vec3& wi,
                           Random& random) {
  assert(wi.z > 0.0 && eta > 0.0);
  Traveller ray = {.direction = -wi,
                   .x = random.uniform(),
                   .y = random.uniform(),
                   .z = field.highest(),
                   .cell_x = static_cast<int>(random.uniform() * field.size()),
                   .cell_y = static_cast<int>(random.uniform() * field.size()),
                   .is_lower = false,
                   .is_above = true,
                   .gap = 0.0};
  ray.is_lower = ray.x >= ray.y;
  const Vec2 first = slopes_at(field, ray);
  ray.gap = ray.z - field.height(ray.cell_x, ray.cell_y) - first.x * ray.x - first.y * ray.y;

  int order = 0;
  bool is_fresh = false;  // just scattered by this triangle, which it cannot meet again
  for (int step = 0; step < 1'000'000 && order < 1000; ++step) {
    const Vec2 slopes = slopes_at(field, ray);
    const Vec3& d = ray.direction;
    const auto [edge, to_edge] = next_edge(ray);
    const double climb = d.z - slopes.x * d.x - slopes.y * d.y;  // over the triangle, per length
    const double opening = ray.is_above ? climb : -climb;
    const double to_surface =
        opening < 0.0 ? -ray.gap / opening : std::numeric_limits<double>::infinity();
    const bool meets = !is_fresh && to_surface <= to_edge;
    const double t = meets ? to_surface : to_edge;
    if (!meets) {
      const bool leaves_above = ray.is_above && d.z > 0.0 && ray.z >= field.highest();
      const bool leaves_below = !ray.is_above && d.z < 0.0 && ray.z <= field.lowest();
      if (leaves_above || leaves_below) return {.wo = d, .order = order};
      if (edge == Edge::none) {  // straight up or down over this triangle: nothing more to meet
        if ((d.z > 0.0) == ray.is_above) return {.wo = d, .order = order};
        break;
      }
    }
    ray.x += t * d.x, ray.y += t * d.y, ray.z += t * d.z;
    if (meets) {
      scatter(ray, slopes, eta, random);
      ++order;
      is_fresh = true;
    } else {
      ray.gap = std::max(0.0, ray.gap + t * opening);
      step_across(ray, edge, field.size());
      is_fresh = false;
    }
  }
  return {.wo = wi, .order = 0};
}

}  // namespace lamina
