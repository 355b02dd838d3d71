// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/skin/fit/skin/skin_population.h"

namespace lamina {

/// A band in which skin may be photographed.
struct CandidateBand {
  double wavelength = 0.0;  ///< [nm], its middle, in [350, 1000]
  double width = 0.0;       ///< [nm] full, at half of its height: a Gaussian; 0: one wavelength
};

/// Wavelengths [nm] and weights, of sum 1, of a band: its middle, or 11 over three times its width.
[[nodiscard]] std::vector<std::array<double, 2>> band_samples(const CandidateBand& band);

/// Skins that bands are chosen for: light, medium, dark, of a freckle and over a vessel, with
/// constants of the calibrated recipe.
[[nodiscard]] std::vector<SkinParameters> skins_of_choice();

/// Skins of a population, drawn at random: its Gaussian, within the range of skin_fit_range.
[[nodiscard]] std::vector<SkinParameters> draw_skins(const SkinPopulation& population, int count,
                                                     std::uint64_t seed);

/// Bands together, and what they tell.
struct BandSetRating {
  std::vector<std::size_t> bands;  ///< places among the candidates, ascending
  /// [number] mean over the skins of the standard deviation: relative of fractions and scales, of
  /// the logit of shares. Infinite where the bands do not tell the number.
  std::vector<double> deviations;
  double score = 0.0;  ///< root of their mean square
};

/// Information of uniform light over candidate bands about skin, each known to a share of its
/// reflectance. Source: Fisher information [Donner2008] §6.1; the lower bound of Cramér and Rao
/// [Kay1993] §3.
class BandInformation {
 public:
  /// @param numbers  of skin_fit_numbers that are to be told, by name; at least one
  /// @param noise    of each band, relative to what is reflected, > 0
  /// @param prior    what is known before of these numbers; deviations then are of the coordinates
  ///                 of skin_fit_numbers; null: nothing
  /// @throws InvalidInput for no candidates or skins, one out of range, a name that is none;
  ///         Interrupted if progress asks to stop.
  BandInformation(std::vector<CandidateBand> candidates, std::span<const SkinParameters> skins,
                  const std::vector<std::string>& numbers, double noise,
                  const SkinPopulation* prior = nullptr, const Progress& progress = {});

  [[nodiscard]] const std::vector<CandidateBand>& candidates() const { return candidates_; }
  [[nodiscard]] const std::vector<std::string>& numbers() const { return numbers_; }

  [[nodiscard]] BandSetRating rate(std::vector<std::size_t> bands) const;

  /// The set of least score: of all sets where these are a million or less, else the best one with
  /// a band more than the set before, exchanged until no exchange helps.
  /// @param count  at least as many as numbers, or with a prior 1; at most as candidates.
  /// @throws InvalidInput; Interrupted if progress asks to stop.
  [[nodiscard]] BandSetRating choose(int count, const Progress& progress = {}) const;

  /// Rating of as many of the candidates as evenly spaced as they can be, from the first to the
  /// last.
  [[nodiscard]] BandSetRating evenly_spaced(int count) const;

  /// Reflectance of a skin over the candidates.
  [[nodiscard]] const std::vector<double>& reflectance(std::size_t skin) const {
    return reflectance_[skin];
  }
  /// Relative change of reflectance by the coordinates of the numbers, [candidate][number].
  [[nodiscard]] const DenseMatrix& derivatives(std::size_t skin) const {
    return derivatives_[skin];
  }

 private:
  [[nodiscard]] double score(std::span<const std::size_t> bands,
                             std::span<double> deviations) const;
  [[nodiscard]] BandSetRating best_of_all(int count, const Progress& progress) const;
  [[nodiscard]] BandSetRating exchanged(BandSetRating rating) const;

  std::vector<CandidateBand> candidates_;
  std::vector<std::string> numbers_;
  double noise_ = 0.0;
  std::vector<std::vector<double>> reflectance_;  ///< [skin][candidate]
  std::vector<DenseMatrix> derivatives_;          ///< [skin]
  DenseMatrix prior_;                             ///< inverse covariance; empty without one
};

}  // namespace lamina
