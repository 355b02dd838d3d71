// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/correction_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "lamina/base/core/parallel_chunks.h"

namespace lamina {
namespace {

/// Widths that are tried, 1, 2, 4 … steps of the graph: test FitCorrection.IsAsWideAsSeenPlacesAskFor.
constexpr int widths = 9;
constexpr int steps_of_width(int width) { return 1 << width; }

/// Of these, the narrowest that are fitted twice as well.
constexpr int widths_twice = 6;

/// Steps by which what a half predicts is averaged.
constexpr int steps_of_score = 24;

/// Places that all of the surface counts as in that.
constexpr float places_of_prior = 200.0f;

/// Steps over which the ratio is taken that a sample may be so many times beyond.
constexpr int steps_of_outliers = 32;
constexpr float most_over_ratio = 10.0f;

/// Samples that the wider fit counts as in what a narrow one says of directions.
constexpr double samples_of_prior = 1000.0;

constexpr std::size_t places_of_chunk = 64;

template <int N>
using Ratios = std::vector<DirectionalRatio<N>>;

/// Parts of the samples: two halves, and all.
constexpr std::size_t parts = 3, all_samples = 2;

/// The sums of samples around each place, as wide as a fit is. Of a half as if it was all.
template <int N>
struct SpreadSums {
  std::vector<PlanarSums<N>> planar;                    ///< of all samples
  std::array<std::vector<WalkedSums<N>>, 2> of_halves;  ///< of walks

