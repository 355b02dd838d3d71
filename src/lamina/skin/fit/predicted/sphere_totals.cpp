// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/sphere_totals.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "lamina/solve/integrating_sphere/lost_light.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina::fit_detail {
namespace {

/// Photons are as many as the inverse square of the error: of a tenth of the light that is lost
/// they are wrong by .3 errors, which makes errors of a fit 5 % larger.
constexpr double fewest_photons = 1e5, most_photons = 4e6;
/// Diffuse light only changes the gain, by a few percent of itself.
constexpr double diffuse_share = 0.1;

/// a += factor * b
void add_scaled(std::vector<LayerDerivatives>& a, double factor,
                std::span<const LayerDerivatives> b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    a[k].by_sigma_a += factor * b[k].by_sigma_a;
    a[k].by_sigma_s += factor * b[k].by_sigma_s;
    a[k].by_g += factor * b[k].by_g;
    a[k].by_thickness += factor * b[k].by_thickness;
  }
}

}  // namespace

LostTotals lost_totals(const LayerStack& stack, const MeasuredSeries& series,
                       std::span<const MeasuredPoint> points) {
  LostTotals lost;
  if (!series.beam_diameter) return lost;
  std::optional<double> above, below;  // ports
  double error = 1.0;
  for (const MeasuredPoint& point : points) {
    if (!point.sphere) continue;
    (point.quantity == MeasuredQuantity::reflectance ? above : below) = point.sphere->sample_port;
    error = std::min(error, point.standard_deviation);
  }
  const double photons = std::clamp(1.0 / (error * error), fewest_photons, most_photons);
  const auto lost_at = [&](double port) {
    return lost_light(stack, series.incidence, *series.beam_diameter, port,
                      {.photons = static_cast<std::uint64_t>(photons)});
  };
  const auto diffuse_at = [&](const LayerStack& side, double port) {
    const auto few = static_cast<std::uint64_t>(diffuse_share * photons);
    return lost_light(side, {.is_diffuse = true}, port, port, {.photons = few}).reflected.value;
  };
  std::optional<LostLight> found;
  if (above) {
    found = lost_at(*above);
    lost.reflected = found->reflected.value;
    lost.diffuse_above = diffuse_at(stack, *above);
  }
  if (below) {
    if (!found || above != below) found = lost_at(*below);
    lost.transmitted = found->transmitted.value;
    lost.diffuse_below = diffuse_at(lit_from_below({&stack, 1})[0], *below);
  }
  return lost;
}

SphereTotal sphere_total(const MeasuredPoint& point, bool has_specular,
                         const AddingDoublingDerivatives& beam,
                         const AddingDoublingDerivatives& diffuse, const LostTotals& lost) {
  const bool is_behind = point.quantity == MeasuredQuantity::transmittance;
  const AddingDoublingTotals& of_beam = beam.totals;
  const double diffuse_reflectance = diffuse.totals.totals.specular_reflectance +
                                     diffuse.totals.totals.diffuse_reflectance -
                                     (is_behind ? lost.diffuse_below : lost.diffuse_above);
  SphereTotal total;
  // All unscattered light goes straight, that of lower boundaries, too.
  SampleLight light;
  SphereReading reading;
  if (is_behind) {
    light = {.scattered = of_beam.totals.transmittance - of_beam.unscattered_transmittance -
                          lost.transmitted,
             .straight = of_beam.unscattered_transmittance};
    reading = transmittance_reading(*point.sphere, light, diffuse_reflectance);
  } else {
    light = {.scattered = of_beam.totals.specular_reflectance + of_beam.totals.diffuse_reflectance -
                          of_beam.unscattered_reflectance - lost.reflected,
             .straight = has_specular ? of_beam.unscattered_reflectance : 0.0};
    reading = reflectance_reading(*point.sphere, light, diffuse_reflectance);
    if (!has_specular) reading.by_straight = 0.0;
  }
  total.value = reading.value;
  if (beam.diffuse_reflectance.empty()) return total;

  total.derivatives.resize(beam.diffuse_reflectance.size());
  add_scaled(total.derivatives, reading.by_scattered,
             is_behind ? beam.transmittance : beam.diffuse_reflectance);
  add_scaled(total.derivatives, reading.by_straight - reading.by_scattered,
             is_behind ? beam.unscattered_transmittance : beam.unscattered_reflectance);
  std::vector<LayerDerivatives> by_layer = diffuse.diffuse_reflectance;
  if (is_behind) std::ranges::reverse(by_layer);
  add_scaled(total.derivatives, reading.by_diffuse_reflectance, by_layer);
  return total;
}

}  // namespace lamina::fit_detail
