// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

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
  friend BandValues operator/(BandValues a, const BandValues& b) {
    for (int i = 0; i < N; ++i) a.v[i] /= b.v[i];
    return a;
  }
};

template <int N>
[[nodiscard]] BandValues<N> sqrt(BandValues<N> a) {
  for (float& x : a.v) x = std::sqrt(x);
  return a;
}
template <int N>
[[nodiscard]] BandValues<N> abs(BandValues<N> a) {
  for (float& x : a.v) x = std::abs(x);
  return a;
}
template <int N>
[[nodiscard]] BandValues<N> min(BandValues<N> a, const BandValues<N>& b) {
  for (int i = 0; i < N; ++i) a.v[i] = b.v[i] < a.v[i] ? b.v[i] : a.v[i];
  return a;
}
template <int N>
[[nodiscard]] BandValues<N> max(BandValues<N> a, const BandValues<N>& b) {
  for (int i = 0; i < N; ++i) a.v[i] = b.v[i] > a.v[i] ? b.v[i] : a.v[i];
  return a;
}

/// exp(-x) for x >= 0 in all lanes at once; relative error below 2e-7, 0 beyond x = 87.
///
/// 2^-n times a Taylor polynomial of what is left, at most half a power of two to either side.
template <int N>
[[nodiscard]] BandValues<N> exp_minus(BandValues<N> a) {
  for (float& x : a.v) {
    const float clipped = x < 87.0f ? x : 87.0f;
    const auto n = static_cast<std::int32_t>(clipped * 1.44269504f + 0.5f);
    const auto whole = static_cast<float>(n);
    const float r = (clipped - whole * 0.693359375f) + whole * 2.12194440e-4f;  // ln 2 in two parts
    float p = 1.0f / 5040.0f;
    p = 1.0f / 720.0f - r * p;
    p = 1.0f / 120.0f - r * p;
    p = 1.0f / 24.0f - r * p;
    p = 1.0f / 6.0f - r * p;
    p = 0.5f - r * p;
    p = 1.0f - r * p;
    p = 1.0f - r * p;
    const float power = std::bit_cast<float>((127 - n) << 23);
    x = x < 87.0f ? p * power : 0.0f;
  }
  return a;
}

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