  [[nodiscard]] WalkedSums<N> walked(std::size_t part, std::size_t place) const {
    if (part != all_samples) return of_halves[part][place];
    WalkedSums<N> both = of_halves[0][place];
    both += of_halves[1][place];
    return 0.5f * both;
  }
  void spread(const PlaceGraph& graph) {
    planar = graph.spread(planar);
    for (auto& of_half : of_halves) of_half = graph.spread(of_half);
  }
};

/// The fits to each part of the samples.
template <int N>
using Fits = std::array<Ratios<N>, parts>;

/// Halves have half of the samples, so that a prior weighs twice as much.
constexpr double pull_of_part(std::size_t part) { return part == all_samples ? 1.0 : 2.0; }

template <int N>
DirectionalRatio<N> sum(DirectionalRatio<N> a, const DirectionalRatio<N>& b, float factor = 1.0f) {
  for (std::size_t k = 0; k < direction_terms; ++k) a[k] += factor * b[k];
  return a;
}

template <int N>
using Samples = std::vector<std::vector<WalkedSample<N>>>;

/// The weighted light that walks find at each place.
template <int N>
std::vector<BandValues<N>> weighted_walked(const Samples<N>& samples) {
  std::vector<BandValues<N>> light(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (const WalkedSample<N>& sample : samples[i]) light[i] += sample.weight * sample.walked;
  return light;
}

/// Takes away what single walks bring beyond many times the light around them, which is noise that
/// no fit could tell from light. It is missed in their mean, to which the fit is scaled.
template <int N>
void take_outliers_away(const PlaceGraph& graph, Samples<N>& samples) {
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
/// @param walked  weighted, of each place, outliers included
template <int N>
void keep_mean(const Samples<N>& samples, std::span<const BandValues<N>> walked, int bands,
               CorrectionFit<N>& fit) {
  BandValues<N> fitted, missing, squares;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    BandValues<N> fitted_there;
    for (const auto& [terms, of_walk, planar, weight] : samples[i])
      fitted_there +=
          weight * (planar * evaluate(fit.shape, terms) * evaluate(fit.ratios[i], terms));
    const BandValues<N> missing_there = walked[i] - fitted_there;
    fitted += fitted_there;
    missing += missing_there;
    squares += missing_there * missing_there;
  }
  for (int b = 0; b < bands; ++b) {
    const float known = 1.0f - squares[b] / (missing[b] * missing[b]);
    if (!(fitted[b] > 0.0f && known > 0.0f)) continue;
    const float factor = std::max(1.0f + known * missing[b] / fitted[b], 0.0f);
    for (DirectionalRatio<N>& ratio : fit.ratios)
      for (BandValues<N>& term : ratio) term[b] *= factor;
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

/// What a fit leaves of the samples is fitted at the same width and added: where the ratio bends, a
/// fit alone flattens it, and both together do so much less. Source: [Tukey1977] ch. 16, "twicing".
template <int N>
Fits<N> fitted_twice(const PlaceGraph& graph, const SpreadSums<N>& at_places,
                     const std::vector<PlanarSums<N>>& wide_planar, int steps, int bands,
                     double pull, Fits<N> fits) {
  for (std::size_t part = 0; part < parts; ++part) {
    Ratios<N>& fit = fits[part];
    std::vector<WalkedSums<N>> left(fit.size());
    parallel_chunks(left.size(), places_of_chunk, [&](std::size_t i) {
      left[i] = at_places.walked(part, i);
      left[i] += -1.0f * at_places.planar[i].product(fit[i]);
    });
    for (int step = 0; step < steps; ++step) left = graph.spread(left);
    parallel_chunks(left.size(), places_of_chunk, [&](std::size_t i) {
      fit[i] = sum(fit[i], fit_ratio(wide_planar[i], left[i], bands, pull_of_part(part) * pull,
                                     DirectionalRatio<N>{}));
    });
  }
  return fits;
}

/// Of several fits the best at each place: that of which either half predicts best what the other
/// found, where places are seen.
template <int N>
class BestFits {
 public:
  /// @param planar  of each half at each place
  BestFits(const PlaceGraph& graph, std::span<const float> areas,
           const std::array<std::vector<PlanarSums<N>>, 2>& planar, const SpreadSums<N>& at_places,
           int bands)
      : graph_(graph), areas_(areas), planar_(planar), at_places_(at_places), bands_(bands) {
    for (const PlanarSums<N>& sums : at_places.planar) all_light_ += sums.of[0];
  }

  void consider(const Fits<N>& fits) {
    std::vector<BandValues<N>> scores(areas_.size());
    parallel_chunks(scores.size(), places_of_chunk, [&](std::size_t i) {
      if (!(areas_[i] > 0.0f)) return;
      // The squares that each half leaves of the other, less those that no fit changes.
      for (std::size_t h = 0; h < 2; ++h) {
        const DirectionalRatio<N>& ratio = fits[h][i];
        scores[i] +=
            planar_[1 - h][i].product(ratio, ratio) - at_places_.of_halves[1 - h][i].product(ratio);
      }
    });
    add_score_of_all(at_places_.planar, scores);
    for (int step = 0; step < steps_of_score; ++step) scores = graph_.spread(scores);
    const bool is_first = best_score_.empty();
    if (is_first) {
      best_ = fits;
      best_score_.resize(scores.size());
    }
    for (std::size_t i = 0; i < scores.size(); ++i) {
      // One width for all bands, so that noise has no color; each counts by its light.
      const BandValues<N> over_light = scores[i] / all_light_;
      float score = 0.0f;
      for (int b = 0; b < bands_; ++b) score += over_light[b];
      if (!is_first && !(score < best_score_[i])) continue;
      best_score_[i] = score;
      for (std::size_t part = 0; part < parts; ++part) best_[part][i] = fits[part][i];
    }
  }
  [[nodiscard]] Fits<N> take() { return std::move(best_); }

 private:
  const PlaceGraph& graph_;
  std::span<const float> areas_;
  const std::array<std::vector<PlanarSums<N>>, 2>& planar_;
  const SpreadSums<N>& at_places_;
  int bands_;
  BandValues<N> all_light_ = BandValues<N>::filled(1e-30f);
  Fits<N> best_;
  std::vector<float> best_score_;
};

/// The fits to all of the surface as one.
template <int N>
Fits<N> fits_of_all(const SpreadSums<N>& at_places, int bands) {
  const std::size_t places = at_places.planar.size();
  PlanarSums<N> planar;
  for (const PlanarSums<N>& sums : at_places.planar) planar += sums;
  Fits<N> fits;
  for (std::size_t part = 0; part < parts; ++part) {
    WalkedSums<N> walked;
    for (std::size_t i = 0; i < places; ++i) walked += at_places.walked(part, i);
    fits[part].assign(places, fit_ratio(planar, walked, bands, 0.0, DirectionalRatio<N>{}));
  }
  return fits;
}

/// What a fit leaves wrong: root mean square over the mean light.
template <int N>
double error_left(std::span<const float> areas,
                  const std::array<std::vector<PlanarSums<N>>, 2>& planar,
                  const SpreadSums<N>& at_places, const Fits<N>& chosen, const Fits<N>& narrowest,
                  int bands) {
  // What each half leaves of the other is its error, noise included, less the squares of the truth.
  // These follow from the narrowest fits: little is smoothed away, and what is wrong in one half is
  // not in the other.
  double area = 0.0, light = 0.0, left = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (!(areas[i] > 0.0f)) continue;
    const PlanarSums<N>& both = at_places.planar[i];
    const WalkedSums<N>&first = at_places.of_halves[0][i], &second = at_places.of_halves[1][i];
    const DirectionalRatio<N>&a = chosen[0][i], &b = chosen[1][i];
    const DirectionalRatio<N>&u = narrowest[0][i], &v = narrowest[1][i];
    const auto truth = second.product(u) + first.product(v) - both.product(u, v);
    const auto of_halves = planar[1][i].product(a, a) - second.product(a) +
                           planar[0][i].product(b, b) - first.product(b) + truth;
    const auto apart = sum(a, b, -1.0f);
    const auto of_noise = both.product(apart, apart);
    for (int band = 0; band < bands; ++band) {
      // Squares over the planar light, times it.
      const double scale = static_cast<double>(both.of[0][band] / areas[i]);
      noise += scale * 0.25 * static_cast<double>(of_noise[band]);  // of the mean of both halves
      left += scale * static_cast<double>(of_halves[band]);
      light += 0.5 * static_cast<double>(first.of[0][band] + second.of[0][band]);
      area += static_cast<double>(areas[i]);
    }
  }
  return light > 0.0 ? std::sqrt(std::max(left - noise, noise) * area) / light : 0.0;
}

}  // namespace

template <int N>
CorrectionFit<N> fit_correction(const PlaceGraph& graph, std::span<const float> areas,
                                std::vector<std::vector<WalkedSample<N>>> samples, int bands,
                                const std::optional<AngularShape<N>>& shape) {
  using Bands = BandValues<N>;
  const std::size_t places = samples.size();
  if (places == 0) return {};
  const std::vector<Bands> of_picture = weighted_walked(samples);
  take_outliers_away(graph, samples);
  CorrectionFit<N> fit{.shape = shape ? *shape : fit_shape(samples, bands)};
  std::array<std::vector<PlanarSums<N>>, 2> planar;  // of the halves at each place
  for (auto& of_half : planar) of_half.resize(places);
  SpreadSums<N> at_places{.planar = std::vector<PlanarSums<N>>(places), .of_halves = {}};
  for (auto& of_half : at_places.of_halves) of_half.resize(places);
  double samples_each = 0.0;
  for (std::size_t i = 0; i < places; ++i) {
    for (std::size_t s = 0; s < samples[i].size(); ++s) {
      const auto& [terms, of_walk, planar_alone, weight] = samples[i][s];
      planar[s % 2][i].add(terms, evaluate(fit.shape, terms) * planar_alone);
      at_places.of_halves[s % 2][i].add(terms, 2.0f * of_walk);
    }
    for (std::size_t h = 0; h < 2; ++h) at_places.planar[i] += planar[h][i];
    samples_each += static_cast<double>(samples[i].size()) / static_cast<double>(places);
  }
  std::vector<SpreadSums<N>> sums = {at_places};
  for (int width = 0, steps = 0; width < widths; ++width) {
    if (width > 0) sums.push_back(sums.back());
    for (; steps < steps_of_width(width); ++steps) sums.back().spread(graph);
  }

  // From the widest, which is all of the surface, to the narrowest. The halves' planar light is
  // taken as half of all.
  BestFits<N> best(graph, areas, planar, at_places, bands);
  Fits<N> fits = fits_of_all(at_places, bands);
  best.consider(fits);
  for (int width = widths - 1; width >= 0; --width) {
    const SpreadSums<N>& wide = sums[static_cast<std::size_t>(width)];
    const int steps = steps_of_width(width);
    const double pull = samples_of_prior / (samples_each * PlaceGraph::places_reached(steps));
    parallel_chunks(places, places_of_chunk, [&](std::size_t i) {
      for (std::size_t part = 0; part < parts; ++part)
        fits[part][i] = fit_ratio(wide.planar[i], wide.walked(part, i), bands,
                                  pull_of_part(part) * pull, fits[part][i]);
    });
    best.consider(fits);
    if (width < widths_twice)
      best.consider(fitted_twice(graph, at_places, wide.planar, steps, bands, pull, fits));
  }
  Fits<N> chosen = best.take();
  fit.error_left = error_left(areas, planar, at_places, chosen, fits, bands);
  fit.ratios = std::move(chosen[all_samples]);
  for (const std::size_t half : {0U, 1U}) fit.of_halves[half] = std::move(chosen[half]);
  keep_mean<N>(samples, of_picture, bands, fit);
  return fit;
}

#define LAMINA_INSTANTIATE(N)                                                              \
  template CorrectionFit<N> fit_correction(const PlaceGraph&, std::span<const float>,      \
                                           std::vector<std::vector<WalkedSample<N>>>, int, \
                                           const std::optional<AngularShape<N>>&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
