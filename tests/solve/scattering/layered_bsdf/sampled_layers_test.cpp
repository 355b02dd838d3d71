// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/sampled_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"
#include "solve/scattering/only_target.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double albedo, double tau, double g, double ior) {
  return {.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = g, .ior = ior},
          .thickness = tau};
}

/// A stack as the renderer has it: one for all bands but for the albedo of the first layer.
struct Case {
  std::vector<LayerStack> bands;
  double theta_o;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](double theta_o, auto make) {
    Case& one = all.emplace_back(Case{{}, theta_o});
    for (const double albedo : {0.9, 0.6, 0.3}) one.bands.push_back(make(albedo));
  };
  add(0.3, [](double a) { return LayerStack({layer(a, infinite, 0.0, 1.0)}); });
  add(1.53, [](double a) { return LayerStack({layer(a, infinite, 0.0, 1.4)}, 1.0, 1.4); });
  add(1.4, [](double a) { return LayerStack({layer(a, infinite, 0.9, 1.0)}); });
  add(1.55, [](double a) { return LayerStack({layer(a, 0.5, 0.8, 1.33)}); });
  add(0.5, [](double a) { return LayerStack({layer(a, 0.5, 0.9, 1.33)}, 1.0, 1.5); });
  add(pi - 1.0, [](double a) { return LayerStack({layer(a, 0.5, 0.7, 1.33)}); });
  add(0.8, [](double a) {
    return LayerStack(
        {layer(a, 0.3, 0.8, 1.5), layer(0.8, 0.4, -0.4, 1.33), layer(0.9, infinite, 0.6, 1.4)}, 1.0,
        1.4);
  });
  return all;
}

