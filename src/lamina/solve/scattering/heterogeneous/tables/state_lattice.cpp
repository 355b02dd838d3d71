// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

#include <algorithm>
#include <cmath>

#include "lamina/layers/optics/medium.h"

namespace lamina {
namespace {

constexpr std::size_t dimensions = std::tuple_size_v<StateVector>;

double dot(const StateVector& a, const StateVector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < dimensions; ++i)
    if (std::isfinite(a[i])) sum += a[i] * b[i];
  return sum;
}

StateVector difference(const StateVector& a, const StateVector& b) {
  StateVector d{};
  for (std::size_t i = 0; i < dimensions; ++i)
    d[i] = std::isfinite(a[i]) ? a[i] - b[i] : 0.0;  // what is infinite does not vary
  return d;
}

using Covariance = std::array<StateVector, dimensions>;

/// Eigenvectors of a symmetric matrix, by Jacobi's rotations; [vector].
std::array<StateVector, dimensions> principal_axes(Covariance a) {
  std::array<StateVector, dimensions> vectors{};
  for (std::size_t i = 0; i < dimensions; ++i) vectors[i][i] = 1.0;
  for (int sweep = 0; sweep < 30; ++sweep)
    for (std::size_t p = 0; p < dimensions; ++p)
      for (std::size_t q = p + 1; q < dimensions; ++q) {
        if (std::abs(a[p][q]) <= 1e-18 * (a[p][p] + a[q][q])) continue;
        const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1.0 / std::hypot(t, 1.0), s = t * c;
        const auto rotate = [&](double& x, double& y) {
          const double old = x;
          x = c * x - s * y;
          y = s * old + c * y;
        };
        for (std::size_t k = 0; k < dimensions; ++k) rotate(a[k][p], a[k][q]);
        for (std::size_t k = 0; k < dimensions; ++k) rotate(a[p][k], a[q][k]);
        for (std::size_t k = 0; k < dimensions; ++k) rotate(vectors[p][k], vectors[q][k]);
      }
  return vectors;
}

/// Lays nodes at equal distances, fewer where all axes together would have too many.
void lay_nodes(std::vector<StateAxis>& axes, double step, std::size_t most_nodes) {
  constexpr std::size_t fewest = 4;
  for (std::size_t all = most_nodes + 1; all > most_nodes; step *= 1.1) {
    all = 1;
    for (StateAxis& axis : axes) {
      axis.nodes =
          std::max(fewest, static_cast<std::size_t>(std::ceil((axis.high - axis.low) / step)) + 1);
      all *= axis.nodes;
    }
    if (step > 100.0) break;  // five axes of four nodes are the fewest that there can be
  }
}

}  // namespace

LayerTexels uniform_texels(const LayerState& state) {
  const auto one = [](double value) { return std::vector<float>{static_cast<float>(value)}; };
  return {one(state.sigma_a), one(state.sigma_s), one(state.g), one(state.thickness),
          one(state.roughness)};
}

LayerState state_of(const LayerTexels& texels, std::size_t texel) {
  const auto at = [&](const std::vector<float>& values) {
    return static_cast<double>(values[values.size() > 1 ? texel : 0]);
  };
  return {at(texels.sigma_a), at(texels.sigma_s), at(texels.g), at(texels.thickness),
          at(texels.roughness)};
}

bool varies_in_absorption_only(const LayerTexels& texels) {
  return texels.sigma_s.size() == 1 && texels.g.size() == 1 && texels.thickness.size() == 1 &&
         texels.roughness.size() == 1;
}

StateVector state_vector(const LayerState& state) {
  return {std::log(std::max(state.sigma_a, least_coefficient)),
          std::log(std::max(state.sigma_s, least_coefficient)), std::log1p(-state.g),
          std::log(state.thickness), state.roughness};
}

LayerState state_of(const StateVector& vector) {
  return {.sigma_a = std::exp(vector[0]),
          .sigma_s = std::exp(vector[1]),
          .g = -std::expm1(vector[2]),
          .thickness = std::exp(vector[3]),
          .roughness = std::clamp(vector[4], 0.0, 1.0)};
}

std::size_t node_count(const StateLattice& lattice) {
  std::size_t count = 1;
  for (const StateAxis& axis : lattice.axes) count *= axis.nodes;
  return count;
}

LayerState state_at(const StateLattice& lattice, const LatticePlace& fractions) {
  StateVector at = lattice.origin;
  for (std::size_t a = 0; a < lattice.axes.size(); ++a) {
    const StateAxis& axis = lattice.axes[a];
    const double along = axis.low + fractions[a] * (axis.high - axis.low);
    for (std::size_t i = 0; i < dimensions; ++i) at[i] += axis.direction[i] * along;
  }
  return state_of(at);
}

LayerState node_state(const StateLattice& lattice, std::size_t node) {
  LatticePlace fractions{};
  for (std::size_t a = 0; a < lattice.axes.size(); ++a) {
    const std::size_t nodes = lattice.axes[a].nodes;
    fractions[a] = static_cast<double>(node % nodes) / static_cast<double>(nodes - 1);
    node /= nodes;
  }
  return state_at(lattice, fractions);
}

LatticePlace place_in(const StateLattice& lattice, const LayerState& state) {
  const StateVector from_origin = difference(state_vector(state), lattice.origin);
  LatticePlace place{};
  for (std::size_t a = 0; a < lattice.axes.size(); ++a) {
    const StateAxis& axis = lattice.axes[a];
    const double share = (dot(from_origin, axis.direction) - axis.low) / (axis.high - axis.low);
    place[a] = std::clamp(share, 0.0, 1.0) * static_cast<double>(axis.nodes - 1);
  }
  return place;
}

