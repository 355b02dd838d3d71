// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace lamina {

/// A stream of random numbers: xoshiro256++, seeded through splitmix64.
///
/// Each photon, pixel or sample has its own stream, `make_random(seed, index)`, so a result depends
/// on the seed alone and not on threads or on how the work was split.
///
/// Source: [BlackmanVigna2021].
class Random {
 public:
  explicit Random(std::uint64_t state) {
    for (auto& word : state_) word = splitmix(state);
  }

  [[nodiscard]] std::uint64_t bits() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform in [0, 1), a multiple of 2^-24.
  [[nodiscard]] float uniform_float() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }

  /// One step of splitmix64: a good hash of `state`, which moves on.
  static std::uint64_t splitmix(std::uint64_t& state) {
    state += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_[4];
};

/// The stream number `index` of a seed. Streams of different indices are independent.
[[nodiscard]] inline Random make_random(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t state = seed;
  const std::uint64_t hashed_seed = Random::splitmix(state);
  state = hashed_seed ^ (index * 0xd1342543de82ef95u);
  return Random(Random::splitmix(state));
}

}  // namespace lamina
