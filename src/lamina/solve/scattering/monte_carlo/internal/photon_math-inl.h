// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Functions of random bits on SIMD lanes; included once per instruction set.

#if defined(LAMINA_PHOTON_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_PHOTON_MATH_INL_H_
#undef LAMINA_PHOTON_MATH_INL_H_
#else
#define LAMINA_PHOTON_MATH_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::photon::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Uniform in (0, 1): the upper 24 bits of each lane, centred in their interval.
template <class DF, class VU>
HWY_INLINE hn::Vec<DF> uniform(DF df, VU bits) {
  const hn::RebindToSigned<DF> di;
  const auto whole = hn::ConvertTo(df, hn::BitCast(di, hn::ShiftRight<8>(bits)));
  return hn::MulAdd(whole, hn::Set(df, 0x1p-24f), hn::Set(df, 0x1p-25f));
}

/// -log(u) for u in (0, 1), to 2e-7 relative: minimax polynomial of log(1 + f) / f, found by
/// iteratively reweighted least squares, on [sqrt(1/2), sqrt(2)) after the exponent is split off.
template <class DF>
HWY_INLINE hn::Vec<DF> minus_log(DF df, hn::Vec<DF> u) {
  const hn::RebindToSigned<DF> di;
  const auto bits = hn::BitCast(di, u);
  const auto offset = hn::Sub(bits, hn::Set(di, 0x3f3504f3));  // sqrt(1/2)
  const auto exponent = hn::ShiftRight<23>(offset);
  const auto mantissa = hn::BitCast(df, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
  const auto f = hn::Sub(mantissa, hn::Set(df, 1.0f));
  const auto e = hn::ConvertTo(df, exponent);
  // Two chains of powers of f^2 rather than one of f: shorter latency.
  const auto f2 = hn::Mul(f, f);
  auto even = hn::MulAdd(f2, hn::Set(df, 0.162225758f), hn::Set(df, 0.199001661f));
  auto odd = hn::MulAdd(f2, hn::Set(df, -0.101068841f), hn::Set(df, -0.172508314f));
  even = hn::MulAdd(even, f2, hn::Set(df, 0.333350589f));
  odd = hn::MulAdd(odd, f2, hn::Set(df, -0.24969909f));
  even = hn::MulAdd(even, f2, hn::Set(df, 0.999999945f));
  odd = hn::MulAdd(odd, f2, hn::Set(df, -0.500003651f));
  const auto p = hn::MulAdd(odd, f, even);
  return hn::NegMulAdd(e, hn::Set(df, 0.693147180559945f), hn::Neg(hn::Mul(f, p)));
}

/// Sine and cosine of a uniform angle: the upper two bits choose the quadrant, the other thirty
/// the angle in it, in [-pi/4, pi/4). To 3e-8.
template <class DF, class VU>
HWY_INLINE void sincos_2pi(DF df, VU bits, hn::Vec<DF>& sine, hn::Vec<DF>& cosine) {
  const hn::RebindToSigned<DF> di;
  const hn::RebindToUnsigned<DF> du;
  const auto t =
      hn::Mul(hn::ConvertTo(df, hn::BitCast(di, hn::ShiftLeft<2>(bits))), hn::Set(df, 0x1p-31f));
  const auto t2 = hn::Mul(t, t);
  auto s = hn::MulAdd(t2, hn::Set(df, -3.59504522e-05f), hn::Set(df, 0.00249000102f));
  auto c = hn::MulAdd(t2, hn::Set(df, -0.000318880508f), hn::Set(df, 0.0158499153f));
  s = hn::MulAdd(s, t2, hn::Set(df, -0.0807454325f));
  c = hn::MulAdd(c, t2, hn::Set(df, -0.308424254f));
  s = hn::Mul(hn::MulAdd(s, t2, hn::Set(df, 0.785398161f)), t);
  c = hn::MulAdd(c, t2, hn::Set(df, 0.999999972f));
  // Quadrant: the upper bit turns by 180 degrees, the next one by 90.
  const auto half_turn = hn::BitCast(df, hn::And(bits, hn::Set(du, 0x80000000u)));
  const auto quarter = hn::RebindMask(df, hn::TestBit(bits, hn::Set(du, 0x40000000u)));
  sine = hn::Xor(hn::IfThenElse(quarter, c, s), half_turn);
  cosine = hn::Xor(hn::IfThenElse(quarter, hn::Neg(s), c), half_turn);
}

/// Four words of xoshiro128+ per lane. Source: [BlackmanVigna2021].
template <class VU>
struct RandomLanes {
  VU s0, s1, s2, s3;
};

/// 32 random bits per lane; the lowest are weak and unused.
template <class VU>
HWY_INLINE VU draw(RandomLanes<VU>& r) {
  const VU result = hn::Add(r.s0, r.s3);
  const VU t = hn::ShiftLeft<9>(r.s1);
  r.s2 = hn::Xor(r.s2, r.s0);
  r.s3 = hn::Xor(r.s3, r.s1);
  r.s1 = hn::Xor(r.s1, r.s2);
  r.s0 = hn::Xor(r.s0, r.s3);
  r.s2 = hn::Xor(r.s2, t);
  r.s3 = hn::RotateRight<21>(r.s3);
  return result;
}

}  // namespace lamina::photon::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
