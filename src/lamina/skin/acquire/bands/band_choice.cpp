// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/bands/band_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/symmetric_eigen.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {
namespace {

constexpr std::size_t most_numbers = 8;
constexpr double most_sets = 1e6;
using Square = std::array<double, most_numbers * most_numbers>;  ///< rows of a smaller matrix

/// The change of a number's value with its coordinate: its logarithm, or the logit of a share; with
/// a prior that of the number.
double value_by_coordinate(const FitParameter& parameter, double value, bool has_prior) {
  if (has_prior) return fit_value_derivative(parameter, fit_coordinate(parameter, value));
  return parameter.scale == FitScale::logit ? value * (1.0 - value) : value;
}

/// The inverse of the covariance of some numbers of a population.
DenseMatrix precision_of(const SkinPopulation& population,
                         const std::vector<std::string>& numbers) {
  std::vector<std::size_t> places;
  for (const std::string& name : numbers) {
    const auto found = std::ranges::find(population.names, name);
    if (found == population.names.end())
      throw InvalidInput("numbers: the population knows nothing of " + name);
    places.push_back(static_cast<std::size_t>(found - population.names.begin()));
  }
  const std::size_t n = places.size();
  DenseMatrix covariance(n, n), precision(n, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      covariance(i, j) = population.correlation(places[i], places[j]) *
                         population.priors[places[i]].standard_deviation *
                         population.priors[places[j]].standard_deviation;
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k)
        precision(i, j) += eigen.vectors(i, k) * eigen.vectors(j, k) / eigen.values[k];
  return precision;
}

/// Diagonal of the inverse of a positive definite matrix of n rows, in place of it; false if it is
/// not definite.
bool invert_diagonal(Square& a, std::size_t n, std::span<double> diagonal) {
  double largest = 0.0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, a[i * n + i]);
  for (std::size_t i = 0; i < n; ++i)  // Cholesky's factor below the diagonal
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      if (i == j) {
        if (!(sum > 1e-14 * largest)) return false;
        a[i * n + i] = std::sqrt(sum);
      } else {
        a[i * n + j] = sum / a[j * n + j];
      }
    }
  std::array<double, most_numbers> column;
  for (std::size_t c = 0; c < n; ++c) {  // of the inverse of the factor
    diagonal[c] = 0.0;
    for (std::size_t i = c; i < n; ++i) {
      double sum = i == c ? 1.0 : 0.0;
      for (std::size_t k = c; k < i; ++k) sum -= a[i * n + k] * column[k];
      column[i] = sum / a[i * n + i];
      diagonal[c] += column[i] * column[i];
    }
  }
  return true;
}

double sets_of(std::size_t candidates, int count) {
  double sets = 1.0;
  for (int i = 0; i < count; ++i) sets *= (static_cast<double>(candidates) - i) / (count - i);
  return sets;
}

}  // namespace

std::vector<std::array<double, 2>> band_samples(const CandidateBand& band) {
  if (band.width == 0.0) return {{band.wavelength, 1.0}};
  constexpr int count = 11;
  std::vector<std::array<double, 2>> samples;
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const double x = 3.0 * (i - 0.5 * (count - 1)) / (count - 1);  // in widths
    const double nm = band.wavelength + x * band.width;
    if (nm < 350.0 || nm > 1000.0) continue;
    samples.push_back({nm, std::exp(-4.0 * std::numbers::ln2 * x * x)});
    sum += samples.back()[1];
  }
  for (auto& [nm, weight] : samples) weight /= sum;
  return samples;
}

std::vector<SkinParameters> skins_of_choice() {
  const auto skin = [](double melanin, double blend, double epidermis, double carotene,
                       double dermis) {
    SkinParameters made;
    made.melanin = melanin;
    made.melanin_blend = blend;
    made.hemoglobin_epidermis = epidermis;
    made.carotene = carotene;
    made.hemoglobin_dermis = dermis;
    return made;
  };
  return {skin(0.010, 0.60, 0.002, 0.002, 0.010), skin(0.030, 0.70, 0.002, 0.002, 0.012),
          skin(0.080, 0.80, 0.003, 0.002, 0.012), skin(0.045, 0.35, 0.002, 0.003, 0.009),
          skin(0.012, 0.70, 0.002, 0.003, 0.030)};
}

