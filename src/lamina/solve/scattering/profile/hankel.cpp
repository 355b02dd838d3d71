// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/hankel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>
#include <tuple>

#include "lamina/base/core/error.h"
#include "lamina/base/core/lazy_values.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/profile/internal/correlation_kernel.h"

namespace lamina {
namespace {

using std::numbers::pi;

// The series of k: its step is at most this. Half of its Nyquist rate, pi / 0.08 = 39 per unit of
// log k, and the width of the soft band limit there are chosen for the least error over profiles
// from a point source to a Gaussian; see tests/solve/scattering/profile/hankel_test.cpp.
constexpr double largest_k_step = 0.08;
constexpr double limit_width = 5.0;
// The kernel is below 1e-14 beyond k r = exp(5.8), and equal to k r within 1e-6 below 1e-3.
constexpr double log_last_kr = 5.8;
constexpr double first_kr = 1e-3;
// The series of k r on which the kernel is kept: both strides are whole numbers of its step.
constexpr double largest_kernel_step = 0.0125;

/// Imaginary part of log Gamma(z), continuous in z, for Re z > 0; to 1e-14.
/// Source: [AbramowitzStegun1964] 6.1.40 after ten steps of the recurrence.
double phase_of_gamma(std::complex<double> z) {
  double phase = 0.0;
  for (int i = 0; i < 10; ++i, z += 1.0) phase -= std::arg(z);
  const std::complex<double> q = 1.0 / (z * z);
  const std::complex<double> stirling =
      (z - 0.5) * std::log(z) - z +
      (1.0 / 12 - q * (1.0 / 360 - q * (1.0 / 1260 - q * (1.0 / 1680 - q / 1188.0)))) / z;
  return phase + stirling.imag();
}

/// x J0(x) at x = exp(y), y = y0 + i * step, without what oscillates faster over y than the soft
/// limit. Its Fourier transform over y is 2^(-iw) Gamma((1 - iw)/2) / Gamma((1 + iw)/2), whose
/// absolute value is 1: the transform keeps the norm, and rounding errors stay as small as they
/// come. Summed by the trapezoidal rule, whose copies of the kernel stand 2 pi / 0.1 apart in y.
std::vector<double> band_limited_kernel(double y0, double step, std::size_t size, double limit) {
  std::vector<double> kernel(size, 0.0);
  std::size_t start = 0;
  for (; start < size; ++start) {  // well below the oscillations the limit changes nothing
    const double x = std::exp(y0 + step * static_cast<double>(start)), q = 0.25 * x * x;
    if (x > 0.05) break;
    kernel[start] = x * (1.0 - q * (1.0 - q * (1.0 / 4 - q / 36)));
  }
  constexpr double dw = 0.1;
  constexpr std::size_t run = 64;  // waves are advanced by multiplication that far, then set anew
  for (int n = 0; n * dw < limit + 6.0 * limit_width; ++n) {
    const double w = n * dw;
    const double amplitude =
        (n == 0 ? 0.5 : 1.0) * dw / pi * 0.5 * std::erfc((w - limit) / limit_width);
    const double phase = -w * std::numbers::ln2 - 2.0 * phase_of_gamma({0.5, 0.5 * w});
    const double turn_re = std::cos(w * step), turn_im = std::sin(w * step);
    for (std::size_t i = start; i < size; i += run) {
      const double angle = w * (y0 + step * static_cast<double>(i)) + phase;
      double re = amplitude * std::cos(angle), im = amplitude * std::sin(angle);
      for (std::size_t j = i; j < std::min(size, i + run); ++j) {
        kernel[j] += re;
        const double next = re * turn_re - im * turn_im;
        im = re * turn_im + im * turn_re;
        re = next;
      }
    }
  }
  return kernel;
}

void check(const RadialGrid& grid) {
  const bool is_valid = grid.size >= 2 && grid.first > 0.0 && grid.last > grid.first &&
                        std::isfinite(grid.last) && std::isfinite(grid.last / grid.first);
  if (is_valid) return;
  PlainTextStream message;
  message << "radii: at least 2, with 0 < first < last [mm], are required, but there are "
          << grid.size << " from " << grid.first << " to " << grid.last;
  throw InvalidInput(message.str());
}

HankelPlan new_plan(const RadialGrid& grid) {
  HankelPlan plan;
  plan.r = radii(grid);
  const double r_step = std::log(grid.last / grid.first) / static_cast<double>(grid.size - 1);
  plan.r_stride = static_cast<std::size_t>(std::ceil(r_step / largest_kernel_step));
  const double step = r_step / static_cast<double>(plan.r_stride);
  plan.k_stride = std::max<std::size_t>(1, static_cast<std::size_t>(largest_k_step / step));
  plan.k_step = step * static_cast<double>(plan.k_stride);

  const double k_first = first_kr / grid.last;
  const double y_first = std::log(k_first * grid.first);
  const auto k_size = static_cast<std::size_t>(std::ceil((log_last_kr - y_first) / plan.k_step));
  for (std::size_t j = 0; j < k_size; ++j)
    plan.k.push_back(k_first * std::exp(plan.k_step * static_cast<double>(j)));
  const auto size = static_cast<std::size_t>((log_last_kr - y_first) / step) + plan.k_stride;
  plan.kernel = band_limited_kernel(y_first, step, size, pi / plan.k_step);
  return plan;
}

}  // namespace

std::vector<double> radii(const RadialGrid& grid) {
  check(grid);
  std::vector<double> r(grid.size);
  const double step = std::log(grid.last / grid.first) / static_cast<double>(grid.size - 1);
  for (std::size_t i = 0; i < grid.size; ++i)
    r[i] = grid.first * std::exp(step * static_cast<double>(i));
  r.back() = grid.last;
  return r;
}

HankelPlan make_hankel_plan(const RadialGrid& grid) {
  static KeptValues<std::tuple<double, double, std::size_t>, HankelPlan> kept(16);
  return kept.at({grid.first, grid.last, grid.size}, [&] { return new_plan(grid); });
}

std::vector<double> inverse_hankel(const HankelPlan& plan, std::span<const double> spectra,
                                   std::size_t channels) {
  const std::size_t k_size = plan.k.size();
  assert(spectra.size() == k_size * channels);
  std::vector<double> weighted(spectra.begin(), spectra.end());
  for (std::size_t j = 0; j < k_size; ++j) {
    // Below the first k the spectrum is constant and the kernel is k r: a geometric series.
    const double below = j == 0 ? 1.0 / -std::expm1(-2.0 * plan.k_step) : 1.0;
    const double weight = plan.k[j] * plan.k_step * below / (2.0 * pi);
    for (std::size_t c = 0; c < channels; ++c) weighted[j * channels + c] *= weight;
  }
  std::vector<double> profiles = detail::correlate(plan.kernel, plan.r_stride, plan.k_stride,
                                                   weighted, channels, plan.r.size());
  for (std::size_t i = 0; i < plan.r.size(); ++i)
    for (std::size_t c = 0; c < channels; ++c) profiles[i * channels + c] /= plan.r[i];
  return profiles;
}

}  // namespace lamina
