// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>
#include <string>

#include "gaussian_tables_fingerprint.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

namespace lamina {
namespace {

std::string key_of(const MappedStack& stack, OperatorTotals totals,
                   std::span<const double> reference_sigma_a, const GaussianTableGrid& grid) {
  PlainTextStream key;
  key << std::hexfloat << "gaussian tables, format 1, solver " LAMINA_GAUSSIAN_TABLES_FINGERPRINT
      << ' ' << static_cast<int>(totals) << ' ' << stack.ior_above << ' ' << stack.ior_below;
  for (const auto& [sigma_s, g, ior, thickness, states] : stack.layers) {
    key << " layer " << sigma_s << ' ' << g << ' ' << ior << ' ' << thickness;
    if (!states) continue;
    key << " states";
    for (const double value : states->origin) key << ' ' << value;
    for (const StateAxis& axis : states->axes) {
      key << " axis " << axis.low << ' ' << axis.high << ' ' << axis.nodes;
      for (const double value : axis.direction) key << ' ' << value;
    }
  }
  key << ' ' << name_of(stack.distribution) << " ground " << stack.ground_reflectance;
  if (totals != OperatorTotals::diffusion)
    for (const double sigma_a : reference_sigma_a) key << " reference " << sigma_a;
  const auto& [lowest, highest, rows, first_variance, gaussians, ridge] = grid;
  key << " grid " << lowest << ' ' << highest << ' ' << rows << ' ' << first_variance << ' '
      << gaussians << ' ' << ridge;
  return key.str();
}

/// Calls `act` for every table of numbers of a stack whose layers are there.
template <class Tables, class Act>
void for_each_part(Tables& tables, const Act& act) {
  act(tables.variances);
  for (auto& layer : tables.layers)
    for (auto* table : {&layer.reflection_above, &layer.transmission_down, &layer.reflection_below,
                        &layer.transmission_up}) {
      act(table->weights);
      act(table->error);
    }
}

std::string packed(const StackTables& tables) {
  std::string bytes;
  for_each_part(tables, [&](const std::vector<double>& part) {
    const std::size_t size = part.size();
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes.append(reinterpret_cast<const char*>(part.data()), size * sizeof(double));
  });
  return bytes;
}

std::optional<StackTables> unpacked(std::string_view bytes, const GaussianTableGrid& grid,
                                    const MappedStack& stack) {
  StackTables tables{.grid = grid,
                     .variances = {},
                     .ground_reflectance = stack.ground_reflectance,
                     .lattices = {},
                     .layers = std::vector<LayerTables>(stack.layers.size())};
  for (const MappedLayer& layer : stack.layers) tables.lattices.push_back(lattice_of(layer, grid));
  bool is_good = true;
  for_each_part(tables, [&](std::vector<double>& part) {
    std::size_t size = 0;
    is_good = is_good && bytes.size() >= sizeof size;
    if (!is_good) return;
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes.remove_prefix(sizeof size);
    is_good = size <= bytes.size() / sizeof(double);
    if (!is_good) return;
    part.resize(size);
    std::memcpy(part.data(), bytes.data(), size * sizeof(double));
    bytes.remove_prefix(size * sizeof(double));
  });
  return is_good && bytes.empty() ? std::optional(std::move(tables)) : std::nullopt;
}

}  // namespace

StackTables cached_stack_tables(const std::optional<DiskCache>& cache, const MappedStack& stack,
                                OperatorTotals totals, std::span<const double> reference_sigma_a,
                                const GaussianTableGrid& grid, const Progress& progress) {
  if (!cache) return make_stack_tables(stack, totals, reference_sigma_a, grid, progress);
  const std::string key = key_of(stack, totals, reference_sigma_a, grid);
  if (const auto bytes = load_cached(*cache, key))
    if (auto tables = unpacked(*bytes, grid, stack)) return std::move(*tables);
  StackTables tables = make_stack_tables(stack, totals, reference_sigma_a, grid, progress);
  save_cached(*cache, key, packed(tables));
  return tables;
}

}  // namespace lamina
