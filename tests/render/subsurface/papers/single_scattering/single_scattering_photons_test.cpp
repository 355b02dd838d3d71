// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "render/subsurface/papers/single_scattering/light_once.h"

namespace lamina {
namespace {

using namespace once;

constexpr double ior = 1.4, theta_i = 0.9;
constexpr int angles = 9;  // bins of 10 degrees

double edge(int angle) { return 0.5 * std::numbers::pi * angle / angles; }

/// Fraction of the light that leaves within each bin of angles and was scattered once, by photons.
/// What lies below a slab has its index, as light scattered once is not sent back there.
std::array<Estimate, angles> by_photons(double g, std::size_t band, double thickness) {
  const MaterialLayer layer = one_layer(g, ior).layers[0];
  const LayerStack stack(
      {{.medium =
            {.sigma_a = layer.sigma_a[band], .sigma_s = layer.sigma_s[band], .g = g, .ior = ior},
        .thickness = thickness}},
      1.0, ior);
  const MonteCarloResult traced =
      trace_photons(stack, {.photons = 1'000'000,
                            .seed = 3,
                            .incidence = {.theta = theta_i},
                            .tallies = {.angles = angles, .orders = true}});
  std::array<Estimate, angles> once;
  for (int a = 0; a < angles; ++a) {
    const Estimate& per_angle =
        traced.angular_by_order.reflection[static_cast<std::size_t>(angles + a)];
    const double solid = 2.0 * std::numbers::pi * (std::cos(edge(a)) - std::cos(edge(a + 1)));
    once[static_cast<std::size_t>(a)] = {solid * per_angle.value, solid * per_angle.standard_error};
  }
  return once;
}

/// The same from the rendered radiance, by quadrature over directions.
std::array<BandValues<4>, angles> by_rendering(const LightOnce& rendered) {
  constexpr int azimuths = 8;  // of one half, to which the other is alike
  std::array<BandValues<4>, angles> once;
  for (int a = 0; a < angles; ++a) {
    const Quadrature cosines = gauss_legendre(2, std::cos(edge(a + 1)), std::cos(edge(a)));
    for (std::size_t i = 0; i < cosines.nodes.size(); ++i)
      for (int j = 0; j < azimuths; ++j) {
        const Vec3f to_eye =
            along(std::acos(cosines.nodes[i]), std::numbers::pi * (j + 0.5) / azimuths);
        const double weight =
            cosines.weights[i] * cosines.nodes[i] * 2.0 * std::numbers::pi / azimuths;
        once[static_cast<std::size_t>(a)] +=
            static_cast<float>(weight / (std::cos(theta_i) * std::numbers::pi)) *
            rendered.mean(to_eye, 256);
      }
  }
  return once;
}

struct Body {
  std::string name;
  Mesh mesh;
  double thickness;
};

std::array<Body, 2> bodies() {
  return {Body{"half-space", make_square(200.0f), infinite},
          Body{"slab", make_plate(200.0f, 0.5f), 0.5}};
}

Scene lit(const Body& body, double g) {
  return scene_of(body.mesh, one_layer(g, ior),
                  DirectionalLight{.direction = {std::sin(theta_i), 0, std::cos(theta_i)},
                                   .irradiance = {pi, pi, pi}});
}

// Photons that were scattered once leave as light scattered once is rendered, at all angles.
TEST(SingleScattering, IsThatOfPhotonsScatteredOnce) {
  for (const Body& body : bodies())
    for (const double g : {0.0, 0.8}) {
      const auto refracted = by_rendering(LightOnce(lit(body, g), true));
      const auto straight = by_rendering(LightOnce(lit(body, g), false));
      for (std::size_t b = 0; b < 3; ++b) {
        const auto photons = by_photons(g, b, body.thickness);
        double sum = 0.0, variance = 0.0, sum_refracted = 0.0, sum_straight = 0.0;
        for (std::size_t a = 0; a < angles; ++a) {
          const auto band = static_cast<int>(b);
          const double found = static_cast<double>(refracted[a][band]);
          EXPECT_NEAR(found, photons[a].value, 4.0 * photons[a].standard_error + 3e-3 * found)
              << body.name << " g " << g << " band " << b << " angle " << a;
          sum += photons[a].value;
          variance += photons[a].standard_error * photons[a].standard_error;
          sum_refracted += found;
          sum_straight += static_cast<double>(straight[a][band]);
        }
        const double error = std::sqrt(variance);
        EXPECT_LT(error, 0.03 * sum) << "so that noise cannot hide a bias";
        EXPECT_NEAR(sum_refracted, sum, 4.0 * error + 1e-3 * sum);
        EXPECT_NEAR(sum_straight, sum, 4.0 * error + 1e-3 * sum);
      }
    }
}

// [HanrahanKrueger1993]'s first order of a finite layer, with the angles inside.
TEST(SingleScattering, OfAFlatSlabIsTheFirstOrder) {
  const Body slab = bodies()[1];
  for (const double g : {0.0, 0.8})
    for (const bool is_refracted : {false, true}) {
      const LightOnce rendered(lit(slab, g), is_refracted);
      for (const double theta_o : {0.1, 0.6, 1.3}) {
        constexpr double phi = 0.7;
        const BandValues<4> found = rendered.mean(along(theta_o, phi), 1 << 13);
        const double sin_i = std::sin(theta_i) / ior, sin_o = std::sin(theta_o) / ior;
        const double in_i = std::sqrt(1.0 - sin_i * sin_i), in_o = std::sqrt(1.0 - sin_o * sin_o);
        const double cos_turn = -(in_i * in_o + sin_i * sin_o * std::cos(phi));
        const double phase = (1.0 - g * g) / (4.0 * std::numbers::pi *
                                              std::pow(1.0 + g * g - 2.0 * g * cos_turn, 1.5));
        const MaterialLayer layer = one_layer(g, ior).layers[0];
        for (std::size_t b = 0; b < 3; ++b) {
          const double sigma_t = layer.sigma_a[b] + layer.sigma_s[b];
          const double reached =
              1.0 - std::exp(-sigma_t * slab.thickness * (1.0 / in_i + 1.0 / in_o));
          const double expected = (1.0 - fresnel(std::cos(theta_i), ior)) *
                                  (1.0 - fresnel(std::cos(theta_o), ior)) / (ior * ior) *
                                  layer.sigma_s[b] / sigma_t * phase / (in_i + in_o) * reached *
                                  std::cos(theta_i) * std::numbers::pi;
          EXPECT_NEAR(static_cast<double>(found[static_cast<int>(b)]), expected, 2e-3 * expected)
              << "g " << g << " band " << b << " theta_o " << theta_o;
        }
      }
    }
}

}  // namespace
}  // namespace lamina
