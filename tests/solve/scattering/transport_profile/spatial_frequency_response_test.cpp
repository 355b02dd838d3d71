// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "solve/scattering/layer_parameters.h"

namespace lamina {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

Layer of(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

struct Case {
  const char* name;
  LayerStack stack;
};
const std::vector<Case> cases{
    {"thin slab", LayerStack({of(.1, 10, .9, 1.33, .1)})},
    {"half-space", LayerStack({of(.5, 4, 0, 1.3, .2), of(.02, 10, .8, 1.4, endless)}, 1, 1.4)},
    {"clear plate, ground",
     LayerStack({of(0, 0, 0, 1.5, .2), of(.1, 20, .7, 1.5, .5)}, 1, 1.5, {.reflectance = .6})},
    {"four layers", LayerStack({of(.3, 2, -.3, 1.5, .2), of(.05, 8, .6, 1.33, .4),
                                of(1, 30, .95, 1.33, .1), of(.02, 1, .3, 1.33, 1)})},
};

// Without waves: what adding-doubling finds, less what is not scattered of a beam.
TEST(SpatialFrequencyResponse, IsTheTotalAtZeroFrequency) {
  for (const auto& [name, stack] : cases)
    for (const Illumination light : {Illumination::normal_beam, Illumination::diffuse})
      for (const bool is_from_below : {false, true}) {
        const bool has_lower_side = !is_semi_infinite(stack) && stack.ground().reflectance == 0.0;
        if (is_from_below && !has_lower_side) continue;
        const bool is_diffuse = light == Illumination::diffuse;
        const auto found = spatial_frequency_response(
            std::vector{stack}, std::vector{0.0},
            {.accuracy = .1, .illumination = light, .is_from_below = is_from_below});
        const auto known =
            adding_doubling(is_from_below ? flipped(stack) : stack, {.is_diffuse = is_diffuse});
        const double r = known.totals.diffuse_reflectance, t = known.totals.transmittance;
        const double back = known.unscattered_reflectance - known.totals.specular_reflectance;
        const double through = (1.0 - stack.ground().reflectance) * known.unscattered_transmittance;
        EXPECT_NEAR(found.reflectance[0], is_diffuse ? r : r - back, 1e-6) << name;
        EXPECT_NEAR(found.transmittance[0], is_diffuse ? t : t - through, 1e-6) << name;
      }
}

// A fit compares responses as they are printed, with the directions that they end with.
TEST(SpatialFrequencyDerivatives, AreThoseOfCentralDifferences) {
  const std::vector<double> k{2.0};
  for (const auto& [name, stack] : cases) {
    if (stack.layers().size() > 2) continue;  // frequency_derivatives_test has them, in less time
    const bool is_diffuse = name == std::string("half-space");
    const TransferProfileOptions options{
        .accuracy = .1,
        .illumination = is_diffuse ? Illumination::diffuse : Illumination::normal_beam};
    const auto exact = spatial_frequency_derivatives(std::vector{stack}, k, options);
    const auto value = spatial_frequency_response(std::vector{stack}, k, options);
    EXPECT_EQ(exact.response.reflectance, value.reflectance);
    for (std::size_t l = 0; l < stack.layers().size(); ++l)
      for (const LayerParameter& parameter : layer_parameters) {
        Layer layer = stack.layers()[l];
        const double at = parameter.value(layer);
        const bool is_g = std::string(parameter.name) == "g";
        if (!std::isfinite(at) || (!is_g && at == 0.0)) continue;
        const double h = is_g ? 1e-3 : 2e-3 * at;
        const auto more =
            spatial_frequency_response(std::vector{changed(stack, l, parameter, h)}, k, options);
        const auto less =
            spatial_frequency_response(std::vector{changed(stack, l, parameter, -h)}, k, options);
        // Of what the parameter changes more, of both sides.
        double most = 0.0;
        for (std::size_t i = 0; i < k.size(); ++i)
          most = std::max({most, std::abs(exact.reflectance[i][l].*parameter.derivative),
                           std::abs(exact.transmittance[i][l].*parameter.derivative)});
        for (std::size_t i = 0; i < k.size(); ++i) {
          EXPECT_NEAR(exact.reflectance[i][l].*parameter.derivative,
                      (more.reflectance[i] - less.reflectance[i]) / (2.0 * h), 1e-4 * most)
              << name << ": R by " << parameter.name << " of layer " << l << ", k " << k[i];
          EXPECT_NEAR(exact.transmittance[i][l].*parameter.derivative,
                      (more.transmittance[i] - less.transmittance[i]) / (2.0 * h), 1e-4 * most)
              << name << ": T by " << parameter.name << " of layer " << l << ", k " << k[i];
        }
      }
  }
}

TEST(SpatialFrequencyDerivatives, FromBelowAreThoseOfTheStackTurnedOver) {
  const std::vector stack{LayerStack({of(.2, 8, .6, 1.33, .4), of(1, 30, .8, 1.5, .1)})};
  const std::vector turned{flipped(stack[0])};
  const std::vector<double> k{1.0};
  const auto below =
      spatial_frequency_derivatives(stack, k, {.accuracy = .1, .is_from_below = true});
  const auto above = spatial_frequency_derivatives(turned, k, {.accuracy = .1});
  for (const LayerParameter& parameter : layer_parameters)
    for (std::size_t l = 0; l < 2; ++l) {
      EXPECT_EQ(below.reflectance[0][l].*parameter.derivative,
                above.reflectance[0][1 - l].*parameter.derivative);
      EXPECT_EQ(below.transmittance[0][l].*parameter.derivative,
                above.transmittance[0][1 - l].*parameter.derivative);
    }
}

TEST(SpatialFrequencyDerivatives, RefuseWhatHasNone) {
  Layer rough = of(1, 1, 0, 1.4, 1);
  rough.top.roughness = .2;
  const std::vector<double> k{1.0};
  EXPECT_THROW((void)spatial_frequency_derivatives(std::vector{LayerStack({rough})}, k),
               InvalidInput);
  EXPECT_THROW(
      (void)spatial_frequency_derivatives(std::vector{LayerStack({of(0, 1, 0, 1, endless)})}, k),
      InvalidInput);
}

}  // namespace
}  // namespace lamina
