// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/medium_fit/homogeneous_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "lamina/base/core/bracketed_root.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/fit/slab/slab_inversion.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/transport_profile/half_space_table.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"

namespace lamina {
namespace {

double mean_over_bands(std::span<const LayerStack> stacks,
                       const std::function<double(const LayerStack&)>& number) {
  const double first = number(stacks.front());  // so that equal numbers have themselves as mean
  double sum = 0.0;
  for (const LayerStack& stack : stacks) sum += number(stack) - first;
  return first + sum / static_cast<double>(stacks.size());
}

/// Whether the layer of each band is a medium that a channel can take as it is.
bool is_homogeneous(const ChannelLight& light, std::span<const LayerStack> stacks) {
  const Medium& first = stacks.front().layers().front().medium;
  return !light.channels.are_converted && std::ranges::all_of(stacks, [&](const LayerStack& stack) {
    const Layer& layer = stack.layers().front();
    return stack.layers().size() == 1 && (light.transmits || is_semi_infinite(stack)) &&
           layer.medium.g == first.g && layer.medium.ior == first.ior &&
           std::holds_alternative<HenyeyGreenstein>(phase_function(layer));
  });
}

double thickness_of(const LayerStack& stack) {
  double sum = 0.0;
  for (const Layer& layer : stack.layers()) sum += layer.thickness;
  return sum;
}

LayerStack stack_of(const Medium& medium, const HomogeneousFit& fit) {
  return LayerStack({{.medium = medium, .thickness = fit.thickness}}, fit.ior_above,
                    fit.is_thin() ? fit.ior_below : medium.ior);
}

/// The lowest point of a function of one number, between two that enclose it.
/// Source: golden sections [Press2007] §10.2.
double lowest_between(double low, double high, const std::function<double(double)>& value) {
  const double section = 0.5 * (std::sqrt(5.0) - 1.0);
  double left = high - section * (high - low), right = low + section * (high - low);
  double at_left = value(left), at_right = value(right);
  constexpr double narrow = 1e-4;
  while (high - low > narrow) {
    if (at_left < at_right) {
      high = std::exchange(right, left);
      at_right = std::exchange(at_left, value(left = high - section * (high - low)));
    } else {
      low = std::exchange(left, right);
      at_left = std::exchange(at_right, value(right = low + section * (high - low)));
    }
  }
  return 0.5 * (low + high);
}

/// The part of a profile that is one channel.
Profile channel_of(const Profile& profile, std::size_t channel) {
  Profile one{.per = profile.per, .bands = 1, .r = profile.r};
  for (std::size_t i = 0; i < profile.r.size(); ++i) {
    one.reflectance_profile.push_back(profile.reflectance_at(i, channel));
    one.transmittance_profile.push_back(profile.transmittance_at(i, channel));
  }
  one.total_reflectance = {profile.total_reflectance[channel]};
  one.total_transmittance = {profile.total_transmittance[channel]};
  return one;
}

RadialGrid grid_of(const Profile& profile) {
  return {.first = profile.r.front(), .last = profile.r.back(), .size = profile.r.size()};
}

struct HalfSpaceAlbedo {
  double albedo_prime = 0.0;  ///< reduced
  double reflectance = 0.0;   ///< that it has
  bool is_met = false;        ///< that is the one wanted, within 1e-5
};

/// The reduced albedo of a half-space that returns the wanted fraction of diffuse light, its first
/// reflection left out, by adding-doubling: for totals that are printed to five digits, of any
/// index and mean cosine. HalfSpaceColor answers the same question from its table in microseconds,
/// within .1 % and for what a HalfSpaceLook may be.
HalfSpaceAlbedo half_space_albedo(double reflectance, double g, double ior, double ior_above) {
  // The reflectance falls nearly along a straight line in u = sqrt(1 - albedo').
  const auto excess = [&](double u) {
    const LayerStack stack(
        {{.medium = {.sigma_a = u * u, .sigma_s = (1.0 - u * u) / (1.0 - g), .g = g, .ior = ior}}},
        ior_above, ior);
    const auto found = adding_doubling(stack, {.is_diffuse = true}, {.accuracy = 1e-6});
    return found.totals.diffuse_reflectance - reflectance;
  };
  // Half-spaces that absorb less than a 1e-8th never end.
  const auto [u, residual] = falling_root(excess, 1e-4, 0.9999, 2e-6);
  return {.albedo_prime = 1.0 - u * u,
          .reflectance = reflectance + residual,
          .is_met = std::abs(residual) < 1e-5};
}

/// The medium of a half-space whose total is that of a channel and whose profile is as asked.
Medium fit_half_space(const Profile& wanted, const HalfSpaceTable& table, const Medium& like,
                      const HomogeneousFit& fit, FitGoal goal, std::string& note) {
  const HalfSpaceAlbedo found =
      half_space_albedo(wanted.total_reflectance[0], like.g, like.ior, fit.ior_above);
  if (!found.is_met)
    note = "the total of " + number_text(wanted.total_reflectance[0]) +
           " cannot be reached; the nearest is " + number_text(found.reflectance);
  const auto medium_of = [&](double sigma_t_prime) {
    return Medium{.sigma_a = sigma_t_prime * (1.0 - found.albedo_prime),
                  .sigma_s = sigma_t_prime * found.albedo_prime / (1.0 - like.g),
                  .g = like.g,
                  .ior = like.ior};
  };
  const auto profile_of = [&](double log_sigma_t_prime) {
    const std::vector<LayerStack> stacks{stack_of(medium_of(std::exp(log_sigma_t_prime)), fit)};
    const HalfSpaceTable* const tables[] = {&table};
    return HalfSpaceTable::profile(tables, stacks, grid_of(wanted));
  };
  // The distances of a half-space are its mean free paths times numbers of its albedo alone.
  const double wanted_square = mean_square_radius(wanted, 0, true);
  const auto excess_of_radius = [&](double log_sigma_t_prime) {
    return std::abs(
        std::log(mean_square_radius(profile_of(log_sigma_t_prime), 0, true) / wanted_square));
  };
  const auto difference = [&](double log_sigma_t_prime) {
    Profile obtained = profile_of(log_sigma_t_prime);
    obtained.r = wanted.r;
    return profile_difference(wanted, obtained, 0, true);
  };
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  const std::function<double(double)> objective =
      goal == FitGoal::profile ? std::function<double(double)>(difference) : excess_of_radius;
  constexpr double step = 0.35;  // of the logarithm, within which there is one minimum
  const double low = -std::log(wanted.r.back()), high = -std::log(wanted.r.front());
  for (double log = low; log <= high; log += step)
    if (const double value = objective(log); value < least) {
      least = value;
      best = log;
    }
  return medium_of(std::exp(lowest_between(best - step, best + step, objective)));
}

/// The medium of a sheet of given thickness that has both totals of a channel.
Medium fit_sheet(const Profile& wanted, const Medium& like, const HomogeneousFit& fit) {
  constexpr double error_of_totals = 1e-4;
  const LayerStack start = stack_of({.sigma_a = 0.1 / fit.thickness,
                                     .sigma_s = 1.0 / fit.thickness / (1.0 - like.g),
                                     .g = like.g,
                                     .ior = like.ior},
                                    fit);
  const SlabInversion found =
      invert_slab(start, 0,
                  {.reflectance = {std::max(wanted.total_reflectance[0], 0.0), error_of_totals},
                   .transmittance =
                       MeasuredTotal{std::max(wanted.total_transmittance[0], 0.0), error_of_totals},
                   .has_specular = false},
                  {.incidence = {.is_diffuse = true}});
  return {.sigma_a = std::max(found.sigma_a.value, 0.0),
          .sigma_s = std::max(found.sigma_s_prime.value, 0.0) / (1.0 - like.g),
          .g = like.g,
          .ior = like.ior};
}

/// What the fitted media do to the same light.
Profile obtained_profile(const HomogeneousFit& fit, const HalfSpaceTable* table,
                         const Profile& wanted, const Progress& progress) {
  std::vector<LayerStack> stacks;
  for (const Medium& medium : fit.media) stacks.push_back(stack_of(medium, fit));
  Profile profile;
  if (table) {
    const std::vector<const HalfSpaceTable*> tables(stacks.size(), table);
    profile = HalfSpaceTable::profile(tables, stacks, grid_of(wanted));
  } else {
    constexpr double accuracy = 0.01;
    profile = cached_transfer_profile(user_cache(), stacks, grid_of(wanted),
                                      {.accuracy = accuracy,
                                       .error = ProfileError::mean,
                                       .illumination = Illumination::diffuse,
                                       .progress = progress})
                  .result.profile;
  }
  profile.r = wanted.r;
  const auto totals = adding_doubling(stacks, {.is_diffuse = true});
  for (std::size_t c = 0; c < stacks.size(); ++c) {
    profile.total_reflectance[c] = totals[c].totals.diffuse_reflectance;
    profile.total_transmittance[c] = totals[c].totals.transmittance;
  }
  return profile;
}

LightMisfit light_misfit(const Profile& wanted, const Profile& obtained, std::size_t channel,
                         bool reflected) {
  const auto total = [&](const Profile& profile) {
    return reflected ? profile.total_reflectance[channel] : profile.total_transmittance[channel];
  };
  return {.wanted_total = total(wanted),
          .obtained_total = total(obtained),
          .spread = LightMisfit::Spread{
              .wanted_mean_square_radius = mean_square_radius(wanted, channel, reflected),
              .obtained_mean_square_radius = mean_square_radius(obtained, channel, reflected),
              .profile_rms = profile_difference(wanted, obtained, channel, reflected)}};
}

/// With g as options say; 0 for several layers if they do not.
HomogeneousFit fit_of_one_g(const ChannelLight& light, std::span<const LayerStack> stacks,
                            const HomogeneousFitOptions& options) {
  const auto upper = [](const LayerStack& stack) { return stack.layers().front().medium; };
  HomogeneousFit fit{.channels = light.channels,
                     .thickness = light.transmits ? thickness_of(stacks.front())
                                                  : std::numeric_limits<double>::infinity(),
                     .top = stacks.front().layers().front().top};
  fit.ior_above = mean_over_bands(stacks, [](const auto& stack) { return stack.ior_above(); });
  fit.ior_below = mean_over_bands(stacks, [](const auto& stack) { return stack.ior_below(); });
  const Medium own{.g = mean_over_bands(stacks, [&](const auto& s) { return upper(s).g; }),
                   .ior = mean_over_bands(stacks, [&](const auto& s) { return upper(s).ior; })};
  const bool is_single = stacks.front().layers().size() == 1;
  const Medium like{.g = options.g.value_or(is_single ? own.g : 0.0),
                    .ior = options.ior.value_or(own.ior)};
  fit.is_exact = is_homogeneous(light, stacks) && like.g == upper(stacks.front()).g &&
                 like.ior == upper(stacks.front()).ior;
  if (fit.is_exact) {
    for (const LayerStack& stack : stacks) fit.media.push_back(upper(stack));
    fit.misfits = channel_misfits(light, light.profile);
    return fit;
  }
  std::optional<HalfSpaceTable> table;
  if (!fit.is_thin())
    table.emplace(stack_of({.sigma_a = 1.0, .sigma_s = 1.0, .g = like.g, .ior = like.ior}, fit),
                  user_cache(), options.progress);
  for (std::size_t c = 0; c < light.channels.size(); ++c) {
    const Profile wanted = channel_of(light.profile, c);
    std::string note;
    fit.media.push_back(table ? fit_half_space(wanted, *table, like, fit, options.goal, note)
                              : fit_sheet(wanted, like, fit));
    if (!note.empty()) fit.notes.push_back("channel " + light.channels.names[c] + ": " + note);
  }
  fit.misfits = channel_misfits(
      light, obtained_profile(fit, table ? &*table : nullptr, light.profile, options.progress));
  return fit;
}

/// The mean cosine of all scattering, by optical thickness; half-spaces are left out.
double mean_g(std::span<const LayerStack> stacks) {
  double sum = 0.0, weights = 0.0;
  for (const LayerStack& stack : stacks)
    for (const Layer& layer : stack.layers()) {
      if (!std::isfinite(layer.thickness)) continue;
      const double weight = layer.medium.sigma_s * layer.thickness;
      sum += weight * layer.medium.g;
      weights += weight;
    }
  return weights > 0.0 ? sum / weights : 0.0;
}

double mean_profile_rms(const HomogeneousFit& fit) {
  double sum = 0.0;
  for (const ChannelMisfit& misfit : fit.misfits) {
    sum += misfit.reflectance.spread->profile_rms;
    if (misfit.transmittance) sum += misfit.transmittance->spread->profile_rms;
  }
  return sum;
}

}  // namespace

std::vector<ChannelMisfit> channel_misfits(const ChannelLight& wanted, const Profile& obtained) {
  std::vector<ChannelMisfit> misfits;
  for (std::size_t c = 0; c < wanted.channels.size(); ++c) {
    misfits.push_back({.channel = wanted.channels.names[c],
                       .reflectance = light_misfit(wanted.profile, obtained, c, true)});
    if (wanted.transmits)
      misfits.back().transmittance = light_misfit(wanted.profile, obtained, c, false);
  }
  return misfits;
}

HomogeneousFit fit_homogeneous(const ChannelLight& light, std::span<const LayerStack> stacks,
                               const HomogeneousFitOptions& options) {
  if (options.g && !(-1.0 < *options.g && *options.g < 1.0))
    throw InvalidInput("g must lie in (-1, 1), but is " + number_text(*options.g));
  if (options.ior && !(0.1 <= *options.ior && *options.ior <= 10.0))
    throw InvalidInput("ior must lie in [0.1, 10], but is " + number_text(*options.ior));
  HomogeneousFit fit = fit_of_one_g(light, stacks, options);
  if (options.g || !fit.is_thin() || stacks.front().layers().size() == 1) return fit;
  HomogeneousFitOptions forward = options;
  forward.g = mean_g(stacks);
  HomogeneousFit other = fit_of_one_g(light, stacks, forward);
  return mean_profile_rms(other) < mean_profile_rms(fit) ? other : fit;
}

}  // namespace lamina
