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

#include "lamina/solve/scattering/adding_doubling/internal/thin_slab-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

/// A matrix and its derivatives by some parameters. What follows are the product rule and its kin.
struct Differentiated {
  Single value;
  std::vector<Single> derivatives;  ///< [parameter]

  [[nodiscard]] std::size_t columns() const { return value.columns(); }
};

inline Differentiated times(const Differentiated& a, const Differentiated& b) {
  Differentiated out{times(a.value, b.value), {}};
  for (std::size_t k = 0; k < a.derivatives.size(); ++k) {
    out.derivatives.push_back(times(a.derivatives[k], b.value));
    add_times(out.derivatives[k], a.value, b.derivatives[k]);
  }
  return out;
}

inline void add_times(Differentiated& sum, const Differentiated& a, const Differentiated& b) {
  add_times(sum.value, a.value, b.value);
  for (std::size_t k = 0; k < sum.derivatives.size(); ++k) {
    add_times(sum.derivatives[k], a.derivatives[k], b.value);
    add_times(sum.derivatives[k], a.value, b.derivatives[k]);
  }
}

inline Differentiated combined(Terms<Differentiated> terms) {
  const auto of_part = [&](const auto& part) {
    std::vector<std::pair<double, const Single*>> parts;
    for (const auto& [factor, m] : terms) parts.emplace_back(factor, &part(*m));
    return combined(parts);
  };
  Differentiated out{of_part([](const Differentiated& m) -> const Single& { return m.value; }), {}};
  for (std::size_t k = 0; k < terms.begin()->second->derivatives.size(); ++k)
    out.derivatives.push_back(
        of_part([k](const Differentiated& m) -> const Single& { return m.derivatives[k]; }));
  return out;
}

inline void add_to_diagonal(Differentiated& m, double x) { add_to_diagonal(m.value, x); }

inline Differentiated transpose(const Differentiated& m) {
  Differentiated out{transpose(m.value), {}};
  for (const Single& derivative : m.derivatives) out.derivatives.push_back(transpose(derivative));
  return out;
}

inline void flip(Differentiated& m, std::size_t j, std::size_t first, std::size_t last) {
  flip(m.value, j, first, last);
  for (Single& derivative : m.derivatives) flip(derivative, j, first, last);
}

/// From m x = b: m x' = b' - m' x, for all parameters at once.
inline void solve(Differentiated& m, Differentiated& b) {
  Single same = combined({{1.0, &m.value}});
  solve(same, b.value);
  const std::size_t n = b.columns();
  Single rest(m.value.rows(), n * b.derivatives.size());
  for (std::size_t k = 0; k < b.derivatives.size(); ++k) {
    add_product<AlongRows>(target(b.derivatives[k]), source(m.derivatives[k]), factors(b.value),
                           rest.vectors(), n, n, subtract);
    std::copy_n(b.derivatives[k].data(), b.derivatives[k].size(), rest.element(0, k * n));
  }
  solve(m.value, rest);
  for (std::size_t k = 0; k < b.derivatives.size(); ++k)
    std::copy_n(rest.element(0, k * n), b.derivatives[k].size(), b.derivatives[k].data());
}

/// K (J + sign H)^-1 K, J the diagonal matrix of the signs; H, K and so all derivatives symmetric.
/// With X = (J + sign H)^-1 K its derivative is W + W^T, W = X^T (K' - sign H' X / 2).
inline Differentiated sandwich(const Differentiated& H, const Differentiated& K, std::size_t even,
                               double sign) {
  const std::size_t n = H.columns();
  Single joint = combined({{sign, &H.value}}), X = combined({{1.0, &K.value}});
  for (std::size_t j = 0; j < n; ++j) *joint.element(j, j) += j < even ? 1.0 : -1.0;
  solve(joint, X);
  const Single X_turned = transpose(X);
  Differentiated out{times(K.value, X), {}};
  for (std::size_t k = 0; k < H.derivatives.size(); ++k) {
    Single inner = combined({{1.0, &K.derivatives[k]}});
    add_product<AlongRows>(target(inner), source(H.derivatives[k]), factors(X), X.vectors(), n, n,
                           {To::add, -0.5 * sign});
    const Single W = times(X_turned, inner), W_turned = transpose(W);
    out.derivatives.push_back(combined({{1.0, &W}, {1.0, &W_turned}}));
  }
  return out;
}

/// Two equal slabs on one another, as in Doubling.
inline void double_once(Differentiated& H, Differentiated& K, std::size_t even) {
  const Differentiated P = sandwich(H, K, even, -1.0), Q = sandwich(H, K, even, 1.0);
  H = combined({{1.0, &H}, {0.5, &P}, {-0.5, &Q}});
  K = combined({{0.5, &P}, {0.5, &Q}});
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
