// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace lamina {

namespace detail {

/// Numbers in one register. Compilers do not find all of them on their own.
template <int W>
struct LanesOf {
  typedef float Floats __attribute__((vector_size(4 * W)));
  typedef std::int32_t Ints __attribute__((vector_size(4 * W)));
};
#if defined(__AVX2__)
inline constexpr int widest = 8;
#else
inline constexpr int widest = 4;
#endif

using Four = LanesOf<4>::Floats;
#if defined(__SSE__)
[[nodiscard]] inline Four square_root(Four x) { return __builtin_ia32_sqrtps(x); }
[[nodiscard]] inline Four rough_reciprocal(Four x) { return __builtin_ia32_rcpps(x); }
[[nodiscard]] inline Four rough_reciprocal_root(Four x) { return __builtin_ia32_rsqrtps(x); }
#else
[[nodiscard]] inline Four square_root(Four x) {
  for (int i = 0; i < 4; ++i) x[i] = std::sqrt(x[i]);
  return x;
}
[[nodiscard]] inline Four rough_reciprocal(Four x) { return 1.0f / x; }
[[nodiscard]] inline Four rough_reciprocal_root(Four x) { return 1.0f / square_root(x); }
#endif
#if defined(__AVX2__)
using Eight = LanesOf<8>::Floats;
[[nodiscard]] inline Eight square_root(Eight x) { return __builtin_ia32_sqrtps256(x); }
[[nodiscard]] inline Eight rough_reciprocal(Eight x) { return __builtin_ia32_rcpps256(x); }
[[nodiscard]] inline Eight rough_reciprocal_root(Eight x) { return __builtin_ia32_rsqrtps256(x); }
#endif

}  // namespace detail

/// One value per band of a rendering pass; the lanes beyond the bands of a scene are unused.
/// N is 4, 8 or 16: small enough to stay in registers, so that RGB does not pay for 16 bands.
template <int N>
struct alignas(16) BandValues {
  static_assert(N % 4 == 0);
  float v[N] = {};

  static constexpr int lanes = std::min(N, detail::widest);  ///< of one register
  using Floats = detail::LanesOf<lanes>::Floats;
  using Ints = detail::LanesOf<lanes>::Ints;

  [[nodiscard]] static BandValues filled(float value) {
    BandValues result;
    for (int i = 0; i < N; ++i) result.v[i] = value;
    return result;
  }

  /// f of one register of lanes after the other, of one, two or three values.
  template <class F, class... Values>
  [[nodiscard]] static BandValues map(const F& f, const Values&... values) {
    BandValues result;
    for (int i = 0; i < N; i += lanes) {
      const Floats x = f(values.lanes_from(i)...);
      std::memcpy(result.v + i, &x, sizeof x);
    }
    return result;
  }
  [[nodiscard]] Floats lanes_from(int i) const {
    Floats x;
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
/// 1 / x to a relative error of 3e-7, for 1e-37 < x < 1e37: an estimate of 12 bits, which a step of
/// Newton's makes 23. Faster than a division.
template <int N>
[[nodiscard]] BandValues<N> reciprocal(const BandValues<N>& a) {
  return BandValues<N>::map(
      [](auto x) {
        const auto y = detail::rough_reciprocal(x);
        return y + y * (1.0f - x * y);
      },
      a);
}
/// 1 / sqrt(x), likewise.
template <int N>
[[nodiscard]] BandValues<N> reciprocal_root(const BandValues<N>& a) {
  return BandValues<N>::map(
      [](auto x) {
        const auto y = detail::rough_reciprocal_root(x);
        return y + 0.5f * y * (1.0f - x * y * y);
      },
      a);
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
  using Floats = BandValues<N>::Floats;
  using Ints = BandValues<N>::Ints;
  const auto of_lanes = [](Floats x) {
    const Floats limit = Floats{} + 87.0f, clipped = x < limit ? x : limit;
    const auto n = __builtin_convertvector(clipped * 1.44269504f + 0.5f, Ints);
    const auto whole = __builtin_convertvector(n, Floats);
    const auto r = (clipped - whole * 0.693359375f) + whole * 2.12194440e-4f;  // ln 2 in two parts
    Floats p = Floats{} + 1.0f / 5040.0f;
    for (const float coefficient :
         {1.0f / 720.0f, 1.0f / 120.0f, 1.0f / 24.0f, 1.0f / 6.0f, 0.5f, 1.0f, 1.0f})
      p = coefficient - r * p;
    const auto power = std::bit_cast<Floats>((127 - n) << 23);
    return x < limit ? p * power : Floats{};
  };
  return BandValues<N>::map(of_lanes, a);
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
