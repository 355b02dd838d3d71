// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"
#include "lamina/solve/scattering/layered_bsdf/higher_orders.h"
#include "lamina/solve/scattering/layered_bsdf/internal/rough_top.h"
#include "lamina/solve/scattering/layered_bsdf/internal/rough_top_orders.h"

namespace lamina {
namespace {

void check_angle(double angle, const std::string& name) {
  if (!(0.0 <= angle && angle < 0.5 * std::numbers::pi))
    throw InvalidInput(name + ": must lie in [0, pi/2), but is " + number_text(angle));
}

Vec3 direction(double theta, double phi, bool is_above) {
  const double z = std::cos(theta), sine = std::sin(theta);
  return {sine * std::cos(phi), sine * std::sin(phi), is_above ? z : -z};
}

/// As higher_orders_bsdf wants a direction.
StackBeam<double> outside_beam(const detail::RoughTop& top, const detail::FacetBeams& light) {
  StackBeam<double> beam;
  beam.surface = light.reflected;
  beam.toward = light.toward;
  beam.mu = light.toward.z;
  beam.ior = top.ior_outside;
  return beam;
}

StackBsdf under_rough_top(const LayerStack& stack, ScatteringOrders which, double theta_i,
                          std::span<const double> theta_o, std::span<const double> phi_o) {
  const detail::RoughTop top = detail::make_rough_top(stack);
  HigherOrders higher;
  if (which == ScatteringOrders::all) higher = detail::make_higher_orders(stack, top);
  const detail::FacetBeams in = detail::cross_facets(
      top, {-std::sin(theta_i), 0.0, std::cos(theta_i)}, detail::OfPair::first);
  const StackBeam<double> in_outside = outside_beam(top, in);
  const auto rest = [&](const StackBeam<double>& out) {
    return which == ScatteringOrders::all ? higher_orders_bsdf(higher, in_outside, out) : 0.0;
  };
  const std::size_t count = theta_o.size() * phi_o.size();
  StackBsdf result{.brdf = std::vector<double>(count),
                   .btdf = std::vector<double>(count),
                   .estimated_error = higher.estimated_error,
                   .is_accurate = true};
  for (std::size_t i = 0; i < theta_o.size(); ++i) {
    detail::FacetBeams out =
        detail::cross_facets(top, direction(theta_o[i], 0.0, true), detail::OfPair::second);
    double turned = 0.0;
    for (std::size_t j = 0; j < phi_o.size(); ++j) {
      detail::turn(out, phi_o[j] - turned);
      turned = phi_o[j];
      const std::size_t k = i * phi_o.size() + j;
      result.brdf[k] = detail::surface_brdf(top, in, out) + detail::volume_bsdf(top, in, out) +
                       rest(outside_beam(top, out));
      if (!top.below.is_transmissive()) continue;
      const StackBeam<double> below =
          detail::beam_from_below(top, direction(theta_o[i], phi_o[j], false));
      result.btdf[k] = detail::volume_bsdf(top, in, below) + rest(below);
    }
  }
  return result;
}

}  // namespace

StackBsdf layered_bsdf(const LayerStack& stack, ScatteringOrders which, double theta_i,
                       std::span<const double> theta_o, std::span<const double> phi_o) {
  check_angle(theta_i, "angle of incidence");
  for (const double theta : theta_o) check_angle(theta, "angle to look from");
  const FirstOrderStack<double> first = make_first_order(stack);
  if (detail::has_rough_top(stack)) return under_rough_top(stack, which, theta_i, theta_o, phi_o);
  HigherOrders higher;
  if (which == ScatteringOrders::all) higher = make_higher_orders(stack);
  const StackBeam<double> in =
      make_beam(first, {-std::sin(theta_i), 0.0, std::cos(theta_i)});  // goes on to azimuth 0

  const std::size_t count = theta_o.size() * phi_o.size();
  StackBsdf result{.brdf = std::vector<double>(count),
                   .btdf = std::vector<double>(count),
                   .unscattered_reflectance = in.reflected,
                   .unscattered_transmittance = first.is_transmissive() ? in.ground : 0.0,
                   .estimated_error = higher.estimated_error,
                   .is_accurate = true};
  for (const bool is_above : {true, false}) {
    if (!is_above && !first.is_transmissive()) continue;
    std::vector<double>& values = is_above ? result.brdf : result.btdf;
    for (std::size_t i = 0; i < theta_o.size(); ++i)
      for (std::size_t j = 0; j < phi_o.size(); ++j) {
        const StackBeam<double> out = make_beam(first, direction(theta_o[i], phi_o[j], is_above));
        double& value = values[i * phi_o.size() + j];
        value = first_order_bsdf(first, in, out);
        if (which == ScatteringOrders::all) value += higher_orders_bsdf(higher, in, out);
      }
  }
  return result;
}

double misplaced_light(std::span<const double> a, std::span<const double> b,
                       std::span<const double> theta_o, std::span<const double> phi_o) {
  assert(a.size() == b.size() && a.size() == theta_o.size() * phi_o.size());
  double misplaced = 0.0, all = 0.0;
  for (std::size_t i = 0; i < theta_o.size(); ++i)
    for (std::size_t j = 0; j < phi_o.size(); ++j) {
      const bool is_edge = j == 0 || j + 1 == phi_o.size();
      const double weight = (is_edge ? 0.5 : 1.0) * std::sin(theta_o[i]) * std::cos(theta_o[i]);
      const std::size_t k = i * phi_o.size() + j;
      misplaced += weight * std::abs(a[k] - b[k]);
      all += weight * b[k];
    }
  return all > 0.0 ? misplaced / all : 0.0;
}

}  // namespace lamina
