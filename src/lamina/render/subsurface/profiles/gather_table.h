// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/subsurface/profiles/profile_table.h"

namespace lamina {

/// A profile over the square of the radius, for sums over many points: no root, no logarithm.
///
/// Nodes stand at the numbers whose float has its upper bits only, 32 to a doubling of r²; between
/// them the profile is a line over r², which errs by less than 1e-3 where it falls as r^-4.
template <int N>
class RadialTable {
 public:
  RadialTable() = default;
  /// @param first_r2, last_r2  range [mm²]; below it the first value holds, above it 0
  RadialTable(float first_r2, float last_r2);

  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] float node_r2(std::size_t i) const {
    return std::bit_cast<float>((first_ + static_cast<std::uint32_t>(i)) << shift);
  }
  BandValues<N>& operator[](std::size_t i) { return values_[i]; }
  const BandValues<N>& operator[](std::size_t i) const { return values_[i]; }

  struct Place {
    std::size_t i;
    float f;  ///< of the way to the next node
  };
  /// @param r2  [mm²], >= 0
  [[nodiscard]] Place place(float r2) const {
    const auto bits = std::bit_cast<std::uint32_t>(r2);
    const std::uint32_t key = bits >> shift;
    if (key < first_) return {0, 0.0f};
    if (key - first_ + 2 > values_.size()) return {values_.size() - 1, 0.0f};
    constexpr std::uint32_t mask = (1u << shift) - 1u;
    return {key - first_, static_cast<float>(bits & mask) * (1.0f / (1u << shift))};
  }
  [[nodiscard]] BandValues<N> at(float r2) const {
    const auto [i, f] = place(r2);
    return f > 0.0f ? values_[i] + f * (values_[i + 1] - values_[i]) : values_[i];
  }

 private:
  static constexpr int shift = 18;
  std::uint32_t first_ = 0;
  std::vector<BandValues<N>> values_;  ///< [node] [1/mm²]; the last is 0
};

/// Both profiles of a material, spread by as much as the samples that they are summed over are
/// apart: else each sample would show as a spot where the profile is narrower than that.
template <int N>
struct GatherTable {
  RadialTable<N> reflectance, transmittance;
  bool is_transmitting = false;
};

/// @param blur  standard deviation [mm] of the Gaussian that the profiles are convolved with. Their
///              totals are kept. 0 for none.
template <int N>
[[nodiscard]] std::vector<GatherTable<N>> make_gather_tables(
    std::span<const ProfileTable<N>> tables, float blur);

/// The radius [mm] within which a band reflects half of its light, the smallest of all bands that
/// reflect more than `least` in total.
template <int N>
[[nodiscard]] float smallest_half_radius(const ProfileTable<N>& table, float least = 0.005f);

}  // namespace lamina
