// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {

/// Light that one layer scatters once, between two nodes of the grid, with all reflections before
/// and after: the factors of the phase function, in flux over the square root of etendue.
struct SingleScattering {
  double same_side = 0.0;      ///< of scattering on into the same hemisphere
  double opposite_side = 0.0;  ///< of scattering into the other
};

/// Unscattered light of a node inside each layer: its flux down at the layer's top and up at its
/// bottom, for unit flux from outside.
struct LayerFlux {
  double down = 0.0, up = 0.0;
};

/// For light that enters from above, or from below; extinction as the grid has it. By reciprocity
/// also the fraction of light inside, going the other way, that leaves unscattered on that side.
[[nodiscard]] std::vector<LayerFlux> unscattered_from_above(const GridStack& stack,
                                                            std::size_t node);
[[nodiscard]] std::vector<LayerFlux> unscattered_from_below(const GridStack& stack,
                                                            std::size_t node);

/// One layer's light from node `in`, scattered once towards node `out`.
///
/// @param arriving  of `in`, as unscattered_from_above gives it.
/// @param leaving   of `out`, for the side that the light leaves on.
[[nodiscard]] SingleScattering single_scattering(const GridLayer& layer, std::size_t in,
                                                 const LayerFlux& arriving, std::size_t out,
                                                 const LayerFlux& leaving);

/// Light that meets one facet of a rough boundary and is scattered nowhere else: the first rough
/// boundary that a beam from above comes to, or none.
struct SingleFacet {
  std::size_t interface = 0;
  double weight = 0.0;  ///< radiance outside per radiance from the facet and unit flux of the beam
};

/// For light from the node of a beam above that leaves above or below by the node `out`.
[[nodiscard]] SingleFacet single_facet(const GridStack& stack, std::size_t beam, std::size_t out,
                                       bool leaves_above);

/// Radiance outside per irradiance [1/sr]; `phi` is the azimuth, 0 is forward.
[[nodiscard]] double facet_radiance(const GridStack& stack, const SingleFacet& facet,
                                    std::size_t beam, std::size_t out, bool leaves_above,
                                    double phi);

}  // namespace lamina::detail
