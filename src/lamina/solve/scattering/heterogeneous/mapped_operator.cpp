// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/mapped_operator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/heterogeneous/internal/both_ends.h"
#include "lamina/solve/scattering/heterogeneous/internal/operator_powers.h"
#include "lamina/solve/scattering/heterogeneous/internal/sum_over_entries.h"
#include "lamina/solve/scattering/heterogeneous/tables/operator_modes.h"

namespace lamina {
namespace {

using detail::ValuesOfRows;

bool is_uniform(const LayerTexels& texels) {
  return varies_in_absorption_only(texels) && texels.sigma_a.size() == 1;
}

struct LayerToMap {
  const StackTables& tables;
  std::size_t index;
  const LayerTexels& texels;
  std::span<const double> scales;
  double tolerance;

  [[nodiscard]] const StateLattice& lattice() const { return tables.lattices[index]; }
  [[nodiscard]] bool varies_in_absorption() const {
    return lattice().axes.size() == 1 && lattice().axes[0].direction[0] == 1.0;
  }
  /// Calls `make` for each operator that there is.
  template <class Make>
  void make_operators(TransportLayer& layer, const Make& make) const {
    const auto each = operator_tables(tables.layers[index]);
    for (std::size_t which = 0; which < each.size(); ++which)
      if (!each[which]->weights.empty()) layer.operators[which] = make(*each[which]);
  }
};

TransportLayer uniform_layer(const LayerToMap& from, int width, int height) {
  TransportLayer layer{.basis = {.coordinate = make_plane(width, height)}, .operators = {}};
  const LatticePlace place = place_in(from.lattice(), state_of(from.texels, 0));
  from.make_operators(layer, [&](const GaussianTable& table) {
    return detail::on_scales({weights_at(from.lattice(), table, place)}, from.scales);
  });
  return layer;
}

/// What the texels absorb, as far as the lattice of absorptions goes.
AbsorptionRange absorption_range(const LayerToMap& from) {
  const StateAxis& axis = from.lattice().axes[0];
  const double least = std::exp(from.lattice().origin[0] + axis.low);
  const double most = std::exp(from.lattice().origin[0] + axis.high);
  const auto [low, high] = std::ranges::minmax(from.texels.sigma_a);
  return {std::clamp<double>(low, least, most), std::clamp<double>(high, least, most)};
}

/// Profiles of both ends. Stripes of melanin .01 and .06 differ by less than .2 % from those of
/// four terms.
void add_both_ends(const LayerToMap& from, const std::function<LatticePlace(double)>& place_at,
                   TransportLayer& layer) {
  constexpr std::size_t terms = 2;
  const auto each = operator_tables(from.tables.layers[from.index]);
  const detail::BothEnds ends(
      [&](double x) {
        std::array<std::vector<double>, 4> weights;
        for (std::size_t which = 0; which < each.size(); ++which)
          if (!each[which]->weights.empty())
            weights[which] = weights_at(from.lattice(), *each[which], place_at(x));
        return weights;
      },
      terms);
  for (std::size_t t = 0; t < ends.terms(); ++t) {
    TransportLayer::OfEntry& entry = layer.of_entry.emplace_back();
    entry.factor = detail::fit_powers([&](double x) { return std::vector{ends.entry(t, x)}; },
                                      {0.0}, std::array{1.0}, 1e-6)
                       .weights;
    for (std::size_t which = 0; which < each.size(); ++which)
      if (!each[which]->weights.empty())
        entry.operators[which] =
            detail::fit_powers([&](double x) { return ends.exit(t, which, x); },
                               from.tables.variances, from.scales, from.tolerance);
  }
}

/// The operators along the only axis of a lattice as powers of a coordinate in [-1, 1].
/// @param place_at  of the coordinate
void add_powers(const LayerToMap& from, const std::function<LatticePlace(double)>& place_at,
                TransportLayer& layer) {
  from.make_operators(layer, [&](const GaussianTable& table) {
    return detail::fit_powers(
        [&](double x) { return weights_at(from.lattice(), table, place_at(x)); },
        from.tables.variances, from.scales, from.tolerance);
  });
}

/// The place of a coordinate between two absorptions.
std::function<LatticePlace(double)> places_between(const StateLattice& lattice,
                                                   const AbsorptionRange& range) {
  const double low = std::sqrt(range.lowest), high = std::sqrt(range.highest);
  return [&lattice, low, high, state = state_of(lattice.origin)](double x) mutable {
    const double root = 0.5 * (low + high) + 0.5 * (high - low) * x;
    state.sigma_a = root * root;
    return place_in(lattice, state);
  };
}

/// @param most_powers_wanted  if more are needed the layer has no basis
TransportLayer layer_of_powers(const LayerToMap& from, int width, int height,
                               std::size_t most_powers_wanted, ProfileAt profile) {
  const StateLattice& lattice = from.lattice();
  const double last = static_cast<double>(lattice.axes[0].nodes - 1);
  const bool varies_in_absorption = from.varies_in_absorption();
  const AbsorptionRange range = varies_in_absorption ? absorption_range(from) : AbsorptionRange{};
  const std::function<LatticePlace(double)> place_at =
      varies_in_absorption ? places_between(lattice, range)
                           : [last](double x) { return LatticePlace{0.5 * (x + 1.0) * last}; };
  TransportLayer layer{.basis = {.coordinate = {}}, .operators = {}};
  add_powers(from, place_at, layer);
  const auto terms = [](const MappedOperator& op) { return op.terms; };
  if (std::ranges::max(layer.operators, {}, terms).terms > most_powers_wanted) return layer;
  if (varies_in_absorption) {
    layer.basis.coordinate =
        absorption_coordinate(Plane{width, height, from.texels.sigma_a}, range);
    if (profile == ProfileAt::both) add_both_ends(from, place_at, layer);
    return layer;
  }
  layer.basis.coordinate = make_plane(width, height);
  const TexelPlaces places(lattice, from.texels);
  std::vector<float>& coordinate = layer.basis.coordinate.values;
  for (std::size_t t = 0; t < coordinate.size(); ++t)
    coordinate[t] = static_cast<float>(2.0 * places.at(t)[0] / last - 1.0);
  return layer;
}

/// Values at nodes, [mode][node], at each texel: interpolated in all axes, or, where there is one
/// axis, from a table so fine that it may be linear.
void put_modes(const ValuesOfRows& at_nodes, const StateLattice& lattice, const LayerTexels& texels,
               std::vector<Plane>& modes) {
  const std::size_t count = modes.size();
  const TexelPlaces places(lattice, texels);
  std::vector<float> here(count);
  const auto put = [&](std::size_t texel) {
    for (std::size_t m = 0; m < count; ++m) modes[m].values[texel] = here[m];
  };
  if (lattice.axes.size() == 1) {
    constexpr std::size_t fine =
        16;  // steps between nodes: an error of 5e-4 of that of nodes alone
    const std::size_t rows = fine * (lattice.axes[0].nodes - 1) + 1;
    std::vector<float> table(rows * count);  // [row][mode]
    for (std::size_t row = 0; row < rows; ++row)
      for_nodes_around(lattice, {static_cast<double>(row) / fine},
                       [&](std::size_t node, double share) {
                         for (std::size_t m = 0; m < count; ++m)
                           table[row * count + m] += static_cast<float>(share * at_nodes[m][node]);
                       });
    for (std::size_t t = 0; t < modes[0].values.size(); ++t) {
      const double place = fine * places.at(t)[0];
      const std::size_t row = std::min(static_cast<std::size_t>(place), rows - 2);
      const auto f = static_cast<float>(place - static_cast<double>(row));
      const float* values = &table[row * count];
      for (std::size_t m = 0; m < count; ++m)
        here[m] = values[m] + f * (values[count + m] - values[m]);
      put(t);
    }
    return;
  }
  std::vector<float> by_node(node_count(lattice) * count);  // [node][mode]
  for (std::size_t n = 0; n < node_count(lattice); ++n)
    for (std::size_t m = 0; m < count; ++m)
      by_node[n * count + m] = static_cast<float>(at_nodes[m][n]);
  for (std::size_t t = 0; t < modes[0].values.size(); ++t) {
    std::ranges::fill(here, 0.0f);
    for_nodes_around(lattice, places.at(t), [&](std::size_t node, double share) {
      const auto weight = static_cast<float>(share);
      const float* values = &by_node[node * count];
      for (std::size_t m = 0; m < count; ++m) here[m] += weight * values[m];
    });
    put(t);
  }
}

TransportLayer layer_of_modes(const LayerToMap& from, int width, int height) {
  StateLattice lattice = from.lattice();
  if (from.varies_in_absorption()) {  // of all absorptions those that there are
    constexpr std::size_t nodes = 200;
    const AbsorptionRange range = absorption_range(from);
    lattice = absorption_lattice(state_of(lattice.origin), range.lowest, range.highest, nodes);
  }
  const auto each = operator_tables(from.tables.layers[from.index]);
  const std::size_t gaussians = from.tables.variances.size();
  std::array<ValuesOfRows, 4> at_nodes;
  for (std::size_t which = 0; which < each.size(); ++which) {
    const std::vector<double>& table = each[which]->weights;
    if (table.empty()) continue;
    for (std::size_t n = 0; n < node_count(lattice); ++n) {
      const auto row = table.begin() + static_cast<std::ptrdiff_t>(n * gaussians);
      at_nodes[which].push_back(
          from.varies_in_absorption()
              ? weights_at(from.lattice(), *each[which],
                           place_in(from.lattice(), node_state(lattice, n)))
              : std::vector<double>(row, row + static_cast<std::ptrdiff_t>(gaussians)));
    }
  }
  const detail::OperatorModes modes =
      detail::find_modes(at_nodes, from.tables.variances, from.tolerance);

  TransportLayer layer{
      .basis = {.coordinate = {},
                .modes = std::vector<Plane>(modes.at_nodes.size(), make_plane(width, height))},
      .operators = {}};
  for (std::size_t which = 0; which < each.size(); ++which)
    if (!modes.weights[which].empty())
      layer.operators[which] = detail::on_scales(modes.weights[which], from.scales);
  put_modes(modes.at_nodes, lattice, from.texels, layer.basis.modes);
  return layer;
}

}  // namespace

AbsorptionRange absorption_range(const Plane& sigma_a, const GaussianTableGrid& grid) {
  const auto [lowest, highest] = std::minmax_element(sigma_a.values.begin(), sigma_a.values.end());
  return {std::clamp<double>(*lowest, grid.lowest, grid.highest),
          std::clamp<double>(*highest, grid.lowest, grid.highest)};
}

template <class T>
PlaneOf<T> absorption_coordinate(const PlaneOf<T>& sigma_a, const AbsorptionRange& range) {
  PlaneOf<T> result = make_plane<T>(sigma_a.width, sigma_a.height);
  const T low = static_cast<T>(std::sqrt(range.lowest));
  const T width = static_cast<T>(std::sqrt(range.highest)) - low;
  if (width < T(1e-6) * low) return result;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] =
        std::clamp(T(2) * (std::sqrt(sigma_a.values[i]) - low) / width - T(1), T(-1), T(1));
  return result;
}
template Plane absorption_coordinate(const Plane&, const AbsorptionRange&);
template PlaneOf<double> absorption_coordinate(const PlaneOf<double>&, const AbsorptionRange&);

