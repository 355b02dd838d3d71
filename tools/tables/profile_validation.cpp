// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints docs/validation.md's tables of profiles: radiative transfer, layered diffusion and dipole
// against rings of photon Monte Carlo, per range of radii, and the CPU seconds of each.
//
//   profile_validation [PHOTONS [NAME]] > tables.md      NAME: only stacks whose name holds it
//
// Compared is the flux in rings 0.02 mm wide, wherever Monte Carlo knows it to better than 20 %.
// Deviations are of the model from Monte Carlo, relative to Monte Carlo. "chi2/n" adds 0.5 %, the
// accuracy that is asked, to Monte Carlo's standard error in quadrature. The mean weighs each ring
// by the inverse square of that sum. "estimate" is the error of R that the profile itself states,
// root mean square; bold is a chi2/n above 1.6, or a mean beyond 0.3 % and beyond 2.5 of its
// standard errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/dipole_profile.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace {

using namespace lamina;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double ring_width = 0.02;  // [mm]
constexpr int rings = 300;
constexpr double accuracy = 0.005;
constexpr std::array<int, 6> range_ends = {0, 1, 5, 25, 100, 300};  // in rings
constexpr RadialGrid grid = {.first = 1e-4, .last = 1e2, .size = 400};

struct Case {
  std::string name;
  LayerStack stack;
};

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

/// [DonnerJensen2005] Table 3.
LayerStack skin(const double (&sigma_a)[3], const double (&sigma_s)[3]) {
  return LayerStack({layer(sigma_a[0], sigma_s[0], 0.0, 1.4, 0.03),
                     layer(sigma_a[1], sigma_s[1], 0.25, 1.34, 0.05),
                     layer(sigma_a[2], sigma_s[2], 0.8, 1.4, infinite)});
}

std::vector<Case> cases() {
  return {{"skin, red", skin({2.1, 0.16, 0.085}, {48, 32, 4.5})},
          {"skin, green", skin({2.1, 0.19, 1.0}, {60, 40, 4.7})},
          {"skin, blue", skin({5.0, 0.3, 25.0}, {65, 46, 4.8})},
          {"white paint", LayerStack({layer(0.01, 100.0, 0.8, 1.5, 1.0)})},
          {"half-space, n 1.5", LayerStack({layer(1.0, 9.0, 0.0, 1.5, infinite)})},
          {"van de Hulst slab", LayerStack({layer(1.0, 9.0, 0.75, 1.0, 0.2)})},
          {"thin slab", LayerStack({layer(0.5, 4.5, 0.0, 1.5, 0.04)})},
          {"four layers, g .9",
           LayerStack({layer(2.0, 50.0, 0.9, 1.4, 0.05), layer(0.2, 30.0, 0.9, 1.34, 0.1),
                       layer(1.0, 20.0, 0.9, 1.45, 0.2), layer(0.1, 25.0, 0.9, 1.4, infinite)})},
          {"thin slab, n 1", LayerStack({layer(0.5, 4.5, 0.0, 1.0, 0.04)})},
          {"slab, g .95", LayerStack({layer(0.1, 20.0, 0.95, 1.4, 0.5)})}};
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Flux in every ring, with standard errors.
using Rings = std::vector<Estimate>;

double ring_area(int i) { return std::numbers::pi * ring_width * ring_width * (2.0 * i + 1.0); }

/// Takes unscattered light, which all leaves on the axis and is in no profile, out of the first
/// ring. A photon counts in one ring once, so that the sums of squares subtract as the sums do.
void take_out_unscattered(Estimate& ring, const Estimate& unscattered, double photons) {
  const auto second_moment = [&](const Estimate& e) {
    return e.standard_error * e.standard_error * photons + e.value * e.value;
  };
  const double second = second_moment(ring) - second_moment(unscattered);
  ring.value -= unscattered.value;
  ring.standard_error = std::sqrt(std::max(0.0, second - ring.value * ring.value) / photons);
}

Rings photon_rings(const MonteCarloResult& result, bool is_reflectance) {
  const auto& densities = is_reflectance ? result.radial.reflection : result.radial.transmission;
  Rings flux;
  for (int i = 0; i < rings; ++i) {
    const Estimate& density = densities[static_cast<std::size_t>(i)];
    flux.push_back({density.value * ring_area(i), density.standard_error * ring_area(i)});
  }
  take_out_unscattered(
      flux[0], is_reflectance ? result.unscattered_reflectance : result.unscattered_transmittance,
      static_cast<double>(result.photons));
  return flux;
}

/// Integral of 2 pi r times the profile over each ring.
std::vector<double> profile_rings(const Profile& profile, bool is_reflectance) {
  static const Quadrature rule = gauss_legendre(6, 0.0, 1.0);
  const auto panel = [&](double from, double to) {  // in log r
    const double h = std::log(to / from);
    double sum = 0.0;
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
      const double r = from * std::exp(h * rule.nodes[q]);
      const double density = is_reflectance ? reflectance_profile(profile, r, 0)
                                            : transmittance_profile(profile, r, 0);
      sum += rule.weights[q] * h * 2.0 * std::numbers::pi * r * r * density;
    }
    return sum;
  };
  std::vector<double> flux(rings, 0.0);
  // The first ring: the profile rises no faster than 1/r, so that beyond 30 octaves nothing is
  // left.
  double r = ring_width;
  for (int octave = 0; octave < 30; ++octave, r *= 0.5) flux[0] += panel(0.5 * r, r);
  for (int i = 1; i < rings; ++i)
    flux[static_cast<std::size_t>(i)] = panel(i * ring_width, (i + 1) * ring_width);
  return flux;
}

