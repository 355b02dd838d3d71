// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/profile/radial_sampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/core/error.h"

namespace lamina {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Flux between radii a < b of the density h (r / a)^p: 2 pi h a^2 ((b/a)^(p+2) - 1) / (p + 2).
double ring_flux(double h, double a, double b, double p) {
  const double log_ratio = std::log(b / a), x = (p + 2.0) * log_ratio;
  return two_pi * h * a * a * log_ratio * (std::abs(x) < 1e-12 ? 1.0 : std::expm1(x) / x);
}

/// Part of each band's flux per area at radius i, summed over the chosen sides; then the largest.
double envelope(const Profile& profile, ProfileSide side, std::size_t i) {
  double largest = 0.0;
  for (std::size_t b = 0; b < profile.bands; ++b) {
    double value = 0.0, total = 0.0;
    if (side != ProfileSide::transmittance) {
      value += profile.reflectance_at(i, b);
      total += profile.total_reflectance[b];
    }
    if (side != ProfileSide::reflectance) {
      value += profile.transmittance_at(i, b);
      total += profile.total_transmittance[b];
    }
    if (total > 0.0) largest = std::max(largest, value / total);
  }
  return largest;
}

/// The piece that holds r: 0 before the first radius, r.size() beyond the last.
std::size_t piece_at(const RadialSampler& s, double r) {
  return static_cast<std::size_t>(std::upper_bound(s.r.begin(), s.r.end(), r) - s.r.begin());
}

/// The radius from which the power law of a piece is counted.
double start_of(const RadialSampler& s, std::size_t piece) {
  return s.r[piece == 0 ? 0 : piece - 1];
}

}  // namespace

RadialSampler make_radial_sampler(const Profile& profile, ProfileSide side) {
  const std::size_t n = profile.r.size();
  assert(n >= 2);
  RadialSampler s{.r = profile.r, .height = {}, .power = {}, .flux_within = {}};
  std::vector<double> value(n);
  for (std::size_t i = 0; i < n; ++i) value[i] = envelope(profile, side, i);
  const auto secant = [&](std::size_t i) {  // power of r between radii i and i + 1
    return value[i] > 0.0 && value[i + 1] > 0.0
               ? std::log(value[i + 1] / value[i]) / std::log(s.r[i + 1] / s.r[i])
               : 0.0;
  };
  s.height.push_back(value[0]);
  s.power.push_back(std::clamp(secant(0), -1.0, 0.0));
  double flux = two_pi * s.r[0] * s.r[0] * value[0] / (s.power[0] + 2.0);
  s.flux_within.push_back(flux);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const bool is_positive = value[i] > 0.0 && value[i + 1] > 0.0;
    s.height.push_back(is_positive ? value[i] : 0.5 * (value[i] + value[i + 1]));
    s.power.push_back(secant(i));
    flux += ring_flux(s.height.back(), s.r[i], s.r[i + 1], s.power.back());
    s.flux_within.push_back(flux);
  }
  s.height.push_back(value[n - 1]);
  s.power.push_back(value[n - 1] > 0.0 ? std::min(secant(n - 2), -3.0) : -3.0);
  flux += two_pi * s.r[n - 1] * s.r[n - 1] * value[n - 1] / (-2.0 - s.power.back());
  if (!(flux > 0.0))
    throw InvalidInput("profile: some flux is required to draw radii from, but there is none");
  for (double& h : s.height) h /= flux;
  for (double& part : s.flux_within) part /= flux;
  s.weight_bound = flux;
  return s;
}

double sample_radius(const RadialSampler& s, double u) {
  assert(0.0 <= u && u < 1.0);
  const std::size_t n = s.r.size();
  const auto piece = static_cast<std::size_t>(
      std::upper_bound(s.flux_within.begin(), s.flux_within.end(), u) - s.flux_within.begin());
  const double p = s.power[piece];
  if (piece == 0) return s.r[0] * std::pow(std::max(u, 1e-300) / s.flux_within[0], 1.0 / (p + 2.0));
  if (piece == n)
    return s.r[n - 1] * std::pow((1.0 - u) / (1.0 - s.flux_within[n - 1]), 1.0 / (p + 2.0));
  const double a = s.r[piece - 1], b = s.r[piece];
  const double t =
      (u - s.flux_within[piece - 1]) / (s.flux_within[piece] - s.flux_within[piece - 1]);
  const double x = (p + 2.0) * std::log(b / a);
  const double log_ratio =
      std::abs(x) < 1e-12 ? t * std::log(b / a) : std::log1p(t * std::expm1(x)) / (p + 2.0);
  return std::clamp(a * std::exp(log_ratio), a, b);
}

double pdf_radius(const RadialSampler& s, double r) {
  assert(r > 0.0);
  const std::size_t piece = piece_at(s, r);
  return two_pi * r * s.height[piece] * std::pow(r / start_of(s, piece), s.power[piece]);
}

double fraction_within(const RadialSampler& s, double r) {
  const std::size_t n = s.r.size(), piece = piece_at(s, r);
  const double p = s.power[piece];
  if (piece == 0) return s.flux_within[0] * std::pow(r / s.r[0], p + 2.0);
  if (piece == n) return 1.0 - (1.0 - s.flux_within[n - 1]) * std::pow(r / s.r[n - 1], p + 2.0);
  return s.flux_within[piece - 1] + ring_flux(s.height[piece], s.r[piece - 1], r, p);
}

}  // namespace lamina