std::vector<SkinParameters> draw_skins(const SkinPopulation& population, int count,
                                       std::uint64_t seed) {
  const std::size_t n = population.names.size();
  const SymmetricEigen eigen = symmetric_eigen(population.correlation);
  const std::vector<SkinFitNumber> all = skin_fit_numbers({});
  Random random = make_random(seed, 0);
  std::vector<SkinParameters> skins;
  for (int s = 0; s < count; ++s) {
    std::vector<double> normal(n);
    for (double& x : normal)
      x = std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
          std::cos(2.0 * std::numbers::pi * random.uniform());
    SkinParameters skin;
    for (std::size_t i = 0; i < n; ++i) {
      const auto number = std::ranges::find(
          all, population.names[i], [](const SkinFitNumber& each) { return each.parameter.name; });
      double coordinate = fit_coordinate(number->parameter, population.priors[i].mean);
      for (std::size_t j = 0; j < n; ++j)
        coordinate += population.priors[i].standard_deviation * eigen.vectors(i, j) *
                      std::sqrt(std::max(eigen.values[j], 0.0)) * normal[j];
      const double value = std::clamp(fit_value(number->parameter, coordinate),
                                      number->parameter.low, number->parameter.high);
      for (double SkinParameters::*const member : number->values) skin.*member = value;
    }
    skins.push_back(skin);
  }
  return skins;
}

BandInformation::BandInformation(std::vector<CandidateBand> candidates,
                                 std::span<const SkinParameters> skins,
                                 const std::vector<std::string>& numbers, double noise,
                                 const SkinPopulation* prior, const Progress& progress)
    : candidates_(std::move(candidates)), numbers_(numbers), noise_(noise) {
  if (candidates_.empty()) throw InvalidInput("candidates: at least one band must be given");
  if (skins.empty()) throw InvalidInput("skins: at least one must be given");
  if (!(std::isfinite(noise) && noise > 0.0))
    throw InvalidInput("noise: must be > 0, but is " + number_text(noise));
  const std::vector<SkinFitNumber> all = skin_fit_numbers({});
  std::vector<SkinFitNumber> told;
  for (const std::string& name : numbers) {
    const auto found = std::ranges::find(
        all, name, [](const SkinFitNumber& number) { return number.parameter.name; });
    if (found == all.end()) {
      std::string names;
      for (const SkinFitNumber& number : all)
        names += (names.empty() ? "" : ", ") + number.parameter.name;
      throw InvalidInput("numbers: must be of " + names + ", but one is " + name);
    }
    if (std::ranges::count(numbers, name) > 1)
      throw InvalidInput("numbers: " + name + " is there twice");
    told.push_back(*found);
  }
  if (told.empty()) throw InvalidInput("numbers: at least one must be given");
  if (prior) prior_ = precision_of(*prior, numbers);

  std::vector<double> wavelengths, weights;
  std::vector<std::size_t> first = {0};  // [candidate] of its samples
  for (const CandidateBand& band : candidates_) {
    if (!(350.0 <= band.wavelength && band.wavelength <= 1000.0))
      throw InvalidInput("candidates: a wavelength must lie in [350, 1000] nm, but is " +
                         number_text(band.wavelength));
    if (!(0.0 <= band.width && band.width <= 200.0))
      throw InvalidInput("candidates: a width must lie in [0, 200] nm, but is " +
                         number_text(band.width));
    for (const auto& [nm, weight] : band_samples(band)) {
      wavelengths.push_back(nm);
      weights.push_back(weight);
    }
    first.push_back(wavelengths.size());
  }
  const SkinReflectanceTable table(wavelengths, {}, skin_fit_range({}), progress);
  for (const SkinParameters& skin : skins) {
    std::vector<double>& reflected = reflectance_.emplace_back(candidates_.size(), 0.0);
    DenseMatrix& by_numbers = derivatives_.emplace_back(candidates_.size(), told.size());
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      for (std::size_t w = first[c]; w < first[c + 1]; ++w) {
        std::vector<double SkinParameters::*> members;
        for (const SkinFitNumber& number : told)
          members.insert(members.end(), number.values.begin(), number.values.end());
        std::vector<double> by(members.size());
        reflected[c] += weights[w] * table.reflectance_at(w, skin, members, by);
        for (std::size_t n = 0, member = 0; n < told.size(); ++n) {
          const double scale =
              value_by_coordinate(told[n].parameter, skin.*told[n].values[0], prior);
          for (std::size_t v = 0; v < told[n].values.size(); ++v)
            by_numbers(c, n) += weights[w] * scale * by[member++];
        }
      }
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      for (std::size_t n = 0; n < told.size(); ++n) by_numbers(c, n) /= reflected[c];
  }
}

