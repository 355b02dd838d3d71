// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"

namespace lamina {

namespace detail {

[[nodiscard]] inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Owen's nested uniform scrambling of a number whose bits are reversed: each bit is flipped by a
/// hash of the bits above it. Source: [Burley2020] §3, after Laine and Karras.
[[nodiscard]] inline std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// The second Sobol dimension of an index, bits reversed. Its generator matrix is Pascal's triangle
/// modulo 2, a Kronecker power of [[1, 1], [0, 1]], and so takes five steps.
[[nodiscard]] inline std::uint32_t sobol_second_reversed(std::uint32_t x) {
  x ^= (x >> 16) & 0x0000ffffu;
  x ^= (x >> 8) & 0x00ff00ffu;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 1) & 0x55555555u;
  return x;
}

[[nodiscard]] inline std::uint32_t hash_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x21f0aaadu;
  x ^= x >> 15;
  x *= 0xd35a2d97u;
  return x ^ (x >> 15);
}

/// The fraction x / 2^32, below 1.
[[nodiscard]] inline float unit_fraction(std::uint32_t x) {
  return static_cast<float>(x >> 8) * 0x1p-24f;
}

}  // namespace detail

/// The random numbers of one sample of one pixel, dealt in pairs.
///
/// Over the samples of a pixel each pair is an Owen-scrambled (0, 2)-sequence: any 2^k first
/// samples are stratified in every way. Pairs are shuffled against one another and pixels are
/// independent, so a pixel's value does not depend on who computes it, or when.
///
/// Source: [Burley2020], shuffled and scrambled (0, 2)-sequences padded to any dimension.
class PixelSamples {
 public:
  PixelSamples(std::uint64_t seed, std::uint32_t pixel, std::uint32_t sample)
      : key_(detail::hash_bits(
            pixel ^ detail::hash_bits(
                        static_cast<std::uint32_t>(seed) ^
                        detail::hash_bits(static_cast<std::uint32_t>(seed >> 32) + 0x9e3779b9u)))),
        sample_reversed_(detail::reverse_bits(sample)) {}

  /// Uniform in the unit square.
  [[nodiscard]] Vec2f next_2d() {
    const std::uint32_t index = next_index();
    const std::uint32_t x = detail::scramble_reversed(index, detail::hash_bits(key_ ^ 0x55aa55aau));
    const std::uint32_t y = detail::scramble_reversed(detail::sobol_second_reversed(index),
                                                      detail::hash_bits(key_ ^ 0xc3a5c3a5u));
    return {detail::unit_fraction(detail::reverse_bits(x)),
            detail::unit_fraction(detail::reverse_bits(y))};
  }

  /// Uniform in [0, 1).
  [[nodiscard]] float next_1d() {
    const std::uint32_t index = next_index();
    const std::uint32_t x = detail::scramble_reversed(index, detail::hash_bits(key_ ^ 0x55aa55aau));
    return detail::unit_fraction(detail::reverse_bits(x));
  }

  /// The samples of one of several paths that start where this sample has come to. Over all
  /// samples of the pixel the paths are stratified together.
  [[nodiscard]] PixelSamples branch(std::uint32_t path, std::uint32_t paths) const {
    PixelSamples own = *this;
    own.sample_reversed_ =
        detail::reverse_bits(detail::reverse_bits(sample_reversed_) * paths + path);
    return own;
  }

 private:
  std::uint32_t next_index() {
    key_ += 0x9e3779b9u;
    return detail::reverse_bits(
        detail::scramble_reversed(sample_reversed_, detail::hash_bits(key_)));
  }

  std::uint32_t key_;              ///< of the pixel and the dimension
  std::uint32_t sample_reversed_;  ///< index of the sample, bits reversed
};

/// A stream for what needs any number of random numbers.
[[nodiscard]] inline Random make_stream(PixelSamples& samples) {
  const Vec2f u = samples.next_2d();
  return Random((std::uint64_t{std::bit_cast<std::uint32_t>(u.x)} << 32) |
                std::bit_cast<std::uint32_t>(u.y));
}

}  // namespace lamina
