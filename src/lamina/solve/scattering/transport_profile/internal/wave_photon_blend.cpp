// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/internal/wave_photon_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/smooth_step.h"

namespace lamina::detail {
namespace {

using std::numbers::pi;

// test WavePhotonBlend.FindsOutWavesThatDoNotSayIt
constexpr double standard_errors = 2.0;  ///< that an error stands for
constexpr double refuted = 3.0;          ///< standard errors beyond which waves are wrong
constexpr double most_frequencies = 4000.0;
/// Errors of waves ring: they are as large as within these ratios of radii or frequencies.
constexpr double near_in_share = 1.25, near_in_error = 1.25, near_in_k = 1.2;

/// The largest of the values whose places are within a ratio.
std::vector<double> largest_nearby(std::span<const double> values, std::span<const double> place,
                                   double ratio) {
  std::vector<double> largest(values.size(), 0.0);
  std::size_t first = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    while (place[first] * ratio < place[i]) ++first;
    for (std::size_t j = first; j < values.size() && place[j] <= place[i] * ratio; ++j)
      largest[i] = std::max(largest[i], std::abs(values[j]));
  }
  return largest;
}

/// How much photons count at each radius, by the errors of both. Waves are wrong by what they say
/// of themselves, or by what photons find beyond their noise.
///
/// @param scattered  [radius] what waves have of the light that photons count
std::vector<double> share_of_photons(std::span<const double> r, const WaveCurve& waves,
                                     std::span<const double> scattered,
                                     std::span<const Estimate> counted) {
  std::vector<double> wrong(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double found =
        std::abs(scattered[i] - counted[i].value) - refuted * counted[i].standard_error;
    wrong[i] = std::max(waves.error[i], std::isfinite(found) ? found : 0.0);
  }
  wrong = largest_nearby(wrong, r, near_in_share);
  std::vector<double> share(r.size(), 0.0);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double noise = standard_errors * counted[i].standard_error;
    if (noise < 4.0 * wrong[i]) share[i] = smooth_step(0.25, 1.0, wrong[i] / noise);
  }
  return share;
}

/// The value at any radius, in between by a straight line over log r; nearer than the first it is
/// as there.
double at_radius(std::span<const double> r, std::span<const double> values, double radius) {
  const double place = std::clamp(std::log(radius / r[0]) / std::log(r[1] / r[0]), 0.0,
                                  static_cast<double>(r.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(place), r.size() - 2);
  const double part = place - static_cast<double>(i);
  return (1.0 - part) * values[i] + part * values[i + 1];
}

/// What a curve sends between two radii, from 0 on if the first is 0.
double flux_between(std::span<const double> r, std::span<const double> curve, double begin,
                    double end) {
  if (begin == 0.0) return pi * end * end * curve[0];
  constexpr int parts = 4;
  const double step = std::log(end / begin) / parts;
  double sum = 0.0;
  for (int q = 0; q < parts; ++q) {
    const double radius = begin * std::exp((q + 0.5) * step);
    sum += radius * radius * at_radius(r, curve, radius);
  }
  return 2.0 * pi * step * sum;
}

/// By how much waves and photons differ in rings that end at these radii; the first begins at 0.
struct Differences {
  std::vector<double> end;                   ///< [ring] [mm]
  std::vector<double> difference, variance;  ///< [ring] of flux
  std::vector<std::vector<double>> changes;  ///< [ring][step] of the waves
};

Differences differences(std::span<const double> r, const WaveCurve& waves,
                        std::span<const double> scattered, std::span<const double> share,
                        const RingFlux& rings, double photons, double support) {
  Differences all;
  for (std::size_t i = 0; i <= rings.flux.size() && rings.begin_of(i) <= support; ++i) {
    const double begin = i == 0 ? 0.0 : rings.begin_of(i - 1), end = rings.begin_of(i);
    const Estimate& flux = i == 0 ? rings.nearer : rings.flux[i - 1];
    const double part = at_radius(r, share, std::sqrt(std::max(begin, 0.5 * end) * end));
    all.end.push_back(end);
    all.difference.push_back(part * (flux_between(r, scattered, begin, end) - flux.value));
    all.variance.push_back(
        part * part * (std::pow(flux.standard_error, 2.0) + flux.value * flux.value / photons));
    std::vector<double>& changes = all.changes.emplace_back();
    for (const auto change : waves.changes)
      changes.push_back(part * flux_between(r, change, begin, end));
  }
  return all;
}

/// The part of the differences that waves know better, at one spatial frequency.
struct Frequency {
  double k = 0.0;
  double difference = 0.0, variance = 0.0, doubt = 0.0;
  std::vector<double> changes;
  double kept = 0.0;  ///< fraction that stays
};

Frequency at_frequency(const Differences& all, double k, std::size_t steps) {
  Frequency at{.k = k, .changes = std::vector<double>(steps, 0.0)};
  double before = 0.0, inner = 0.0;
  for (std::size_t i = 0; i < all.end.size(); ++i) {
    const double outer = all.end[i], edge = outer * ::j1(k * outer);
    // Mean of J0 over the ring.
    const double mean = 2.0 * (edge - before) / (k * (outer - inner) * (outer + inner));
    at.difference += mean * all.difference[i];
    at.variance += mean * mean * all.variance[i];
    for (std::size_t c = 0; c < steps; ++c) at.changes[c] += mean * all.changes[i][c];
    before = edge;
    inner = outer;
  }
  double square = 0.0;
  for (const double change : at.changes) square += change * change;
  at.doubt = std::sqrt(std::max(square, at.difference * at.difference - at.variance));
  return at;
}

std::vector<Frequency> by_frequency(const Differences& all, std::size_t steps, double k_step,
                                    double highest) {
  std::vector<Frequency> spectrum;
  std::vector<double> k, doubt;
  for (double n = 0.5; n < most_frequencies && n * k_step < highest; ++n) {
    spectrum.push_back(at_frequency(all, n * k_step, steps));
    k.push_back(spectrum.back().k);
    doubt.push_back(spectrum.back().doubt);
  }
  doubt = largest_nearby(doubt, k, near_in_k);
  for (std::size_t n = 0; n < spectrum.size(); ++n) {
    Frequency& at = spectrum[n];
    const double end = smooth_step(0.5, 1.0, at.k / k.back());
    const double wrong = at.variance + doubt[n] * doubt[n];
    at.kept = wrong > 0.0 ? (1.0 - end) * at.variance / wrong : 0.0;
  }
  return spectrum;
}

}  // namespace

