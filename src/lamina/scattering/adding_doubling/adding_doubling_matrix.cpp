// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling/adding_doubling_matrix.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/scattering/adding_doubling/adding_doubling_matrix.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
//
#include "lamina/scattering/adding_doubling/internal/linear_solve-inl.h"
#include "lamina/scattering/adding_doubling/internal/slab_doubling-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

using Batch = Dense<AcrossMatrices>;

Single padded(const double* values, std::size_t rows, std::size_t columns) {
  Single m(rows, columns);
  for (std::size_t j = 0; j < columns; ++j) std::copy_n(values + j * rows, rows, m.element(0, j));
  return m;
}

void unpad(const Single& m, double* values) {
  for (std::size_t j = 0; j < m.columns(); ++j)
    std::copy_n(m.element(0, j), m.rows(), values + j * m.rows());
}

Single times(const Single& a, const Single& b) {
  Single out(a.rows(), b.columns());
  add_product<AlongRows>(target(out), source(a), factors(b), a.vectors(), a.columns(), b.columns(),
                         replace);
  return out;
}

/// A sum of multiples.
Single combined(std::initializer_list<std::pair<double, const Single*>> terms) {
  const D d;
  Single out(terms.begin()->second->rows(), terms.begin()->second->columns());
  for (std::size_t k = 0; k < out.size(); k += lanes()) {
    V sum = hn::Zero(d);
    for (const auto& [factor, m] : terms)
      sum = hn::MulAdd(hn::Set(d, factor), hn::Load(d, m->data() + k), sum);
    hn::Store(sum, d, out.data() + k);
  }
  return out;
}

Single transpose(const Single& m) {
  Single out(m.columns(), m.rows());
  for (std::size_t j = 0; j < m.rows(); ++j) {
    double* const column = out.element(0, j);
    for (std::size_t i = 0; i < m.columns(); ++i) column[i] = *m.element(j, i);
  }
  return out;
}

/// Changes the sign of part of a column.
void flip(Single& m, std::size_t j, std::size_t first, std::size_t last) {
  for (double* value = m.element(first, j); value != m.element(last, j); ++value) *value = -*value;
}

/// The even and odd solutions of a thin layer, which need no matrix of twice the size.
struct ThinSlab {
  Single H, K;  ///< reflection and transmission, times the signs and so symmetric
};

/// With U = A + B, V = A - B, x half the thickness, C = cosh(x sqrt(VU)) and S = U sinh(x
/// sqrt(VU)) / sqrt(VU), reflection plus transmission is (C + S) (C - S)^-1; the same with U and V
/// exchanged is transmission minus reflection.
ThinSlab thin_slab(const SlabProblem& problem) {
  const auto n = static_cast<std::size_t>(problem.size);
  const auto even = static_cast<std::size_t>(problem.even);
  const Single A = padded(problem.forward, n, n), B = padded(problem.backward, n, n);
  const double x = 0.5 * problem.step;
  const Single plus = combined({{x, &A}, {x, &B}}), minus = combined({{x, &A}, {-x, &B}});
  const Single G = times(minus, plus), G2 = times(G, G), G3 = times(G2, G);
  // cosh(y) = sum y^2j / (2j)!, sinh(y) / y = sum y^2j / (2j + 1)! in y^2 = G, up to G^6.
  const auto series = [&](double c1, double c2, double c3, double c4, double c5, double c6) {
    Single high = combined({{1.0 / c4, &G}, {1.0 / c5, &G2}, {1.0 / c6, &G3}});
    add_to_diagonal(high, 1.0 / c3);
    Single sum = combined({{1.0 / c1, &G}, {1.0 / c2, &G2}});
    add_product<AlongRows>(target(sum), source(G3), factors(high), sum.vectors(), n, n, add);
    add_to_diagonal(sum, 1.0);
    return sum;
  };
  const Single cosh_part = series(2.0, 24.0, 720.0, 40320.0, 3628800.0, 479001600.0);
  const Single sinh_over_y = series(6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0);

  // Solves for the transpose of (C + S)(C - S)^-1, which is it but for the signs.
  const auto quotient = [&](const Single& C, const Single& S) {
    Single below = transpose(combined({{1.0, &C}, {-1.0, &S}}));
    Single above = transpose(combined({{1.0, &C}, {1.0, &S}}));
    Elimination(below, above).solve();
    for (std::size_t j = 0; j < n; ++j) flip(above, j, even, n);
    const Single other = transpose(above);
    return combined({{0.5, &above}, {0.5, &other}});
  };
  const Single sum = quotient(cosh_part, times(plus, sinh_over_y));
  // Reciprocity: f(UV) is the transpose of f(VU) but for the signs.
  const auto other_order = [&](const Single& m) {
    Single turned = transpose(m);
    for (std::size_t j = 0; j < n; ++j)
      j < even ? flip(turned, j, even, n) : flip(turned, j, 0, even);
    return turned;
  };
  const Single difference =  // transmission - reflection
      quotient(other_order(cosh_part), times(minus, other_order(sinh_over_y)));
  return {.H = combined({{0.5, &sum}, {-0.5, &difference}}),
          .K = combined({{0.5, &sum}, {0.5, &difference}})};
}

void restore_energy(const double* root_etendue, const Single& H, Single& K) {
  const Single root = padded(root_etendue, H.rows(), 1), both = combined({{1.0, &H}, {1.0, &K}});
  const Single left = times(both, root);  // symmetric: also what leaves per state
  for (std::size_t j = 0; j < K.columns(); ++j)
    *K.element(j, j) += 1.0 - *left.element(j, 0) / root_etendue[j];
}

