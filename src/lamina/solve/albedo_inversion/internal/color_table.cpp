// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/internal/color_table.h"

#include <algorithm>
#include <vector>

namespace lamina::detail {
namespace {

/// Orders of s with a common order of the other variables.
struct Row {
  std::uint8_t roughness, ior, g, size;
  std::uint32_t at;  ///< of the first in ColorTable::values
};

struct ColorTable {
  std::array<std::vector<Row>, 4> rows;  ///< [distribution, light], without empty ones
  std::vector<double> values;
};

ColorTable read_table() {
  ColorTable table;
  std::size_t next = 0;
  for (std::vector<Row>& rows : table.rows)
    for (std::size_t r = 0; r < roughness_orders; ++r)
      for (std::size_t n = 0; n < ior_orders; ++n)
        for (std::size_t g = 0; g < g_orders; ++g) {
          const auto size = static_cast<std::size_t>(color_table_rows[next++]);
          if (size > 0)
            rows.push_back({static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(n),
                            static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(size),
                            static_cast<std::uint32_t>(table.values.size())});
          for (std::size_t s = 0; s < size; ++s)
            table.values.push_back(color_table_unit * color_table_rows[next++]);
        }
  // Loops of one length after the other: processors guess their ends.
  for (std::vector<Row>& rows : table.rows) std::ranges::stable_sort(rows, {}, &Row::size);
  return table;
}

template <std::size_t orders>
std::array<double, orders> chebyshev(double x) {
  std::array<double, orders> values = {1.0, x};
  for (std::size_t n = 2; n < orders; ++n) values[n] = 2.0 * x * values[n - 1] - values[n - 2];
  return values;
}

}  // namespace

ColorCoefficients color_coefficients(double ior, double g, const Interface& top, bool is_diffuse) {
  static const ColorTable table = read_table();
  const auto by_roughness = chebyshev<roughness_orders>(roughness_coordinate(top.roughness));
  const auto by_ior = chebyshev<ior_orders>(ior_coordinate(ior));
  const auto by_g = chebyshev<g_orders>(g_coordinate(g));
  const std::size_t part =
      (top.distribution == MicrofacetDistribution::ggx ? 2u : 0u) + (is_diffuse ? 1u : 0u);

  std::array<double, roughness_orders * ior_orders> by_surface;
  for (std::size_t r = 0; r < roughness_orders; ++r)
    for (std::size_t n = 0; n < ior_orders; ++n)
      by_surface[r * ior_orders + n] = by_roughness[r] * by_ior[n];

  // Several sums, so that none waits for the last row.
  std::array<std::array<double, s_orders>, 4> sums = {};
  std::size_t next = 0;
  for (const Row& row : table.rows[part]) {
    const double weight =
        by_surface[std::size_t{row.roughness} * ior_orders + row.ior] * by_g[row.g];
    const double* const values = &table.values[row.at];
    std::array<double, s_orders>& sum = sums[next++ % sums.size()];
    for (std::size_t s = 0; s < row.size; ++s) sum[s] += weight * values[s];
  }
  ColorCoefficients found;
  for (const auto& sum : sums)
    for (std::size_t s = 0; s < s_orders; ++s) found.q[s] += sum[s];
  const auto reflection =
      first_reflection_rows.subspan(part * by_surface.size(), by_surface.size());
  for (std::size_t i = 0; i < by_surface.size(); ++i)
    found.first_reflection += first_reflection_unit * reflection[i] * by_surface[i];
  return found;
}

}  // namespace lamina::detail
