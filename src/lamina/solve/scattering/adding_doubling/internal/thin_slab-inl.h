// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Thin slabs, from which doubling starts, of matrices alone or with their derivatives; compiled
// once per instruction set.
#if defined(LAMINA_THIN_SLAB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_THIN_SLAB_INL_H_
#undef LAMINA_THIN_SLAB_INL_H_
#else
#define LAMINA_THIN_SLAB_INL_H_
#endif

#include <algorithm>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/internal/linear_solve-inl.h"
#include "lamina/solve/scattering/adding_doubling/internal/slab_doubling-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

inline Single padded(const double* values, std::size_t rows, std::size_t columns) {
  Single m(rows, columns);
  for (std::size_t j = 0; j < columns; ++j) std::copy_n(values + j * rows, rows, m.element(0, j));
  return m;
}

inline void unpad(const Single& m, double* values) {
  for (std::size_t j = 0; j < m.columns(); ++j)
    std::copy_n(m.element(0, j), m.rows(), values + j * m.rows());
}

inline Single times(const Single& a, const Single& b) {
  Single out(a.rows(), b.columns());
  add_product<AlongRows>(target(out), source(a), factors(b), a.vectors(), a.columns(), b.columns(),
                         replace);
  return out;
}

inline void add_times(Single& sum, const Single& a, const Single& b) {
  add_product<AlongRows>(target(sum), source(a), factors(b), sum.vectors(), a.columns(),
                         b.columns(), add);
}

/// A sum of multiples.
inline Single combined(std::span<const std::pair<double, const Single*>> terms) {
  const D d;
  Single out(terms[0].second->rows(), terms[0].second->columns());
  for (std::size_t k = 0; k < out.size(); k += lanes()) {
    V sum = hn::Zero(d);
    for (const auto& [factor, m] : terms)
      sum = hn::MulAdd(hn::Set(d, factor), hn::Load(d, m->data() + k), sum);
    hn::Store(sum, d, out.data() + k);
  }
  return out;
}

template <class M>
using Terms = std::initializer_list<std::pair<double, const M*>>;

inline Single combined(Terms<Single> terms) {
  return combined(std::span(terms.begin(), terms.size()));
}

inline Single transpose(const Single& m) {
  Single out(m.columns(), m.rows());
  for (std::size_t j = 0; j < m.rows(); ++j) {
    double* const column = out.element(0, j);
    for (std::size_t i = 0; i < m.columns(); ++i) column[i] = *m.element(j, i);
  }
  return out;
}

/// Changes the sign of part of a column.
inline void flip(Single& m, std::size_t j, std::size_t first, std::size_t last) {
  for (double* value = m.element(first, j); value != m.element(last, j); ++value) *value = -*value;
}

/// Replaces b by the solution of m x = b, and m by its factors.
inline void solve(Single& m, Single& b) { Elimination(m, b).solve(); }

/// Gives a slab that absorbs nothing the light back that rounding lost.
inline void restore_energy(const double* root_etendue, const Single& H, Single& K) {
  const Single root = padded(root_etendue, H.rows(), 1), both = combined({{1.0, &H}, {1.0, &K}});
  const Single left = times(both, root);  // symmetric: also what leaves per state
  for (std::size_t j = 0; j < K.columns(); ++j)
    *K.element(j, j) += 1.0 - *left.element(j, 0) / root_etendue[j];
}

/// The even and odd solutions of a thin layer, which need no matrix of twice the size.
template <class M>
struct ThinSlab {
  M H, K;  ///< reflection and transmission, times the signs and so symmetric
};

/// With U = A + B, V = A - B, x half the thickness, C = cosh(x sqrt(VU)) and S = U sinh(x
/// sqrt(VU)) / sqrt(VU), reflection plus transmission is (C + S) (C - S)^-1; the same with U and V
/// exchanged is transmission minus reflection.
///
/// @tparam M  Single, or a matrix with its derivatives (differentiated_matrix-inl.h).
template <class M>
ThinSlab<M> thin_slab(const M& A, const M& B, double x, std::size_t even) {
  const std::size_t n = A.columns();
  const auto total = [](Terms<M> terms) { return combined(terms); };
  const M plus = total({{x, &A}, {x, &B}}), minus = total({{x, &A}, {-x, &B}});
  const M G = times(minus, plus), G2 = times(G, G), G3 = times(G2, G);
  // cosh(y) = sum y^2j / (2j)!, sinh(y) / y = sum y^2j / (2j + 1)! in y^2 = G, up to G^6.
  const auto series = [&](double c1, double c2, double c3, double c4, double c5, double c6) {
    M high = total({{1.0 / c4, &G}, {1.0 / c5, &G2}, {1.0 / c6, &G3}});
    add_to_diagonal(high, 1.0 / c3);
    M sum = total({{1.0 / c1, &G}, {1.0 / c2, &G2}});
    add_times(sum, G3, high);
    add_to_diagonal(sum, 1.0);
    return sum;
  };
  const M cosh_part = series(2.0, 24.0, 720.0, 40320.0, 3628800.0, 479001600.0);
  const M sinh_over_y = series(6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0);

  // Solves for the transpose of (C + S)(C - S)^-1, which is it but for the signs.
  const auto quotient = [&](const M& C, const M& S) {
    M below = transpose(total({{1.0, &C}, {-1.0, &S}}));
    M above = transpose(total({{1.0, &C}, {1.0, &S}}));
    solve(below, above);
    for (std::size_t j = 0; j < n; ++j) flip(above, j, even, n);
    const M other = transpose(above);
    return total({{0.5, &above}, {0.5, &other}});
  };
  const M sum = quotient(cosh_part, times(plus, sinh_over_y));
  // Reciprocity: f(UV) is the transpose of f(VU) but for the signs.
  const auto other_order = [&](const M& m) {
    M turned = transpose(m);
    for (std::size_t j = 0; j < n; ++j)
      j < even ? flip(turned, j, even, n) : flip(turned, j, 0, even);
    return turned;
  };
  const M difference =  // transmission - reflection
      quotient(other_order(cosh_part), times(minus, other_order(sinh_over_y)));
  return {.H = total({{0.5, &sum}, {-0.5, &difference}}),
          .K = total({{0.5, &sum}, {0.5, &difference}})};
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