/// The error that the profile estimates for each ring of R, at its middle.
std::vector<double> estimated_errors(const TransferProfile& transfer) {
  std::vector<double> errors;
  for (int i = 0; i < rings; ++i) {
    const double r = (i + 0.5) * ring_width;
    const auto above = std::ranges::upper_bound(transfer.profile.r, r);
    errors.push_back(
        transfer.relative_error[static_cast<std::size_t>(above - transfer.profile.r.begin())]);
  }
  return errors;
}

struct Deviation {
  double chi_square = 0.0;  ///< per ring
  double rms = 0.0;
  Estimate mean;
};

bool is_resolved(const Estimate& ring) { return ring.standard_error < 0.2 * ring.value; }

Deviation compare(const std::vector<double>& model, const Rings& photons, int begin, int end) {
  Deviation d;
  double n = 0.0, weights = 0.0, variance = 0.0;
  for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
    if (!is_resolved(photons[i])) continue;
    const double deviation = model[i] / photons[i].value - 1.0;
    const double error = photons[i].standard_error / photons[i].value;
    const double weight = 1.0 / (error * error + accuracy * accuracy);
    n += 1.0;
    d.chi_square += deviation * deviation * weight;
    d.rms += deviation * deviation;
    weights += weight;
    d.mean.value += weight * deviation;
    variance += weight * weight * error * error;
  }
  d.chi_square /= n;
  d.rms = std::sqrt(d.rms / n);
  d.mean = {d.mean.value / weights, std::sqrt(variance) / weights};
  return d;
}

std::string bold_if(bool is_bold, const std::string& text) {
  return is_bold ? "**" + text + "**" : text;
}

std::string format(const char* pattern, auto... values) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

struct Models {
  std::vector<double> transfer, multipole, dipole;
  std::vector<double> estimate;  ///< of `transfer`
};