Vec3 direction(double mu, double phi) {
  const double sine = std::sqrt(std::max(0.0, 1.0 - mu * mu));
  return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

struct Prepared {
  explicit Prepared(const Case& from)
      : stack(make_first_order<4>(from.bands)), wo(direction(std::cos(from.theta_o), 0.4)) {
    std::vector<HigherOrders> orders;
    for (const LayerStack& band : from.bands) orders.push_back(make_higher_orders(band));
    higher = make_higher_order_bands<4>(orders);
  }
  FirstOrderStack<BandValues<4>> stack;
  HigherOrderBands<4> higher;
  Vec3 wo;
};

const std::vector<Prepared>& prepared_cases() {
  static const std::vector<Prepared> all = [] {
    std::vector<Prepared> made;
    for (const Case& one : cases()) made.emplace_back(one);
    return made;
  }();
  return all;
}

/// Henyey and Greenstein's density in double precision, from the directions themselves.
double phase_between(double g, const Vec3& from, const Vec3& to) {
  const Vec3 apart = to - from;
  const double d = (1.0 - g) * (1.0 - g) + g * dot(apart, apart);
  return (1.0 - g * g) / (4.0 * pi * d * std::sqrt(d));
}

// Through a thin slab of matched index, near and at the peak of the phase function: the first order
// and the density of what is drawn, in single precision against double.
TEST(SampledLayers, KeepsTheForwardPeak) {
  for (const double g : {0.9, 0.995, 0.999}) {
    const double tau = 0.01;
    const std::vector<LayerStack> bands = {LayerStack({layer(1.0, tau, g, 1.0)})};
    const FirstOrderStack<BandValues<4>> stack = make_first_order<4>(bands);
    const Vec3 wo = direction(std::cos(0.7), 0.4);
    const SampledLayers<4> layers(stack, nullptr, wo);
    double phase_chance = 0.0;
    for (const double off : {0.0, 1e-4, 1e-3, 0.01, 0.1}) {
      const Vec3 wi = -direction(std::cos(0.7 + off), 0.4 + 2.0 * off);
      const auto value = layers.evaluate(wi);
      const double mu_i = -wi.z, mu_o = wo.z, phase = phase_between(g, -wi, wo);
      const double a = tau / mu_i, b = tau / mu_o;
      const double attenuation =
          std::abs(a - b) < 1e-9 ? std::exp(-a) : (std::exp(-a) - std::exp(-b)) / (b - a);
      EXPECT_NEAR(static_cast<double>(value.bsdf[0]) / (phase * tau * attenuation / (mu_i * mu_o)),
                  1.0, 1e-3)
          << g << ' ' << off;
      // The density is phase_chance times the phase function, and the cosine for either side.
      const double share =
          (static_cast<double>(value.pdf) - 0.5 * mu_i / pi) / (phase - 0.5 * mu_i / pi);
      if (off == 0.0) phase_chance = share;
      if (off <= 0.01) {
        EXPECT_NEAR(share / phase_chance, 1.0, 1e-3) << g << ' ' << off;
      }
    }
    EXPECT_NEAR(phase_chance, 0.5 * g, 0.05);
  }
}

// What is drawn by the phase function has its quantiles: half of the light turns by less than the
// angle at which the distribution of Henyey and Greenstein is 1/2, and so on.
TEST(SampledLayers, DrawsTheForwardPeak) {
  for (const double g : {0.995, 0.999}) {
    const std::vector<LayerStack> bands = {LayerStack({layer(1.0, 0.01, g, 1.0)})};
    const FirstOrderStack<BandValues<4>> stack = make_first_order<4>(bands);
    const Vec3 wo = direction(std::cos(0.7), 0.4);
    const SampledLayers<4> layers(stack, nullptr, wo);
    for (const double part : {0.02, 0.1, 0.5, 0.9, 0.98}) {
      // u below phase_chance draws by the phase function; u1 is the part of the light that turns by
      // less. q = (1 - g^2) / (1 + g - 2 g u1), 1 - cos = (q^2 - (1 - g)^2) / (2 g).
      const auto drawn = layers.sample(0.01f, static_cast<float>(part), 0.3f);
      const double q = (1.0 - g * g) / (1.0 + g - 2.0 * g * part);
      const double expected = (q - (1.0 - g)) * (q + (1.0 - g)) / (2.0 * g);
      const Vec3 apart = wo + drawn.wi;
      EXPECT_NEAR(0.5 * dot(apart, apart) / expected, 1.0, 2e-3) << g << ' ' << part;
    }
  }
}

// Chi-square over cells of direction; what is not drawn is one more cell. Significance 1e-3 each.
TEST(SampledLayers, DirectionsComeWithTheirDensity) {
  constexpr int cosines = 16, azimuths = 8, draws = 40'000;
  for (const Prepared& prepared : prepared_cases()) {
    const SampledLayers<4> layers(prepared.stack, &prepared.higher, prepared.wo);
    std::vector<double> expected(2 * cosines * azimuths + 1, 0.0);
    const Quadrature rule = gauss_legendre(6, 0.0, 1.0);
    double rest = 1.0;
    for (int i = -cosines; i < cosines; ++i) {
      if (i < 0 && !prepared.stack.is_transmissive()) continue;
      for (int j = 0; j < azimuths; ++j) {
        double sum = 0.0;
        for (std::size_t p = 0; p < rule.nodes.size(); ++p)
          for (std::size_t q = 0; q < rule.nodes.size(); ++q)
            sum += rule.weights[p] * rule.weights[q] *
                   static_cast<double>(
                       layers
                           .evaluate(direction((i + rule.nodes[p]) / cosines,
                                               2.0 * pi * (j + rule.nodes[q]) / azimuths))
                           .pdf);
        const double share = sum * 2.0 * pi / azimuths / cosines;
        expected[static_cast<std::size_t>((i + cosines) * azimuths + j)] = share * draws;
        rest -= share;
      }
    }
    ASSERT_GT(rest, -1e-3);
    expected.back() = std::max(rest, 0.0) * draws;
    std::vector<int> drawn(expected.size(), 0);
    Random random(7);
    for (int k = 0; k < draws; ++k) {
      const auto sample =
          layers.sample(random.uniform_float(), random.uniform_float(), random.uniform_float());
      std::size_t cell = expected.size() - 1;
      if (sample.value.pdf > 0.0f) {
        const int i = std::min(static_cast<int>(std::floor(sample.wi.z * cosines)), cosines - 1);
        const double phi = std::atan2(sample.wi.y, sample.wi.x);
        const int j =
            std::min(static_cast<int>((phi < 0.0 ? phi + 2.0 * pi : phi) / (2.0 * pi) * azimuths),
                     azimuths - 1);
        cell = static_cast<std::size_t>((i + cosines) * azimuths + j);
      }
      ++drawn[cell];
    }
    double chi2 = 0.0, few_expected = 0.0, few_drawn = 0.0;
    int cells = 0;
    for (std::size_t c = 0; c < expected.size(); ++c) {
      if (expected[c] < 10.0) {
        few_expected += expected[c];
        few_drawn += drawn[c];
        continue;
      }
      chi2 += (drawn[c] - expected[c]) * (drawn[c] - expected[c]) / expected[c];
      ++cells;
    }
    EXPECT_NEAR(few_drawn, few_expected, 4.0 * std::sqrt(few_expected) + 5.0);
    EXPECT_LT(chi2, cells + 3.1 * std::sqrt(2.0 * cells) + 10.0)
        << "theta_o " << std::acos(prepared.wo.z);
  }
}

// The mean of bsdf * cosine / pdf is the light that leaves to wo of uniform radiance around.
TEST(SampledLayers, SamplesAddUpToTheFlux) {
  for (const Prepared& prepared : prepared_cases()) {
    if (prepared.wo.z < 0.0) continue;  // the rows are of light from above
    const SampledLayers<4> layers(prepared.stack, &prepared.higher, prepared.wo);
    Random random(3);
    double sum = 0.0, squares = 0.0;
    constexpr int draws = 40'000;
    for (int k = 0; k < draws; ++k) {
      const auto sample =
          layers.sample(random.uniform_float(), random.uniform_float(), random.uniform_float());
      if (!(sample.value.pdf > 0.0f)) continue;
      const double n_out = prepared.stack.ior_above[0];
      const double n_in =
          sample.wi.z > 0.0 ? n_out : static_cast<double>(prepared.stack.ior_below[0]);
      const double weight = static_cast<double>(sample.value.bsdf[1] / sample.value.pdf) *
                            std::abs(sample.wi.z) * n_in * n_in / (n_out * n_out);
      sum += weight;
      squares += weight * weight;
    }
    const double mean = sum / draws;
    const double error = std::sqrt((squares / draws - mean * mean) / draws);
    // By reciprocity what leaves of a beam from wo, to both sides.
    const auto& beam = layers.beam();
    const double expected = static_cast<double>(
        (1.0f - beam.surface[1]) * (value_at(prepared.higher.reflected, beam.mu[0]) +
                                    value_at(prepared.higher.transmitted, beam.mu[0]))[1]);
    EXPECT_NEAR(mean, expected, 4.0 * error + 1e-3) << "theta_o " << std::acos(prepared.wo.z);
    EXPECT_LT(error, 0.02 * mean);
  }
}

// By every set of instructions that this processor has.
TEST(SampledLayers, ValuesAreThoseOfTheSolversInDouble) {
  for (std::size_t c = 0; c < cases().size(); ++c) {
    const Case one = cases()[c];
    const Prepared& prepared = prepared_cases()[c];
    const auto stack = make_first_order(one.bands[2]);
    const HigherOrders higher = make_higher_orders(one.bands[2]);
    for (const double mu : {0.9, 0.2, -0.5}) {
      if (mu < 0.0 && !stack.is_transmissive()) continue;
      const Vec3 wi = direction(mu, 1.0);
      const auto in = make_beam(stack, wi), out = make_beam(stack, prepared.wo);
      const double expected =
          first_order_bsdf(stack, in, out) + higher_orders_bsdf(higher, in, out);
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        const OnlyTarget only(target);
        const SampledLayers<4> layers(prepared.stack, &prepared.higher, prepared.wo);
        EXPECT_NEAR(static_cast<double>(layers.evaluate(wi).bsdf[2]), expected, 1e-4 * expected)
            << hwy::TargetName(target);
      }
    }
  }
}

