// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/medium_fit/half_space_mixture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/transport_profile/half_space_table.h"

namespace lamina {
namespace {

constexpr std::size_t parts = 3;

/// One channel of a mixture.
struct Mixed {
  std::array<Medium, parts> media;
  std::array<double, parts> weights{};
};

/// Parameters: of each medium its place u = sqrt(1 - albedo') and its sigma_t'; two shares, the
/// first of all, the second of what the first leaves.
Mixed mixed_of(std::span<const double> values, const Medium& like) {
  Mixed mixed;
  for (std::size_t k = 0; k < parts; ++k) {
    const double u = values[2 * k], sigma_t_prime = values[2 * k + 1];
    mixed.media[k] = {.sigma_a = sigma_t_prime * u * u,
                      .sigma_s = sigma_t_prime * (1.0 - u * u) / (1.0 - like.g),
                      .g = like.g,
                      .ior = like.ior};
  }
  const double first = values[2 * parts], second = values[2 * parts + 1];
  mixed.weights = {first, (1.0 - first) * second, (1.0 - first) * (1.0 - second)};
  return mixed;
}

LayerStack half_space(const Medium& medium, double ior_above) {
  return LayerStack({{.medium = medium}}, ior_above, medium.ior);
}

/// What a mixture returns: R(r) at the radii of a grid, and the total.
struct Returned {
  std::vector<double> profile;
  double total = 0.0;
};

Returned returned_by(const Mixed& mixed, const HalfSpaceTable& table, double ior_above,
                     const RadialGrid& grid) {
  std::vector<LayerStack> stacks;
  for (const Medium& medium : mixed.media) stacks.push_back(half_space(medium, ior_above));
  const std::vector<const HalfSpaceTable*> tables(parts, &table);
  const Profile each = HalfSpaceTable::profile(tables, stacks, grid);
  Returned returned{.profile = std::vector<double>(each.r.size())};
  for (std::size_t k = 0; k < parts; ++k) {
    for (std::size_t i = 0; i < each.r.size(); ++i)
      returned.profile[i] += mixed.weights[k] * each.reflectance_at(i, k);
    returned.total += mixed.weights[k] * each.total_reflectance[k];
  }
  return returned;
}

Mixed fit_channel(const ChannelLight& light, std::size_t channel, const HalfSpaceTable& table,
                  const HomogeneousFit& fit) {
  const Profile& wanted = light.profile;
  const RadialGrid grid{wanted.r.front(), wanted.r.back(), wanted.r.size()};
  const Medium& one = fit.media[channel];
  double flux = 0.0;
  for (std::size_t i = 0; i < wanted.r.size(); ++i)
    flux += wanted.reflectance_at(i, channel) * wanted.r[i] * wanted.r[i];
  FitData data;
  std::vector<std::size_t> rings;  // with light; the square of what is left is profile_difference's
  constexpr double least_part = 1e-6;
  for (std::size_t i = 0; i < wanted.r.size(); ++i) {
    const double value = wanted.reflectance_at(i, channel);
    const double part = flux > 0.0 ? value * wanted.r[i] * wanted.r[i] / flux : 0.0;
    if (part < least_part) continue;
    rings.push_back(i);
    data.measured.push_back(0.0);
    data.standard_deviation.push_back(1.0 / std::sqrt(part));
  }
  constexpr double error_of_total = 1e-5;
  const double total = fit.misfits[channel].reflectance.wanted_total;
  data.measured.push_back(total);
  data.standard_deviation.push_back(error_of_total);
  data.has_known_errors = false;
  const FitModel model{.predict = [&](std::span<const double> values) {
    const Returned returned = returned_by(mixed_of(values, one), table, fit.ior_above, grid);
    std::vector<double> predicted;
    for (const std::size_t i : rings) {
      const double value = wanted.reflectance_at(i, channel), other = returned.profile[i];
      predicted.push_back(2.0 * (other - value) / (other + value));
    }
    predicted.push_back(returned.total);
    return predicted;
  }};
  const double place = std::sqrt(one.sigma_a / sigma_t_prime(one));
  constexpr double lowest = 1e-3, highest = 0.995;  // of the table of half-spaces
  std::optional<FitResult> best;
  // Around the one medium: two wider ones and a denser one, and so on; the nearest wins.
  for (const auto& factors : {std::array{8.0, 1.0, 0.2}, std::array{3.0, 0.8, 0.3},
                              std::array{20.0, 3.0, 0.5}, std::array{1.5, 1.0, 0.7}}) {
    std::vector<FitParameter> parameters;
    for (std::size_t k = 0; k < parts; ++k) {
      parameters.push_back({.name = "place",
                            .start = std::clamp(place, 0.02, 0.9),
                            .low = lowest,
                            .high = highest,
                            .scale = FitScale::logit});
      parameters.push_back({.name = "sigma_t_prime",
                            .start = factors[k] * sigma_t_prime(one),
                            .low = 1e-3 * sigma_t_prime(one),
                            .high = 1e4 * sigma_t_prime(one),
                            .scale = FitScale::logarithmic});
    }
    for (const double share : {0.35, 0.5})
      parameters.push_back(
          {.name = "share", .start = share, .low = 0.0, .high = 1.0, .scale = FitScale::logit});
    FitResult found =
        fit_parameters(parameters, data, model, {.max_iterations = 60, .tolerance = 1e-5});
    if (!best || found.chi_squared < best->chi_squared) best = std::move(found);
  }
  std::vector<double> values;
  for (const FittedParameter& parameter : best->parameters) values.push_back(parameter.value);
  Mixed mixed = mixed_of(values, one);
  std::array<std::size_t, parts> order;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::ranges::greater{},
                    [&](std::size_t k) { return sigma_t_prime(mixed.media[k]); });
  Mixed sorted;
  for (std::size_t k = 0; k < parts; ++k) {
    sorted.media[k] = mixed.media[order[k]];
    sorted.weights[k] = mixed.weights[order[k]];
  }
  return sorted;
}

}  // namespace

