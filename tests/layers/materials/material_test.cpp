// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/material.h"

#include <gtest/gtest.h>

#include <string>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

Material half_space(MaterialLayer layer) {
  Material material;
  material.ior_above = {1.0, 1.0, 1.0};
  material.ior_below = layer.ior = {1.4, 1.4, 1.5};
  material.layers.push_back(std::move(layer));
  return material;
}

MixturePart part(double fraction, double sigma_a, double sigma_s, double g,
                 ParticlePhase phase = ParticlePhase::henyey_greenstein) {
  const auto each = [](double x) { return std::vector<double>(3, x); };
  return {.name = "part",
          .fraction = fraction,
          .sigma_a = each(sigma_a),
          .sigma_s = each(sigma_s),
          .g = each(g),
          .phase = phase};
}

Layer top_layer(const Material& material) { return layer_stack(material, 0).layers()[0]; }

TEST(Material, LayerStackHasTheNumbersOfItsBand) {
  const Material material = half_space({.sigma_a = {0.1, 0.2, 0.3},
                                        .sigma_s = {1.0, 2.0, 3.0},
                                        .g = {0.7, 0.8, 0.9},
                                        .top = {.roughness = 0.3}});
  const LayerStack stack = layer_stack(material, 2);
  const Layer& layer = stack.layers()[0];
  EXPECT_EQ(layer.medium.sigma_a, 0.3);
  EXPECT_EQ(layer.medium.sigma_s, 3.0);
  EXPECT_EQ(layer.medium.g, 0.9);
  EXPECT_EQ(layer.medium.ior, 1.5);
  EXPECT_EQ(layer.top.roughness, 0.3);
  EXPECT_TRUE(is_semi_infinite(stack));
  EXPECT_EQ(phase_function(layer), PhaseFunction(HenyeyGreenstein{0.9}));
}

TEST(Material, RayleighLayerScattersSo) {
  const Material material = half_space({.sigma_a = {0.0, 0.0, 0.0},
                                        .sigma_s = {1.0, 2.0, 3.0},
                                        .g = {0.0, 0.0, 0.0},
                                        .phase = ParticlePhase::rayleigh});
  EXPECT_EQ(phase_function(top_layer(material)), PhaseFunction(Rayleigh{}));
}

// [HanrahanKrueger1993] §3: sigma_a = sum w sigma_a, sigma_s p = sum w sigma_s p.
TEST(Mixture, AddsUpCoefficientsAndPhaseFunctionsByVolume) {
  const Material material = half_space(
      {.mixture = {part(0.25, 4.0, 8.0, 0.9), part(0.75, 0.4, 1.6, 0.0, ParticlePhase::rayleigh)}});
  const Layer layer = top_layer(material);
  EXPECT_DOUBLE_EQ(layer.medium.sigma_a, 0.25 * 4.0 + 0.75 * 0.4);
  EXPECT_DOUBLE_EQ(layer.medium.sigma_s, 0.25 * 8.0 + 0.75 * 1.6);
  const PhaseFunction large = HenyeyGreenstein{0.9}, small = Rayleigh{};
  for (const double cos_theta : {-1.0, -0.3, 0.0, 0.8, 1.0})
    EXPECT_NEAR(layer.medium.sigma_s * evaluate(*layer.phase, cos_theta),
                2.0 * evaluate(large, cos_theta) + 1.2 * evaluate(small, cos_theta), 1e-12);
  EXPECT_DOUBLE_EQ(layer.medium.g, 2.0 * 0.9 / 3.2);
}

// Diffusion sees sigma_s (1 - g) only, which adds up like sigma_a.
TEST(Mixture, ReducedScatteringAddsUpByVolume) {
  const Material material =
      half_space({.mixture = {part(0.5, 0.0, 10.0, 0.8), part(0.3, 0.0, 4.0, -0.5),
                              part(0.2, 1.0, 0.0, 0.3)}});
  EXPECT_NEAR(sigma_s_prime(top_layer(material).medium), 0.5 * 2.0 + 0.3 * 6.0, 1e-12);
}

TEST(Mixture, LayerItselfFillsTheRest) {
  const Material material = half_space({.sigma_a = {0.3, 0.3, 0.3},
                                        .sigma_s = {20.0, 20.0, 20.0},
                                        .g = {0.8, 0.8, 0.8},
                                        .mixture = {part(0.02, 30.0, 1.0, 0.0)}});
  const Medium medium = top_layer(material).medium;
  EXPECT_DOUBLE_EQ(medium.sigma_a, 0.98 * 0.3 + 0.02 * 30.0);
  EXPECT_DOUBLE_EQ(medium.sigma_s, 0.98 * 20.0 + 0.02 * 1.0);
  EXPECT_DOUBLE_EQ(medium.g, 0.98 * 20.0 * 0.8 / (0.98 * 20.0 + 0.02));
}

TEST(Mixture, OfOneSubstanceIsThatSubstance) {
  const Material material =
      half_space({.mixture = {part(0.5, 0.3, 20.0, 0.8), part(0.5, 0.3, 20.0, 0.8)}});
  const Layer layer = top_layer(material);
  EXPECT_DOUBLE_EQ(layer.medium.sigma_a, 0.3);
  EXPECT_DOUBLE_EQ(layer.medium.sigma_s, 20.0);
  EXPECT_EQ(layer.medium.g, 0.8);
  EXPECT_FALSE(layer.phase.has_value());
}

TEST(Mixture, PartsThatDoNotScatterHaveNoSayInThePhaseFunction) {
  const Material material =
      half_space({.mixture = {part(0.5, 0.3, 20.0, 0.8), part(0.3, 1.0, 0.0, 0.1),
                              part(0.2, 0.0, 0.0, 0.0, ParticlePhase::rayleigh)}});
  EXPECT_EQ(phase_function(top_layer(material)), PhaseFunction(HenyeyGreenstein{0.8}));
  const Material clear = half_space({.mixture = {part(1.0, 0.3, 0.0, 0.8)}});
  EXPECT_EQ(top_layer(clear).medium.sigma_s, 0.0);
  EXPECT_EQ(top_layer(clear).medium.g, 0.0);
}

TEST(Mixture, FractionsThatDoNotFillTheLayerAreRefused) {
  EXPECT_THROW((void)top_layer(half_space({.mixture = {part(0.9, 0.0, 1.0, 0.0)}})), InvalidInput);
  EXPECT_NO_THROW((void)top_layer(half_space({.mixture = {part(1.0 - 5e-7, 0.0, 1.0, 0.0)}})));
  EXPECT_THROW((void)top_layer(
                   half_space({.mixture = {part(1.5, 0.0, 1.0, 0.0), part(-0.5, 0.0, 1.0, 0.0)}})),
               InvalidInput);
}

TEST(Material, VectorWithoutTheBandIsNamed) {
  Material material = half_space({.sigma_a = {0.1}, .sigma_s = {1.0, 2.0, 3.0}, .g = {0, 0, 0}});
  EXPECT_NO_THROW((void)layer_stack(material, 0));
  try {
    (void)layer_stack(material, 1);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "layers[0].sigma_a must hold a number for band 1, but holds 1");
  }
}

}  // namespace
}  // namespace lamina