BlendedCurve blend(std::span<const double> r, const WaveCurve& waves, std::span<const double> known,
                   double unseen, const RingFlux& rings, double photons) {
  const std::size_t radii = r.size(), steps = waves.changes.size();
  BlendedCurve blended{{waves.density.begin(), waves.density.end()},
                       {waves.error.begin(), waves.error.end()}};
  const std::vector<Estimate> counted = density_of_rings(rings, r);
  std::vector<double> scattered(radii);
  for (std::size_t i = 0; i < radii; ++i) scattered[i] = waves.density[i] - known[i];
  const std::vector<double> share = share_of_photons(r, waves, scattered, counted);
  double support = 0.0;
  for (std::size_t i = 0; i < radii; ++i)
    if (share[i] > 0.0) support = r[std::min(i + 1, radii - 1)];
  if (support > 0.0) {
    const double k_step = 1.0 / support;
    const auto spectrum =
        by_frequency(differences(r, waves, scattered, share, rings, photons, support), steps,
                     k_step, waves.highest);
    std::vector<double> stays(radii, 0.0), wrong(radii, 0.0);
    for (std::size_t i = 0; i < radii && r[i] <= support; ++i) {
      std::vector<double> changes(steps, 0.0);
      for (const Frequency& at : spectrum) {
        const double wave = at.kept * ::j0(at.k * r[i]) * at.k * k_step / (2.0 * pi);
        stays[i] += wave * at.difference;
        for (std::size_t c = 0; c < steps; ++c) changes[c] += wave * at.changes[c];
      }
      for (const double change : changes) wrong[i] += std::abs(change);
    }
    wrong = largest_nearby(wrong, r, near_in_error);
    for (std::size_t i = 0; i < radii; ++i) {
      if (share[i] == 0.0) continue;
      const double noise = standard_errors * counted[i].standard_error;
      blended.density[i] += stays[i] - share[i] * (scattered[i] - counted[i].value);
      blended.error[i] = (1.0 - share[i]) * waves.error[i] +
                         share[i] * (noise + wrong[i] + unseen * std::abs(known[i]));
    }
  }
  for (std::size_t i = 0; i < radii; ++i) {
    blended.error[i] += std::max(0.0, -blended.density[i]);
    blended.density[i] = std::max(0.0, blended.density[i]);
  }
  return blended;
}

}  // namespace lamina::detail