double BandInformation::score(std::span<const std::size_t> bands,
                              std::span<double> deviations) const {
  const std::size_t n = numbers_.size();
  std::ranges::fill(deviations, 0.0);
  std::array<double, most_numbers> variance;
  for (const DenseMatrix& derivative : derivatives_) {
    Square information = {};
    for (std::size_t i = 0; i < prior_.values.size(); ++i)
      information[i] = noise_ * noise_ * prior_.values[i];
    for (const std::size_t band : bands)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j)
          information[i * n + j] += derivative(band, i) * derivative(band, j);
    if (!invert_diagonal(information, n, variance)) {
      std::ranges::fill(deviations, std::numeric_limits<double>::infinity());
      return std::numeric_limits<double>::infinity();
    }
    for (std::size_t i = 0; i < n; ++i)
      deviations[i] += noise_ * std::sqrt(variance[i]) / static_cast<double>(derivatives_.size());
  }
  double squares = 0.0;
  for (const double deviation : deviations) squares += deviation * deviation;
  return std::sqrt(squares / static_cast<double>(n));
}

BandSetRating BandInformation::rate(std::vector<std::size_t> bands) const {
  std::ranges::sort(bands);
  BandSetRating rating{.bands = std::move(bands), .deviations = std::vector(numbers_.size(), 0.0)};
  rating.score = score(rating.bands, rating.deviations);
  return rating;
}

BandSetRating BandInformation::best_of_all(int count, const Progress& progress) const {
  const std::size_t candidates = candidates_.size(), size = static_cast<std::size_t>(count);
  std::vector<std::pair<double, std::vector<std::size_t>>> best(
      candidates - size + 1, {std::numeric_limits<double>::infinity(), {}});
  parallel_for(
      best.size(),
      [&](std::size_t first) {
        std::vector<std::size_t> set(size);
        std::vector<double> deviations(numbers_.size());
        std::iota(set.begin(), set.end(), first);
        while (true) {
          const double found = score(set, deviations);
          if (best[first].second.empty() || found < best[first].first) best[first] = {found, set};
          std::size_t i = size;  // the next set in order that begins with the same band
          while (i > 1 && set[i - 1] == candidates - size + i - 1) --i;
          if (i == 1) break;
          ++set[i - 1];
          for (std::size_t k = i; k < size; ++k) set[k] = set[k - 1] + 1;
        }
      },
      progress);
  return rate(
      std::ranges::min_element(best, {}, [](const auto& each) { return each.first; })->second);
}

BandSetRating BandInformation::exchanged(BandSetRating rating) const {
  std::vector<double> deviations(numbers_.size());
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (std::size_t place = 0; place < rating.bands.size(); ++place)
      for (std::size_t other = 0; other < candidates_.size(); ++other) {
        if (std::ranges::count(rating.bands, other) > 0) continue;
        std::vector<std::size_t> set = rating.bands;
        set[place] = other;
        if (!(score(set, deviations) < rating.score * (1.0 - 1e-9))) continue;
        rating.bands[place] = other;
        rating.score = score(rating.bands, deviations);
        has_changed = true;
      }
  }
  return rate(rating.bands);
}

BandSetRating BandInformation::choose(int count, const Progress& progress) const {
  const std::size_t least = prior_.rows > 0 ? 1 : numbers_.size(), most = candidates_.size();
  if (count < static_cast<int>(least) || count > static_cast<int>(most))
    throw InvalidInput("count: must lie in [" + std::to_string(least) + ", " +
                       std::to_string(most) + "], " + (prior_.rows > 0 ? "one" : "numbers") +
                       " to candidates, but is " + std::to_string(count));
  if (sets_of(most, count) <= most_sets) return best_of_all(count, progress);
  // With one band more than the best set of fewer, then by exchanges.
  BandSetRating fewer = count == static_cast<int>(least) ? exchanged(evenly_spaced(count))
                                                         : choose(count - 1, progress);
  if (count == static_cast<int>(least)) return fewer;
  BandSetRating best{.score = std::numeric_limits<double>::infinity()};
  for (std::size_t band = 0; band < most; ++band) {
    if (std::ranges::count(fewer.bands, band) > 0) continue;
    std::vector<std::size_t> set = fewer.bands;
    set.push_back(band);
    BandSetRating more = rate(std::move(set));
    if (best.bands.empty() || more.score < best.score) best = std::move(more);
  }
  return exchanged(std::move(best));
}

BandSetRating BandInformation::evenly_spaced(int count) const {
  const auto [low, high] = std::ranges::minmax(candidates_, {}, &CandidateBand::wavelength);
  std::vector<std::size_t> bands;
  for (int i = 0; i < count; ++i) {
    const double wanted =
        count == 1 ? 0.5 * (low.wavelength + high.wavelength)
                   : low.wavelength + (high.wavelength - low.wavelength) * i / (count - 1);
    std::size_t nearest = candidates_.size();
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (std::ranges::count(bands, c) == 0 &&
          (nearest == candidates_.size() || std::abs(candidates_[c].wavelength - wanted) <
                                                std::abs(candidates_[nearest].wavelength - wanted)))
        nearest = c;
    bands.push_back(nearest);
  }
  return rate(std::move(bands));
}

}  // namespace lamina
