// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/correction_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <vector>

#include "lamina/base/core/random.h"

namespace lamina {
namespace {

using Ratio = DirectionalRatio<4>;

/// Places on a lattice of a plane, 1 mm apart.
std::vector<PlaceGraph::Place> lattice_of_places(int side) {
  std::vector<PlaceGraph::Place> places;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      places.push_back({{{static_cast<float>(x), static_cast<float>(y), 0.0f}, {0, 0, 1}}, 1.0f});
  return places;
}

Vec3f random_direction(Random& random) {
  const float z = std::sqrt(random.uniform_float()), phi = 6.2831853f * random.uniform_float();
  const float r = std::sqrt(1.0f - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A ratio that changes along x by a wave of 40 mm, and with the direction.
Ratio true_ratio(const Vec3f& place) {
  Ratio ratio{};
  const float wave = 1.2f + 0.3f * std::sin(6.2831853f * place.x / 40.0f);
  for (int b = 0; b < 4; ++b) {
    ratio[0][b] = wave - 0.1f * static_cast<float>(b);
    ratio[1][b] = -0.05f;
    ratio[2][b] = 0.2f;
  }
  return ratio;
}

/// Samples of that ratio to planar light that changes from place to place.
std::vector<std::vector<WalkedSample<4>>> noisy_samples(
    const std::vector<PlaceGraph::Place>& places, int count, float noise) {
  std::vector<std::vector<WalkedSample<4>>> samples(places.size());
  Random random(7);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float light = 1.0f + 0.5f * std::cos(2.0f * places[i].at.position.y);
    for (int s = 0; s < count; ++s) {
      const DirectionTerms terms =
          direction_terms_of(random_direction(random), places[i].at.normal, 1.4f);
      const auto planar = BandValues<4>::filled(light);
      BandValues<4> walked = planar * evaluate(true_ratio(places[i].at.position), terms);
      for (int b = 0; b < 4; ++b)
        walked[b] *= 1.0f + noise * (2.0f * random.uniform_float() - 1.0f);
      samples[i].push_back({terms, walked, planar});
    }
  }
  return samples;
}

TEST(PlaceGraph, SpreadsWithoutLossAndNotAroundAnEdge) {
  // Two sides of a wall, .1 mm thick.
  std::vector<PlaceGraph::Place> places = lattice_of_places(12);
  const std::size_t front = places.size();
  for (std::size_t i = 0; i < front; ++i) {
    PlaceGraph::Place behind = places[i];
    behind.at.position.z = -0.1f;
    behind.at.normal = {0, 0, -1};
    places.push_back(behind);
  }
  const PlaceGraph graph(places);
  std::vector<BandValues<4>> values(places.size());
  values[5] = BandValues<4>::filled(3.0f);
  for (int step = 0; step < 20; ++step) values = graph.spread(values);
  double before = 0.0, behind = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i)
    (i < front ? before : behind) += static_cast<double>(values[i][2]);
  EXPECT_NEAR(before, 3.0, 1e-4);
  EXPECT_EQ(behind, 0.0);
  EXPECT_LT(values[5][0], 0.2f);
  EXPECT_GT(values[front - 1][0], 0.0f);
}

TEST(PlaceGraph, FindsPlacesThatAreFarApartBesideCloseOnes) {
  std::vector<PlaceGraph::Place> places = lattice_of_places(6);
  for (int x = 4; x < 8; ++x)  // 4 mm apart
    places.push_back({{{4.0f * static_cast<float>(x), 2.0f, 0.0f}, {0, 0, 1}}, 4.0f});
  const PlaceGraph graph(places);
  const auto far = graph.weights_at({26, 2, 0}, {0, 0, 1});
  ASSERT_GT(far.count, 0u);
  float sum = 0.0f;
  for (std::size_t k = 0; k < far.count; ++k) {
    EXPECT_GE(far.point[k], 36u);
    sum += far.weight[k];
  }
  EXPECT_NEAR(sum, 1.0f, 1e-5f);
}

// Both sum the same products of planar light, terms and ratios.
TEST(PlanarSums, WouldBeWalkedAsTheirProductsSay) {
  Random random(5);
  PlanarSums<4> planar;
  for (int s = 0; s < 20; ++s)
    planar.add(direction_terms_of(random_direction(random), {0, 0, 1}, 1.4f),
               BandValues<4>::filled(random.uniform_float()));
  Ratio a{}, b{};
  for (std::size_t k = 0; k < direction_terms; ++k) {
    a[k] = BandValues<4>::filled(random.uniform_float() - 0.3f);
    b[k] = BandValues<4>::filled(random.uniform_float() - 0.3f);
  }
  float sum = 0.0f;
  const WalkedSums<4> walked = planar.product(a);
  for (std::size_t k = 0; k < direction_terms; ++k) sum += walked.of[k][1] * b[k][1];
  EXPECT_NEAR(sum, planar.product(a, b)[1], 1e-4f * std::abs(sum));
}

TEST(FitCorrection, FindsARatioThatSamplesHoldWithoutNoise) {
  // The same at all places: no width smooths anything away.
  const auto places = lattice_of_places(10);
  auto samples = noisy_samples(places, 32, 0.0f);
  const Ratio expected = true_ratio({10, 0, 0});
  for (auto& of_place : samples)
    for (auto& sample : of_place) sample.walked = sample.planar * evaluate(expected, sample.terms);
  const std::vector<float> areas(places.size(), 1.0f);
  const auto fit = fit_correction<4>(PlaceGraph(places), areas, samples, 4);
  // But for what a shape that takes the mean over azimuths leaves to the rest.
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const auto& [terms, walked, planar, weight] : samples[i])
      for (int b = 0; b < 4; ++b)
        EXPECT_NEAR((planar * evaluate(fit.shape, terms) * evaluate(fit.ratios[i], terms))[b],
                    walked[b], 5e-3f * walked[b]);
  EXPECT_LT(fit.error_left, 0.05);
}

// 8 samples of 58 % noise at a place are wrong by 20 %. Smoothing must bring most of that, and the
// estimate of what is left must be about right.
TEST(FitCorrection, SmoothsNoiseAndSaysWhatIsLeft) {
  const auto places = lattice_of_places(40);
  const auto samples = noisy_samples(places, 8, 1.0f);
  const std::vector<float> areas(places.size(), 1.0f);
  const auto fit = fit_correction<4>(PlaceGraph(places), areas, samples, 4);
  double squares = 0.0, light = 0.0, count = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const auto& [terms, walked, planar, weight] : samples[i]) {
      const auto truth = planar * evaluate(true_ratio(places[i].at.position), terms);
      const auto found = planar * evaluate(fit.shape, terms) * evaluate(fit.ratios[i], terms);
      for (int b = 0; b < 4; ++b) {
        squares += std::pow(static_cast<double>(found[b] - truth[b]), 2);
        light += static_cast<double>(truth[b]);
        ++count;
      }
    }
  const double error = std::sqrt(squares / count) / (light / count);
  EXPECT_LT(error, 0.06);
  EXPECT_GT(error, 0.005);
  EXPECT_NEAR(fit.error_left / error, 1.0, 0.4);
}

