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

/// Steps over which the ratio is taken that a sample may be so many times beyond.
constexpr int steps_of_outliers = 32;
constexpr float most_over_ratio = 10.0f;

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

template <int N>
using Samples = std::vector<std::vector<WalkedSample<N>>>;

/// Samples without what single walks bring beyond many times the light around them, which is noise
/// that no fit could tell from light. It is missed in their mean, to which the fit is scaled.
template <int N>
Samples<N> without_outliers(const PlaceGraph& graph, Samples<N> samples) {
  std::vector<BandValues<N>> walked(samples.size()), planar(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (const WalkedSample<N>& sample : samples[i]) {
      walked[i] += sample.walked;
      planar[i] += sample.planar;
    }
  for (int step = 0; step < steps_of_outliers; ++step) {
    walked = graph.spread(walked);
    planar = graph.spread(planar);
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto ratio =
        max(walked[i], BandValues<N>{}) / max(planar[i], BandValues<N>::filled(1e-30f));
    for (WalkedSample<N>& sample : samples[i]) {
      const auto most = most_over_ratio * ratio * sample.planar;
      sample.walked = min(max(sample.walked, -1.0f * most), most);
    }
  }
  return samples;
}

/// The shape that fits all samples best, by the same squares as fit_ratio.
template <int N>
AngularShape<N> fit_shape(const Samples<N>& samples, int bands) {
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
void keep_mean(const Samples<N>& samples, int bands, CorrectionFit<N>& fit) {
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

/// Adds what all places together say of a width, for as much as `places_of_prior` of them count:
/// what few noisy places say alone would often be wrong.
template <int N>
void add_score_of_all(const std::vector<PlanarSums<N>>& planar, std::vector<BandValues<N>>& score) {
  BandValues<N> all, light = BandValues<N>::filled(1e-30f);
  for (std::size_t i = 0; i < score.size(); ++i) {
    all += score[i];
    light += planar[i].of[0];
  }
  const float weight =
      places_of_prior / static_cast<float>(PlaceGraph::places_reached(steps_of_score));
  for (std::size_t i = 0; i < score.size(); ++i)
    score[i] += weight * (planar[i].of[0] / light) * all;
}

}  // namespace

template <int N>
CorrectionFit<N> fit_correction(const PlaceGraph& graph, std::span<const float> areas,
                                const std::vector<std::vector<WalkedSample<N>>>& all_samples,
                                int bands) {
  using Bands = BandValues<N>;
  const std::size_t places = all_samples.size();
  if (places == 0) return {};
  const Samples<N> samples = without_outliers<N>(graph, all_samples);
  CorrectionFit<N> fit{.shape = fit_shape(samples, bands)};
  std::array<std::vector<PlanarSums<N>>, 2> planar;  // of the halves at each place
  SpreadSums<N> at_places{.planar = std::vector<PlanarSums<N>>(places)};
  for (std::size_t h = 0; h < 2; ++h) {
    planar[h].resize(places);
    at_places.walked[h].resize(places);
  }
  std::vector<Bands> flat(places);
  for (std::size_t i = 0; i < places; ++i) {
    for (std::size_t s = 0; s < samples[i].size(); ++s) {
      const auto& [terms, of_walk, planar_alone, weight] = samples[i][s];
      const Bands of_planar = evaluate(fit.shape, terms) * planar_alone;
      flat[i] += planar_alone;
      planar[s % 2][i].add(terms, of_planar);
      at_places.walked[s % 2][i].add(terms, of_walk);
    }
    for (std::size_t h = 0; h < 2; ++h) at_places.planar[i] += planar[h][i];
  }
  std::vector<SpreadSums<N>> sums = {at_places};
  for (int width = 0, steps = 0; width < widths; ++width) {
    if (width > 0) sums.push_back(sums.back());
    for (; steps < steps_of_width(width); ++steps) sums.back().spread(graph);
  }

  // From the widest, which is all of the surface, to the narrowest. The halves' planar light is
  // taken as half of all.
  PlanarSums<N> all_planar;
  std::array<WalkedSums<N>, 2> all_walked{};
  Bands all_light = Bands::filled(1e-30f);
  for (std::size_t i = 0; i < places; ++i) {
    all_planar += at_places.planar[i];
    all_light += at_places.planar[i].of[0];
    for (std::size_t h = 0; h < 2; ++h) all_walked[h] += at_places.walked[h][i];
  }
  const auto fit_both = [&](const PlanarSums<N>& under, const WalkedSums<N>& first,
                            const WalkedSums<N>& second, double pull,
                            const DirectionalRatio<N>& prior) {
    WalkedSums<N> both = first;
    both += second;
    return fit_ratio(under, both, bands, pull, prior);
  };
  const DirectionalRatio<N> none{};
  Fits<N> fits{
      .whole = Ratios<N>(places, fit_both(all_planar, all_walked[0], all_walked[1], 0.0, none))};
  for (std::size_t h = 0; h < 2; ++h)
    fits.half[h].assign(places, fit_ratio(all_planar, 2.0f * all_walked[h], bands, 0.0, none));
  Fits<N> chosen = fits;
  std::vector<float> best_score(places);
  for (int width = widths; width >= 0; --width) {
    const bool is_of_all = width == widths;
    std::vector<Bands> scores(places);
    constexpr std::size_t chunk = 64;
    parallel_chunks(places, chunk, [&](std::size_t i) {
      if (!is_of_all) {
        const SpreadSums<N>& wide = sums[static_cast<std::size_t>(width)];
        const double pull = samples_of_prior / (static_cast<double>(samples.front().size()) *
                                                PlaceGraph::places_reached(steps_of_width(width)));
        fits.whole[i] =
            fit_both(wide.planar[i], wide.walked[0][i], wide.walked[1][i], pull, fits.whole[i]);
        for (std::size_t h = 0; h < 2; ++h)
          fits.half[h][i] = fit_ratio(wide.planar[i], 2.0f * wide.walked[h][i], bands, 2.0 * pull,
                                      fits.half[h][i]);
      }
      // The squares that each half leaves of the other, less those that no fit changes.
      for (std::size_t h = 0; h < 2; ++h) {
        const DirectionalRatio<N>& ratio = fits.half[h][i];
        scores[i] += planar[1 - h][i].product(ratio, ratio) -
                     2.0f * at_places.walked[1 - h][i].product(ratio);
      }
    });
    add_score_of_all(at_places.planar, scores);
    for (int step = 0; step < steps_of_score; ++step) scores = graph.spread(scores);
    for (std::size_t i = 0; i < places; ++i) {
      // One width for all bands, so that noise has no color; each counts by its light.
      const Bands over_light = scores[i] / all_light;
      float score = 0.0f;
      for (int b = 0; b < bands; ++b) score += over_light[b];
      if (!is_of_all && !(score < best_score[i])) continue;
      best_score[i] = score;
      chosen.whole[i] = fits.whole[i];
      for (std::size_t h = 0; h < 2; ++h) chosen.half[h][i] = fits.half[h][i];
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
  keep_mean(all_samples, bands, fit);
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
