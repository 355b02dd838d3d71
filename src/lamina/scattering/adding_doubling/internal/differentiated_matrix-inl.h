// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Matrices with their derivatives, for doubling that is differentiated; compiled once per
// instruction set.
#if defined(LAMINA_DIFFERENTIATED_MATRIX_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_DIFFERENTIATED_MATRIX_INL_H_
#undef LAMINA_DIFFERENTIATED_MATRIX_INL_H_
#else
#define LAMINA_DIFFERENTIATED_MATRIX_INL_H_
#endif

#include <cstddef>
#include <vector>

#include "lamina/scattering/adding_doubling/internal/thin_slab-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

/// A matrix and its derivatives by some parameters. What follows are the product rule and its kin.
struct Sloped {
  Single value;
  std::vector<Single> slopes;  ///< [parameter]

  [[nodiscard]] std::size_t columns() const { return value.columns(); }
};

inline Sloped times(const Sloped& a, const Sloped& b) {
  Sloped out{times(a.value, b.value), {}};
  for (std::size_t k = 0; k < a.slopes.size(); ++k) {
    out.slopes.push_back(times(a.slopes[k], b.value));
    add_times(out.slopes[k], a.value, b.slopes[k]);
  }
  return out;
}

inline void add_times(Sloped& sum, const Sloped& a, const Sloped& b) {
  add_times(sum.value, a.value, b.value);
  for (std::size_t k = 0; k < sum.slopes.size(); ++k) {
    add_times(sum.slopes[k], a.slopes[k], b.value);
    add_times(sum.slopes[k], a.value, b.slopes[k]);
  }
}

inline Sloped combined(Terms<Sloped> terms) {
  const auto of_part = [&](const auto& part) {
    std::vector<std::pair<double, const Single*>> parts;
    for (const auto& [factor, m] : terms) parts.emplace_back(factor, &part(*m));
    return combined(parts);
  };
  Sloped out{of_part([](const Sloped& m) -> const Single& { return m.value; }), {}};
  for (std::size_t k = 0; k < terms.begin()->second->slopes.size(); ++k)
    out.slopes.push_back(of_part([k](const Sloped& m) -> const Single& { return m.slopes[k]; }));
  return out;
}

inline void add_to_diagonal(Sloped& m, double x) { add_to_diagonal(m.value, x); }

inline Sloped transpose(const Sloped& m) {
  Sloped out{transpose(m.value), {}};
  for (const Single& slope : m.slopes) out.slopes.push_back(transpose(slope));
  return out;
}

inline void flip(Sloped& m, std::size_t j, std::size_t first, std::size_t last) {
  flip(m.value, j, first, last);
  for (Single& slope : m.slopes) flip(slope, j, first, last);
}

/// From m x = b: m x' = b' - m' x, for all parameters at once.
inline void solve(Sloped& m, Sloped& b) {
  Single same = combined({{1.0, &m.value}});
  solve(same, b.value);
  const std::size_t n = b.columns();
  Single rest(m.value.rows(), n * b.slopes.size());
  for (std::size_t k = 0; k < b.slopes.size(); ++k) {
    add_product<AlongRows>(target(b.slopes[k]), source(m.slopes[k]), factors(b.value),
                           rest.vectors(), n, n, subtract);
    std::copy_n(b.slopes[k].data(), b.slopes[k].size(), rest.element(0, k * n));
  }
  solve(m.value, rest);
  for (std::size_t k = 0; k < b.slopes.size(); ++k)
    std::copy_n(rest.element(0, k * n), b.slopes[k].size(), b.slopes[k].data());
}

/// K (J + sign H)^-1 K, J the diagonal matrix of the signs; H, K and so all slopes symmetric. With
/// X = (J + sign H)^-1 K its slope is W + W^T, W = X^T (K' - sign H' X / 2).
inline Sloped sandwich(const Sloped& H, const Sloped& K, std::size_t even, double sign) {
  const std::size_t n = H.columns();
  Single joint = combined({{sign, &H.value}}), X = combined({{1.0, &K.value}});
  for (std::size_t j = 0; j < n; ++j) *joint.element(j, j) += j < even ? 1.0 : -1.0;
  solve(joint, X);
  const Single X_turned = transpose(X);
  Sloped out{times(K.value, X), {}};
  for (std::size_t k = 0; k < H.slopes.size(); ++k) {
    Single inner = combined({{1.0, &K.slopes[k]}});
    add_product<AlongRows>(target(inner), source(H.slopes[k]), factors(X), X.vectors(), n, n,
                           {To::add, -0.5 * sign});
    const Single W = times(X_turned, inner), W_turned = transpose(W);
    out.slopes.push_back(combined({{1.0, &W}, {1.0, &W_turned}}));
  }
  return out;
}

/// Two equal slabs on one another, as in Doubling.
inline void double_once(Sloped& H, Sloped& K, std::size_t even) {
  const Sloped P = sandwich(H, K, even, -1.0), Q = sandwich(H, K, even, 1.0);
  H = combined({{1.0, &H}, {0.5, &P}, {-0.5, &Q}});
  K = combined({{0.5, &P}, {0.5, &Q}});
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
