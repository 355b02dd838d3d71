// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/correction_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace lamina {
namespace {

/// Widths that are tried: 1, 2, 4 … steps of the graph.
constexpr int widths = 9;
constexpr int steps_of_width(int width) { return 1 << width; }

/// Steps by which what a half predicts is averaged.
constexpr int steps_of_score = 24;

/// Places that all of the surface counts as in that.
constexpr float places_of_prior = 200.0f;

/// Samples that the wider fit counts as in what a narrow one says of directions.
constexpr double samples_of_prior = 1000.0;

template <int N>
using Ratios = std::vector<DirectionalRatio<N>>;

/// The sums of samples around each place, as wide as a fit is.
template <int N>
struct SpreadSums {
  std::vector<PlanarSums<N>> planar;                 ///< of all samples
  std::array<std::vector<WalkedSums<N>>, 2> walked;  ///< of each half

  void spread(const PlaceGraph& graph) {
    planar = graph.spread(planar);
    for (auto& half : walked) half = graph.spread(half);
  }
};

/// The fits to all samples and to each half.
template <int N>
struct Fits {
  Ratios<N> whole;
  std::array<Ratios<N>, 2> half;
};

template <int N>
DirectionalRatio<N> difference(DirectionalRatio<N> a, const DirectionalRatio<N>& b) {
  for (std::size_t k = 0; k < direction_terms; ++k) a[k] = a[k] - b[k];
  return a;
}

/// The shape that fits all samples best, by the same squares as fit_ratio.
template <int N>
AngularShape<N> fit_shape(const std::vector<std::vector<WalkedSample<N>>>& samples, int bands) {
  constexpr std::size_t count = 3;
  AngularShape<N> shape{};
  for (int b = 0; b < bands; ++b) {
    SmallMatrix<count> matrix{};
    SmallVector<count> right{};
    for (const auto& of_place : samples)
      for (const auto& [terms, walked, planar, weight] : of_place) {
        const auto m = static_cast<double>(terms[1]);
        const SmallVector<count> powers = {1.0, m, m * m};
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t j = 0; j <= i; ++j)
            matrix[i][j] += powers[i] * powers[j] * static_cast<double>(planar[b]);
          right[i] += powers[i] * static_cast<double>(walked[b]);
        }
      }
    const auto found = solve_cholesky(cholesky(matrix, count), count, right);
    for (std::size_t i = 0; i < count; ++i) shape[i][b] = static_cast<float>(found[i]);
  }
  return shape;
}

/// Scales a fit to the weighted mean of the samples, as far as that is known: by Stein's shrinkage.
template <int N>
void keep_mean(const std::vector<std::vector<WalkedSample<N>>>& samples, int bands,
               CorrectionFit<N>& fit) {
  BandValues<N> fitted, missing, squares;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    BandValues<N> missing_there;
    for (const auto& [terms, walked, planar, weight] : samples[i]) {
      const auto found = planar * evaluate(fit.shape, terms) * evaluate(fit.ratios[i], terms);
      fitted += weight * found;
      missing_there += weight * (walked - found);
    }
    missing += missing_there;
    squares += missing_there * missing_there;
  }
  for (int b = 0; b < bands; ++b) {
    const float known = 1.0f - squares[b] / (missing[b] * missing[b]);
    if (!(fitted[b] > 0.0f && known > 0.0f)) continue;
    for (auto& term : fit.shape) term[b] *= std::max(1.0f + known * missing[b] / fitted[b], 0.0f);
  }
}

/// Adds what all places together say of a width, for as much as `places_of_prior` of them count: what
/// few noisy places say alone would often be wrong.
template <int N>
void add_score_of_all(const std::vector<PlanarSums<N>>& planar, std::vector<BandValues<N>>& score) {
  BandValues<N> all, light = BandValues<N>::filled(1e-30f);
  for (std::size_t i = 0; i < score.size(); ++i) {
    all += score[i];
    light += planar[i].of[0];
  }
  const float weight = places_of_prior /
                       static_cast<float>(PlaceGraph::places_reached(steps_of_score));
  for (std::size_t i = 0; i < score.size(); ++i)
    score[i] += weight * (planar[i].of[0] / light) * all;
}

}  // namespace

