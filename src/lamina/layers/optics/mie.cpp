// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/mie.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"

namespace lamina {
namespace {

using Complex = std::complex<double>;

/// The coefficients a_n, b_n of the scattered wave, n = 1 ... at index n - 1.
struct MieSeries {
  std::vector<Complex> a, b;
};

/// Terms take time and memory.
void check_length(double x, Complex m) {
  if (!(x <= 1e5))
    throw InvalidInput("a sphere must have a size parameter of at most 1e5, but has " +
                       number_text(x));
  if (!(std::abs(m) <= 100.0))
    throw InvalidInput("a sphere must have a relative index of at most 100, but has " +
                       number_text(std::abs(m)));
}

MieSeries mie_series(double x, Complex m) {
  check_length(x, m);
  assert(0.0 < x && m.real() > 0.0 && m.imag() >= 0.0);
  const auto terms = static_cast<std::size_t>(x + 4.05 * std::cbrt(x) + 8.0);
  const Complex mx = m * x;
  // The logarithmic derivative D_n(mx) is stable downward only. From any value at n = z + d, z =
  // |mx|, it comes true by n = z within exp(-4/3 sqrt(2/z) d^1.5): 1e-16 for d = 7.1 z^(1/3).
  const double z = std::abs(mx);
  const auto start =
      static_cast<std::size_t>(std::max(static_cast<double>(terms), z) + 7.5 * std::cbrt(z) + 16.0);
  std::vector<Complex> log_derivative(start + 1);
  for (std::size_t n = start; n > 0; --n) {
    const Complex ratio = static_cast<double>(n) / mx;
    log_derivative[n - 1] = ratio - 1.0 / (log_derivative[n] + ratio);
  }
  // Riccati-Bessel functions psi_n(x) and xi_n(x) = psi_n - i chi_n. Upward, psi loses its digits
  // beyond n = x, where it no longer matters in double precision with Wiscombe's number of terms.
  MieSeries series{std::vector<Complex>(terms), std::vector<Complex>(terms)};
  double psi_before = std::cos(x), psi = std::sin(x);
  double chi_before = -std::sin(x), chi = std::cos(x);
  for (std::size_t n = 1; n <= terms; ++n) {
    const double factor = (2.0 * static_cast<double>(n) - 1.0) / x;
    const double psi_next = factor * psi - psi_before, chi_next = factor * chi - chi_before;
    psi_before = psi;
    psi = psi_next;
    chi_before = chi;
    chi = chi_next;
    const Complex xi(psi, -chi), xi_before(psi_before, -chi_before);
    const double n_over_x = static_cast<double>(n) / x;
    const Complex da = log_derivative[n] / m + n_over_x, db = m * log_derivative[n] + n_over_x;
    series.a[n - 1] = (da * psi - psi_before) / (da * xi - xi_before);
    series.b[n - 1] = (db * psi - psi_before) / (db * xi - xi_before);
  }
  return series;
}

}  // namespace

MieSphere mie_sphere(double size_parameter, Complex relative_ior) {
  const auto [a, b] = mie_series(size_parameter, relative_ior);
  double extinction = 0.0, scattering = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    extinction += (2.0 * n + 1.0) * (a[i] + b[i]).real();
    scattering += (2.0 * n + 1.0) * (std::norm(a[i]) + std::norm(b[i]));
    cosine += (2.0 * n + 1.0) / (n * (n + 1.0)) * (a[i] * std::conj(b[i])).real();
    if (i + 1 < a.size())
      cosine += n * (n + 2.0) / (n + 1.0) *
                (a[i] * std::conj(a[i + 1]) + b[i] * std::conj(b[i + 1])).real();
  }
  const double scale = 2.0 / (size_parameter * size_parameter);
  return {.extinction = scale * extinction,
          .scattering = scale * scattering,
          .g = scattering > 0.0 ? 2.0 * cosine / scattering : 0.0};
}

std::vector<double> mie_phase(double size_parameter, Complex relative_ior,
                              std::span<const double> cos_theta) {
  const auto [a, b] = mie_series(size_parameter, relative_ior);
  double scattering = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    scattering += (2.0 * static_cast<double>(i) + 3.0) * (std::norm(a[i]) + std::norm(b[i]));
  std::vector<double> phase(cos_theta.size());
  const auto phase_at = [&](double mu) {
    assert(-1.0 <= mu && mu <= 1.0);
    Complex s1 = 0.0, s2 = 0.0;
    double pi_before = 0.0, pi = 1.0;  // angular functions pi_n and tau_n
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double n = static_cast<double>(i + 1);
      const double tau = n * mu * pi - (n + 1.0) * pi_before;
      const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
      s1 += weight * (a[i] * pi + b[i] * tau);
      s2 += weight * (a[i] * tau + b[i] * pi);
      const double pi_next = ((2.0 * n + 1.0) * mu * pi - (n + 1.0) * pi_before) / n;
      pi_before = pi;
      pi = pi_next;
    }
    // |S|² / (2 x²) over the scattering cross section in the same units.
    return (std::norm(s1) + std::norm(s2)) / (4.0 * std::numbers::pi * scattering);
  };
  constexpr std::size_t at_once = 64;
  parallel_for((phase.size() + at_once - 1) / at_once, [&](std::size_t part) {
    const std::size_t end = std::min(phase.size(), (part + 1) * at_once);
    for (std::size_t i = part * at_once; i < end; ++i) phase[i] = phase_at(cos_theta[i]);
  });
  return phase;
}

MieBulk mie_bulk(const Particles& particles, double ior_medium, double wavelength) {
  assert(particles.median_radius > 0.0 && particles.sigma_log_radius >= 0.0);
  constexpr double mm_per_nm = 1e-6;
  const double wave_number = 2.0 * std::numbers::pi * ior_medium / (wavelength * mm_per_nm);
  const Complex relative_ior = particles.ior / ior_medium;
  // Means over the spread of radii. By volume a log-normal keeps its form, its median moved by
  // 3 sigma², so the nodes stand where the volume is.
  const double sigma = particles.sigma_log_radius;
  const double center = std::log(particles.median_radius) + 2.5 * sigma * sigma;
  const Quadrature rule = sigma > 0.0 ? gauss_legendre(200, -6.0, 6.0) : Quadrature{{0.0}, {1.0}};
  const double largest = std::exp(center + sigma * rule.nodes.back());
  check_length(wave_number * largest, relative_ior);  // before hours pass on smaller ones
  double volume = 0.0, absorbing = 0.0, scattering = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double log_radius = center + sigma * rule.nodes[i];
    const double radius = std::exp(log_radius);
    const double t = sigma > 0.0 ? (log_radius - std::log(particles.median_radius)) / sigma : 0.0;
    const double number = rule.weights[i] * std::exp(-0.5 * t * t);
    const double area = number * std::numbers::pi * radius * radius;
    const MieSphere sphere = mie_sphere(wave_number * radius, relative_ior);
    volume += number * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    absorbing += area * std::max(0.0, sphere.extinction - sphere.scattering);
    scattering += area * sphere.scattering;
    cosine += area * sphere.scattering * sphere.g;
  }
  const double number_density = particles.volume_fraction / volume;
  return {.sigma_a = particles.ior.imag() > 0.0 ? number_density * absorbing : 0.0,
          .sigma_s = number_density * scattering,
          .g = scattering > 0.0 ? cosine / scattering : 0.0};
}

}  // namespace lamina
