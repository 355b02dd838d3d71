// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {

/// Response that leaves as a wave J0(k r) of the beam's flux, diffuse light only: what
/// spatial-frequency domain imaging measures, at k = 0 what adding-doubling finds. Nodes and
/// azimuthal modes grow, from 10 and 6 to 36 and 14, until a step changes less than the accuracy
/// asked, of the value or of a hundredth of that without waves, or would take more than some 10 s.
/// The errors are what the last step changed.
struct SpatialFrequencyResponse {
  std::vector<double> k;                                       ///< [i] [1/mm]
  std::vector<double> reflectance;                             ///< [i][band]
  std::vector<double> transmittance;                           ///< [i][band]
  std::vector<double> reflectance_error, transmittance_error;  ///< [i][band] estimated, absolute
  std::vector<double> largest_error;  ///< [band], relative as the accuracy is asked
  std::vector<int> nodes, modes;      ///< [band], of the last step
};
[[nodiscard]] SpatialFrequencyResponse spatial_frequency_response(
    std::span<const LayerStack> stacks, std::span<const double> k,
    const TransferProfileOptions& options = {});

/// Responses and their derivatives by what layers are made of.
struct SpatialFrequencyDerivatives {
  SpatialFrequencyResponse response;
  std::vector<std::vector<LayerDerivatives>> reflectance, transmittance;  ///< [i][band], [layer]
};

/// Response with the derivatives on the directions that it ended with, so that a
/// fit sees the derivative of the numbers that it compares: to 1e-6 of central differences there.
/// At k = 0 those of adding-doubling's totals, less unscattered light. All layers and parameters
/// together take four to five times as long as the responses.
///
/// @throws InvalidInput as spatial_frequency_response; naming the layer, if a boundary is rough, or
///         if an infinitely thick layer absorbs nothing.
[[nodiscard]] SpatialFrequencyDerivatives spatial_frequency_derivatives(
    std::span<const LayerStack> stacks, std::span<const double> k,
    const TransferProfileOptions& options = {});

}  // namespace lamina