/// RMS error of the fitted ratio along the normal at places, over its mean.
double error_of(const CorrectionFit<4>& fit, const std::vector<PlaceGraph::Place>& places,
                std::size_t count, const std::function<float(const Vec3f&)>& truth) {
  double squares = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const DirectionTerms terms = direction_terms_of({0, 0, 1}, {0, 0, 1}, 1.4f);
    const float expected = truth(places[i].at.position);
    const float found = (evaluate(fit.shape, terms) * evaluate(fit.ratios[i], terms))[0];
    squares += std::pow(static_cast<double>(found - expected), 2);
    sum += static_cast<double>(expected);
  }
  const auto n = static_cast<double>(count);
  return std::sqrt(squares / n) / (sum / n);
}

/// Samples of a ratio to even light, with a noise of the walks, as many as are asked for at a
/// place.
std::vector<std::vector<WalkedSample<4>>> samples_of(
    const std::vector<PlaceGraph::Place>& places, const std::function<float(const Vec3f&)>& truth,
    float noise, const std::function<int(std::size_t)>& count, std::uint64_t seed = 11) {
  std::vector<std::vector<WalkedSample<4>>> samples(places.size());
  Random random(seed);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const int n = count(i);
    for (int s = 0; s < n; ++s) {
      const DirectionTerms terms = direction_terms_of(random_direction(random), {0, 0, 1}, 1.4f);
      const auto planar = BandValues<4>::filled(1.0f / static_cast<float>(n));
      const float chance = 1.0f + noise * (2.0f * random.uniform_float() - 1.0f);
      samples[i].push_back({terms, truth(places[i].at.position) * chance * planar, planar});
    }
  }
  return samples;
}

