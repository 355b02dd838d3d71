// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// How wrong values can be for the lattice of facets alone, as `accuracy`.
inline constexpr double rough_bsdf_error = 2e-3;

struct StackBsdfOptions {
  double accuracy = 1e-3;  ///< asked of each value, relative to it or to the mean if that is larger
  int max_nodes = 72;      ///< of the direction grid's first segment, >= 4; 42 if rough
  Progress progress = {};  ///< told that the work goes on, not how far it is
};

/// How a stack scatters a beam: radiance per irradiance [1/sr], for one angle of incidence.
///
/// What leaves in the mirror direction and straight through without being scattered has no finite
/// radiance: it is left out here and given as fractions of the flux.
struct StackBsdf {
  std::vector<double> brdf;  ///< [theta_o][phi_o]
  std::vector<double> btdf;  ///< [theta_o][phi_o]; 0 for a half-space
  double unscattered_reflectance = 0.0;
  double unscattered_transmittance = 0.0;
  double estimated_error = 0.0;  ///< largest difference between the last two grids, as `accuracy`
  int nodes = 0;                 ///< of the last grid
  int modes = 0;                 ///< azimuthal modes that were needed on it
  bool is_accurate = false;      ///< estimated_error <= options.accuracy
};

/// BRDF and BTDF by adding-doubling, one azimuthal Fourier mode after the other.
///
/// Light scattered once, with all its reflections at the interfaces, is taken out of the modes and
/// added by the phase function itself, so that forward peaks stay sharp and nothing rings. So is
/// light that meets one facet of a rough boundary and nothing else.
///
/// With rough boundaries values are good to rough_bsdf_error. Light that meets two boundaries with
/// nothing to scatter it in between must be resolved by the grid.
///
/// @param theta_i  angle of incidence outside [rad], in [0, pi/2).
/// @param theta_o  angles from the normal of the side that light leaves on [rad], in [0, pi/2).
/// @param phi_o    azimuths of the leaving light [rad]: 0 goes on, in the mirror direction and
///                 straight through; pi turns back to where the light comes from.
/// @throws InvalidInput for angles out of range, and for rough boundaries whose lobes are too
///         narrow for the finest grid; Interrupted if progress asks to stop.
///
/// Source: [Nakajima1988] for the single scattering, extended to interreflections.
[[nodiscard]] StackBsdf stack_bsdf(const LayerStack& stack, double theta_i,
                                   std::span<const double> theta_o, std::span<const double> phi_o,
                                   const StackBsdfOptions& options = {});

/// BSDFs of all bands of a material, in parallel. Bands whose indices and roughnesses are equal
/// share the operators of their rough boundaries.
[[nodiscard]] std::vector<StackBsdf> stack_bsdf(std::span<const LayerStack> bands, double theta_i,
                                                std::span<const double> theta_o,
                                                std::span<const double> phi_o,
                                                const StackBsdfOptions& options = {});

}  // namespace lamina
