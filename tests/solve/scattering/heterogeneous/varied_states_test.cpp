// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Layers of which anything varies: scattering, thickness, the mean cosine, roughness.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/solve/scattering/profile/layer_response.h"
#include "literal/delta_tracking.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int side = 24;
constexpr std::size_t texels = side * side;

// Coats on a half-space, and two layers as of a leaf.
struct Varied {
  MappedStack stack;
  std::vector<LayerTexels> layers;
};

/// Paint that is .02 to .5 mm thick on a stone of scattering .6 to 6/mm.
Varied paint_on_stone() {
  LayerTexels paint = uniform_texels({.sigma_a = 0.05, .sigma_s = 25.0, .g = 0.4});
  LayerTexels stone = uniform_texels({.sigma_a = 0.02, .sigma_s = 2.0, .g = 0.0});
  paint.thickness.clear(), stone.sigma_s.clear();
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      paint.thickness.push_back(0.02f * std::pow(25.0f, static_cast<float>(x) / (side - 1)));
      stone.sigma_s.push_back(0.6f * std::pow(10.0f, static_cast<float>(y) / (side - 1)));
    }
  return {{1.0, {{25.0, 0.4, 1.5, 0.1}, {2.0, 0.0, 1.6, infinite}}, 1.6}, {paint, stone}};
}

/// Two layers that thicken together and hold the same, of which the upper one varies in pigment.
Varied leaf() {
  LayerTexels upper = uniform_texels({.g = 0.8}), lower = upper;
  for (LayerTexels* layer : {&upper, &lower})
    layer->sigma_a.clear(), layer->sigma_s.clear(), layer->thickness.clear();
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const float d = 0.05f * std::pow(6.0f, static_cast<float>(x) / (side - 1));
      const float pigment = 0.05f * std::pow(20.0f, static_cast<float>(y) / (side - 1));
      upper.thickness.push_back(d), lower.thickness.push_back(d);
      upper.sigma_a.push_back(pigment / d), lower.sigma_a.push_back(0.3f / d);
      upper.sigma_s.push_back(2.4f / d), lower.sigma_s.push_back(5.6f / d);
    }
  return {{1.0, {{12.0, 0.8, 1.4, 0.1}, {28.0, 0.8, 1.4, 0.1}}, 1.0}, {upper, lower}};
}

Varied with_lattices(Varied varied) {
  for (std::size_t i = 0; i < varied.layers.size(); ++i)
    varied.stack.layers[i].states = fit_lattice(varied.layers[i]);
  return varied;
}

std::vector<Plane> no_sheets(const Varied& varied) {
  return std::vector<Plane>(varied.layers.size() - 1, make_plane(side, side));
}

/// The layered multipole at a texel.
LayerResponse closed_form(const Varied& varied, std::size_t texel) {
  LayerResponse all;
  const auto& layers = varied.stack.layers;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const LayerState at = state_of(varied.layers[i], texel);
    const double ior = layers[i].ior;
    const double above = i == 0 ? varied.stack.ior_above : layers[i - 1].ior;
    const double below = i + 1 == layers.size() ? varied.stack.ior_below : layers[i + 1].ior;
    const auto inside = [&](double outside) {
      return diffuse_reflectance_inside({}, ior, outside, DiffuseFresnel::exact);
    };
    all = stacked(all, response(make_multipole({at.sigma_a, at.sigma_s, at.g, ior}, at.thickness,
                                               inside(above), inside(below)),
                                0.0));
  }
  return all;
}

/// Under even light, with texels as wide as a metre: no light goes from one to another, so that
/// each is as if all were like it.
TransportResult far_apart(const Varied& varied, OperatorTotals totals) {
  const StackTables tables = make_stack_tables(varied.stack, totals);
  const auto layers =
      make_heterogeneous_layers(tables, side, side, varied.layers, no_sheets(varied), 1000.0);
  return transport(layers, make_plane(side, side, 1.0f));
}

TEST(VariedStates, SlowMapsGiveTheClosedFormOfEachPlace) {
  for (const Varied& varied : {with_lattices(paint_on_stone()), with_lattices(leaf())}) {
    const TransportResult result = far_apart(varied, OperatorTotals::diffusion);
    for (std::size_t i = 0; i < texels; ++i) {
      const LayerResponse wanted = closed_form(varied, i);
      ASSERT_NEAR(result.reflected.values[i], wanted.reflection_above, 1e-3) << i;
      ASSERT_NEAR(result.transmitted.values[i],
                  std::isinf(varied.stack.layers.back().thickness) ? 0.0 : wanted.transmission_down,
                  1e-3)
          << i;
    }
  }
}