TexelPlaces::TexelPlaces(const StateLattice& lattice, const LayerTexels& texels)
    : texels_(texels),
      varies_{texels.sigma_a.size() > 1, texels.sigma_s.size() > 1, texels.g.size() > 1,
              texels.thickness.size() > 1, texels.roughness.size() > 1} {
  const StateVector first = state_vector(state_of(texels, 0));
  for (std::size_t i = 0; i < dimensions; ++i)
    varies_[i] = varies_[i] && std::isfinite(lattice.origin[i]);  // what is infinite does not
  for (const StateAxis& axis : lattice.axes) {
    Axis& to = axes_.emplace_back();
    to.last = static_cast<double>(axis.nodes - 1);
    const double nodes_per_length = to.last / (axis.high - axis.low);
    to.start = -axis.low * nodes_per_length;
    for (std::size_t i = 0; i < dimensions; ++i) {
      if (!std::isfinite(lattice.origin[i])) continue;
      const double slope = nodes_per_length * axis.direction[i];
      to.start -= slope * lattice.origin[i];
      if (varies_[i])
        to.slope[i] = slope;
      else
        to.start += slope * first[i];
    }
  }
}

LatticePlace TexelPlaces::at(std::size_t texel) const {
  // In floats, as the texels are: a logarithm's error is that of the number.
  constexpr auto least = static_cast<float>(least_coefficient);
  StateVector v{};
  if (varies_[0]) v[0] = std::log(std::max(texels_.sigma_a[texel], least));
  if (varies_[1]) v[1] = std::log(std::max(texels_.sigma_s[texel], least));
  if (varies_[2]) v[2] = std::log1p(-texels_.g[texel]);
  if (varies_[3]) v[3] = std::log(texels_.thickness[texel]);
  if (varies_[4]) v[4] = texels_.roughness[texel];
  LatticePlace place{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    double sum = axes_[a].start;
    for (std::size_t i = 0; i < dimensions; ++i) sum += axes_[a].slope[i] * v[i];
    place[a] = std::clamp(sum, 0.0, axes_[a].last);
  }
  return place;
}

StateLattice absorption_lattice(const LayerState& state, double lowest, double highest,
                                std::size_t nodes) {
  StateLattice lattice{.origin = state_vector(state), .axes = {}};
  lattice.origin[0] = 0.0;
  lattice.axes.push_back({.direction = {1.0, 0.0, 0.0, 0.0, 0.0},
                          .low = std::log(lowest),
                          .high = std::log(highest),
                          .nodes = nodes});
  return lattice;
}

StateLattice fit_lattice(const LayerTexels& texels, double step, std::size_t most_nodes,
                         double least_extent) {
  const std::size_t size = std::max({texels.sigma_a.size(), texels.sigma_s.size(), texels.g.size(),
                                     texels.thickness.size(), texels.roughness.size()});
  StateLattice lattice{.origin = state_vector(state_of(texels, 0)), .axes = {}};
  if (size == 1) return lattice;
  std::vector<StateVector> vectors;
  vectors.reserve(size);
  StateVector mean{};
  for (std::size_t i = 0; i < size; ++i) {
    vectors.push_back(difference(state_vector(state_of(texels, i)), lattice.origin));
    for (std::size_t k = 0; k < dimensions; ++k) mean[k] += vectors.back()[k];
  }
  for (double& value : mean) value /= static_cast<double>(size);
  Covariance covariance{};
  for (StateVector& v : vectors) {
    v = difference(v, mean);
    for (std::size_t i = 0; i < dimensions; ++i)
      for (std::size_t j = 0; j < dimensions; ++j) covariance[i][j] += v[i] * v[j];
  }
  for (std::size_t i = 0; i < dimensions; ++i) lattice.origin[i] += mean[i];
  for (const StateVector& direction : principal_axes(covariance)) {
    StateAxis axis{.direction = direction, .low = 0.0, .high = 0.0, .nodes = 0};
    for (const StateVector& v : vectors) {
      const double at = dot(v, direction);
      axis.low = std::min(axis.low, at), axis.high = std::max(axis.high, at);
    }
    if (axis.high - axis.low > least_extent) lattice.axes.push_back(axis);
  }
  lay_nodes(lattice.axes, step, most_nodes);
  return lattice;
}

double widest_spread(std::span<const StateLattice> lattices) {
  constexpr double of_skin = 13.2, most = 400.0;
  double widest = of_skin;
  for (const StateLattice& lattice : lattices) {
    const bool is_any_absorption = lattice.axes.size() == 1 && lattice.origin[0] == 0.0;
    if (is_any_absorption) continue;
    for (std::size_t node = 0; node < node_count(lattice); ++node) {
      const LayerState state = node_state(lattice, node);
      const double root =
          sigma_tr({.sigma_a = state.sigma_a, .sigma_s = state.sigma_s, .g = state.g});
      widest = std::max(widest, 4.0 / (root * root));
    }
  }
  return std::min(widest, most);
}

FourRows four_rows(double place, std::size_t rows) {
  const double last = static_cast<double>(rows - 1);
  place = std::clamp(place, 0.0, last);
  const double first = std::clamp(std::floor(place) - 1.0, 0.0, last - 3.0), u = place - first;
  return {static_cast<std::size_t>(first),
          {(u - 1) * (u - 2) * (u - 3) / -6, u * (u - 2) * (u - 3) / 2, u * (u - 1) * (u - 3) / -2,
           u * (u - 1) * (u - 2) / 6}};
}

}  // namespace lamina
