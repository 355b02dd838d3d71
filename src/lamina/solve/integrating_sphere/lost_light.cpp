// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/integrating_sphere/lost_light.h"

#include <atomic>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {

LostLight lost_light(const LayerStack& stack, const Incidence& incidence, double beam_diameter,
                     double port_diameter, const LostLightOptions& options) {
  if (!(0.0 <= beam_diameter && beam_diameter <= port_diameter))
    throw InvalidInput("beam_diameter must lie in [0, " + number_text(port_diameter) +
                       "] mm, the port's, but is " + number_text(beam_diameter));
  const double port = 0.5 * port_diameter;
  MonteCarloOptions run{.photons = options.photons, .seed = options.seed, .incidence = incidence};
  if (beam_diameter > 0.0) run.beam = {Beam::Shape::flat, 0.5 * beam_diameter};
  run.tallies.r = {.count = 2, .width = port};  // within, and all beyond
  std::atomic<bool> is_stopped = false;
  run.progress = [&](double finished) {
    if (!report_progress(options.progress, finished)) is_stopped = true;
    return !is_stopped;
  };
  const MonteCarloResult found = trace_photons(stack, run);
  if (is_stopped) throw Interrupted();
  // Densities over the rings, of which the second ends at twice the port.
  const double area = 3.0 * std::numbers::pi * port * port;
  const auto beyond = [&](const Estimate& density) {
    return Estimate{area * density.value, area * density.standard_error};
  };
  return {beyond(found.radial.reflection[1]), beyond(found.radial.transmission[1])};
}

}  // namespace lamina
