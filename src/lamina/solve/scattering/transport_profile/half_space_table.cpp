// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/half_space_table.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"

namespace lamina {
namespace {

/// Places of the table, close where little is absorbed, for light goes far then, and how far is
/// what counts; and where hardly anything is scattered, in a forward peak.
std::vector<double> table_places() {
  // That they are enough: test HalfSpaceTable.HasTheProfilesOfSinglyMadeHalfSpaces.
  constexpr double lowest = 1e-4, second = 1.2e-3, last = 0.998;
  const auto step_at = [](double place) {
    return std::min({0.42 * place, 0.08, 0.01 + 0.35 * (1.0 - place)});
  };
  std::vector<double> places{lowest};
  for (double place = second; place < last - 0.005; place += step_at(place))
    places.push_back(place);
  places.push_back(last);
  return places;
}

/// In reduced mean free paths; what is beyond goes on as profiles do.
constexpr RadialGrid table_radii{.first = 2e-4, .last = 2e3, .size = 350};
/// test HalfSpaceTable.HasTheProfilesOfSinglyMadeHalfSpaces
constexpr double table_accuracy = 0.005;
/// Of the fullest ring of equal relative width: what a ring with less holds is rounding.
constexpr double least_ring = 1e-8;
constexpr std::size_t rings_of_slope = 5;

double sigma_s_prime_of(const Medium& medium) { return medium.sigma_s * (1.0 - medium.g); }

/// The root of the part of the reduced extinction that absorbs.
double place_of(const Medium& medium) {
  return std::sqrt(medium.sigma_a / (medium.sigma_a + sigma_s_prime_of(medium)));
}

/// Of a reduced mean free path of 1 mm.
LayerStack node_stack(const LayerStack& like, double place) {
  Layer layer = like.layers().front();
  layer.medium.sigma_a = place * place;
  layer.medium.sigma_s = (1.0 - place * place) / (1.0 - layer.medium.g);
  return LayerStack({layer}, like.ior_above(), like.ior_below());
}

/// The logarithm of a profile; where it is too dark to be known it falls on as an exponential.
std::vector<double> log_of(const Profile& profile, std::size_t band) {
  const std::vector<double>& r = profile.r;
  double fullest = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i)
    fullest = std::max(fullest, r[i] * r[i] * profile.reflectance_at(i, band));
  std::vector<double> log;
  bool is_known = true;
  double slope = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double value = profile.reflectance_at(i, band);
    const bool rises = i < rings_of_slope || r[i] * r[i] * value > least_ring * fullest;
    if (is_known && !(value > 0.0 && rises)) {
      is_known = false;
      slope = (log[i - 1] - log[i - rings_of_slope]) / (r[i - 1] - r[i - rings_of_slope]);
    }
    log.push_back(is_known ? std::log(value) : log[i - 1] + slope * (r[i] - r[i - 1]));
  }
  return log;
}

/// The cubic through the values at four places around one.
struct Cubic {
  std::size_t first = 0;
  std::array<double, 4> weights;
};
Cubic cubic_at(std::span<const double> places, double place) {
  const auto above = std::ranges::upper_bound(places, place) - places.begin();
  Cubic cubic{.first = static_cast<std::size_t>(
                  std::clamp<std::ptrdiff_t>(above - 2, 0, std::ssize(places) - 4))};
  for (std::size_t j = 0; j < 4; ++j) {
    cubic.weights[j] = 1.0;
    for (std::size_t q = 0; q < 4; ++q)
      if (q != j)
        cubic.weights[j] *=
            (place - places[cubic.first + q]) / (places[cubic.first + j] - places[cubic.first + q]);
  }
  return cubic;
}

}  // namespace

bool HalfSpaceTable::is_for(const LayerStack& stack) {
  return stack.layers().size() == 1 && is_semi_infinite(stack) &&
         stack.layers().front().medium.sigma_s > 0.0;
}

bool HalfSpaceTable::covers(const LayerStack& stack) const {
  if (!is_for(stack)) return false;
  const Layer &a = stack.layers().front(), &b = like_.layers().front();
  return stack.ior_above() == like_.ior_above() && a.medium.ior == b.medium.ior &&
         a.medium.g == b.medium.g && a.top == b.top && phase_function(a) == phase_function(b);
}

HalfSpaceTable::HalfSpaceTable(const LayerStack& like, const std::optional<DiskCache>& cache,
                               const Progress& progress)
    : like_(node_stack(like, 0.5)), places_(table_places()) {
  assert(is_for(like));
  std::vector<LayerStack> stacks;
  for (const double place : places_) stacks.push_back(node_stack(like, place));
  const Profile solved = cached_transfer_profile(cache, stacks, table_radii,
                                                 {.accuracy = table_accuracy,
                                                  .error = ProfileError::mean,
                                                  .illumination = Illumination::diffuse,
                                                  .progress = progress})
                             .result.profile;
  radii_ = solved.r;
  log_profiles_.resize(radii_.size() * places_.size());
  for (std::size_t j = 0; j < places_.size(); ++j) {
    const double log_albedo = std::log(1.0 - places_[j] * places_[j]);
    const std::vector<double> log = log_of(solved, j);
    for (std::size_t i = 0; i < radii_.size(); ++i)
      log_profiles_[i * places_.size() + j] = log[i] - log_albedo;
    log_totals_.push_back(std::log(solved.total_reflectance[j]) - log_albedo);
  }
}

Profile HalfSpaceTable::profile(const LayerStack& stack) const {
  const Medium& medium = stack.layers().front().medium;
  const double sigma_t_prime = medium.sigma_a + sigma_s_prime_of(medium);
  const double albedo = sigma_s_prime_of(medium) / sigma_t_prime;
  const Cubic cubic = cubic_at(places_, place_of(medium));
  const auto at = [&](const double* log_values) {
    double log = 0.0;
    for (std::size_t j = 0; j < 4; ++j) log += cubic.weights[j] * log_values[cubic.first + j];
    return albedo * std::exp(log);
  };
  Profile result{.per = ProfilePer::arriving_flux, .bands = 1};
  for (std::size_t i = 0; i < radii_.size(); ++i) {
    result.r.push_back(radii_[i] / sigma_t_prime);
    result.reflectance_profile.push_back(sigma_t_prime * sigma_t_prime *
                                         at(&log_profiles_[i * places_.size()]));
  }
  result.transmittance_profile.assign(radii_.size(), 0.0);
  result.total_reflectance = {at(log_totals_.data())};
  result.total_transmittance = {0.0};
  return result;
}

Profile HalfSpaceTable::profile(std::span<const HalfSpaceTable* const> tables,
                                std::span<const LayerStack> bands, const RadialGrid& radii) {
  Profile result{
      .per = ProfilePer::arriving_flux, .bands = bands.size(), .r = lamina::radii(radii)};
  result.reflectance_profile.resize(result.r.size() * bands.size());
  result.transmittance_profile.assign(result.reflectance_profile.size(), 0.0);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    assert(tables[b]->covers(bands[b]));
    const Profile band = tables[b]->profile(bands[b]);
    result.total_reflectance.push_back(band.total_reflectance[0]);
    result.total_transmittance.push_back(0.0);
    for (std::size_t i = 0; i < result.r.size(); ++i)
      result.reflectance_profile[i * bands.size() + b] = reflectance_profile(band, result.r[i], 0);
  }
  return result;
}

}  // namespace lamina
