// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// A stack of layers as multipoles that exchange diffuse flux; one wavelength.
struct LayeredDiffusion {
  std::vector<Multipole> layers;   ///< from the lit surface downward
  double ground_reflection = 0.0;  ///< fraction of the flux out of the last layer that a ground
                                   ///< sends back into it, in [0, 1]
  Interreflections interreflections = Interreflections::all;
};

/// Every boundary may be rough; the roughness changes what it turns back from inside.
///
/// Holds where each layer is a few reduced mean free paths thick and scatters much more than it
/// absorbs. For skin the totals are right within 5 % and the profile within tens of percent.
///
/// @throws InvalidInput naming the first layer that does not scatter: light does not diffuse there.
///
/// Source: [DonnerJensen2005] §§2.2-2.4.
[[nodiscard]] LayeredDiffusion make_layered_diffusion(const LayerStack& stack,
                                                      const DiffusionOptions& options = {});

/// Layered diffusion of all bands of a material; boundaries that bands share are worked out once.
/// @throws InvalidInput naming the band too.
[[nodiscard]] std::vector<LayeredDiffusion> make_layered_diffusion(
    std::span<const LayerStack> stacks, const DiffusionOptions& options = {});

/// Response of what is under the last layer: open space, or a ground that lets nothing pass.
[[nodiscard]] LayerResponse ground_response(const LayeredDiffusion& model);

/// Response of the whole stack at spatial frequency k [1/mm], k >= 0, per flux that has entered.
[[nodiscard]] LayerResponse response(const LayeredDiffusion& model, double k);

/// The limit of `response` for k to infinity: what leaves where it entered, because it crossed thin
/// layers only, or met a ground under them.
[[nodiscard]] LayerResponse local_response(const LayeredDiffusion& model);

/// Indices of the layers that are thinner than their source depth. There the model is crude, as
/// `response(const Multipole&, double)` says.
[[nodiscard]] std::vector<std::size_t> thin_layers(const LayeredDiffusion& model);

/// Totals of the light that arrives on a stack, by diffusion at k = 0. The absorptance of a
/// layer is the net flux into it; the light that enters does so as diffuse flux, whatever its
/// angle, so incidence counts in the specular reflectance only. Over a ground that reflects,
/// `transmittance` is what the ground takes.
///
/// @throws InvalidInput as make_layered_diffusion.
[[nodiscard]] SlabTotals diffusion_totals(const LayerStack& stack, const Incidence& incidence,
                                          const DiffusionOptions& options = {});

}  // namespace lamina
