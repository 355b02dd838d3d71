// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/ring_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace lamina {
namespace {

/// Reach of what is nearby, to either side in log r.
constexpr std::array<double, 11> reaches = {0.05, 0.07, 0.1, 0.14, 0.2, 0.28,
                                            0.4,  0.56, 0.8, 1.12, 1.6};
/// Widths agree where their answers, each give or take so many standard errors, have a value in
/// common. A bias below that stays hidden: errors are stated that much larger than the noise.
constexpr double agreement = 0.6, hidden_bias = 1.25;
constexpr double fewest_photons = 300.0;  ///< that a disc around the axis holds to be resolved
constexpr std::size_t fewest_rings = 5;   ///< with light, of a parabola
constexpr double unknown = std::numeric_limits<double>::infinity();

struct Parabola {
  std::array<double, 3> of{};  ///< log density is of[0] + of[1] x + of[2] x², x from the middle
  [[nodiscard]] double at(double x) const { return of[0] + x * (of[1] + x * of[2]); }
};

/// A symmetric matrix of 3 x 3, inverted; nothing if it is singular.
using Square = std::array<std::array<double, 3>, 3>;
std::optional<Square> inverse(const Square& m) {
  Square c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, d = (j + 1) % 3, e = (j + 2) % 3;
      c[j][i] = m[a][d] * m[b][e] - m[a][e] * m[b][d];
    }
  const double determinant = m[0][0] * c[0][0] + m[0][1] * c[1][0] + m[0][2] * c[2][0];
  if (!(determinant > 1e-12 * m[0][0] * m[1][1] * m[2][2])) return std::nullopt;
  for (auto& row : c)
    for (double& value : row) value /= determinant;
  return c;
}

/// What a ring whose middle lies at x catches of unit density there, if it is exp(parabola).
double catch_of(const Parabola& parabola, double x, double middle_radius, double width) {
  constexpr std::array<double, 3> place = {-0.3872983346207417, 0.0, 0.3872983346207417};
  constexpr std::array<double, 3> weight = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const double here = parabola.at(x);
  double sum = 0.0;
  for (std::size_t q = 0; q < 3; ++q) {
    const double step = place[q] * width;
    sum += weight[q] * std::exp(2.0 * step + parabola.at(x + step) - here);
  }
  return 2.0 * std::numbers::pi * middle_radius * middle_radius * width * sum;
}

struct Fit {
  Estimate density;
  double slope = 0.0;  ///< of log density over log r
};

