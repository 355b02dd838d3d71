// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"

namespace lamina {
namespace {

/// One band of one table of a profile, as a function of radius.
struct RadialTable {
  std::span<const double> r;
  std::span<const double> values;  ///< [r, band]
  std::size_t bands, band;

  double operator[](std::size_t i) const { return values[i * bands + band]; }
  /// d log(value) / d log(r) between radii i and i + 1, both values > 0.
  double secant(std::size_t i) const {
    return std::log((*this)[i + 1] / (*this)[i]) / std::log(r[i + 1] / r[i]);
  }
};

RadialTable reflectance_table(const Profile& profile, std::size_t band) {
  return {profile.r, profile.reflectance_profile, profile.bands, band};
}

RadialTable transmittance_table(const Profile& profile, std::size_t band) {
  return {profile.r, profile.transmittance_profile, profile.bands, band};
}

/// Power of r nearer than the first radius: 0 for a flat top, -1 for a single-scattering peak.
double first_power(const RadialTable& table) {
  const bool is_positive = table.r.size() > 1 && table[0] > 0.0 && table[1] > 0.0;
  return is_positive ? std::clamp(table.secant(0), -1.0, 0.0) : 0.0;
}

double last_power(const RadialTable& table) {
  const std::size_t n = table.r.size();
  const bool is_positive = n > 1 && table[n - 2] > 0.0 && table[n - 1] > 0.0;
  return is_positive ? std::min(table.secant(n - 2), -3.0) : -3.0;
}

/// Slope at radius i of the monotone cubic: the harmonic mean of the secants beside it, weighted
/// for unequal steps; `secant` is that of the interval in question, for the ends.
double slope(const RadialTable& table, std::size_t i, double secant) {
  if (i == 0 || i + 1 == table.r.size()) return secant;
  if (!(table[i - 1] > 0.0 && table[i] > 0.0 && table[i + 1] > 0.0)) return secant;
  const double before = table.secant(i - 1), after = table.secant(i);
  if (before * after <= 0.0) return 0.0;
  const double h0 = std::log(table.r[i] / table.r[i - 1]);
  const double h1 = std::log(table.r[i + 1] / table.r[i]);
  const double w0 = h0 + 2.0 * h1, w1 = 2.0 * h0 + h1;
  return (w0 + w1) / (w0 / before + w1 / after);
}

double interpolate(const RadialTable& table, std::size_t i, double r) {
  const double a = table[i], b = table[i + 1];
  const double t = std::log(r / table.r[i]) / std::log(table.r[i + 1] / table.r[i]);
  if (!(a > 0.0 && b > 0.0)) return a + t * (b - a);
  const double h = std::log(table.r[i + 1] / table.r[i]);
  const double secant = table.secant(i);
  const double from = slope(table, i, secant), to = slope(table, i + 1, secant);
  const double u = 1.0 - t;
  return a * std::exp(h * t * (secant * t * (3.0 - 2.0 * t) + u * (from * u - to * t)));
}

double evaluate(const RadialTable& table, double r) {
  assert(r > 0.0 && !table.r.empty());
  const std::size_t n = table.r.size();
  if (r <= table.r[0]) return table[0] * std::pow(r / table.r[0], first_power(table));
  if (r >= table.r[n - 1]) return table[n - 1] * std::pow(r / table.r[n - 1], last_power(table));
  const auto above = std::upper_bound(table.r.begin(), table.r.end(), r);
  return interpolate(table, static_cast<std::size_t>(above - table.r.begin()) - 1, r);
}

FluxCurve flux_curve(const RadialTable& table) {
  constexpr double two_pi = 2.0 * std::numbers::pi;
  static const Quadrature rule = gauss_legendre(4, 0.0, 1.0);
  const std::size_t n = table.r.size();
  FluxCurve curve;
  double flux = two_pi * table.r[0] * table.r[0] * table[0] / (2.0 + first_power(table));
  curve.within.push_back(flux);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double h = std::log(table.r[i + 1] / table.r[i]);
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {  // in log r
      const double r = table.r[i] * std::exp(h * rule.nodes[q]);
      flux += two_pi * h * rule.weights[q] * r * r * interpolate(table, i, r);
    }
    curve.within.push_back(flux);
  }
  const double last = table.r[n - 1];
  curve.beyond = two_pi * last * last * table[n - 1] / (-2.0 - last_power(table));
  return curve;
}

Profile scaled(Profile profile, ProfilePer per, std::span<const double> factors, bool divide) {
  assert(factors.size() == profile.bands);
  if (profile.per == per) return profile;
  profile.per = per;
  for (auto* table : {&profile.reflectance_profile, &profile.transmittance_profile,
                      &profile.total_reflectance, &profile.total_transmittance})
    for (std::size_t i = 0; i < table->size(); ++i) {
      const double factor = factors[i % profile.bands];
      (*table)[i] = divide ? (*table)[i] / factor : (*table)[i] * factor;
    }
  return profile;
}

}  // namespace

double reflectance_profile(const Profile& profile, double r, std::size_t band) {
  return evaluate(reflectance_table(profile, band), r);
}

double transmittance_profile(const Profile& profile, double r, std::size_t band) {
  return evaluate(transmittance_table(profile, band), r);
}

FluxCurve reflected_flux(const Profile& profile, std::size_t band) {
  return flux_curve(reflectance_table(profile, band));
}

FluxCurve transmitted_flux(const Profile& profile, std::size_t band) {
  return flux_curve(transmittance_table(profile, band));
}

Profile per_arriving_flux(Profile profile, std::span<const double> entry_transmittance) {
  return scaled(std::move(profile), ProfilePer::arriving_flux, entry_transmittance, false);
}

Profile per_entered_flux(Profile profile, std::span<const double> entry_transmittance) {
  return scaled(std::move(profile), ProfilePer::entered_flux, entry_transmittance, true);
}

}  // namespace lamina