// Adding-doubling of the whole stack at each place, which knows nothing of layers one by one. Each
// layer is right where the others are at their middle.
TEST(VariedStates, TotalsOfRadiativeTransferAreThoseOfTheWholeStack) {
  for (const Varied& varied : {with_lattices(paint_on_stone()), with_lattices(leaf())}) {
    const TransportResult result = far_apart(varied, OperatorTotals::radiative_transfer);
    double largest = 0.0, largest_through = 0.0;
    for (const std::size_t i : {0u, 11u, 23u, 12u * 24u + 12u, 9u * 24u + 20u, 575u, 552u}) {
      std::vector<Layer> solid;
      for (std::size_t l = 0; l < varied.layers.size(); ++l) {
        const LayerState at = state_of(varied.layers[l], i);
        solid.push_back({.medium = {at.sigma_a, at.sigma_s, at.g, varied.stack.layers[l].ior},
                         .thickness = at.thickness});
      }
      const SlabTotals totals =
          adding_doubling(LayerStack(solid, 1.0, varied.stack.ior_below)).totals;
      const double entered = 1.0 - totals.specular_reflectance;
      const auto off = [&](float seen, double wanted) {
        return std::abs(static_cast<double>(seen) - wanted / entered);
      };
      largest = std::max(largest, off(result.reflected.values[i], totals.diffuse_reflectance));
      if (std::isfinite(varied.stack.layers.back().thickness))
        largest_through =
            std::max(largest_through, off(result.transmitted.values[i], totals.transmittance));
    }
    EXPECT_LT(largest, 0.01);
    EXPECT_LT(largest_through, 0.01);
  }
}

// Where one quantity varies, modes and powers of a coordinate are two ways to the same.
TEST(VariedStates, ModesAreAsGoodAsPowers) {
  Varied varied = paint_on_stone();
  varied.layers[1] = uniform_texels({.sigma_a = 0.02, .sigma_s = 2.0});
  // A half-space of two quantities, so that its basis is modes, that says the same as one.
  Varied moded = varied;
  moded.layers[0].sigma_s.assign(texels, 25.0f);
  moded.layers[0].sigma_s[5] = 25.5f;
  const auto seen = [](const Varied& v) {
    const StackTables tables = make_stack_tables(v.stack, OperatorTotals::diffusion);
    const auto layers = make_heterogeneous_layers(tables, side, side, v.layers, no_sheets(v), 0.1);
    Plane light = make_plane(side, side, 1.0f);
    for (std::size_t i = 0; i < texels; i += 3) light.values[i] = 0.0f;
    return transport(layers, light).reflected;
  };
  varied = with_lattices(varied), moded = with_lattices(moded);
  ASSERT_EQ(varied.stack.layers[0].states->axes.size(), 1u);
  ASSERT_EQ(moded.stack.layers[0].states->axes.size(), 2u);
  const Plane powers = seen(varied), modes = seen(moded);
  for (std::size_t i = 0; i < texels; ++i)
    if (i != 5) {
      ASSERT_NEAR(powers.values[i], modes.values[i], 1.5e-3) << i;
    }
}

// A ground of 40 % under a coat: what adding-doubling finds for the two.
TEST(VariedStates, GroundsReturnWhatComesThrough) {
  LayerTexels coat = uniform_texels({.sigma_a = 0.2, .sigma_s = 20.0, .g = 0.5});
  coat.thickness = paint_on_stone().layers[0].thickness;
  Varied varied{{1.0, {{20.0, 0.5, 1.5, 0.1}}, 1.5}, {coat}};
  varied.stack.ground_reflectance = 0.4;
  varied = with_lattices(varied);
  const Plane seen = far_apart(varied, OperatorTotals::radiative_transfer).reflected;
  for (const std::size_t i : {0u, 7u, 16u, 23u}) {
    const LayerState at = state_of(coat, i);
    const SlabTotals totals =
        adding_doubling(
            LayerStack({{.medium = {at.sigma_a, at.sigma_s, at.g, 1.5}, .thickness = at.thickness}},
                       1.0, 1.5, {.reflectance = 0.4}))
            .totals;
    EXPECT_NEAR(seen.values[i], totals.diffuse_reflectance / (1.0 - totals.specular_reflectance),
                1e-3)
        << at.thickness;
  }
}

