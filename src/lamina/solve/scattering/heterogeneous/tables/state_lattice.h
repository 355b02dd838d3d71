// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace lamina {

/// State of a layer at one place, in one band; its index is the same everywhere.
struct LayerState {
  double sigma_a = 0.0;                                        ///< [1/mm]
  double sigma_s = 0.0;                                        ///< [1/mm]
  double g = 0.0;                                              ///< in (-1, 1)
  double thickness = std::numeric_limits<double>::infinity();  ///< [mm], > 0
  double roughness = 0.0;  ///< of the upper boundary, microfacet alpha
  friend bool operator==(const LayerState&, const LayerState&) = default;
};

/// The states of a layer over a surface: a number for each texel, or one where it is the same
/// everywhere.
struct LayerTexels {
  std::vector<float> sigma_a, sigma_s, g, thickness, roughness;  ///< as in LayerState
};

[[nodiscard]] LayerTexels uniform_texels(const LayerState& state);
[[nodiscard]] LayerState state_of(const LayerTexels& texels, std::size_t texel);

/// Whether nothing but the absorption varies.
[[nodiscard]] bool varies_in_absorption_only(const LayerTexels& texels);

/// A state in coordinates in which operators vary smoothly: the logarithms of absorption,
/// scattering, 1 - g and thickness, and the roughness. Products of powers, as absorption and
/// scattering over a thickness that varies, are straight lines in them.
using StateVector = std::array<double, 5>;
[[nodiscard]] StateVector state_vector(const LayerState& state);
[[nodiscard]] LayerState state_of(const StateVector& vector);

/// Less absorption or scattering than this counts as this [1/mm], so that logarithms exist.
inline constexpr double least_coefficient = 1e-6;

/// A line of nodes at equal distances.
struct StateAxis {
  StateVector direction{};       ///< of length 1
  double low = 0.0, high = 0.0;  ///< of the first and the last node, from the origin
  std::size_t nodes = 0;         ///< at least 4
  friend bool operator==(const StateAxis&, const StateAxis&) = default;
};

/// States at which a layer is solved: a box of nodes around all that a surface has. Between the
/// nodes everything is interpolated by cubics.
struct StateLattice {
  StateVector origin{};
  std::vector<StateAxis> axes;  ///< none: one state
  friend bool operator==(const StateLattice&, const StateLattice&) = default;
};

/// Nodes of a lattice; the first axis runs fastest.
[[nodiscard]] std::size_t node_count(const StateLattice& lattice);
[[nodiscard]] LayerState node_state(const StateLattice& lattice, std::size_t node);

/// A number for each axis of a lattice.
using LatticePlace = StateVector;

/// The state at a fraction of each axis, 0 at its low end and 1 at its high end.
[[nodiscard]] LayerState state_at(const StateLattice& lattice, const LatticePlace& fractions);

/// Place of a state along each axis, 0 at the first node and 1 from node to node, kept within the
/// lattice. What does not lie in the box is brought to it along the axes.
[[nodiscard]] LatticePlace place_in(const StateLattice& lattice, const LayerState& state);

/// The places of texels in a lattice, as place_in finds them: only what varies is looked at.
class TexelPlaces {
 public:
  TexelPlaces(const StateLattice& lattice, const LayerTexels& texels);
  [[nodiscard]] LatticePlace at(std::size_t texel) const;

 private:
  struct Axis {
    StateVector slope{};  ///< nodes per unit of each coordinate that varies
    double start = 0.0;   ///< where these coordinates are 0
    double last = 0.0;
  };
  const LayerTexels& texels_;
  std::array<bool, std::tuple_size_v<StateVector>> varies_{};
  std::vector<Axis> axes_;
};

/// All absorptions between two [1/mm], of a layer that is otherwise as `state` says.
[[nodiscard]] StateLattice absorption_lattice(const LayerState& state, double lowest,
                                              double highest, std::size_t nodes);

/// The box along the principal axes of all texels' state vectors. What varies together is one axis,
/// and what varies by less than `least_extent` is none. The origin is the mean of the vectors.
///
/// @param step        between nodes along the longest axis at most, as far as `most_nodes` allow
[[nodiscard]] StateLattice fit_lattice(const LayerTexels& texels, double step = 0.06,
                                       std::size_t most_nodes = 1500, double least_extent = 2e-4);

/// The nodes around a place and their shares in the interpolation, which sum to 1:
/// `take(node, share)`.
template <class Take>
void for_nodes_around(const StateLattice& lattice, const LatticePlace& place, const Take& take);

/// Variance beyond which little light of any layer goes [mm²]: 4 / sigma_tr² of the state that
/// absorbs least; no less than what holds the tail of a dermis without blood.
///
/// @param lattices  [layer]
[[nodiscard]] double widest_spread(std::span<const StateLattice> lattices);

/// The four equidistant rows around a place, and their shares in Lagrange's polynomial.
struct FourRows {
  std::size_t first;
  std::array<double, 4> share;
};
[[nodiscard]] FourRows four_rows(double place, std::size_t rows);

template <class Take>
void for_nodes_around(const StateLattice& lattice, const LatticePlace& place, const Take& take) {
  const std::size_t axes = lattice.axes.size();
  std::array<FourRows, std::tuple_size_v<StateVector>> rows{};
  std::size_t corners = 1;
  for (std::size_t a = 0; a < axes; ++a) {
    rows[a] = four_rows(place[a], lattice.axes[a].nodes);
    corners *= 4;
  }
  for (std::size_t corner = 0; corner < corners; ++corner) {
    std::size_t node = 0, stride = 1, digits = corner;
    double share = 1.0;
    for (std::size_t a = 0; a < axes; ++a, digits /= 4) {
      node += stride * (rows[a].first + digits % 4);
      stride *= lattice.axes[a].nodes;
      share *= rows[a].share[digits % 4];
    }
    take(node, share);
  }
}

}  // namespace lamina
