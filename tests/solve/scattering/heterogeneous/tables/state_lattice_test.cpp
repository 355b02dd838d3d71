// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

TEST(StateLattice, StatesSurviveTheirVectors) {
  for (const LayerState& state :
       {LayerState{0.3, 12.0, 0.8, 0.2, 0.0}, LayerState{2e-5, 0.5, -0.4, infinite, 0.3}}) {
    const LayerState again = state_of(state_vector(state));
    EXPECT_NEAR(again.sigma_a, state.sigma_a, 1e-12 * state.sigma_a);
    EXPECT_NEAR(again.sigma_s, state.sigma_s, 1e-12 * state.sigma_s);
    EXPECT_NEAR(again.g, state.g, 1e-14);
    EXPECT_DOUBLE_EQ(again.thickness, state.thickness);
    EXPECT_DOUBLE_EQ(again.roughness, state.roughness);
  }
}

// A leaf that thickens holds the same, spread over more: three quantities vary, one axis.
TEST(StateLattice, WhatVariesTogetherIsOneAxis) {
  LayerTexels leaf = uniform_texels({.g = 0.8});
  leaf.sigma_a.clear(), leaf.sigma_s.clear(), leaf.thickness.clear();
  for (int i = 0; i < 50; ++i) {
    const auto d = static_cast<float>(0.1 * std::exp(0.03 * i));
    leaf.sigma_a.push_back(0.7f / d);
    leaf.sigma_s.push_back(1.3f / d);
    leaf.thickness.push_back(d);
  }
  const StateLattice lattice = fit_lattice(leaf);
  ASSERT_EQ(lattice.axes.size(), 1u);
  EXPECT_NEAR(lattice.axes[0].high - lattice.axes[0].low, std::sqrt(3.0) * 0.03 * 49, 1e-4);
  for (const std::size_t texel : {0u, 17u, 49u}) {
    const LatticePlace place = place_in(lattice, state_of(leaf, texel));
    LatticePlace fractions{};
    fractions[0] = place[0] / static_cast<double>(lattice.axes[0].nodes - 1);
    const LayerState seen = state_at(lattice, fractions);
    EXPECT_NEAR(seen.thickness / static_cast<double>(leaf.thickness[texel]), 1.0, 1e-5);
    EXPECT_NEAR(seen.sigma_a * seen.thickness, 0.7, 1e-5);
  }
}

TEST(StateLattice, UniformLayersAreOneStateAndHalfSpacesStayInfinite) {
  const LayerState state{.sigma_a = 0.1, .sigma_s = 4.0, .g = 0.5};
  EXPECT_TRUE(fit_lattice(uniform_texels(state)).axes.empty());
  LayerTexels texels = uniform_texels(state);
  texels.sigma_s = {2.0f, 4.0f, 8.0f};
  const StateLattice lattice = fit_lattice(texels);
  ASSERT_EQ(lattice.axes.size(), 1u);
  for (std::size_t n = 0; n < node_count(lattice); ++n) {
    EXPECT_EQ(node_state(lattice, n).thickness, infinite);
    EXPECT_NEAR(node_state(lattice, n).sigma_a, 0.1, 1e-6);
  }
}

// Cubics give what is cubic in the places exactly.
TEST(StateLattice, InterpolatesCubicsExactly) {
  LayerTexels texels = uniform_texels({.sigma_a = 0.1, .sigma_s = 4.0, .thickness = 1.0});
  texels.sigma_a = {0.1f, 0.4f, 0.1f, 0.4f};
  texels.thickness = {1.0f, 1.0f, 3.0f, 3.0f};
  const StateLattice lattice = fit_lattice(texels);
  ASSERT_EQ(lattice.axes.size(), 2u);
  const auto cubic = [](double a, double b) { return 1.0 + a * a * b - 0.2 * b * b * b + a; };
  const std::size_t across = lattice.axes[0].nodes;
  for (const double a : {0.3, 2.7, static_cast<double>(across) - 1.2})
    for (const double b : {0.0, 4.4}) {
      double sum = 0.0;
      for_nodes_around(lattice, {a, b}, [&](std::size_t node, double share) {
        sum +=
            share * cubic(static_cast<double>(node % across), static_cast<double>(node / across));
      });
      EXPECT_NEAR(sum, cubic(a, b), 1e-9 * std::abs(cubic(a, b)));
    }
}

TEST(StateLattice, TakesNoMoreNodesThanAllowed) {
  LayerTexels texels = uniform_texels({.sigma_a = 0.1, .sigma_s = 4.0, .thickness = 1.0});
  texels.sigma_a.clear(), texels.sigma_s.clear(), texels.thickness.clear(), texels.g.clear();
  for (int i = 0; i < 16; ++i) {
    texels.sigma_a.push_back(i & 1 ? 0.01f : 1.0f);
    texels.sigma_s.push_back(i & 2 ? 1.0f : 10.0f);
    texels.thickness.push_back(i & 4 ? 0.1f : 1.0f);
    texels.g.push_back(i & 8 ? 0.1f : 0.9f);
  }
  const StateLattice lattice = fit_lattice(texels);
  EXPECT_EQ(lattice.axes.size(), 4u);
  EXPECT_LE(node_count(lattice), 1500u);
  for (std::size_t i = 0; i < 16; ++i) {  // and all texels lie within
    const LatticePlace place = place_in(lattice, state_of(texels, i));
    LatticePlace fractions{};
    for (std::size_t a = 0; a < 4; ++a)
      fractions[a] = place[a] / static_cast<double>(lattice.axes[a].nodes - 1);
    EXPECT_NEAR(state_at(lattice, fractions).sigma_a / static_cast<double>(texels.sigma_a[i]), 1.0,
                1e-5);
  }
}

}  // namespace
}  // namespace lamina