TransportLayer make_transport_layer(const StackTables& tables, std::size_t i,
                                    const LayerTexels& texels, int width, int height,
                                    std::span<const double> scales, double tolerance,
                                    ProfileAt profile) {
  const LayerToMap layer{tables, i, texels, scales, tolerance};
  if (is_uniform(texels)) return uniform_layer(layer, width, height);
  if (tables.lattices[i].axes.size() == 1) {
    constexpr std::size_t most_short_powers = 12;
    TransportLayer powers = layer_of_powers(
        layer, width, height,
        profile == ProfileAt::both && layer.varies_in_absorption() ? detail::most_powers
                                                                   : most_short_powers,
        profile);
    if (!powers.basis.coordinate.values.empty()) return powers;
  }
  return layer_of_modes(layer, width, height);
}

TransportLayer make_absorption_layer(const StackTables& tables, std::size_t i,
                                     const AbsorptionRange& range, std::span<const double> scales,
                                     double tolerance, ProfileAt profile) {
  const LayerTexels none;
  const LayerToMap from{tables, i, none, scales, tolerance};
  assert(from.varies_in_absorption());
  const auto place_at = places_between(from.lattice(), range);
  TransportLayer layer;
  if (range.lowest == range.highest)
    from.make_operators(layer, [&](const GaussianTable& table) {
      return detail::on_scales({weights_at(from.lattice(), table, place_at(0.0))}, scales);
    });
  else
    add_powers(from, place_at, layer);
  if (range.lowest < range.highest && profile == ProfileAt::both)
    add_both_ends(from, place_at, layer);
  return layer;
}

