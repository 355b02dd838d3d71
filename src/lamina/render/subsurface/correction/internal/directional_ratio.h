// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lamina/base/core/small_matrix.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"

namespace lamina {

/// Number of terms of the ratio of two radiances that leave a surface: a constant, the cosine to
/// the normal inside, and the direction along the surface inside. Where light diffuses, radiance
/// inside is linear in the direction: the fluence and the net flux.
inline constexpr std::size_t direction_terms = 5;
using DirectionTerms = std::array<float, direction_terms>;

/// @param direction  in which light leaves, unit length
/// @param normal     of the surface, unit length
/// @param ior        inside over outside, > 0
[[nodiscard]] inline DirectionTerms direction_terms_of(const Vec3f& direction, const Vec3f& normal,
                                                       float ior) {
  const Vec3f along = (direction - dot(direction, normal) * normal) / std::max(ior, 1.0f);
  const float cosine = std::sqrt(std::max(1.0f - dot(along, along), 0.0f));
  // In the middle of what leaves, so that terms hardly depend on each other.
  constexpr float middle = 0.85f, half_width = 0.2f;
  return {1.0f, (cosine - middle) / half_width, along.x, along.y, along.z};
}

/// The ratio's factors of those terms.
template <int N>
using DirectionalRatio = std::array<BandValues<N>, direction_terms>;

template <int N>
[[nodiscard]] BandValues<N> evaluate(const DirectionalRatio<N>& ratio,
                                     const DirectionTerms& terms) {
  BandValues<N> value;
  for (std::size_t k = 0; k < direction_terms; ++k) value += terms[k] * ratio[k];
  return max(value, BandValues<N>{});
}

/// A ratio over the cosine alone, a parabola: all places of a surface have about the same, as light
/// that leaves straight comes from deeper than light that leaves at a slant.
template <int N>
using AngularShape = std::array<BandValues<N>, 3>;

template <int N>
[[nodiscard]] BandValues<N> evaluate(const AngularShape<N>& shape, const DirectionTerms& terms) {
  return max(shape[0] + terms[1] * (shape[1] + terms[1] * shape[2]), BandValues<N>{});
}

template <int N>
struct WalkedSums;

/// Sums over samples of light by a planar method, times two of those terms.
template <int N>
struct PlanarSums {
  using Bands = BandValues<N>;
  static constexpr std::size_t products = direction_terms * (direction_terms + 1) / 2;
  std::array<Bands, products> of{};  ///< the lower triangle by rows

  void add(const DirectionTerms& terms, const Bands& planar) {
    std::size_t k = 0;
    for (std::size_t i = 0; i < direction_terms; ++i)
      for (std::size_t j = 0; j <= i; ++j) of[k++] += (terms[i] * terms[j]) * planar;
  }
  /// a^T P b.
  [[nodiscard]] Bands product(const DirectionalRatio<N>& a, const DirectionalRatio<N>& b) const {
    Bands total;
    std::size_t k = 0;
    for (std::size_t i = 0; i < direction_terms; ++i) {
      for (std::size_t j = 0; j < i; ++j) total += of[k++] * (a[i] * b[j] + a[j] * b[i]);
      total += of[k++] * a[i] * b[i];
    }
    return total;
  }
  /// P a: what walks would find if the ratio was a.
  [[nodiscard]] WalkedSums<N> product(const DirectionalRatio<N>& a) const;
  PlanarSums& operator+=(const PlanarSums& other) {
    for (std::size_t k = 0; k < products; ++k) of[k] += other.of[k];
    return *this;
  }
  friend PlanarSums operator*(float factor, PlanarSums sums) {
    for (Bands& bands : sums.of) bands *= factor;
    return sums;
  }
};

/// Sums over samples of light by walks, times one of those terms.
template <int N>
struct WalkedSums {
  using Bands = BandValues<N>;
  std::array<Bands, direction_terms> of{};

  void add(const DirectionTerms& terms, const Bands& walked) {
    for (std::size_t i = 0; i < direction_terms; ++i) of[i] += terms[i] * walked;
  }
  [[nodiscard]] Bands product(const DirectionalRatio<N>& a) const {
    Bands total;
    for (std::size_t i = 0; i < direction_terms; ++i) total += of[i] * a[i];
    return total;
  }
  WalkedSums& operator+=(const WalkedSums& other) {
    for (std::size_t i = 0; i < direction_terms; ++i) of[i] += other.of[i];
    return *this;
  }
  friend WalkedSums operator*(float factor, WalkedSums sums) {
    for (Bands& bands : sums.of) bands *= factor;
    return sums;
  }
};

template <int N>
WalkedSums<N> PlanarSums<N>::product(const DirectionalRatio<N>& a) const {
  WalkedSums<N> result;
  std::size_t k = 0;
  for (std::size_t i = 0; i < direction_terms; ++i) {
    for (std::size_t j = 0; j < i; ++j, ++k) {
      result.of[i] += of[k] * a[j];
      result.of[j] += of[k] * a[i];
    }
    result.of[i] += of[k++] * a[i];
  }
  return result;
}

/// The ratio that fits best: the one with the least squares of (walked - planar * ratio) over
/// planar, so that a constant one is that of the sums. Drawn to a prior in how it depends on
/// direction.
///
/// @param bands  that are fitted; the others are those of the prior
/// @param pull   weight of the prior over that of the samples, >= 0
template <int N>
[[nodiscard]] DirectionalRatio<N> fit_ratio(const PlanarSums<N>& planar,
                                            const WalkedSums<N>& walked, int bands, double pull,
                                            const DirectionalRatio<N>& prior) {
  DirectionalRatio<N> ratio = prior;
  for (int b = 0; b < bands; ++b) {
    const auto weight = static_cast<double>(planar.of[0][b]);
    if (!(weight > 0.0)) continue;
    SmallMatrix<direction_terms> matrix{};
    SmallVector<direction_terms> right{};
    std::size_t k = 0;
    for (std::size_t i = 0; i < direction_terms; ++i) {
      for (std::size_t j = 0; j <= i; ++j) matrix[i][j] = static_cast<double>(planar.of[k++][b]);
      constexpr double little = 3e-3;  // where samples look one way, as towards an eye
      const double drawn = ((i == 0 ? 0.0 : pull) + little) * weight;
      matrix[i][i] += drawn;
      right[i] = static_cast<double>(walked.of[i][b]) + drawn * static_cast<double>(prior[i][b]);
    }
    const auto found = solve_cholesky(cholesky(matrix, direction_terms), direction_terms, right);
    for (std::size_t i = 0; i < direction_terms; ++i) ratio[i][b] = static_cast<float>(found[i]);
  }
  return ratio;
}

}  // namespace lamina