HalfSpaceMixture fit_half_space_mixture(const ChannelLight& light, const HomogeneousFit& fit,
                                        const Progress& progress) {
  assert(!fit.is_thin());
  const HalfSpaceTable table(
      half_space({.sigma_a = 1.0, .sigma_s = 1.0, .g = fit.g(), .ior = fit.ior()}, fit.ior_above),
      user_cache(), progress);
  const std::size_t channels = light.channels.size();
  HalfSpaceMixture mixture;
  mixture.media.assign(parts, std::vector<Medium>(channels));
  mixture.weights.assign(parts, std::vector<double>(channels));
  Profile obtained = light.profile;
  const RadialGrid grid{obtained.r.front(), obtained.r.back(), obtained.r.size()};
  std::vector<Mixed> mixed(channels);
  for (std::size_t c = 0; c < channels; ++c) {
    report_or_throw(progress, static_cast<double>(c) / static_cast<double>(channels));
    mixed[c] = fit_channel(light, c, table, fit);
    const Returned returned = returned_by(mixed[c], table, fit.ior_above, grid);
    for (std::size_t i = 0; i < obtained.r.size(); ++i)
      obtained.reflectance_profile[i * channels + c] = returned.profile[i];
    // The totals by adding-doubling, better than the table's.
    obtained.total_reflectance[c] = 0.0;
    for (std::size_t k = 0; k < parts; ++k) {
      mixture.media[k][c] = mixed[c].media[k];
      mixture.weights[k][c] = mixed[c].weights[k];
      obtained.total_reflectance[c] +=
          mixed[c].weights[k] *
          adding_doubling(half_space(mixed[c].media[k], fit.ior_above), {.is_diffuse = true})
              .totals.diffuse_reflectance;
    }
  }
  mixture.misfits = channel_misfits(light, obtained);
  return mixture;
}

}  // namespace lamina
