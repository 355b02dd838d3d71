// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/exchange/medium_fit/channel_light.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// Property that one half-space shall have in common with layers, besides its total.
enum class FitGoal {
  profile,            ///< as near as can be to R(r), by profile_difference
  mean_square_radius  ///< the same mean square radius
};

template <>
inline constexpr auto enum_names<FitGoal> = std::to_array<EnumName<FitGoal>>(
    {{"profile", FitGoal::profile}, {"mean_square_radius", FitGoal::mean_square_radius}});

/// Light as it is wanted and as it is obtained. Totals are fractions of the arriving flux; the
/// first reflection is no part of them.
struct LightMisfit {
  struct Spread {
    double wanted_mean_square_radius = 0.0, obtained_mean_square_radius = 0.0;  ///< [mm²]
    double profile_rms = 0.0;  ///< by profile_difference
  };
  double wanted_total = 0.0, obtained_total = 0.0;
  std::optional<Spread> spread;  ///< absent if only totals are known
};

/// How far what was written is from the material, one channel.
struct ChannelMisfit {
  std::string channel;
  LightMisfit reflectance;
  std::optional<LightMisfit> transmittance;  ///< of what lets light through
};

/// How one of two profiles stands for the other, per channel.
[[nodiscard]] std::vector<ChannelMisfit> channel_misfits(const ChannelLight& wanted,
                                                         const Profile& obtained);

struct HomogeneousFitOptions {
  /// Absent: that of a single layer; of several 0, and in sheets their mean if the profile is then
  /// nearer. In thick skin 0 is nearer than its own .8.
  std::optional<double> g;
  std::optional<double> ior;  ///< absent: that of the upper layer, the mean of its bands
  FitGoal goal = FitGoal::profile;
  Progress progress = {};
};

/// A homogeneous material that does to light nearly what layers do: one medium per channel, all
/// with the same g and index.
struct HomogeneousFit {
  Channels channels;
  std::vector<Medium> media;  ///< [channel], in mm
  /// [mm]; infinite, or that of all layers together if they let light through.
  double thickness = std::numeric_limits<double>::infinity();
  Interface top;  ///< as the material has it
  double ior_above = 1.0, ior_below = 1.0;
  std::vector<ChannelMisfit> misfits;  ///< [channel]
  bool is_exact = false;               ///< these are the material's own numbers
  std::vector<std::string> notes;      ///< what could not be met

  [[nodiscard]] double g() const { return media.front().g; }
  [[nodiscard]] double ior() const { return media.front().ior; }
  [[nodiscard]] bool is_thin() const { return thickness < std::numeric_limits<double>::infinity(); }
};

/// Something thick: the total of each channel is met by the albedo, then the profile by the mean
/// free path. Something thin, which is as thick as its layers together: both totals are met by
/// inverse adding-doubling, and the profile is what comes of it. All by radiative transfer.
///
/// A single layer that scatters by Henyey and Greenstein's function, of one g and index in all
/// bands, is taken as it is.
///
/// @param light  channel_light of these stacks.
/// @throws InvalidInput if g or ior cannot be; Interrupted.
[[nodiscard]] HomogeneousFit fit_homogeneous(const ChannelLight& light,
                                             std::span<const LayerStack> stacks,
                                             const HomogeneousFitOptions& options = {});

}  // namespace lamina
