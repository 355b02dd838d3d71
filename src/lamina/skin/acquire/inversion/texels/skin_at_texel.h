// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "lamina/base/core/small_matrix.h"
#include "lamina/skin/fit/skin/skin_population.h"

namespace lamina::detail {

inline constexpr std::size_t most_free_numbers = 8;
inline constexpr std::size_t skin_layer_count = 2;  ///< epidermis, dermis

/// Numbers [number] at a texel.
using TexelNumbers = SmallVector<most_free_numbers>;
/// A symmetric matrix over them.
using TexelMatrix = SmallMatrix<most_free_numbers>;

/// Absorption of epidermis and dermis [1/mm], and its derivatives by coordinates of numbers.
struct LayerAbsorption {
  std::array<double, skin_layer_count> sigma_a = {};
  std::array<TexelNumbers, skin_layer_count> by_number = {};
};

/// Skin at one texel after the other: its numbers are set, then its absorption is asked for.
class SkinAtTexel {
 public:
  /// @param numbers  must outlive this
  SkinAtTexel(std::span<const SkinFitNumber> numbers, const SkinParameters& skin);

  void set(std::span<const double> coordinates);
  [[nodiscard]] LayerAbsorption absorption(const SkinSpectrum& spectrum);

 private:
  std::span<const SkinFitNumber> numbers_;
  SkinParameters skin_;
  TexelNumbers values_ = {}, slopes_ = {};  ///< of values by coordinates
};

/// The nearest coordinate whose value lies in the number's range.
[[nodiscard]] double coordinate_in_range(const FitParameter& parameter, double coordinate);

}  // namespace lamina::detail
