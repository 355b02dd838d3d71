// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/low_orders/diffuse_lowest_orders.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/solve/scattering/low_orders/diffuse_single_scattering.h"
#include "lamina/solve/scattering/low_orders/single_at_contact.h"
#include "lamina/solve/scattering/low_orders/unscattered_paths.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"
#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"

namespace lamina::detail {
namespace {

// Against rays over radius, skin and leaf agree to 0.05 % from 0.25 mean free paths on.
constexpr double highest_per_sigma_t = 24.0;

}  // namespace

ProfileCurves diffuse_lowest_orders(const LayerStack& stack, const GridStack& on_grid,
                                    Illumination illumination, const HankelPlan& plan,
                                    const StraightLight& light) {
  auto fine =
      make_frequency_solver(stack, light.nodes, light.modes, {}, illumination, RoughModes::first);
  fine.stack = above_rough_inside(std::move(fine.stack));
  std::vector<double> extinction;
  for (std::size_t l = 0; l < on_grid.layers.size(); ++l) {
    extinction.push_back(on_grid.layers[l].sigma_t);
    fine.stack.layers[l].sigma_t = extinction.back();
  }
  const auto single = make_diffuse_single(fine, extinction, light.depth_nodes);
  const auto grid = make_frequency_grid(on_grid, light.frequencies, highest_per_sigma_t);
  // Light scattered once grows as 1/r near the point: a part that does the same and has the same
  // total is put in over radius, the rest over frequency.
  const double contact =
      light.contact ? *light.contact : single_at_contact(stack, on_grid, fine.top);
  const double slowest = 1e-3 * grid.highest;
  const double decay = contact > 0.0
                           ? std::max(contact / single_response(single, 0.0).reflectance, slowest)
                           : slowest;
  std::vector<double> reflected, transmitted;
  for (const double k : grid.k) {
    const auto once = single_response(single, k);
    reflected.push_back(once.reflectance - contact / std::hypot(k, decay));
    transmitted.push_back(once.transmittance);
  }
  const auto reflectance = make_spectrum(grid, reflected);
  const auto transmittance = make_spectrum(grid, transmitted);
  std::vector<double> spectra;
  for (const double k : plan.k) {
    spectra.push_back(evaluate(reflectance, k));
    spectra.push_back(is_semi_infinite(stack) ? 0.0 : evaluate(transmittance, k));
  }
  const std::vector<double> rest = inverse_hankel(plan, spectra, 2);
  const auto paths = unscattered_paths(fine.stack, light.mirrors);
  const auto straight = unscattered_response(fine, paths, 0.0);
  ProfileCurves curves;
  curves.total_reflectance = straight.reflectance + contact / decay + evaluate(reflectance, 0.0);
  curves.total_transmittance = straight.transmittance + evaluate(transmittance, 0.0);
  const double half_step = std::sqrt(plan.r[1] / plan.r[0]);
  for (std::size_t i = 0; i < plan.r.size(); ++i) {
    const double r = plan.r[i];
    const auto unscattered = unscattered_ring(fine, paths, r / half_step, r * half_step);
    const double near = contact * std::exp(-decay * r) / (2.0 * std::numbers::pi * r);
    curves.reflectance.push_back(unscattered.reflectance + near + rest[2 * i]);
    curves.transmittance.push_back(unscattered.transmittance + rest[2 * i + 1]);
  }
  return curves;
}

}  // namespace lamina::detail