/// The fit around log r = u within a reach.
std::optional<Fit> fit(const RingFlux& rings, double u, double reach) {
  const double first = std::log(rings.first_radius), width = rings.log_width;
  const auto size = static_cast<std::ptrdiff_t>(rings.flux.size());
  const auto from = std::max<std::ptrdiff_t>(
      0, static_cast<std::ptrdiff_t>(std::ceil((u - reach - first) / width - 0.5)));
  const auto to =
      std::min(size, static_cast<std::ptrdiff_t>(std::floor((u + reach - first) / width + 0.5)));
  double light = 0.0, area = 0.0;
  std::size_t lit = 0;
  for (std::ptrdiff_t i = from; i < to; ++i) {
    const auto ring = static_cast<std::size_t>(i);
    light += rings.flux[ring].value;
    area += std::numbers::pi *
            (std::pow(rings.begin_of(ring + 1), 2) - std::pow(rings.begin_of(ring), 2));
    lit += rings.flux[ring].value > 0.0 ? 1 : 0;
  }
  if (lit < fewest_rings) return std::nullopt;
  Parabola parabola{{std::log(light / area), 0.0, 0.0}};
  Square information{}, spread{};
  for (int step = 0; step < 25; ++step) {
    information = spread = {};
    std::array<double, 3> slope{};
    for (std::ptrdiff_t i = from; i < to; ++i) {
      const auto ring = static_cast<std::size_t>(i);
      const double x = first + (static_cast<double>(i) + 0.5) * width - u;
      const double t = x / (reach + 0.5 * width);
      const double kernel = std::pow(std::max(0.0, 1.0 - t * t), 2.0);
      const double expected =
          std::exp(parabola.at(x)) * catch_of(parabola, x, std::exp(u + x), width);
      const std::array<double, 3> power = {1.0, x, x * x};
      const double variance = std::pow(rings.flux[ring].standard_error, 2.0);
      for (std::size_t a = 0; a < 3; ++a) {
        slope[a] += kernel * (rings.flux[ring].value - expected) * power[a];
        for (std::size_t b = 0; b < 3; ++b) {
          information[a][b] += kernel * expected * power[a] * power[b];
          spread[a][b] += kernel * kernel * variance * power[a] * power[b];
        }
      }
    }
    const auto back = inverse(information);
    if (!back) return std::nullopt;
    double largest = 0.0;
    std::array<double, 3> change{};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) change[a] += (*back)[a][b] * slope[b];
      largest = std::max(largest, std::abs(change[a]) * std::pow(reach, a));
    }
    if (!std::isfinite(largest)) return std::nullopt;
    const double damping = std::min(1.0, 2.0 / std::max(largest, 1e-300));
    for (std::size_t a = 0; a < 3; ++a) parabola.of[a] += damping * change[a];
    if (largest > 1e-6) continue;
    double variance = 0.0;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) variance += (*back)[0][a] * spread[a][b] * (*back)[0][b];
    const double density = std::exp(parabola.of[0]);
    return Fit{{density, hidden_bias * density * std::sqrt(variance)}, parabola.of[1]};
  }
  return std::nullopt;
}

/// Nearest distance at which rings are worth reading: the disc within holds enough photons.
double nearest_radius(const RingFlux& rings) {
  double light = rings.nearer.value, variance = std::pow(rings.nearer.standard_error, 2.0);
  for (std::size_t ring = 0; ring < rings.flux.size(); ++ring) {
    light += rings.flux[ring].value;
    variance += std::pow(rings.flux[ring].standard_error, 2.0);
    if (light * light > fewest_photons * variance) return rings.begin_of(ring + 1);
  }
  return rings.begin_of(rings.flux.size());
}

/// The widest of the fits that agree; an infinite error if there is none.
Fit widest_fit(const RingFlux& rings, double u) {
  Fit best{{0.0, unknown}};
  double low = -unknown, high = unknown;
  for (const double reach : reaches) {
    const auto found = fit(rings, u, reach);
    if (!found) continue;
    const auto [value, noise] = found->density;
    low = std::max(low, value - agreement * noise);
    high = std::min(high, value + agreement * noise);
    if (best.density.standard_error < unknown && low > high) break;
    if (noise < best.density.standard_error) best = *found;
  }
  return best;
}

/// Nearer than the nearest fit: a power of r, no steeper than 1/r; half of what that makes of it
/// may be wrong, and some more.
Estimate nearer(const Fit& nearest, double ratio) {
  const auto [value, noise] = nearest.density;
  const double power = std::pow(ratio, std::clamp(nearest.slope, -1.0, 0.0));
  const double doubt = 0.5 * (power - 1.0) - 0.03 * std::log(ratio);
  return {value * power, power * noise + value * doubt};
}

}  // namespace

double RingFlux::begin_of(std::size_t ring) const {
  return first_radius * std::exp(log_width * static_cast<double>(ring));
}

std::vector<Estimate> density_of_rings(const RingFlux& rings, std::span<const double> r) {
  const double nearest = nearest_radius(rings), farthest = rings.begin_of(rings.flux.size());
  const Fit first = widest_fit(rings, std::log(nearest));
  std::vector<Estimate> density;
  for (const double radius : r) {
    if (radius > farthest || first.density.standard_error == unknown)
      density.push_back({0.0, unknown});
    else if (radius <= nearest)
      density.push_back(nearer(first, radius / nearest));
    else
      density.push_back(widest_fit(rings, std::log(radius)).density);
  }
  return density;
}

}  // namespace lamina
