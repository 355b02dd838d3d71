// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/solve/scattering/heterogeneous/blurs/cell_blurs.h"
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

namespace lamina {

/// A band of light on thin parts. What it points at must live until make_thin_parts returns.
struct ThinBand {
  const MappedStack* stack;         ///< its last layer is a half-space, a slab in thin parts
  const StackTables* tables;        ///< of the stack
  std::vector<double> reference;    ///< [layer], typical absorption [1/mm]
  std::span<const float> sigma_a;   ///< [cell], absorption of the last layer [1/mm]
  bool has_transfer_totals = true;  ///< what slabs transmit is scaled to radiative transfer
};

/// Parts of a surface so thin that light comes through, as ears and nostrils: what has come down to
/// the last layer at a far side comes up here. Each cell takes light from all cells that face the
/// other way, through a slab as thick as both are apart along the mean of their normals:
///
///     U(x) = a(x) sum over j of A_j (1 - n_x . n_j) / 2 T(r_xj; d_xj) a(j) D(j)
///
/// So the way follows the local geometry, thickness is none of a single ray, and what passes is
/// smooth. T is the transmittance profile of the multipole at a typical absorption; a is what the
/// maps' own makes of it: the half of the slab at that side, as light sees it that spreads on its
/// way up. So veins cast shadows which are soft by their depth.
///
/// Exact for a flat slab of one absorption. Source: [DonnerJensen2005] Eqs. 13 and 27, [Donner2008]
/// §4.3; docs/subsurface_texture_space.md.
template <int N>
struct ThinParts {
  struct Geometry;
  std::shared_ptr<const Geometry> geometry;  ///< null: nothing is thin
  CellField<N> passing;                      ///< [cell], a
  CellField<N> reflectance;      ///< [cell], of the last layer over that of a half-space
  std::vector<float> thickness;  ///< [cell], of the slab that transmits as much [mm]; 0: thick
};

/// @param positions, normals  [cell]; normals are of unit length and point outward
/// @param bands               [band], not empty
template <int N>
[[nodiscard]] ThinParts<N> make_thin_parts(const CellGraph& graph, std::span<const Vec3f> positions,
                                           std::span<const Vec3f> normals,
                                           std::span<const ThinBand> bands);

/// Light that comes up through the last layer.
/// @param down  [cell], light that has come down to it
template <int N>
[[nodiscard]] CellField<N> pass_through(const CellGraph& graph, const ThinParts<N>& thin,
                                        const CellField<N>& down);

}  // namespace lamina