template <class T>
std::vector<PlaneOf<T>> apply_layer(const BlurPyramid& pyramid, const PlaneOf<T>& input,
                                    const TransportLayerOf<T>& layer,
                                    std::span<const std::size_t> which) {
  return detail::sum_over_entries(
      layer, input, which,
      [&](const std::vector<T>& factor, const PlaneOf<T>& light) {
        return times_basis(layer.basis, light, factor);
      },
      [&](const PlaneOf<T>& light, const auto& operators) {
        return apply_operators(pyramid, light, layer.basis, operators);
      },
      [](PlaneOf<T>& sum, const PlaneOf<T>& more) {
        for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += more.values[i];
      });
}
template std::vector<Plane> apply_layer(const BlurPyramid&, const Plane&, const TransportLayer&,
                                        std::span<const std::size_t>);
template std::vector<PlaneOf<double>> apply_layer(const BlurPyramid&, const PlaneOf<double>&,
                                                  const TransportLayerOf<double>&,
                                                  std::span<const std::size_t>);

TransportLayer ground_layer(double reflectance, int width, int height, std::size_t scales) {
  TransportLayer layer{.basis = {.coordinate = make_plane(width, height)}, .operators = {}};
  const auto value = static_cast<float>(reflectance);
  layer.operators[0] = {.terms = 1, .weights = std::vector<float>(scales, 0.0f), .totals = {value}};
  layer.operators[0].weights[0] = value;  // where the light is
  return layer;
}

}  // namespace lamina
