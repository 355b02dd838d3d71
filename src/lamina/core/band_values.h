// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace lamina {

namespace detail {

/// Four numbers in one register. Compilers do not find all of them on their own.
using FourFloats = float __attribute__((vector_size(16)));
using FourInts = std::int32_t __attribute__((vector_size(16)));

[[nodiscard]] inline FourFloats four(float x) { return FourFloats{x, x, x, x}; }
[[nodiscard]] inline FourFloats square_root(FourFloats x) {
#if defined(__SSE__)
  return __builtin_ia32_sqrtps(x);
#else
  for (int i = 0; i < 4; ++i) x[i] = std::sqrt(x[i]);
  return x;
#endif
}

}  // namespace detail

/// One value per band of a rendering pass; the lanes beyond the bands of a scene are unused.
/// N is 4, 8 or 16: small enough to stay in registers, so that RGB does not pay for 16 bands.
template <int N>
struct alignas(16) BandValues {
  static_assert(N % 4 == 0);
  float v[N] = {};

  [[nodiscard]] static BandValues filled(float value) {
    return map([&] { return detail::four(value); });
  }

  /// f of four lanes after the other, of one, two or three values.
  template <class F, class... Values>
  [[nodiscard]] static BandValues map(const F& f, const Values&... values) {
    BandValues result;
    for (int i = 0; i < N; i += 4) {
      const detail::FourFloats x = f(values.four_from(i)...);
      std::memcpy(result.v + i, &x, sizeof x);
    }
    return result;
  }
  [[nodiscard]] detail::FourFloats four_from(int i) const {
    detail::FourFloats x;
    std::memcpy(&x, v + i, sizeof x);
    return x;
  }

  float& operator[](int i) { return v[i]; }
  const float& operator[](int i) const { return v[i]; }

  friend BandValues operator+(const BandValues& a, const BandValues& b) {
    return map([](auto x, auto y) { return x + y; }, a, b);
  }
  friend BandValues operator-(const BandValues& a, const BandValues& b) {
    return map([](auto x, auto y) { return x - y; }, a, b);
  }
  friend BandValues operator*(const BandValues& a, const BandValues& b) {
    return map([](auto x, auto y) { return x * y; }, a, b);
  }
  friend BandValues operator/(const BandValues& a, const BandValues& b) {
    return map([](auto x, auto y) { return x / y; }, a, b);
  }
  friend BandValues operator*(const BandValues& a, float s) {
    return map([&](auto x) { return x * s; }, a);
  }
  friend BandValues operator*(float s, const BandValues& a) { return a * s; }
  BandValues& operator+=(const BandValues& b) { return *this = *this + b; }
  BandValues& operator*=(const BandValues& b) { return *this = *this * b; }
  BandValues& operator*=(float s) { return *this = *this * s; }
};

template <int N>
[[nodiscard]] BandValues<N> sqrt(const BandValues<N>& a) {
  return BandValues<N>::map([](auto x) { return detail::square_root(x); }, a);
}
template <int N>
[[nodiscard]] BandValues<N> abs(const BandValues<N>& a) {
  return BandValues<N>::map([](auto x) { return x < 0.0f ? -x : x; }, a);
}
template <int N>
[[nodiscard]] BandValues<N> min(const BandValues<N>& a, const BandValues<N>& b) {
  return BandValues<N>::map([](auto x, auto y) { return y < x ? y : x; }, a, b);
}
template <int N>
[[nodiscard]] BandValues<N> max(const BandValues<N>& a, const BandValues<N>& b) {
  return BandValues<N>::map([](auto x, auto y) { return y > x ? y : x; }, a, b);
}
/// Lane by lane: where `x` is less than `limit`, `below`, else `above`.
template <int N>
[[nodiscard]] BandValues<N> where_less(const BandValues<N>& x, float limit,
                                       const BandValues<N>& below, const BandValues<N>& above) {
  return BandValues<N>::map([&](auto t, auto a, auto b) { return t < limit ? a : b; }, x, below,
                            above);
}

/// exp(-x) for x >= 0 in all lanes at once; relative error below 2e-7, 0 beyond x = 87.
///
/// 2^-n times a Taylor polynomial of what is left, at most half a power of two to either side.
template <int N>
[[nodiscard]] BandValues<N> exp_minus(const BandValues<N>& a) {
  const auto of_four = [](detail::FourFloats x) {
    const detail::FourFloats limit = detail::four(87.0f), clipped = x < limit ? x : limit;
    const auto n = __builtin_convertvector(clipped * 1.44269504f + 0.5f, detail::FourInts);
    const auto whole = __builtin_convertvector(n, detail::FourFloats);
    const auto r = (clipped - whole * 0.693359375f) + whole * 2.12194440e-4f;  // ln 2 in two parts
    detail::FourFloats p = detail::four(1.0f / 5040.0f);
    for (const float coefficient :
         {1.0f / 720.0f, 1.0f / 120.0f, 1.0f / 24.0f, 1.0f / 6.0f, 0.5f, 1.0f, 1.0f})
      p = coefficient - r * p;
    const auto power = std::bit_cast<detail::FourFloats>((127 - n) << 23);
    return x < limit ? p * power : detail::four(0.0f);
  };
  return BandValues<N>::map(of_four, a);
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
