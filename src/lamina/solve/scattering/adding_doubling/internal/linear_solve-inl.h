// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Linear equations by elimination with row exchanges, compiled once per instruction set.
#if defined(LAMINA_LINEAR_SOLVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_LINEAR_SOLVE_INL_H_
#undef LAMINA_LINEAR_SOLVE_INL_H_
#else
#define LAMINA_LINEAR_SOLVE_INL_H_
#endif

#include <cmath>

#include "lamina/solve/scattering/adding_doubling/internal/dense_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

using Single = Dense<AlongRows>;

/// Solves m x = b by blocks of rows and columns: whole vectors of any width.
class Elimination {
 public:
  /// @param m  [n x n], replaced by its factors.
  /// @param b  [n x any], replaced by the solution.
  Elimination(Single& m, Single& b)
      : m_(m), b_(b), n_(m.rows()), strip_(block, std::max(n_, b.columns())) {}

  void solve() {
    for (std::size_t first = 0; first < n_; first += block) {
      const std::size_t last = std::min(n_, first + block);
      factor_panel(first, last);
      // What the panel's rows are in the columns to the right of it, and what follows below.
      make_triangle_inverse(first, last, Triangle::lower);
      const std::size_t right = n_ - last;
      apply_inverse(m_, first, last, last);
      apply_inverse(b_, first, last, 0);
      const std::size_t below = last / lanes();
      if (right == 0) break;
      const Source panel = source(m_).at(below, first);
      const std::size_t vectors = m_.vectors() - below;
      add_product<AlongRows>(target(m_).at(below, last), panel, factors(m_).at(first, last),
                             vectors, block, right, subtract);
      add_product<AlongRows>(target(b_).at(below, 0), panel, factors(b_).at(first, 0), vectors,
                             block, b_.columns(), subtract);
    }
    for (std::size_t end = (n_ + block - 1) / block * block; end > 0; end -= block) {
      const std::size_t first = end - block, last = std::min(n_, end);
      make_triangle_inverse(first, last, Triangle::upper);
      apply_inverse(b_, first, last, 0);
      add_product<AlongRows>(target(b_), source(m_).at(0, first), factors(b_).at(first, 0),
                             first / lanes(), last - first, b_.columns(), subtract);
    }
  }

 private:
  static constexpr std::size_t block = 8;  ///< rows: one vector of AVX-512, or several
  enum class Triangle { lower, upper };

  /// Columns [first, last), from row `first` on: L below the diagonal, of which it has ones, and U.
  void factor_panel(std::size_t first, std::size_t last) {
    const D d;
    const std::size_t above = first / lanes(), vectors = m_.vectors() - above;
    for (std::size_t j = first; j < last; ++j) {
      double* const column = m_.element(0, j);
      std::size_t pivot = j;
      for (std::size_t i = j + 1; i < n_; ++i)
        if (std::abs(column[i]) > std::abs(column[pivot])) pivot = i;
      if (pivot != j) exchange_rows(j, pivot, first);
      const double inverse = 1.0 / column[j];
      for (std::size_t i = j + 1; i < n_; ++i) column[i] *= inverse;
      // Rows up to j take no part: 0 in their place for as long as the others are changed.
      double done[block];
      std::copy(column + first, column + j + 1, done);
      std::fill(column + first, column + j + 1, 0.0);
      for (std::size_t c = j + 1; c < last; ++c) {
        const V factor = hn::Set(d, *m_.element(j, c));
        const Target panel = target(m_).at(above, 0);
        for (std::size_t v = 0; v < vectors; ++v)
          hn::Store(
              hn::NegMulAdd(hn::Load(d, panel.place(v, j)), factor, hn::Load(d, panel.place(v, c))),
              d, panel.place(v, c));
      }
      std::copy(done, done + (j + 1 - first), column + first);
    }
  }

  /// The factors left of column `from` have done their work.
  void exchange_rows(std::size_t i, std::size_t k, std::size_t from) {
    for (std::size_t c = from; c < n_; ++c) std::swap(*m_.element(i, c), *m_.element(k, c));
    for (std::size_t c = 0; c < b_.columns(); ++c) std::swap(*b_.element(i, c), *b_.element(k, c));
  }

  /// The inverse of the lower (with ones in its diagonal) or upper triangle at [first, last).
  void make_triangle_inverse(std::size_t first, std::size_t last, Triangle which) {
    const std::size_t size = last - first;
    inverse_.fill(0.0);
    const auto at = [&](std::size_t i, std::size_t j) { return *m_.element(first + i, first + j); };
    for (std::size_t j = 0; j < size; ++j) {
      if (which == Triangle::lower) {
        *inverse_.element(j, j) = 1.0;
        for (std::size_t i = j + 1; i < size; ++i) {
          double sum = 0.0;
          for (std::size_t q = j; q < i; ++q) sum -= at(i, q) * *inverse_.element(q, j);
          *inverse_.element(i, j) = sum;
        }
      } else {
        *inverse_.element(j, j) = 1.0 / at(j, j);
        for (std::size_t i = j; i-- > 0;) {
          double sum = 0.0;
          for (std::size_t q = i + 1; q <= j; ++q) sum -= at(i, q) * *inverse_.element(q, j);
          *inverse_.element(i, j) = sum / at(i, i);
        }
      }
    }
  }

  /// Rows [first, last) of x, in columns from `from` on, times the inverse.
  void apply_inverse(Single& x, std::size_t first, std::size_t last, std::size_t from) {
    const D d;
    const std::size_t above = first / lanes(), columns = x.columns() - from;
    const std::size_t vectors = (last - first + lanes() - 1) / lanes();
    const Target rows = target(x).at(above, from), copy = target(strip_);
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t v = 0; v < vectors; ++v)
        hn::Store(hn::Load(d, rows.place(v, j)), d, copy.place(v, j));
    add_product<AlongRows>(rows, source(inverse_), factors(strip_), vectors, last - first, columns,
                           replace);
  }

  Single& m_;
  Single& b_;
  std::size_t n_;
  Single strip_, inverse_{block, block};
};

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
