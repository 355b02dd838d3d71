// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/albedo_inversion.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/diffusion/dipole.h"

namespace lamina {
namespace {

/// A medium of sigma_t_prime = 1 / mm.
Medium unit_medium(double albedo_prime, double ior) {
  return {.sigma_a = 1.0 - albedo_prime, .sigma_s = albedo_prime, .g = 0.0, .ior = ior};
}

/// The frequency at which a falling spectrum is half of what it is at 0.
template <class Spectrum>
double half_frequency(const Spectrum& spectrum) {
  const double at_0 = spectrum(0.0);
  return std::exp(falling_root([&](double log_k) { return spectrum(std::exp(log_k)) / at_0 - 0.5; },
                               std::log(1e-12), std::log(1e12), 1e-14)
                      .place);
}

void require(bool holds, const char* rule, double given) {
  if (holds) return;
  PlainTextStream message;
  message << rule << ", but is " << given;
  throw InvalidInput(message.str());
}

}  // namespace

AlbedoInversion invert_dipole_albedo(double reflectance, double ior_inside, double ior_outside,
                                     const DiffusionOptions& options) {
  // A depends on the indices alone, so that it is found once.
  Dipole dipole = make_dipole(unit_medium(1.0, ior_inside), ior_outside, options);
  const auto total = [&](double albedo_prime) {
    dipole.albedo_prime = albedo_prime;
    dipole.sigma_tr = std::sqrt(3.0 * (1.0 - albedo_prime));
    return total_reflectance(dipole);
  };
  return invert_albedo(total, reflectance);
}

Medium medium_from_look(const DiffuseLook& look, double g, double ior, double ior_outside,
                        const DiffusionOptions& options) {
  require(0.0 <= look.reflectance && look.reflectance < 1.0, "reflectance must lie in [0, 1)",
          look.reflectance);
  require(look.diffuse_mfp > 0.0 && std::isfinite(look.diffuse_mfp), "diffuse_mfp must be > 0 [mm]",
          look.diffuse_mfp);
  const double alpha =
      invert_dipole_albedo(look.reflectance, ior, ior_outside, options).albedo_prime;
  const double sigma_t_prime = 1.0 / (look.diffuse_mfp * std::sqrt(3.0 * (1.0 - alpha)));
  require(std::isfinite(sigma_t_prime), "reflectance must lie farther below 1", look.reflectance);
  return {.sigma_a = (1.0 - alpha) * sigma_t_prime,
          .sigma_s = alpha * sigma_t_prime / (1.0 - g),
          .g = g,
          .ior = ior};
}

Medium equivalent_half_space(const LayerStack& stack, const DiffusionOptions& options) {
  const LayeredDiffusion model = make_layered_diffusion(stack, options);
  const auto spectrum = [&](double k) { return response(model, k).reflection_above; };
  const double ior = stack.layers()[0].medium.ior;
  const double alpha =
      invert_dipole_albedo(spectrum(0.0), ior, stack.ior_above(), options).albedo_prime;
  const Dipole unit =
      make_dipole(unit_medium(std::max(alpha, 1e-12), ior), stack.ior_above(), options);
  const double scale = half_frequency(spectrum) /
                       half_frequency([&](double k) { return reflectance_at_frequency(unit, k); });
  return {.sigma_a = (1.0 - alpha) * scale, .sigma_s = alpha * scale, .g = 0.0, .ior = ior};
}

}  // namespace lamina
