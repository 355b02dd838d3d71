// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/solve/scattering/low_orders/diffuse_lowest_orders.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina::detail {

/// One band's profile, with an estimate of its error.
struct BandProfile {
  ProfileCurves profile;
  ProfileCurves error;           ///< estimated, absolute [1/mm²]
  double estimated_error = 0.0;  ///< largest, relative, where it is asked for
  double mean_error = 0.0;       ///< of all light, relative, of the side where it is larger
  int nodes = 0, modes = 0, frequencies = 0;
  std::uint64_t photons = 0;  ///< that took part
};

/// Nodes, azimuthal modes and frequencies are chosen one after the other, each with the other two
/// kept low, until one step more changes little: their errors hardly depend on one another. Then
/// their changes are added up, or the band is solved once with all three. Where that does not reach
/// the accuracy asked, or would take more than a second, photons refine the profile.
///
/// @param flux  what the profile adds up to over the plane. How much light there is takes fewer
///              directions to know than where it goes: what they miss is put right by a factor.
[[nodiscard]] BandProfile solve_band(const LayerStack& stack, const HankelPlan& plan,
                                     const TransferProfileOptions& options,
                                     const FrequencyResponse& flux);

}  // namespace lamina::detail