// Up to six layers of one index share their directions in one step; more go one after the other.
TEST(SampledLayers, AnyNumberOfLayersAndBandsGivesTheSameValues) {
  for (const std::size_t count : {1u, 4u, 6u, 7u, 12u}) {
    std::vector<Layer> layers;
    for (std::size_t k = 0; k < count; ++k)
      layers.push_back(layer(0.5 + 0.04 * static_cast<double>(k), 0.2, 0.5,
                             1.3 + 0.05 * static_cast<double>(k % 3)));
    const LayerStack stack(layers, 1.0, 1.4);
    const auto first = make_first_order(stack);
    const auto bands = make_first_order<16>(std::span(&stack, 1));
    for (const Vec3& wo : {direction(0.7, 0.0), direction(-0.3, 0.0)})
      for (const double mu : {1.0, 0.4, 1e-3, -0.8}) {
        const Vec3 wi = direction(mu, 2.0);
        const double expected = first_order_bsdf(first, make_beam(first, wi), make_beam(first, wo));
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
          const OnlyTarget only(target);
          const SampledLayers<16> seen(bands, nullptr, wo);
          const auto value = seen.evaluate(wi);
          EXPECT_NEAR(static_cast<double>(value.bsdf[15]), expected, 1e-4 * expected)
              << count << " layers, mu " << mu << ", " << hwy::TargetName(target);
        }
      }
  }
}

}  // namespace
}  // namespace lamina
