// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>

#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"

namespace lamina::detail {
namespace {

using Complex = std::complex<double>;

/// Without the care for infinities that makes std::complex slow.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
Complex inverse(Complex a) { return std::conj(a) / std::norm(a); }
Complex polar_exp(Complex a) { return std::polar(std::exp(a.real()), a.imag()); }

/// Integral of exp(-a z) over [0, d]; d may be infinite.
Complex decay_integral(Complex a, double d) {
  if (!std::isfinite(d)) return inverse(a);
  const Complex x = a * d;
  if (std::abs(x) < 1e-3) return d * (1.0 - times(x, 1.0 - times(x, 1.0 - x / 4.0) / 3.0) / 2.0);
  return times(1.0 - polar_exp(-x), inverse(a));
}

/// Light of one direction and one azimuthal wave in a layer.
struct Course {
  Complex across = 0.0;        ///< what gets through the layer unscattered
  Complex emitted_up = 0.0;    ///< light scattered once, at the layer's top
  Complex emitted_down = 0.0;  ///< and at its bottom
};

/// What leaves of the light emitted in all layers, with all its reflections.
///
/// By reciprocity the fractions that leave are the unscattered light inside, going the other way,
/// for unit flux that enters where the light leaves.
///
/// @param r         [interface] reflectance for the direction, from the side where it leaves.
/// @param is_above  where it leaves.
Complex leaving(const std::vector<double>& r, const std::vector<Course>& course, bool is_above,
                std::vector<Complex>& work) {
  const std::size_t layers = course.size();
  const auto layer_at = [&](std::size_t l) -> const Course& {
    return course[is_above ? l : layers - 1 - l];
  };
  // Up to the outside: what each interface lets through, and the reflection behind each layer.
  work.resize(2 * layers + 1);
  Complex* const pass = work.data();
  Complex* const behind = pass + layers + 1;
  Complex reflection = 0.0;
  for (std::size_t l = layers + 1; l-- > 0;) {
    const double face = r[is_above ? l : layers - l];
    pass[l] = face < 1.0 ? (1.0 - face) * inverse(1.0 - face * reflection) : 0.0;
    reflection = face + (1.0 - face) * times(reflection, pass[l]);
    if (l == 0) break;
    behind[l - 1] = reflection;
    const Complex across = layer_at(l - 1).across;
    reflection = times(times(across, reflection), across);
  }
  Complex flux = 1.0, sum = 0.0;
  for (std::size_t l = 0; l < layers; ++l) {
    const Course& at = layer_at(l);
    flux = times(flux, pass[l]);
    sum += times(flux, is_above ? at.emitted_up : at.emitted_down);
    flux = times(flux, at.across);
    sum += times(times(flux, behind[l]), is_above ? at.emitted_down : at.emitted_up);
  }
  return sum;
}

}  // namespace

FrequencyResponse single_scattering_response(const FrequencySolver& solver, double k) {
  const GridStack& stack = solver.stack;
  const std::size_t beam = stack.grid.extra[0], layers = stack.layers.size();
  const UnscatteredFlux flux = unscattered_flux(stack, beam, Unscattered::on_grid);
  const bool has_below = !stack.is_semi_infinite && stack.ground_reflectance == 0.0;
  FrequencyResponse result;
  std::vector<double> r(layers + 1);
  std::vector<Course> course(layers);
  std::vector<Complex> work;
  for (std::size_t i = 0; i < stack.grid.size(); ++i) {
    if (i == beam) continue;
    const auto is_active = [&](std::size_t medium) {
      return i < active_count(stack.grid, stack.ior[medium]);
    };
    for (std::size_t q = 0; q <= layers; ++q)
      r[q] = is_active(q) && is_active(q + 1)
                 ? node_fresnel(stack.grid, i, stack.ior[q], stack.ior[q + 1])
                 : 1.0;
    for (std::size_t q = 0; q < solver.waves.rate.size(); ++q) {
      for (std::size_t l = 0; l < layers; ++l) {
        const GridLayer& layer = stack.layers[l];
        Course& at = course[l] = Course{};
        if (!is_active(l + 1) || (layer.sigma_s == 0.0 && i >= layer.reach)) continue;
        const double cos = layer.cos[i], d = layer.thickness;
        const double tangent = stack.grid.p[i] / (layer.ior * cos);
        const Complex rate = node_extinction(layer, i) / cos - k * tangent * solver.waves.rate[q];
        at.across = std::isfinite(d) ? polar_exp(-rate * d) : 0.0;
        if (layer.sigma_s == 0.0) continue;
        const double strength =
            0.25 * layer.sigma_s * stack.grid.etendue[i] / (layer.ior * layer.ior * cos);
        const double on = strength * solver.phase[l][0].forward(i, beam);
        const double back = strength * solver.phase[l][0].backward(i, beam);
        const double extinction = node_extinction(layer, beam);
        const double down = flux.down[2 * l], up = flux.up[2 * l + 1];
        const Complex turned = back * decay_integral(rate + extinction, d);
        at.emitted_up = down * turned;
        if (!std::isfinite(d)) continue;
        const Complex gone_on =
            on * std::exp(-extinction * d) * decay_integral(rate - extinction, d);
        at.emitted_up += up * gone_on;
        at.emitted_down = down * gone_on + up * turned;
      }
      const Complex weight = solver.waves.weight[0][q];
      result.reflectance += times(weight, leaving(r, course, true, work)).real();
      if (has_below) result.transmittance += times(weight, leaving(r, course, false, work)).real();
    }
  }
  return result;
}

}  // namespace lamina::detail
