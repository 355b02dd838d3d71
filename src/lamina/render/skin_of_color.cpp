// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/core/parallel.h"
#include "lamina/render/skin_colors.h"
#include "lamina/render/surface_skin_maps.h"
#include "lamina/render/texture.h"
#include "lamina/scattering/adding_doubling.h"

namespace lamina {
namespace {

constexpr std::size_t nodes = 9;  // solved, of each parameter

/// Range of the logarithm of what is sought.
struct Range {
  double low, high;
  [[nodiscard]] double at(double place) const {
    return std::exp(low + place / static_cast<double>(nodes - 1) * (high - low));
  }
};
const Range melanin_range{std::log(0.002), std::log(0.45)};
const Range blood_range{std::log(0.0008), std::log(0.09)};

double log_luminance(double r, double g, double b) {
  return std::log(std::max(0.2126 * r + 0.7152 * g + 0.0722 * b, 1e-4));
}
double log_ratio(double a, double b) { return std::log(std::max(a, 1e-4) / std::max(b, 1e-4)); }

}  // namespace

SkinOfColor::SkinOfColor(const SkinParameters& base) : looks_(nodes * nodes) {
  const BandSet bands = default_spectral_bands();
  const BandWeights weights = make_skin_band_weights(bands, base);
  parallel_for(nodes * nodes, [&](std::size_t k) {
    SkinParameters skin = base;
    skin.melanin = melanin_range.at(static_cast<double>(k / nodes));
    skin.hemoglobin_dermis = blood_range.at(static_cast<double>(k % nodes));
    std::array<double, 3> color{};
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const double reflectance =
          adding_doubling(skin_layer_stack(skin, bands.wavelengths()[b]), {}, {.accuracy = 1e-4})
              .totals.diffuse_reflectance;
      for (std::size_t c = 0; c < 3; ++c) color[c] += weights[b][c] * reflectance;
    }
    looks_[k] = {log_luminance(color[0], color[1], color[2]), log_ratio(color[0], color[1]),
                 log_ratio(color[2], color[1])};
  });
}

SkinOfColor::Look SkinOfColor::look_at(double melanin, double blood) const {
  const auto i = std::min(static_cast<std::size_t>(melanin), nodes - 2);
  const auto j = std::min(static_cast<std::size_t>(blood), nodes - 2);
  const double x = melanin - static_cast<double>(i), y = blood - static_cast<double>(j);
  const Look* corner = &looks_[i * nodes + j];
  const auto mixed = [&](double Look::* part) {
    return (1 - x) * ((1 - y) * corner[0].*part + y * corner[1].*part) +
           x * ((1 - y) * corner[nodes].*part + y * corner[nodes + 1].*part);
  };
  return {mixed(&Look::luminance), mixed(&Look::redness), mixed(&Look::blueness)};
}

// The node that looks most like it, then steps of Gauss and Newton, kept in range and only taken
// where they bring the look nearer.
SkinOfColor::Value SkinOfColor::at(const Vec3f& reflectance) const {
  const auto r = static_cast<double>(reflectance.x), g = static_cast<double>(reflectance.y),
             b = static_cast<double>(reflectance.z);
  const Look wanted{log_luminance(r, g, b), log_ratio(r, g), log_ratio(b, g)};
  const auto minus = [](const Look& p, const Look& q) {
    return Vec3{p.luminance - q.luminance, p.redness - q.redness, p.blueness - q.blueness};
  };
  const auto distance = [&](const Look& look) { return length(minus(look, wanted)); };
  const auto nearest = std::ranges::min_element(looks_, {}, distance) - looks_.begin();
  constexpr double end = nodes - 1;
  double x = static_cast<double>(static_cast<std::size_t>(nearest) / nodes);
  double y = static_cast<double>(static_cast<std::size_t>(nearest) % nodes);
  double best = distance(look_at(x, y));
  for (int step = 0; step < 30 && best > 1e-6; ++step) {
    constexpr double h = 0.5;  // [node]: across the kinks between cells
    const double x0 = std::max(x - h, 0.0), x1 = std::min(x + h, end);
    const double y0 = std::max(y - h, 0.0), y1 = std::min(y + h, end);
    const Look here = look_at(x, y), left = look_at(x0, y), right = look_at(x1, y),
               below = look_at(x, y0), above = look_at(x, y1);
    const Vec3 along_x = minus(right, left) / (x1 - x0), along_y = minus(above, below) / (y1 - y0);
    const Vec3 missing = minus(wanted, here);
    const double xx = dot(along_x, along_x), xy = dot(along_x, along_y), yy = dot(along_y, along_y),
                 determinant = xx * yy - xy * xy;
    if (determinant < 1e-12) break;
    const double to_x = dot(along_x, missing), to_y = dot(along_y, missing);
    const double dx = (to_x * yy - xy * to_y) / determinant;
    const double dy = (xx * to_y - to_x * xy) / determinant;
    double share = 1.0;
    for (; share > 1e-3; share *= 0.5) {
      const double u = std::clamp(x + share * dx, 0.0, end),
                   v = std::clamp(y + share * dy, 0.0, end);
      const double there = distance(look_at(u, v));
      if (there >= best) continue;
      x = u, y = v, best = there;
      break;
    }
    if (share <= 1e-3) break;
  }
  return {melanin_range.at(x), blood_range.at(y)};
}

}  // namespace lamina