// A rough surface, by adding-doubling of the same at two places.
TEST(VariedStates, RoughSurfacesReturnAsMuchFromInsideAsTheyDo) {
  LayerTexels stone = uniform_texels({.sigma_a = 0.01, .sigma_s = 2.6, .roughness = 0.0});
  stone.roughness.clear();
  for (std::size_t i = 0; i < texels; ++i)
    stone.roughness.push_back(0.3f + 0.1f * static_cast<float>(i % side) / (side - 1));
  Varied varied{{1.0, {{2.6, 0.0, 1.5, infinite}}, 1.5}, {stone}};
  varied = with_lattices(varied);
  const Plane seen = far_apart(varied, OperatorTotals::radiative_transfer).reflected;
  for (const std::size_t i : {5u, 23u}) {
    const Layer rough{.medium = {0.01, 2.6, 0.0, 1.5},
                      .top = {.roughness = static_cast<double>(stone.roughness[i])}};
    const SlabTotals totals = adding_doubling(LayerStack({rough}, 1.0, 1.5)).totals;
    EXPECT_NEAR(seen.values[i], totals.diffuse_reflectance / (1.0 - totals.specular_reflectance),
                1e-3)
        << i;
  }
}

// Random maps of coats without absorption, each texel of .05 mm unlike the next: what comes back is
// what came in, though the profile of the exit point does not keep light by itself. At single
// texels a little more may come back, as where a coat is thin beside thick ones.
TEST(VariedStates, NoMoreLightComesBackThanCameIn) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform;
  Varied varied = paint_on_stone();
  for (LayerTexels& layer : varied.layers) layer.sigma_a = {1e-6f};
  for (float& d : varied.layers[0].thickness) d = 0.02f * std::pow(25.0f, uniform(random));
  for (float& s : varied.layers[1].sigma_s) s = 0.6f * std::pow(10.0f, uniform(random));
  varied = with_lattices(varied);
  for (const OperatorTotals totals :
       {OperatorTotals::diffusion, OperatorTotals::radiative_transfer}) {
    const StackTables tables = make_stack_tables(varied.stack, totals);
    const auto layers =
        make_heterogeneous_layers(tables, side, side, varied.layers, no_sheets(varied), 0.05);
    const Plane seen = transport(layers, make_plane(side, side, 1.0f)).reflected;
    double sum = 0.0;
    for (const float value : seen.values) sum += static_cast<double>(value);
    const float largest = *std::ranges::max_element(seen.values);
    EXPECT_LT(largest, 1.03f);
    EXPECT_LT(sum / texels, 1.0);
    EXPECT_GT(sum / texels, 0.98);
  }
}