int double_slab(const SlabProblem& problem, double* reflection, double* transmission) {
  const auto n = static_cast<std::size_t>(problem.size);
  const auto even = static_cast<std::size_t>(problem.even);
  auto [H, K] = thin_slab(problem);
  Doubling<AlongRows> double_once(n, even);
  int done = 0;
  while (done < problem.doublings) {
    double_once(H, K);
    if (problem.conserved != nullptr) restore_energy(problem.conserved, H, K);
    ++done;
    if (problem.opaque > 0.0 && all_less(K, problem.opaque)) break;
  }
  unpad(H, reflection);
  unpad(K, transmission);
  for (std::size_t k = even * n; k < n * n; ++k) {
    reflection[k] *= -1.0;
    transmission[k] *= -1.0;
  }
  return done;
}

/// All of a batch are doubled as often as the one that needs it most: the others start thinner. In
/// half-spaces until the most transparent one lets through no more than `opaque`.
void double_batch(std::span<const SlabProblem> problems, double* const* reflection,
                  double* const* transmission) {
  const auto n = static_cast<std::size_t>(problems[0].size);
  const auto even = static_cast<std::size_t>(problems[0].even);
  int doublings = 0;
  for (const SlabProblem& problem : problems) doublings = std::max(doublings, problem.doublings);
  std::vector<ThinSlab> thin;
  for (SlabProblem problem : problems) {
    problem.step = std::ldexp(problem.step, problem.doublings - doublings);
    thin.push_back(thin_slab(problem));
  }
  Batch H(n, n), K(n, n);
  for (std::size_t l = 0; l < lanes(); ++l) {
    const ThinSlab& of_lane = thin[std::min(l, thin.size() - 1)];  // a lane too many repeats it
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        H.element(i, j)[l] = *of_lane.H.element(i, j);
        K.element(i, j)[l] = *of_lane.K.element(i, j);
      }
  }
  Doubling<AcrossMatrices> double_once(n, even);
  for (int done = 0; done < doublings; ++done) {
    double_once(H, K);
    if (problems[0].opaque > 0.0 && all_less(K, problems[0].opaque)) break;
  }
  for (std::size_t l = 0; l < problems.size(); ++l)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const double sign = j < even ? 1.0 : -1.0;
        reflection[l][j * n + i] = sign * H.element(i, j)[l];
        transmission[l][j * n + i] = sign * K.element(i, j)[l];
      }
}

void double_slabs(std::span<const SlabProblem> problems, double* const* reflection,
                  double* const* transmission) {
  for (std::size_t first = 0; first < problems.size(); first += lanes())
    double_batch(problems.subspan(first, std::min(lanes(), problems.size() - first)),
                 reflection + first, transmission + first);
}

std::size_t slabs_at_once() { return lanes(); }

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out(a.rows, b.columns);
  const Single wide = padded(a.values.data(), a.rows, a.columns);
  const Factors by = {b.values.data(), 1, b.rows};
  // Whole vectors to where they belong, what is left by way of a strip.
  const std::size_t whole = a.rows / lanes(), rest = whole * lanes();
  add_product<AlongRows>({out.values.data(), out.rows}, source(wide), by, whole, a.columns,
                         b.columns, replace);
  if (rest == a.rows) return out;
  Single strip(a.rows - rest, b.columns);
  add_product<AlongRows>(target(strip), source(wide).at(whole, 0), by, 1, a.columns, b.columns,
                         replace);
  for (std::size_t j = 0; j < b.columns; ++j)
    std::copy_n(strip.element(0, j), strip.rows(), &out(rest, j));
  return out;
}

Matrix between(const Matrix& a, const Matrix& b) {
  const std::size_t n = a.rows;
  Single m(n, n), inverse(n, n);
  add_product<AlongRows>(target(m), source(padded(a.values.data(), n, n)), {b.values.data(), 1, n},
                         m.vectors(), n, n, {To::replace, -1.0});
  add_to_diagonal(m, 1.0);
  inverse.fill(0.0);
  add_to_diagonal(inverse, 1.0);
  Elimination(m, inverse).solve();
  Matrix out(n, n);
  unpad(inverse, out.values.data());
  return out;
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina::detail {

HWY_EXPORT(double_slab);
HWY_EXPORT(double_slabs);
HWY_EXPORT(slabs_at_once);
HWY_EXPORT(product);
HWY_EXPORT(between);

int double_slab(const SlabProblem& problem, double* reflection, double* transmission) {
  return HWY_DYNAMIC_DISPATCH(double_slab)(problem, reflection, transmission);
}

void double_slabs(std::span<const SlabProblem> problems, double* const* reflection,
                  double* const* transmission) {
  HWY_DYNAMIC_DISPATCH(double_slabs)(problems, reflection, transmission);
}

std::size_t slabs_at_once() { return HWY_DYNAMIC_DISPATCH(slabs_at_once)(); }

Matrix product(const Matrix& a, const Matrix& b) { return HWY_DYNAMIC_DISPATCH(product)(a, b); }

Matrix between(const Matrix& a, const Matrix& b) { return HWY_DYNAMIC_DISPATCH(between)(a, b); }

std::vector<double> product(const Matrix& m, const std::vector<double>& x) {
  std::vector<double> y(m.rows, 0.0);
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i) y[i] += m(i, j) * x[j];
  return y;
}

}  // namespace lamina::detail
#endif
