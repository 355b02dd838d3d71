// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/profile.h"

namespace lamina {

/// Channels that the numbers of an exported material are per.
enum class ExportChannels {
  rgb,    ///< channels of linear Rec.709/sRGB
  bands,  ///< the bands of the material: these channels too, or wavelengths
};

template <>
inline constexpr auto enum_names<ExportChannels> = std::to_array<EnumName<ExportChannels>>(
    {{"rgb", ExportChannels::rgb}, {"bands", ExportChannels::bands}});

/// Channels as sums over bands.
struct Channels {
  std::vector<std::string> names;            ///< "R", or a wavelength as "540"
  std::vector<double> wavelengths;           ///< [channel] [nm]; empty for R, G, B
  std::vector<std::vector<double>> weights;  ///< [channel][band], of sum 1
  bool are_converted = false;                ///< from wavelengths to R, G, B

  [[nodiscard]] std::size_t size() const { return names.size(); }
};

/// Channels R, G, B of a spectral material are the colors of its light under D65, by
/// make_band_weights: light adds up, coefficients do not.
[[nodiscard]] Channels make_channels(const BandSet& bands, ExportChannels kind);

/// Numbers per band as numbers per channel.
/// @param values  [i][band]
/// @return        [i][channel]
[[nodiscard]] std::vector<double> to_channels(const Channels& channels,
                                              std::span<const double> values);

/// Light that layers send back and through where it arrives evenly from all directions at a point,
/// per channel and arriving flux: what renderers that follow light below a surface show of a
/// material. The first reflection at the upper boundary is no part of it.
///
/// The upper and the lowest boundary count as smooth, their roughness being the renderer's
/// business.
struct ChannelLight {
  Channels channels;
  Profile profile;                 ///< bands are channels; totals by adding-doubling
  std::vector<double> mean_error;  ///< [channel], estimated, of the profile, relative, by flux
  bool transmits = false;          ///< there is a lower side from which light leaves
};

/// By radiative transfer; kept in the user's cache.
///
/// @param stacks  [band]; every band must scatter.
/// @throws InvalidInput naming the band that does not scatter, or as transfer_profile; Interrupted.
[[nodiscard]] ChannelLight channel_light(const Material& material,
                                         std::span<const LayerStack> stacks, ExportChannels kind,
                                         const Progress& progress = {});

/// Channels of less transmitted light than this in all of them are those of something thick.
inline constexpr double least_transmittance = 1e-3;

/// The mean square of the distance at which light leaves [mm²], within the radii of the profile:
/// of what hardly absorbs it grows with them.
[[nodiscard]] double mean_square_radius(const Profile& profile, std::size_t channel,
                                        bool reflected);

/// How far one profile is from another: the root of the mean square of the difference over the mean
/// of both, weighted by the flux of `wanted` in each ring; between 0 and 2, and for small ones the
/// relative difference. Both have the same radii.
[[nodiscard]] double profile_difference(const Profile& wanted, const Profile& obtained,
                                        std::size_t channel, bool reflected);

}  // namespace lamina
