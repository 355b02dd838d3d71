// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/base/core/estimate.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// Flat layers whose absorption varies along the surface: a rectangle of square texels that repeats
/// without end in x and y. All maps are [row, column]; an empty map does not vary.
struct Patch {
  LayerStack stack;           ///< smooth boundaries, black ground
  int columns = 1, rows = 1;  ///< >= 1
  double texel = 1.0;         ///< edge of a texel [mm], > 0

  /// [layer] absorption coefficient [1/mm], >= 0, in place of the layer's own.
  std::vector<std::vector<double>> sigma_a;

  /// [layer] fraction of the light that passes each crossing of the layer's lower boundary, in [0,
  /// 1]: ink or basal melanin in a thin sheet. Empty: all.
  std::vector<std::vector<double>> junction;

  std::vector<double> irradiance;  ///< >= 0, not all 0; empty: 1
};

struct PatchPhotonOptions {
  std::uint64_t photons = 1'000'000;  ///< >= 1
  std::uint64_t seed = 0;
  Incidence incidence;
  Progress progress;  ///< may stop the run, which keeps what it has
};

struct PatchPhotons {
  std::uint64_t photons = 0;          ///< that were followed
  std::vector<Estimate> exitance;     ///< [row, column], in the unit of the irradiance
  std::vector<Estimate> transmitted;  ///< likewise, of what leaves below
};

/// Follows photons through layers of varying absorption: the reference for solvers that blur.
///
/// Free paths are drawn from the scattering coefficient, which does not vary, and the weight falls
/// by the absorption along the path, texel by texel, so nothing is approximated. The exitance is
/// what leaves at the top, averaged over each texel; the first reflection is left out. The result
/// does not depend on the number of threads.
///
/// Source: [HanrahanKrueger1993] Figure 7, with absorption along the path in place of the albedo.
/// @throws InvalidInput if a map has the wrong size or a value out of range, or a boundary is
/// rough.
[[nodiscard]] PatchPhotons trace_patch_photons(const Patch& patch,
                                               const PatchPhotonOptions& options = {});

}  // namespace lamina
