// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace lamina {

/// One value per band of a rendering pass; the lanes beyond the bands of a scene are unused.
/// N is 4, 8 or 16: small enough to stay in registers, so that RGB does not pay for 16 bands.
template <int N>
struct alignas(16) BandValues {
  float v[N] = {};

  [[nodiscard]] static BandValues filled(float value) {
    BandValues result;
    for (float& x : result.v) x = value;
    return result;
  }

  float& operator[](int i) { return v[i]; }
  const float& operator[](int i) const { return v[i]; }

  BandValues& operator+=(const BandValues& b) {
    for (int i = 0; i < N; ++i) v[i] += b.v[i];
    return *this;
  }
  BandValues& operator*=(const BandValues& b) {
    for (int i = 0; i < N; ++i) v[i] *= b.v[i];
    return *this;
  }
  BandValues& operator*=(float s) {
    for (int i = 0; i < N; ++i) v[i] *= s;
    return *this;
  }
  friend BandValues operator+(BandValues a, const BandValues& b) { return a += b; }
  friend BandValues operator-(BandValues a, const BandValues& b) {
    for (int i = 0; i < N; ++i) a.v[i] -= b.v[i];
    return a;
  }
  friend BandValues operator*(BandValues a, const BandValues& b) { return a *= b; }
  friend BandValues operator*(BandValues a, float s) { return a *= s; }
  friend BandValues operator*(float s, BandValues a) { return a *= s; }
};

/// Sum over all lanes.
template <int N>
[[nodiscard]] float sum(const BandValues<N>& a) {
  float total = 0.0f;
  for (int i = 0; i < N; ++i) total += a.v[i];
  return total;
}

/// The largest lane.
template <int N>
[[nodiscard]] float largest(const BandValues<N>& a) {
  float top = a.v[0];
  for (int i = 1; i < N; ++i) top = std::max(top, a.v[i]);
  return top;
}

}  // namespace lamina