template <int N>
CorrectionFit<N> fit_correction(const PlaceGraph& graph, std::span<const float> areas,
                                const std::vector<std::vector<WalkedSample<N>>>& samples,
                                int bands) {
  using Bands = BandValues<N>;
  const std::size_t places = samples.size();
  if (places == 0) return {};
  CorrectionFit<N> fit{.shape = fit_shape(samples, bands)};
  std::array<std::vector<PlanarSums<N>>, 2> planar;  // of the halves at each place
  SpreadSums<N> at_places{.planar = std::vector<PlanarSums<N>>(places)};
  for (std::size_t h = 0; h < 2; ++h) {
    planar[h].resize(places);
    at_places.walked[h].resize(places);
  }
  std::vector<Bands> flat(places);
  PlanarSums<N> all_planar;
  WalkedSums<N> all_walked;
  for (std::size_t i = 0; i < places; ++i) {
    for (std::size_t s = 0; s < samples[i].size(); ++s) {
      const auto& [terms, of_walk, planar_alone, weight] = samples[i][s];
      const Bands of_planar = evaluate(fit.shape, terms) * planar_alone;
      flat[i] += planar_alone;
      planar[s % 2][i].add(terms, of_planar);
      at_places.walked[s % 2][i].add(terms, of_walk);
      all_planar.add(terms, of_planar);
      all_walked.add(terms, of_walk);
    }
    for (std::size_t h = 0; h < 2; ++h) at_places.planar[i] += planar[h][i];
  }
  std::vector<SpreadSums<N>> sums = {at_places};
  for (int width = 0, steps = 0; width < widths; ++width) {
    if (width > 0) sums.push_back(sums.back());
    for (; steps < steps_of_width(width); ++steps) sums.back().spread(graph);
  }

  // From the widest to the narrowest. The halves' planar light is taken as half of all.
  const DirectionalRatio<N> pooled = fit_ratio<N>(all_planar, all_walked, bands, 0.0, {});
  const Ratios<N> all_alike(places, pooled);
  Fits<N> fits{all_alike, {all_alike, all_alike}}, chosen = fits;
  std::vector<Bands> best_score(places);
  for (int width = widths - 1; width >= 0; --width) {
    const SpreadSums<N>& wide = sums[static_cast<std::size_t>(width)];
    const double pull = samples_of_prior / (static_cast<double>(samples.front().size()) *
                                            PlaceGraph::places_reached(steps_of_width(width)));
    std::vector<Bands> score(places);
    constexpr std::size_t chunk = 64;
    parallel_chunks(places, chunk, [&](std::size_t i) {
      WalkedSums<N> both = wide.walked[0][i];
      both += wide.walked[1][i];
      fits.whole[i] = fit_ratio(wide.planar[i], both, bands, pull, fits.whole[i]);
      for (std::size_t h = 0; h < 2; ++h) {
        DirectionalRatio<N>& ratio = fits.half[h][i];
        ratio = fit_ratio(wide.planar[i], 2.0f * wide.walked[h][i], bands, 2.0 * pull, ratio);
        // The squares that it leaves of the other half, less those that no fit changes.
        score[i] += planar[1 - h][i].product(ratio, ratio) -
                    2.0f * at_places.walked[1 - h][i].product(ratio);
      }
    });
    add_score_of_all(at_places.planar, score);
    for (int step = 0; step < steps_of_score; ++step) score = graph.spread(score);
    const bool is_first = width == widths - 1;
    for (std::size_t i = 0; i < places; ++i)
      for (int b = 0; b < bands; ++b) {
        if (!is_first && !(score[i][b] < best_score[i][b])) continue;
        best_score[i][b] = score[i][b];
        for (std::size_t k = 0; k < direction_terms; ++k) {
          chosen.whole[i][k][b] = fits.whole[i][k][b];
          for (std::size_t h = 0; h < 2; ++h) chosen.half[h][i][k][b] = fits.half[h][i][k][b];
        }
      }
  }

  // What each half leaves of the other is its error, noise included, less the squares of the truth.
  // These follow from the narrowest fits: little is smoothed away, and what is wrong in one half is
  // not in the other.
  DirectionalRatio<N> one{};
  one[0] = Bands::filled(1.0f);
  double area = 0.0, light = 0.0, changed = 0.0, left = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < places; ++i) {
    if (!(areas[i] > 0.0f)) continue;
    const PlanarSums<N>& both = at_places.planar[i];
    const auto& [first, second] = at_places.walked;
    const DirectionalRatio<N>&a = chosen.half[0][i], &b = chosen.half[1][i];
    const DirectionalRatio<N>&u = fits.half[0][i], &v = fits.half[1][i];
    const Bands truth = 2.0f * (second[i].product(u) + first[i].product(v)) - both.product(u, v);
    const Bands of_halves = planar[1][i].product(a, a) - 2.0f * second[i].product(a) +
                            planar[0][i].product(b, b) - 2.0f * first[i].product(b) + truth;
    const auto apart = difference<N>(a, b);
    const Bands of_noise = both.product(apart, apart);
    const Bands corrected = both.product(one, chosen.whole[i]);
    for (int band = 0; band < bands; ++band) {
      changed += std::pow(static_cast<double>(corrected[band] - flat[i][band]), 2) /
                 static_cast<double>(areas[i]);
      // Squares over the planar light, times it.
      const double scale = static_cast<double>(both.of[0][band] / areas[i]);
      noise += scale * 0.25 * static_cast<double>(of_noise[band]);  // of the mean of both halves
      left += scale * static_cast<double>(of_halves[band]);
      light += static_cast<double>(first[i].of[0][band] + second[i].of[0][band]);
      area += static_cast<double>(areas[i]);
    }
  }
  if (light > 0.0) {
    fit.change = std::sqrt(changed * area) / light;
    fit.error_left = std::sqrt(std::max(left - noise, noise) * area) / light;
  }
  fit.ratios = std::move(chosen.whole);
  keep_mean(samples, bands, fit);
  return fit;
}

#define LAMINA_INSTANTIATE(N)                                                         \
  template CorrectionFit<N> fit_correction(const PlaceGraph&, std::span<const float>, \
                                           const std::vector<std::vector<WalkedSample<N>>>&, int)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
