// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Values of all bands in SIMD; included once per instruction set.

#if defined(LAMINA_BAND_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_BAND_LANES_INL_H
#undef LAMINA_BAND_LANES_INL_H
#else
#define LAMINA_BAND_LANES_INL_H
#endif

#include <hwy/highway.h>

#include "lamina/base/spectrum/band_values.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::first_order::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
template <int N>
using BandLanes = BandValues<N>;

template <int N>
void store(const BandValues<N>& from, BandValues<N>& to) {
  to = from;
}
#else

/// BandValues as they are computed with, in as few vectors as hold them.
template <int N>
class BandLanes {
 public:
  using D = hn::CappedTag<float, N>;
  using V = hn::Vec<D>;
  static constexpr int width = static_cast<int>(sizeof(V) / sizeof(float));

  BandLanes() = default;
  HWY_INLINE BandLanes(const BandValues<N>& values) {
    for (int i = 0; i < count; ++i) v_[i] = hn::LoadU(D(), values.v + i * width);
  }
  /// In whole vectors: an assignment may copy by halves, and delay who then reads them as one.
  friend HWY_INLINE void store(const BandLanes& from, BandValues<N>& to) {
    for (int i = 0; i < count; ++i) hn::StoreU(from.v_[i], D(), to.v + i * width);
  }
  explicit HWY_INLINE operator BandValues<N>() const {
    BandValues<N> values;
    store(*this, values);
    return values;
  }
  static HWY_INLINE BandLanes filled(float value) {
    return map([&] { return hn::Set(D(), value); });
  }

  /// f of one vector after the other.
  template <class F, class... Values>
  static HWY_INLINE BandLanes map(const F& f, const Values&... values) {
    BandLanes result;
    for (int i = 0; i < count; ++i) result.v_[i] = f(values.v_[i]...);
    return result;
  }

  friend HWY_INLINE BandLanes operator+(const BandLanes& a, const BandLanes& b) {
    return map([](V x, V y) { return hn::Add(x, y); }, a, b);
  }
  friend HWY_INLINE BandLanes operator-(const BandLanes& a, const BandLanes& b) {
    return map([](V x, V y) { return hn::Sub(x, y); }, a, b);
  }
  friend HWY_INLINE BandLanes operator*(const BandLanes& a, const BandLanes& b) {
    return map([](V x, V y) { return hn::Mul(x, y); }, a, b);
  }
  friend HWY_INLINE BandLanes operator/(const BandLanes& a, const BandLanes& b) {
    return map([](V x, V y) { return hn::Div(x, y); }, a, b);
  }
  friend HWY_INLINE BandLanes operator*(float s, const BandLanes& a) { return filled(s) * a; }
  HWY_INLINE BandLanes& operator+=(const BandLanes& b) { return *this = *this + b; }
  HWY_INLINE BandLanes& operator*=(const BandLanes& b) { return *this = *this * b; }

 private:
  static constexpr int count = N / width;
  V v_[count];
};

// As the functions of band_values.h, and to the same errors.

template <int N>
HWY_INLINE BandLanes<N> sqrt(const BandLanes<N>& a) {
  return BandLanes<N>::map([](auto x) { return hn::Sqrt(x); }, a);
}
template <int N>
HWY_INLINE BandLanes<N> abs(const BandLanes<N>& a) {
  return BandLanes<N>::map([](auto x) { return hn::Abs(x); }, a);
}
template <int N>
HWY_INLINE BandLanes<N> min(const BandLanes<N>& a, const BandLanes<N>& b) {
  return BandLanes<N>::map([](auto x, auto y) { return hn::Min(y, x); }, a, b);
}
template <int N>
HWY_INLINE BandLanes<N> max(const BandLanes<N>& a, const BandLanes<N>& b) {
  return BandLanes<N>::map([](auto x, auto y) { return hn::Max(y, x); }, a, b);
}
template <int N>
HWY_INLINE BandLanes<N> where_less(const BandLanes<N>& x, float limit, const BandLanes<N>& below,
                                   const BandLanes<N>& above) {
  const auto bound = hn::Set(typename BandLanes<N>::D(), limit);
  return BandLanes<N>::map(
      [&](auto t, auto a, auto b) { return hn::IfThenElse(hn::Lt(t, bound), a, b); }, x, below,
      above);
}

// Estimates of 12 bits on x86, of 8 elsewhere, which is too few for one step.
template <int N>
HWY_INLINE BandLanes<N> reciprocal(const BandLanes<N>& a) {
  const auto one = hn::Set(typename BandLanes<N>::D(), 1.0f);
  return BandLanes<N>::map(
      [&](auto x) {
#if HWY_ARCH_X86
        const auto y = hn::ApproximateReciprocal(x);
        return hn::Add(y, hn::Mul(y, hn::Sub(one, hn::Mul(x, y))));
#else
        return hn::Div(one, x);
#endif
      },
      a);
}
template <int N>
HWY_INLINE BandLanes<N> reciprocal_root(const BandLanes<N>& a) {
  const typename BandLanes<N>::D d;
  const auto one = hn::Set(d, 1.0f);
  return BandLanes<N>::map(
      [&](auto x) {
#if HWY_ARCH_X86
        const auto y = hn::ApproximateReciprocalSqrt(x), half = hn::Mul(hn::Set(d, 0.5f), y);
        return hn::Add(y, hn::Mul(half, hn::Sub(one, hn::Mul(hn::Mul(x, y), y))));
#else
        return hn::Div(one, hn::Sqrt(x));
#endif
      },
      a);
}

template <int N>
HWY_INLINE BandLanes<N> exp_minus(const BandLanes<N>& a) {
  const typename BandLanes<N>::D d;
  const hn::RebindToSigned<typename BandLanes<N>::D> integers;
  return BandLanes<N>::map(
      [&](auto x) {
        const auto limit = hn::Set(d, 87.0f), clipped = hn::Min(x, limit);
        const auto n = hn::ConvertTo(
            integers, hn::Add(hn::Mul(clipped, hn::Set(d, 1.44269504f)), hn::Set(d, 0.5f)));
        const auto whole = hn::ConvertTo(d, n);
        const auto r = hn::Add(hn::Sub(clipped, hn::Mul(whole, hn::Set(d, 0.693359375f))),
                               hn::Mul(whole, hn::Set(d, 2.12194440e-4f)));
        auto p = hn::Set(d, 1.0f / 5040.0f);
        for (const float coefficient :
             {1.0f / 720.0f, 1.0f / 120.0f, 1.0f / 24.0f, 1.0f / 6.0f, 0.5f, 1.0f, 1.0f})
          p = hn::Sub(hn::Set(d, coefficient), hn::Mul(r, p));
        const auto power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(integers, 127), n)));
        return hn::IfThenElseZero(hn::Lt(x, limit), hn::Mul(p, power));
      },
      a);
}
#endif

}  // namespace lamina::first_order::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
