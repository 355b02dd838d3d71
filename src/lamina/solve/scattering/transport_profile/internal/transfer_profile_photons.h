// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/low_orders/diffuse_lowest_orders.h"
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/slab_totals.h"
#include "lamina/solve/scattering/spatial_frequency/illumination.h"

namespace lamina::detail {

/// Profile of a band by waves, and by what it may be wrong: curves that hold what the last step of
/// each refinement changed, times what is left of it, with their signs.
struct WaveProfile {
  ProfileCurves profile, error;  ///< per radius of a plan; the error without sign
  std::vector<ProfileCurves> changes;
  double highest = 0.0;  ///< spatial frequency that was solved [1/mm]
};

/// Light that is known without photons, per radius, and how they tell it apart.
struct LowestOrders {
  ProfileCurves curves;
  KnownLight above, below;
  double below_axis = 0.0;  ///< flux that leaves below at r = 0, and that photons count
  double unseen = 0.0;      ///< fraction of the light scattered once that it takes for unscattered
};
[[nodiscard]] LowestOrders lowest_orders(const LayerStack& stack, Illumination illumination,
                                         const HankelPlan& plan);

struct PhotonRefinement {
  ProfileCurves profile, error;  ///< the error of some two standard errors
  std::uint64_t photons = 0;
};

/// Events that photons get for an accuracy, relative: for 0.005 a second's, with facets some five.
[[nodiscard]] double events_for(const LayerStack& stack, double accuracy);

/// Whether photons can refine a profile of this stack: its top is smooth.
[[nodiscard]] bool can_refine_by_photons(const LayerStack& stack);

/// The profile of a band by waves and photons together, each where it knows more.
///
/// Waves know long wavelengths best, and light far from the beam; photons know where light is that
/// leaves near the beam, after two scatterings and more, for which waves lack directions. Light of
/// lower orders is known without them. wave_photon_blend.h has the rule.
///
/// @param events  of photons to spend, some 1e8 a CPU-second.
///
/// Source: docs/radiative_transfer_profiles.md.
/// @throws Interrupted if progress asks to stop.
[[nodiscard]] PhotonRefinement refine_by_photons(const LayerStack& stack,
                                                 const Incidence& incidence, const HankelPlan& plan,
                                                 const WaveProfile& waves,
                                                 const LowestOrders& lowest, double events,
                                                 const Progress& progress);

}  // namespace lamina::detail
