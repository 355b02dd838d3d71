// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/medium_fit/channel_light.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/transport_profile/doubtful_profile.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"

namespace lamina {
namespace {

constexpr double accuracy_of_profile = 0.01;  // on average, beside which every fit is coarse

/// Radii from well below the shortest mean free path to where next to nothing leaves.
RadialGrid grid_for(std::span<const LayerStack> stacks) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const LayerStack& stack : stacks)
    for (const Layer& layer : stack.layers())
      shortest = std::min(shortest, mfp_prime(layer.medium));
  RadialGrid grid{.first = std::clamp(0.02 * shortest, 1e-6, 1e3), .last = 0.0, .size = 0};
  grid.last = std::max(5e4 * grid.first, std::min(100.0, 5e6 * grid.first));
  constexpr double per_decade = 50.0;
  grid.size = static_cast<std::size_t>(per_decade * std::log10(grid.last / grid.first)) + 1;
  return grid;
}

void require_scattering(const Material& material, std::span<const LayerStack> stacks) {
  for (std::size_t band = 0; band < stacks.size(); ++band)
    if (std::ranges::none_of(stacks[band].layers(),
                             [](const Layer& layer) { return layer.medium.sigma_s > 0.0; }))
      throw InvalidInput(
          material.name + ", band " + band_name(material.bands, band) +
          ": a layer must scatter (sigma_s > 0) for light to be fitted, but none does");
}

const std::vector<double>& side_of(const Profile& profile, bool reflected) {
  return reflected ? profile.reflectance_profile : profile.transmittance_profile;
}

}  // namespace

Channels make_channels(const BandSet& bands, ExportChannels kind) {
  Channels channels;
  if (bands.is_rgb() || kind == ExportChannels::bands) {
    channels.wavelengths.assign(bands.wavelengths().begin(), bands.wavelengths().end());
    for (std::size_t b = 0; b < bands.size(); ++b) {
      channels.names.push_back(band_name(bands, b));
      channels.weights.emplace_back(bands.size(), 0.0).at(b) = 1.0;
    }
    return channels;
  }
  const BandWeights weights = make_band_weights(bands);
  channels.names = {"R", "G", "B"};
  channels.are_converted = true;
  for (std::size_t c = 0; c < 3; ++c) {
    channels.weights.emplace_back();
    for (const auto& of_band : weights) channels.weights.back().push_back(of_band[c]);
  }
  return channels;
}

std::vector<double> to_channels(const Channels& channels, std::span<const double> values) {
  const std::size_t bands = channels.weights.front().size();
  std::vector<double> result;
  for (std::size_t i = 0; i + bands <= values.size(); i += bands)
    for (const std::vector<double>& weights : channels.weights) {
      double sum = 0.0;
      for (std::size_t b = 0; b < bands; ++b) sum += weights[b] * values[i + b];
      result.push_back(sum);
    }
  return result;
}

ChannelLight channel_light(const Material& material, std::span<const LayerStack> stacks,
                           ExportChannels kind, const Progress& progress) {
  require_scattering(material, stacks);
  std::vector<LayerStack> smooth;
  for (const LayerStack& stack : stacks) smooth.push_back(with_smooth_ends(stack));
  const TransferProfile solved = cached_transfer_profile(user_cache(), smooth, grid_for(smooth),
                                                         {.accuracy = accuracy_of_profile,
                                                          .error = ProfileError::mean,
                                                          .illumination = Illumination::diffuse,
                                                          .progress = progress})
                                     .result;
  refuse_doubtful(solved.mean_error, "lamina export --to mcml");
  ChannelLight light{.channels = make_channels(material.bands, kind)};
  const Profile& from = solved.profile;
  Profile& to = light.profile;
  to = {.per = from.per, .bands = light.channels.size(), .r = from.r};
  to.reflectance_profile = to_channels(light.channels, from.reflectance_profile);
  to.transmittance_profile = to_channels(light.channels, from.transmittance_profile);
  // Colors of far light may fall below 0, by the weights of bands; so little that 0 will do.
  for (auto* const side : {&to.reflectance_profile, &to.transmittance_profile})
    for (double& value : *side) value = std::max(value, 0.0);
  std::vector<double> reflectance, transmittance;
  for (const AddingDoublingTotals& of_band : adding_doubling(smooth, {.is_diffuse = true})) {
    reflectance.push_back(of_band.totals.diffuse_reflectance);
    transmittance.push_back(of_band.totals.transmittance);
  }
  to.total_reflectance = to_channels(light.channels, reflectance);
  to.total_transmittance = to_channels(light.channels, transmittance);
  for (const std::vector<double>& weights : light.channels.weights) {
    double error = 0.0;
    for (std::size_t b = 0; b < weights.size(); ++b)
      error += std::abs(weights[b]) * solved.mean_error[b];
    light.mean_error.push_back(error);
  }
  light.transmits =
      std::ranges::none_of(stacks,
                           [](const LayerStack& stack) {
                             return is_semi_infinite(stack) || stack.ground().reflectance > 0.0;
                           }) &&
      std::ranges::any_of(to.total_transmittance,
                          [](double t) { return t >= least_transmittance; });
  return light;
}

double mean_square_radius(const Profile& profile, std::size_t channel, bool reflected) {
  const std::vector<double>& values = side_of(profile, reflected);
  double flux = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < profile.r.size(); ++i) {  // rings of equal relative width
    const double square = profile.r[i] * profile.r[i];
    flux += values[i * profile.bands + channel] * square;
    moment += values[i * profile.bands + channel] * square * square;
  }
  return flux > 0.0 ? moment / flux : 0.0;
}

double profile_difference(const Profile& wanted, const Profile& obtained, std::size_t channel,
                          bool reflected) {
  assert(wanted.r == obtained.r);
  const std::vector<double>& values = side_of(wanted, reflected);
  const std::vector<double>& others = side_of(obtained, reflected);
  double flux = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < wanted.r.size(); ++i) {
    const double value = values[i * wanted.bands + channel];
    const double other = std::max(others[i * obtained.bands + channel], 0.0);
    if (!(value > 0.0)) continue;  // a channel that is a difference of bands may fall below 0
    const double weight = value * wanted.r[i] * wanted.r[i];
    const double difference = 2.0 * (other - value) / (other + value);
    flux += weight;
    squares += weight * difference * difference;
  }
  return flux > 0.0 ? std::sqrt(squares / flux) : 0.0;
}

}  // namespace lamina