/// A ridge about as wide as noisy fits are.
float ridge(const Vec3f& at) {
  const float x = (at.x - 20.0f) / 6.0f;
  return 1.0f + std::exp(-x * x);
}

// A single fit as wide as this noise asks for leaves 97.1 % of the top, in the mean of five.
TEST(FitCorrection, FlattensLittleWhereTheRatioBends) {
  const auto places = lattice_of_places(40);
  const std::vector<float> areas(places.size(), 1.0f);
  const DirectionTerms terms = direction_terms_of({0, 0, 1}, {0, 0, 1}, 1.4f);
  double top = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto samples = samples_of(
        places, ridge, 1.0f, [](std::size_t) { return 8; }, seed);
    const auto fit = fit_correction<4>(PlaceGraph(places), areas, samples, 4);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Vec3f& at = places[i].at.position;
      if (!(std::abs(at.x - 20.0f) < 1.5f)) continue;
      top += static_cast<double>((evaluate(fit.shape, terms) * evaluate(fit.ratios[i], terms))[0] /
                                 ridge(at));
      ++count;
    }
  }
  EXPECT_GT(top / count, 0.978);
  EXPECT_LT(top / count, 1.01);
}

// Elsewhere lie bright places that nobody sees, of nothing but noise: the widest fit suits them.
TEST(FitCorrection, IsAsWideAsSeenPlacesAskFor) {
  auto places = lattice_of_places(40);
  const std::size_t seen = places.size();
  std::vector<float> areas(seen, 1.0f);
  for (PlaceGraph::Place place : lattice_of_places(40)) {
    place.at.position.x += 500.0f;
    places.push_back(place);
    areas.push_back(0.0f);
  }
  auto samples = samples_of(places, ridge, 0.2f, [](std::size_t) { return 8; });
  Random random(3);
  for (std::size_t i = seen; i < places.size(); ++i)
    for (auto& sample : samples[i]) {
      sample.planar *= 100.0f;
      sample.walked = (random.uniform_float() < 0.25f ? 4.0f : 0.0f) * sample.planar;
    }
  const PlaceGraph graph(places);
  const double error = error_of(fit_correction<4>(graph, areas, samples, 4), places, seen, ridge);
  EXPECT_LT(error, 0.05);
  areas.assign(places.size(), 1.0f);
  EXPECT_GT(error_of(fit_correction<4>(graph, areas, samples, 4), places, seen, ridge),
            1.5 * error);
}

// Places of many samples and of few, all of the same light.
TEST(FitCorrection, TakesAnyNumberOfSamplesAtAPlace) {
  const auto places = lattice_of_places(20);
  const std::vector<float> areas(places.size(), 1.0f);
  const auto slope = [](const Vec3f& at) { return 1.0f + 0.02f * at.x; };
  const auto samples =
      samples_of(places, slope, 0.0f, [](std::size_t i) { return i % 3 == 0 ? 2 : 24; });
  const auto fit = fit_correction<4>(PlaceGraph(places), areas, samples, 4);
  EXPECT_LT(error_of(fit, places, places.size(), slope), 0.02);
}

}  // namespace
}  // namespace lamina