/// Half of a period so, half otherwise, under full light; both by transport and by photons who know
/// no layers. The error is the root mean square over the mean, the photons' noise taken out.
double error_at_steps(const LayerState& coat, const LayerState& other_coat, const LayerState& base,
                      const LayerState& other_base, OperatorTotals totals, std::uint64_t photons) {
  constexpr std::size_t columns = 48;
  constexpr int rows = 16;
  constexpr double texel = 0.1, period = texel * columns;
  const auto is_first = [](std::size_t column) {
    return columns / 4 <= column && column < columns - columns / 4;
  };
  Varied varied{{1.0, {{1.0, 0.0, 1.5, coat.thickness}, {1.0, 0.0, 1.5, infinite}}, 1.5}, {{}, {}}};
  for (std::size_t i = 0; i < columns * rows; ++i) {
    const bool first = is_first(i % columns);
    const std::array<LayerState, 2> states = {first ? coat : other_coat, first ? base : other_base};
    for (std::size_t l = 0; l < 2; ++l) {
      LayerTexels& to = varied.layers[l];
      to.sigma_a.push_back(static_cast<float>(states[l].sigma_a));
      to.sigma_s.push_back(static_cast<float>(states[l].sigma_s));
      to.g.push_back(static_cast<float>(states[l].g));
      to.thickness.push_back(static_cast<float>(states[l].thickness));
      to.roughness.push_back(0.0f);
    }
  }
  varied = with_lattices(varied);
  const auto layers =
      make_heterogeneous_layers(make_stack_tables(varied.stack, totals), columns, rows,
                                varied.layers, {make_plane(columns, rows)}, texel);
  const Plane seen = transport(layers, make_plane(columns, rows, 1.0f)).reflected;

  const auto largest = [](const LayerState& a, const LayerState& b) {
    return std::max(a.sigma_a + a.sigma_s, b.sigma_a + b.sigma_s);
  };
  const double deepest = std::max(coat.thickness, other_coat.thickness);
  const auto medium = [&](double x, double z) {
    const bool first = is_first(static_cast<std::size_t>(x / texel) % columns);
    const LayerState& top = first ? coat : other_coat;
    return z < top.thickness ? top : first ? base : other_base;
  };
  const double in_base = largest(base, other_base);
  const auto truth = reference::trace_varied_body(
      {.ior = 1.5,
       .period = period,
       .medium = medium,
       .majorants = {{0.0, std::max(in_base, largest(coat, other_coat))}, {deepest, in_base}}},
      columns, photons, 5);
  double square = 0.0, noise = 0.0, sum = 0.0;
  for (std::size_t x = 0; x < columns; ++x) {
    // Both halves of the period are mirror images of each other.
    const double wanted = 0.5 * (truth.reflected[x] + truth.reflected[columns - 1 - x]);
    square += std::pow(static_cast<double>(seen.values[columns * 8 + x]) - wanted, 2);
    noise += 0.5 * std::pow(truth.standard_error[x], 2);
    sum += wanted;
  }
  EXPECT_TRUE(std::isfinite(square));
  return std::sqrt(std::max(0.0, square - noise) * columns) / sum;
}

// Half-planes 2.4 mm wide. Photons cross from one to the other, and light of full strength shows
// only the edges: so these are errors of the model, which takes the profile where light comes out.
TEST(VariedStates, StepsAreNearThoseOfPhotons) {
  const LayerState thin{.sigma_a = 0.05, .sigma_s = 25.0, .g = 0.4, .thickness = 0.05};
  const LayerState thick{.sigma_a = 0.05, .sigma_s = 25.0, .g = 0.4, .thickness = 0.2};
  const LayerState dark{.sigma_a = 0.5, .sigma_s = 25.0, .g = 0.4, .thickness = 0.1};
  const LayerState dense{.sigma_a = 0.1, .sigma_s = 60.0, .g = 0.4, .thickness = 0.1};
  const LayerState clear{.sigma_a = 0.1, .sigma_s = 15.0, .g = 0.4, .thickness = 0.1};
  const LayerState stone{.sigma_a = 0.05, .sigma_s = 3.0, .g = 0.0};
  const LayerState dense_stone{.sigma_a = 0.05, .sigma_s = 9.0, .g = 0.0};
  const char* photons_wanted = std::getenv("LAMINA_TABLE_PHOTONS");
  const std::uint64_t photons = photons_wanted ? std::stoull(photons_wanted) : 30'000;
  const struct {
    const char* what;
    LayerState coat, other_coat, base, other_base;
    double allowed;  ///< of radiative transfer
  } cases[] = {{"thickness of a coat", thin, thick, stone, stone, 0.05},
               {"scattering of a coat", dense, clear, stone, stone, 0.05},
               {"scattering below a coat", thin, thin, stone, dense_stone, 0.06},
               {"absorption of a coat", dark, clear, stone, stone, 0.08}};
  for (const auto& [what, coat, other_coat, base, other_base, allowed] : cases) {
    const auto error = [&](OperatorTotals totals) {
      return error_at_steps(coat, other_coat, base, other_base, totals, photons);
    };
    const double transfer = error(OperatorTotals::radiative_transfer);
    EXPECT_LT(transfer, allowed) << what;
    if (!photons_wanted) continue;
    std::printf("| %s | %.1f %% | %.1f %% | %.1f %% |\n", what,
                100.0 * error(OperatorTotals::diffusion), 100.0 * transfer,
                100.0 * error(OperatorTotals::radiative_transfer_profile));
  }
}

}  // namespace
}  // namespace lamina
