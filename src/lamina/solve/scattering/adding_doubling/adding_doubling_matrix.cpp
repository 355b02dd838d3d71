// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"

#include <algorithm>
#include <cmath>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
//
#include "lamina/solve/scattering/adding_doubling/internal/slab_doubling-inl.h"
#include "lamina/solve/scattering/adding_doubling/internal/thin_slab-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

using Batch = Dense<AcrossMatrices>;

ThinSlab<Single> thin_slab(const SlabProblem& problem) {
  const auto n = static_cast<std::size_t>(problem.size);
  return thin_slab(padded(problem.forward, n, n), padded(problem.backward, n, n),
                   0.5 * problem.step, static_cast<std::size_t>(problem.even));
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
/// @param rungs  last doublings that are kept, [rung * stride + problem]
void double_batch(std::span<const SlabProblem> problems, std::size_t rungs, std::size_t stride,
                  double* const* reflection, double* const* transmission) {
  const auto n = static_cast<std::size_t>(problems[0].size);
  const auto even = static_cast<std::size_t>(problems[0].even);
  int doublings = static_cast<int>(rungs) - 1;
  for (const SlabProblem& problem : problems) doublings = std::max(doublings, problem.doublings);
  std::vector<ThinSlab<Single>> thin;
  for (SlabProblem problem : problems) {
    problem.step = std::ldexp(problem.step, problem.doublings - doublings);
    thin.push_back(thin_slab(problem));
  }
  Batch H(n, n), K(n, n);
  for (std::size_t l = 0; l < lanes(); ++l) {
    const ThinSlab<Single>& of_lane =
        thin[std::min(l, thin.size() - 1)];  // a lane too many repeats it
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        H.element(i, j)[l] = *of_lane.H.element(i, j);
        K.element(i, j)[l] = *of_lane.K.element(i, j);
      }
  }
  const auto keep = [&](std::size_t rung) {
    for (std::size_t l = 0; l < problems.size(); ++l)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i) {
          const double sign = j < even ? 1.0 : -1.0;
          reflection[rung * stride + l][j * n + i] = sign * H.element(i, j)[l];
          transmission[rung * stride + l][j * n + i] = sign * K.element(i, j)[l];
        }
  };
  Doubling<AcrossMatrices> double_once(n, even);
  const int first_kept = doublings + 1 - static_cast<int>(rungs);
  bool is_opaque = false;
  for (int done = 0; done < doublings && !(is_opaque && rungs == 1); ++done) {
    if (done >= first_kept) keep(static_cast<std::size_t>(done - first_kept));
    if (!is_opaque) double_once(H, K);
    is_opaque = problems[0].opaque > 0.0 && all_less(K, problems[0].opaque);
  }
  keep(rungs - 1);
}

void double_slab_ladder(std::span<const SlabProblem> problems, std::size_t rungs,
                        double* const* reflection, double* const* transmission) {
  for (std::size_t first = 0; first < problems.size(); first += lanes())
    double_batch(problems.subspan(first, std::min(lanes(), problems.size() - first)), rungs,
                 problems.size(), reflection + first, transmission + first);
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
HWY_EXPORT(double_slab_ladder);
HWY_EXPORT(slabs_at_once);
HWY_EXPORT(product);
HWY_EXPORT(between);

int double_slab(const SlabProblem& problem, double* reflection, double* transmission) {
  return HWY_DYNAMIC_DISPATCH(double_slab)(problem, reflection, transmission);
}

void double_slab_ladder(std::span<const SlabProblem> problems, std::size_t rungs,
                        double* const* reflection, double* const* transmission) {
  HWY_DYNAMIC_DISPATCH(double_slab_ladder)(problems, rungs, reflection, transmission);
}

void double_slabs(std::span<const SlabProblem> problems, double* const* reflection,
                  double* const* transmission) {
  double_slab_ladder(problems, 1, reflection, transmission);
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
