// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/transport_gradient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double mm_per_texel = 0.055;

/// Numbers in [low, high], each texel unlike the next.
template <class T>
PlaneOf<T> noise(int width, int height, unsigned seed, double low = -1.0, double high = 1.0) {
  PlaneOf<T> plane = make_plane<T>(width, height);
  std::mt19937 random(seed);
  for (T& value : plane.values)
    value = static_cast<T>(std::uniform_real_distribution<double>(low, high)(random));
  return plane;
}

template <class T>
double dot(const PlaneOf<T>& a, const PlaneOf<T>& b) {
  return std::inner_product(a.values.begin(), a.values.end(), b.values.begin(), 0.0);
}
template <class T>
double dot(const TransportMaps<T>& a, const TransportMaps<T>& b) {
  double sum = dot(a.irradiance, b.irradiance);
  for (std::size_t i = 0; i < a.sigma_a.size(); ++i) sum += dot(a.sigma_a[i], b.sigma_a[i]);
  for (std::size_t i = 0; i < a.absorbance.size(); ++i)
    sum += dot(a.absorbance[i], b.absorbance[i]);
  return sum;
}

struct Case {
  std::string name;
  MappedStack stack;
  std::vector<AbsorptionRange> ranges;
  DifferentiableOptions options = {};
  int width = 24, height = 20;
  int stripe = 0;  ///< width of stripes of which each second is dark [texel]; 0: noise
};

/// One layer, two, a fold of three, a ground, bright layers whose closure takes what is around.
std::vector<Case> cases() {
  const MappedLayer epidermis{14.0, 0.8, 1.4, 0.25}, dermis{7.0, 0.8, 1.38, infinite};
  const MappedLayer thin_dermis{7.0, 0.8, 1.38, 1.5};
  const AbsorptionRange dark{0.1, 1.2}, pale{0.02, 0.2};
  return {
      {"slab", {1.0, {{14.0, 0.8, 1.4, 0.8}}, 1.2}, {dark}},
      {"skin", {1.0, {epidermis, dermis}, 1.38}, {dark, pale}},
      // Edges, and sides that are odd.
      {"stripes", {1.0, {epidermis, dermis}, 1.38}, {dark, pale}, {}, 63, 21, 16},
      {"skin, by the exit",
       {1.0, {epidermis, dermis}, 1.38},
       {dark, pale},
       {.transport = {.interlayer_bounces = 1}, .profile = ProfileAt::exit}},
      {"fold", {1.0, {epidermis, thin_dermis, epidermis}, 1.0}, {dark, pale, dark}},
      {"ground", {1.0, {epidermis}, 1.4, 0.6}, {dark}},
      {"paint on stone",
       {1.0, {{60.0, 0.5, 1.5, 0.1}, {40.0, 0.8, 1.5, infinite}}, 1.5},
       {{0.001, 0.01}, {0.001, 0.01}}},
  };
}

StackTables tables_of(const Case& at) {
  return make_stack_tables(at.stack, OperatorTotals::diffusion, {},
                           {.lowest = 1e-3, .highest = 10.0, .rows = 32});
}

template <class T>
TransportMaps<T> maps_of(const Case& at) {
  TransportMaps<T> maps{{}, {}, noise<T>(at.width, at.height, 1, 0.0, 1.0)};
  for (unsigned i = 0; i < at.ranges.size(); ++i) {
    const auto& [low, high] = at.ranges[i];
    PlaneOf<T>& map =
        maps.sigma_a.emplace_back(noise<T>(at.width, at.height, 10 + i, 1.1 * low, 0.9 * high));
    for (int t = 0; at.stripe > 0 && t < at.width * at.height; ++t) {
      const int x = t % at.width, y = t / at.width;
      const double unlike_neighbors = 1.0 + 0.001 * ((5 * x + 3 * y) % 11);
      map.values[static_cast<std::size_t>(t)] =
          static_cast<T>(unlike_neighbors * (x / at.stripe % 2 > 0 ? 0.9 * high : 1.1 * low));
    }
    if (i > 0) maps.absorbance.push_back(noise<T>(at.width, at.height, 20 + i, 0.0, 0.3));
  }
  return maps;
}

template <class T>
TransportMaps<T> direction_of(const TransportMaps<T>& maps, unsigned seed) {
  TransportMaps<T> direction = maps;
  const auto vary = [&](PlaneOf<T>& plane) {
    const PlaneOf<T> factors = noise<T>(plane.width, plane.height, seed++);
    for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] *= factors.values[i];
  };
  for (PlaneOf<T>& plane : direction.sigma_a) vary(plane);
  for (PlaneOf<T>& plane : direction.absorbance) vary(plane);
  vary(direction.irradiance);
  return direction;
}