void print_rows(const std::string& name, const Rings& photons, const Models& models) {
  for (std::size_t range = 0; range + 1 < range_ends.size(); ++range) {
    const int begin = range_ends[range], end = range_ends[range + 1];
    double n = 0.0, square = 0.0, estimate = 0.0;
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      if (!is_resolved(photons[i])) continue;
      const double error = photons[i].standard_error / photons[i].value;
      square += error * error;
      estimate += models.estimate[i] * models.estimate[i];
      n += 1.0;
    }
    if (n == 0.0) continue;
    const Deviation transfer = compare(models.transfer, photons, begin, end);
    const double mean = std::abs(transfer.mean.value);
    std::printf("| %s | %g–%g | %g | %.2f %% | %s | %.2f %% | %.2f %% | %s |", name.c_str(),
                begin * ring_width, end * ring_width, n, 100.0 * std::sqrt(square / n),
                bold_if(transfer.chi_square > 1.6, format("%.2f", transfer.chi_square)).c_str(),
                100.0 * transfer.rms, 100.0 * std::sqrt(estimate / n),
                bold_if(mean > 0.003 && mean > 2.5 * transfer.mean.standard_error,
                        format("%+.2f ± %.2f %%", 100.0 * transfer.mean.value,
                               100.0 * transfer.mean.standard_error))
                    .c_str());
    for (const auto* flux : {&models.multipole, &models.dipole}) {
      const Deviation other = compare(*flux, photons, begin, end);
      std::printf(" %.0f, %+.0f %% |", 100.0 * other.rms, 100.0 * other.mean.value);
    }
    std::puts("");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t photons =
      argc > 1 ? static_cast<std::uint64_t>(std::strtod(argv[1], nullptr)) : 20'000'000;
  const std::string only = argc > 2 ? argv[2] : "";
  std::printf(
      "%.3g photons per stack; radiative transfer at %g %%. Deviations from Monte Carlo: root mean "
      "square, mean.\n\n",
      static_cast<double>(photons), 100.0 * accuracy);
  std::puts(
      "| stack | r [mm] | rings | Monte Carlo's error | radiative transfer: χ²/n | rms | estimate "
      "| mean | "
      "diffusion | dipole |\n|---|---|---|---|---|---|---|---|---|---|");
  std::string times;
  std::uint64_t seed = 0;  // each stack has its own, so that their errors are independent
  for (const auto& [name, stack] : cases()) {
    if (name.find(only) == std::string::npos) continue;
    const std::vector<LayerStack> bands = {stack};
    const std::vector<double> entered = {entry_transmittance(stack, {})};
    std::array<double, 4> seconds{};
    ++seed;
    const auto timed = [&](std::size_t which, const auto& solve) {
      const double start = cpu_seconds();
      auto result = solve();
      seconds[which] = cpu_seconds() - start;
      return result;
    };
    // One ring more takes the light beyond.
    const MonteCarloResult counted = timed(0, [&] {
      return trace_photons(
          stack, {.photons = photons, .seed = seed, .tallies = {.r = {rings + 1, ring_width}}});
    });
    const TransferProfile transfer =
        timed(1, [&] { return transfer_profile(bands, grid, {.accuracy = accuracy}); });
    const Profile multipole = timed(2, [&] {
      return per_arriving_flux(make_diffusion_profile(bands, {}, grid).profile, entered);
    });
    const Profile dipole =
        timed(3, [&] { return per_arriving_flux(make_dipole_profile(bands, {}, grid), entered); });
    for (const bool is_reflectance : {true, false}) {
      if (!is_reflectance && is_semi_infinite(stack)) continue;
      print_rows(name + (is_reflectance ? ", R" : ", T"), photon_rings(counted, is_reflectance),
                 {.transfer = profile_rings(transfer.profile, is_reflectance),
                  .multipole = profile_rings(multipole, is_reflectance),
                  .dipole = profile_rings(dipole, is_reflectance),
                  .estimate = estimated_errors(transfer)});
    }
    times += format("| %s | %.1f s |", name.c_str(), seconds[0]);
    times += format(" %.2f s | %.2f %% |", seconds[1], 100.0 * transfer.estimated_error[0]);
    times += format(" %.1f ms | %.2f ms |\n", 1e3 * seconds[2], 1e3 * seconds[3]);
  }
  std::printf(
      "\n| stack, one band, CPU time | Monte Carlo | radiative transfer | its estimated error | "
      "diffusion | "
      "dipole |\n|---|---|---|---|---|---|\n%s",
      times.c_str());
}
