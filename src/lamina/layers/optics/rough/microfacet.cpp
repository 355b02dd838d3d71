// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/microfacet.h"

#include <limits>

namespace lamina {
namespace {

template <class T>
constexpr T inversion_tolerance = sizeof(T) == 4 ? T(1e-6) : T(1e-12);

/// Inverse of erf on (-1, 1). Source: [Giles2012], single precision, to 4e-7 relative; in double
/// one step of Halley's method follows, to 1e-13.
template <class T>
T erf_inverse(T x) {
  T w = -std::log((T{1} - x) * (T{1} + x));
  T p;
  if (w < T{5}) {
    w -= T(2.5);
    p = T(2.81022636e-08);
    for (const double c : {3.43273939e-07, -3.5233877e-06, -4.39150654e-06, 0.00021858087,
                           -0.00125372503, -0.00417768164, 0.246640727, 1.50140941})
      p = p * w + T(c);
  } else {
    w = std::sqrt(w) - T{3};
    p = T(-0.000200214257);
    for (const double c : {0.000100950558, 0.00134934322, -0.00367342844, 0.00573950773,
                           -0.0076224613, 0.00943887047, 1.00167406, 2.83297682})
      p = p * w + T(c);
  }
  T y = p * x;
  if constexpr (sizeof(T) == 8) {
    // erf(y) - x by the complement, which keeps its digits in the tails.
    const T e = x > T{0} ? (T{1} - x) - std::erfc(y) : std::erfc(-y) - (T{1} + x);
    const T step = e * std::exp(y * y) * T{0.5} / std::numbers::inv_sqrtpi_v<T>;
    y -= step / (T{1} + y * step);
  }
  return y;
}

/// exp(z^2) erfc(z) for z >= 0.
double erfc_scaled(double z) {
  if (z < 25.0) return std::exp(z * z) * std::erfc(z);
  const double q = 0.5 / (z * z);
  return std::numbers::inv_sqrtpi / z *
         (1.0 - q * (1.0 - 3.0 * q * (1.0 - 5.0 * q * (1.0 - 7.0 * q))));
}

/// Slope x of a visible facet of a unit-roughness Beckmann surface along the view: its density is
/// proportional to (a - x) exp(-x^2) for x < a, where a >= 0 is the cotangent of the view's angle.
///
/// As a function of e = erf(x) the distribution is concave, so that Newton's and Halley's steps
/// are safe.
template <class T>
T sample_slope_from_above(T a, T u) {
  constexpr T sqrtpi = T{1} / std::numbers::inv_sqrtpi_v<T>;
  constexpr T edge = T{1} - std::numeric_limits<T>::epsilon();
  const T c = std::min(std::erf(a), edge);
  const T norm = T{1} / (sqrtpi * a * (T{1} + c) + std::exp(-a * a));
  // [Jakob2014]: the start.
  const T theta = std::atan2(T{1}, a);
  const T fit = T{1} + theta * (T(-0.876) + theta * (T(0.4265) - T(0.0594) * theta));
  T e = c - (T{1} + c) * std::pow(T{1} - u, fit);
  T low = -edge, high = c;
  T x = T{0};
  for (int round = 0; round < 40; ++round) {
    if (!(low <= e && e <= high)) e = T{0.5} * (low + high);
    x = erf_inverse(e);
    const T bell = std::exp(-x * x);
    const T error = norm * (sqrtpi * a * (T{1} + e) + bell) - u;
    if (std::abs(error) < inversion_tolerance<T>) break;
    (error > T{0} ? high : low) = e;
    const T slope = sqrtpi * (a - x);
    const T step = error / (norm * slope);
    e -= step / std::max(T{0.5},
                         T{1} + T(0.25) * std::numbers::pi_v<T> * step / (bell * slope));  // Halley
  }
  return std::min(x, a);
}

/// The same for a < 0, a view from below the mean plane. The way t = a - x > 0 from the edge has
/// the survival function S(t) = exp(2 a t - t^2) (1 + a sqrt(pi) erfcx(t - a)) up to a factor; log
/// S is concave, so that Newton's method converges from the right.
double sample_slope_from_below(double a, double u) {
  constexpr double sqrtpi = 1.0 / std::numbers::inv_sqrtpi;
  const auto bracket = [&](double t) { return 1.0 + a * sqrtpi * erfc_scaled(t - a); };
  const double survival = std::max(u, 1e-300);
  const double log_target = std::log(survival) + std::log(bracket(0.0));
  const double l = -std::log(survival);
  double t = std::min(std::sqrt(l), (l + std::sqrt(2.0 * l)) / (-2.0 * a)) + 1e-12;
  for (int step = 0; step < 60; ++step) {
    const double b = bracket(t);
    const double log_s = 2.0 * a * t - t * t + std::log(b);
    const double next = std::max(0.5 * t, t + (log_s - log_target) * b / (2.0 * t));
    const bool done = std::abs(next - t) < 1e-12 * (1.0 + t);
    t = next;
    if (done) break;
  }
  return a - t;
}

/// Slopes of a visible facet of unit roughness, turned back to a normal of roughness alpha.
template <class T>
BasicVec3<T> sample_visible_normal_beckmann(T alpha, const BasicVec3<T>& w, T u1, T u2) {
  const T sin_theta = std::sqrt(w.x * w.x + w.y * w.y);
  constexpr T edge = T{1} - std::numeric_limits<T>::epsilon();
  const T across = erf_inverse(std::clamp(T{2} * u2 - T{1}, -edge, edge));
  const T tilt = alpha * sin_theta;
  T along;
  if (w.z > T(1e4) * tilt)  // the view is from the normal: plain Gaussian slopes
    along = erf_inverse(std::clamp(T{2} * u1 - T{1}, -edge, edge));
  else if (w.z >= T{0})
    along = sample_slope_from_above(w.z / tilt, u1);
  else
    along = T(sample_slope_from_below(static_cast<double>(w.z / tilt), static_cast<double>(u1)));
  const T cos_phi = sin_theta > T{0} ? w.x / sin_theta : T{1};
  const T sin_phi = sin_theta > T{0} ? w.y / sin_theta : T{0};
  return normalize(BasicVec3<T>{-alpha * (cos_phi * along - sin_phi * across),
                                -alpha * (sin_phi * along + cos_phi * across), T{1}});
}

/// The facets of GGX are a half-ellipsoid. Stretched to a hemisphere, it mirrors the view into a
/// uniform spherical cap.
template <class T>
BasicVec3<T> sample_visible_normal_ggx(T alpha, const BasicVec3<T>& w, T u1, T u2) {
  const BasicVec3<T> view = normalize(BasicVec3<T>{alpha * w.x, alpha * w.y, w.z});
  constexpr T edge = T{32} * std::numeric_limits<T>::epsilon();  // at 0 the facet has no direction
  const T rise = std::max(T{1} - u2, edge) * (T{1} + view.z);
  const T z = rise - view.z;
  const T sin_theta = std::sqrt(std::clamp(T{1} - z * z, T{0}, T{1}));
  const T phi = T{2} * std::numbers::pi_v<T> * u1;
  return normalize(BasicVec3<T>{alpha * (sin_theta * std::cos(phi) + view.x),
                                alpha * (sin_theta * std::sin(phi) + view.y), rise});
}

/// log Gamma(1 + x) for x >= 0 by Stirling's series at x + 8, to 1e-11; std::lgamma has global
/// state.
double log_gamma_1p(double x) {
  double product = 1.0;
  for (int k = 1; k < 8; ++k) product *= x + k;
  const double y = x + 8.0, q = 1.0 / (y * y);
  const double series = (1.0 / 12 - q * (1.0 / 360 - q * (1.0 / 1260 - q / 1680))) / y;
  constexpr double half_log_2pi = 0.91893853320467274178;
  return (y - 0.5) * std::log(y) - y + half_log_2pi + series - std::log(product);
}

}  // namespace

template <class T>
T masking_shadowing_through(const Microfacets<T>& facets, const BasicVec3<T>& wi,
                            const BasicVec3<T>& wo) {
  const double li = static_cast<double>(smith_lambda(facets, wi));
  const double lo = static_cast<double>(smith_lambda(facets, -wo));
  const double sum = 1.0 + li + lo;
  if (li == 0.0 || lo == 0.0) return T(1.0 / sum);
  return T(std::exp(log_gamma_1p(li) + log_gamma_1p(lo) - log_gamma_1p(li + lo)) / sum);
}

template <class T>
BasicVec3<T> sample_visible_normal(const Microfacets<T>& facets, const BasicVec3<T>& w, T u1,
                                   T u2) {
  return facets.distribution == MicrofacetDistribution::ggx
             ? sample_visible_normal_ggx(facets.alpha, w, u1, u2)
             : sample_visible_normal_beckmann(facets.alpha, w, u1, u2);
}

template float masking_shadowing_through(const Microfacets<float>&, const Vec3f&, const Vec3f&);
template double masking_shadowing_through(const Microfacets<double>&, const Vec3&, const Vec3&);
template Vec3f sample_visible_normal(const Microfacets<float>&, const Vec3f&, float, float);
template Vec3 sample_visible_normal(const Microfacets<double>&, const Vec3&, double, double);

}  // namespace lamina