TransportMaps<double> moved(TransportMaps<double> maps, const TransportMaps<double>& direction,
                            double step) {
  const auto move = [&](PlaneOf<double>& plane, const PlaneOf<double>& by) {
    for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] += step * by.values[i];
  };
  for (std::size_t i = 0; i < maps.sigma_a.size(); ++i) move(maps.sigma_a[i], direction.sigma_a[i]);
  for (std::size_t i = 0; i < maps.absorbance.size(); ++i)
    move(maps.absorbance[i], direction.absorbance[i]);
  move(maps.irradiance, direction.irradiance);
  return maps;
}

// The light is linear in what arrives: <f(x), y> = <x, f^T(y)>.
TEST(TransportGradient, IsTheTransposeOfTheLight) {
  for (const Case& at : cases()) {
    DifferentiableTransport<double> model(tables_of(at), at.width, at.height, at.ranges,
                                          mm_per_texel, at.options);
    const TransportMaps<double> maps = maps_of<double>(at);
    const TransportLight<double> light = model.light(maps);
    const TransportLight<double> y{noise<double>(at.width, at.height, 2),
                                   noise<double>(at.width, at.height, 3)};
    const double forward =
        dot(light.reflected, y.reflected) + dot(light.transmitted, y.transmitted);
    const double back = dot(maps.irradiance, model.gradient(y).irradiance);
    double size = 0.0;  // of the sums' terms
    for (std::size_t i = 0; i < y.reflected.values.size(); ++i)
      size += std::abs(light.reflected.values[i] * y.reflected.values[i]);
    EXPECT_NEAR(forward, back, 1e-12 * size) << at.name;
  }
}

// A loss that is not linear in the light, along random directions of all maps.
TEST(TransportGradient, IsThatOfCentralDifferences) {
  for (const Case& at : cases()) {
    DifferentiableTransport<double> model(tables_of(at), at.width, at.height, at.ranges,
                                          mm_per_texel, at.options);
    const PlaneOf<double> wanted = noise<double>(at.width, at.height, 4, 0.0, 0.4);
    const auto loss = [&](const TransportLight<double>& light) {
      double sum = 0.0;
      for (std::size_t i = 0; i < wanted.values.size(); ++i)
        sum += std::pow(light.reflected.values[i] - wanted.values[i], 2) +
               wanted.values[i] * light.transmitted.values[i];
      return sum;
    };
    const TransportMaps<double> maps = maps_of<double>(at);
    TransportLight<double> by_light{model.light(maps).reflected, wanted};
    for (std::size_t i = 0; i < wanted.values.size(); ++i)
      by_light.reflected.values[i] = 2.0 * (by_light.reflected.values[i] - wanted.values[i]);
    const TransportMaps<double> gradient = model.gradient(by_light);
    for (const unsigned seed : {100u, 200u}) {
      // All maps; and absorption alone, whose part is small beside that of the light.
      TransportMaps<double> direction = direction_of(maps, seed);
      if (seed == 200u) std::ranges::fill(direction.irradiance.values, 0.0);
      const double h = at.stripe > 0 ? 1e-6 : 1e-4;  // so small that no kink is crossed
      const auto at_step = [&](double step) {
        return loss(model.light(moved(maps, direction, step)));
      };
      const double difference =
          (8.0 * (at_step(h) - at_step(-h)) - (at_step(2.0 * h) - at_step(-2.0 * h))) / (12.0 * h);
      const double slope = dot(gradient, direction);
      EXPECT_NEAR(slope, difference, 1e-6 * std::abs(difference)) << at.name << ' ' << seed;
      EXPECT_GT(std::abs(difference), 1e-4) << at.name;
    }
  }
}

