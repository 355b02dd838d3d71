// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "lamina/base/spectrum/band_values.h"

namespace lamina {

namespace detail {
template <int W>
struct HalvesOf {
  typedef std::uint16_t Halves __attribute__((vector_size(2 * W)));
  typedef std::uint32_t Words __attribute__((vector_size(4 * W)));
};
}  // namespace detail

/// Values to a relative error of 2^-8, in half the memory: the upper halves of floats (bfloat16).
template <int N>
struct BriefBands {
  std::uint16_t v[N] = {};
};

/// Rounds to nearest. The values must be finite.
template <int N>
[[nodiscard]] BriefBands<N> brief(const BandValues<N>& values) {
  BriefBands<N> result;
  for (int i = 0; i < N; ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(values.v[i]);
    result.v[i] = static_cast<std::uint16_t>((bits + 0x7fffu + (bits >> 16 & 1u)) >> 16);
  }
  return result;
}

template <int N>
[[nodiscard]] BandValues<N> in_full(const BriefBands<N>& values) {
  using Bands = BandValues<N>;
  using Halves = detail::HalvesOf<Bands::lanes>::Halves;
  using Words = detail::HalvesOf<Bands::lanes>::Words;
  Bands result;
  for (int i = 0; i < N; i += Bands::lanes) {
    Halves upper;
    std::memcpy(&upper, values.v + i, sizeof upper);
    const Words bits = __builtin_convertvector(upper, Words) << 16;
    std::memcpy(result.v + i, &bits, sizeof bits);
  }
  return result;
}

}  // namespace lamina
