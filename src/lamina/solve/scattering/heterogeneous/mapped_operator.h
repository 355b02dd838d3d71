// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/texel_operators.h"
#include "lamina/solve/scattering/heterogeneous/path_absorption.h"
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

namespace lamina {

/// Absorptions that a map holds [1/mm]. What lies outside counts as the nearer end.
struct AbsorptionRange {
  double lowest, highest;
};

/// The range of a map, widened to hold no less than the table's rows do and no more.
[[nodiscard]] AbsorptionRange absorption_range(const Plane& sigma_a, const GaussianTableGrid& grid);

/// Place of each absorption in the range: its square root, -1 at the lowest and 1 at the highest.
/// (Diffusion depends on the root of absorption: so polynomials of low degree do.)
template <class T>
[[nodiscard]] PlaneOf<T> absorption_coordinate(const PlaneOf<T>& sigma_a,
                                               const AbsorptionRange& range);

/// A layer over a surface: its operators, and the functions of the texel that their weights are
/// sums of.
template <class T>
struct TransportLayerOf {
  TexelBasisOf<T> basis;
  std::array<MappedOperatorOf<T>, 4> operators;  ///< R+, T+, R-, T-; a half-space has R+ only
  /// Where profiles are those of both ends: what becomes of the light times a function of where it
  /// enters.
  struct OfEntry {
    std::vector<T> factor;  ///< [term] of the basis
    std::array<MappedOperatorOf<T>, 4> operators;
  };
  std::vector<OfEntry> of_entry;  ///< empty: profiles of the exit
};
using TransportLayer = TransportLayerOf<float>;

/// Light by operators of a layer, [operator].
template <class T>
[[nodiscard]] std::vector<PlaneOf<T>> apply_layer(const BlurPyramid& pyramid,
                                                  const PlaneOf<T>& input,
                                                  const TransportLayerOf<T>& layer,
                                                  std::span<const std::size_t> which);

/// The operators of layer i of a stack as its states vary over texels.
///
/// Where one axis of states is all that varies, and polynomials are short, the basis is the powers
/// of a coordinate along it: of absorption alone the square root, else the place along the axis.
/// Otherwise it is modes: functions of the state, orthogonal to one another, that together hold the
/// operators of all nodes of the lattice to `tolerance` of their largest totals. They are found by
/// taking in, again and again, the node that the modes so far miss most (Gram and Schmidt's
/// process with pivots), so they are few: about as many as the operators have independent shapes.
///
/// @param texels  width * height of them, or one where all are the same
/// @param scales  of the tables' Gaussians, as scales_of_gaussians gives them
[[nodiscard]] TransportLayer make_transport_layer(const StackTables& tables, std::size_t i,
                                                  const LayerTexels& texels, int width, int height,
                                                  std::span<const double> scales, double tolerance,
                                                  ProfileAt profile = ProfileAt::exit);

/// The operators of a layer of which only absorption varies, by powers of its coordinate between
/// two absorptions. The basis is left to the caller: absorption_coordinate between the same two.
[[nodiscard]] TransportLayer make_absorption_layer(const StackTables& tables, std::size_t i,
                                                   const AbsorptionRange& range,
                                                   std::span<const double> scales, double tolerance,
                                                   ProfileAt profile);

/// A ground that returns a part of the light where it arrives.
/// @param scales  how many there are
[[nodiscard]] TransportLayer ground_layer(double reflectance, int width, int height,
                                          std::size_t scales);

}  // namespace lamina