// <J v, y> = <v, J^T y>, and J v is what the light changes by.
TEST(TransportGradient, ChangesOfTheLightAreItsTranspose) {
  for (const Case& at : cases()) {
    DifferentiableTransport<double> model(tables_of(at), at.width, at.height, at.ranges,
                                          mm_per_texel, at.options);
    const TransportMaps<double> maps = maps_of<double>(at);
    const TransportMaps<double> direction = direction_of(maps, 300);
    const double h = at.stripe > 0 ? 1e-6 : 1e-4;
    const TransportLight<double> ahead = model.light(moved(maps, direction, h));
    const TransportLight<double> behind = model.light(moved(maps, direction, -h));
    (void)model.light(maps);
    const TransportLight<double> y{noise<double>(at.width, at.height, 2),
                                   noise<double>(at.width, at.height, 3)};
    const TransportLight<double> change = model.tangent(direction);
    const double size =
        std::sqrt(dot(change.reflected, change.reflected) * dot(y.reflected, y.reflected));
    EXPECT_NEAR(dot(change.reflected, y.reflected) + dot(change.transmitted, y.transmitted),
                dot(direction, model.gradient(y)), 1e-12 * size)
        << at.name;
    for (std::size_t i = 0; i < change.reflected.values.size(); ++i) {
      const auto slope = [&](const PlaneOf<double>& high, const PlaneOf<double>& low) {
        return (high.values[i] - low.values[i]) / (2.0 * h);
      };
      ASSERT_NEAR(change.reflected.values[i], slope(ahead.reflected, behind.reflected), 1e-6)
          << at.name;
      ASSERT_NEAR(change.transmitted.values[i], slope(ahead.transmitted, behind.transmitted), 1e-6)
          << at.name;
    }
    // Maps that do not change can be left out.
    const TransportLight<double> light = model.tangent({{}, {}, maps.irradiance});
    const TransportLight<double> wanted = model.light(maps);
    for (std::size_t i = 0; i < wanted.reflected.values.size(); ++i)
      ASSERT_NEAR(light.reflected.values[i], wanted.reflected.values[i], 1e-14) << at.name;
  }
}

// With the ranges that maps have, the light is that of make_heterogeneous_layers.
TEST(TransportGradient, LightIsThatOfTheTransport) {
  for (const Case& at : cases()) {
    const StackTables tables = tables_of(at);
    const TransportMaps<float> maps = maps_of<float>(at);
    const HeterogeneousLayers layers = make_heterogeneous_layers(
        tables, maps.sigma_a, maps.absorbance, mm_per_texel, at.options.profile);
    const TransportResult wanted = transport(layers, maps.irradiance, at.options.transport);
    DifferentiableTransport<float> model(tables, at.width, at.height, at.ranges, mm_per_texel,
                                         at.options);
    const TransportLight<float> light = model.light(maps);
    for (std::size_t i = 0; i < wanted.reflected.values.size(); ++i) {
      // Two ranges differ by what profiles of rank two miss.
      ASSERT_NEAR(light.reflected.values[i], wanted.reflected.values[i], 2e-3) << at.name;
      ASSERT_NEAR(light.transmitted.values[i], wanted.transmitted.values[i], 1e-3) << at.name;
    }
  }
}

TEST(TransportGradient, IsTheSameInFloats) {
  const Case at = cases()[1];
  const StackTables tables = tables_of(at);
  DifferentiableTransport<double> exact(tables, at.width, at.height, at.ranges, mm_per_texel);
  DifferentiableTransport<float> fast(tables, at.width, at.height, at.ranges, mm_per_texel);
  (void)exact.light(maps_of<double>(at));
  (void)fast.light(maps_of<float>(at));
  const auto wanted = exact.gradient({noise<double>(at.width, at.height, 2), {}});
  const auto gradient = fast.gradient({noise<float>(at.width, at.height, 2), {}});
  for (std::size_t l = 0; l < 2; ++l) {
    const double size = std::sqrt(dot(wanted.sigma_a[l], wanted.sigma_a[l]) / (24.0 * 20.0));
    for (std::size_t i = 0; i < wanted.sigma_a[l].values.size(); ++i)
      ASSERT_NEAR(gradient.sigma_a[l].values[i], wanted.sigma_a[l].values[i], 1e-3 * size);
  }
}

TEST(TransportGradient, RefusesLayersOfWhichMoreVaries) {
  LayerTexels texels = uniform_texels({.sigma_a = 0.1, .sigma_s = 10.0, .g = 0.5, .thickness = 1});
  texels.sigma_s = {5.0f, 10.0f, 20.0f};
  MappedStack stack{1.0, {{10.0, 0.5, 1.4, 1.0}}, 1.0};
  stack.layers[0].states = fit_lattice(texels);
  const StackTables tables = make_stack_tables(stack, OperatorTotals::diffusion);
  const AbsorptionRange range{0.1, 0.1};
  EXPECT_THROW(DifferentiableTransport<float>(tables, 8, 8, std::span(&range, 1), 0.1),
               InvalidInput);
}

}  // namespace
}  // namespace lamina
