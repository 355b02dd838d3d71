// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace lamina::detail {

/// Light by operators of a layer, [operator], on texels of a plane or cells of a surface:
/// those of the exit, or the sum over what both ends give (both_ends.h).
///
/// @param layer     TransportLayer or one like it: `operators`, and `of_entry` with `factor` and
///                  `operators`
/// @param at_entry  (factor, light) -> light times a function of where it enters
/// @param apply     (light, operators) -> what each makes of it
/// @param add       (sum, more)
template <class Layer, class Light, class AtEntry, class Apply, class Add>
[[nodiscard]] std::vector<Light> sum_over_entries(const Layer& layer, const Light& light,
                                                  std::span<const std::size_t> which,
                                                  const AtEntry& at_entry, const Apply& apply,
                                                  const Add& add) {
  const auto those = [&](const auto& all) {
    std::vector<decltype(all.data())> operators;
    for (const std::size_t w : which) operators.push_back(&all[w]);
    return operators;
  };
  if (layer.of_entry.empty()) return apply(light, those(layer.operators));
  std::vector<Light> sums;
  for (const auto& entry : layer.of_entry) {
    std::vector<Light> parts = apply(at_entry(entry.factor, light), those(entry.operators));
    if (sums.empty())
      sums = std::move(parts);
    else
      for (std::size_t o = 0; o < sums.size(); ++o) add(sums[o], std::move(parts[o]));
  }
  return sums;
}

}  // namespace lamina::detail
