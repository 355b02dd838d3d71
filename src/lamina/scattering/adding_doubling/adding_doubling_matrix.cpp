// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Compiled several times, for one kind of processor each: LAMINA_KERNELS names the table made here,
// and Eigen's namespace is renamed by a macro so that no symbol is shared between the versions.
#include "lamina/scattering/adding_doubling/adding_doubling_matrix.h"

#ifndef LAMINA_KERNELS
#define LAMINA_KERNELS matrix_kernels_baseline
#define LAMINA_KERNELS_NAME "baseline"
#endif

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#pragma GCC diagnostic pop

#include "lamina/scattering/adding_doubling/internal/adding_doubling_lanes.h"

namespace lamina::detail {

extern const MatrixKernels LAMINA_KERNELS;

namespace {

using Dense = Eigen::MatrixXd;
using View = Eigen::Map<const Dense>;
using Lower = Eigen::SelfAdjointView<Dense, Eigen::Lower>;

/// The even and odd solutions of a thin layer, which need no matrix of twice the size.
///
/// With U = A + B, V = A - B, x half the thickness, C = cosh(x sqrt(VU)) and S = U sinh(x
/// sqrt(VU)) / sqrt(VU), reflection plus transmission is (C + S) (C - S)^-1; the same with U and V
/// exchanged is transmission minus reflection. Both are returned times the signs, so symmetric.
void thin_slab(const SlabProblem& problem, Dense& H, Dense& K) {
  const int n = problem.size, even = problem.even;
  const View A(problem.forward, n, n), B(problem.backward, n, n);
  const double x = 0.5 * problem.step;
  const Dense U = (A + B) * x, V = (A - B) * x;
  Dense G(n, n), G2(n, n), G3(n, n), C(n, n), s(n, n), high(n, n);
  G.noalias() = V * U;
  G2.noalias() = G * G;
  G3.noalias() = G2 * G;
  // cosh(y) = sum y^2j / (2j)!, sinh(y) / y = sum y^2j / (2j + 1)! in y^2 = G, up to G^6.
  high = G / 40320.0 + G2 / 3628800.0 + G3 / 479001600.0;
  high.diagonal().array() += 1.0 / 720.0;
  C.noalias() = G3 * high;
  C += G / 2.0 + G2 / 24.0;
  C.diagonal().array() += 1.0;
  high = G / 362880.0 + G2 / 39916800.0 + G3 / 6227020800.0;
  high.diagonal().array() += 1.0 / 5040.0;
  s.noalias() = G3 * high;
  s += G / 6.0 + G2 / 120.0;
  s.diagonal().array() += 1.0;

  const auto flip_odd_rows = [&](Dense& m) { m.bottomRows(n - even) *= -1.0; };
  const auto flip_odd_columns = [&](Dense& m) { m.rightCols(n - even) *= -1.0; };
  Dense S(n, n);
  // Solves for the transpose of (C + S)(C - S)^-1, which is it but for the signs.
  const auto quotient = [&](const Dense& cosh_part, const Dense& sinh_part) {
    const Dense below = (cosh_part - sinh_part).transpose();
    const Dense above = (cosh_part + sinh_part).transpose();
    Dense q = below.partialPivLu().solve(above);
    flip_odd_rows(q);
    return Dense(0.5 * (q + q.transpose()));
  };
  S.noalias() = U * s;
  const Dense sum = quotient(C, S);
  // Reciprocity: f(UV) is the transpose of f(VU) but for the signs.
  const auto other_order = [&](const Dense& m) {
    Dense t = m.transpose();
    flip_odd_rows(t);
    flip_odd_columns(t);
    return t;
  };
  S.noalias() = V * other_order(s);
  const Dense difference = quotient(other_order(C), S);  // transmission - reflection
  H = 0.5 * (sum - difference);
  K = 0.5 * (sum + difference);
}

/// Space for `sandwich`.
struct Work {
  Dense first, second, Y, W, Z;
};

/// K (J + sign H)^-1 K for symmetric H, K and the diagonal matrix J of the signs; lower triangle.
///
/// The matrix is quasi-definite: positive on the even states, negative on the odd ones, since no
/// reflector returns more than it gets. So two Cholesky factors do, without pivoting.
void sandwich(const Dense& H, const Dense& K, double sign, int even, Work& work, Dense& out) {
  const int n = static_cast<int>(H.rows()), odd = n - even;
  work.first.noalias() = sign * H.topLeftCorner(even, even);
  work.first.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::Ref<Dense>> first_factor(work.first);
  work.Y = K.leftCols(even);
  first_factor.matrixU().solveInPlace<Eigen::OnTheRight>(work.Y);
  out.setZero();
  out.selfadjointView<Eigen::Lower>().rankUpdate(work.Y);
  if (odd == 0) return;
  work.W.noalias() = sign * H.bottomLeftCorner(odd, even);
  first_factor.matrixU().solveInPlace<Eigen::OnTheRight>(work.W);
  work.second.noalias() = -sign * H.bottomRightCorner(odd, odd);
  work.second.diagonal().array() += 1.0;
  work.second.selfadjointView<Eigen::Lower>().rankUpdate(work.W);
  const Eigen::LLT<Eigen::Ref<Dense>> second_factor(work.second);
  work.Z = K.rightCols(odd);
  work.Z.noalias() -= work.Y * work.W.transpose();
  second_factor.matrixU().solveInPlace<Eigen::OnTheRight>(work.Z);
  out.selfadjointView<Eigen::Lower>().rankUpdate(work.Z, -1.0);
}

void restore_energy(const double* root_etendue, const Dense& H, Dense& K) {
  const Eigen::Map<const Eigen::VectorXd> root(root_etendue, H.rows());
  const Eigen::VectorXd left = H * root + K * root;  // symmetric: also what leaves per state
  K.diagonal().array() += 1.0 - left.array() / root.array();
}

/// Two equal slabs on one another: lit alike from both sides, each sees a mirror at the joint, and
/// lit with opposite signs a mirror of reflectance -1.
///
///     R' + T' = R + T (1 - R)^-1 T,    R' - T' = R - T (1 + R)^-1 T
int slab(const SlabProblem& problem, double* reflection, double* transmission) {
  const int n = problem.size, even = problem.even;
  Dense H(n, n), K(n, n), P(n, n), Q(n, n);
  Work work;
  thin_slab(problem, H, K);
  int done = 0;
  while (done < problem.doublings) {
    sandwich(H, K, -1.0, even, work, P);
    sandwich(H, K, 1.0, even, work, Q);
    H.triangularView<Eigen::Lower>() += 0.5 * (P - Q);
    K.triangularView<Eigen::Lower>() = 0.5 * (P + Q);
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
    K.triangularView<Eigen::StrictlyUpper>() = K.transpose();
    if (problem.conserved != nullptr) restore_energy(problem.conserved, H, K);
    ++done;
    if (problem.opaque > 0.0 && K.cwiseAbs().maxCoeff() < problem.opaque) break;
  }
  H.rightCols(n - even) *= -1.0;
  K.rightCols(n - even) *= -1.0;
  Eigen::Map<Dense>(reflection, n, n) = H;
  Eigen::Map<Dense>(transmission, n, n) = K;
  return done;
}

/// Slabs of the same states, `lanes` at a time. All are doubled as often as the one that needs it
/// most: the others start thinner.
void slabs(const SlabProblem* problems, int count, double* const* reflection,
           double* const* transmission) {
  const int n = problems[0].size, even = problems[0].even;
  Dense start_H(n, n), start_K(n, n);
  Batch H(n, n), K(n, n);
  for (int first = 0; first < count; first += lanes) {
    const int last = std::min(count, first + lanes);
    int doublings = 0;
    for (int l = first; l < last; ++l) doublings = std::max(doublings, problems[l].doublings);
    for (int lane = 0; lane < lanes; ++lane) {
      if (first + lane < last) {
        SlabProblem problem = problems[first + lane];
        problem.step = std::ldexp(problem.step, problem.doublings - doublings);
        thin_slab(problem, start_H, start_K);
      }
      for (int j = 0; j < n; ++j)  // a lane too many repeats the last
        for (int i = 0; i < n; ++i) {
          H(i, j)[lane] = start_H(i, j);
          K(i, j)[lane] = start_K(i, j);
        }
    }
    double_slabs(H, K, even, doublings, problems[first].opaque);
    for (int l = first; l < last; ++l)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const double sign = j < even ? 1.0 : -1.0;
          reflection[l][j * n + i] = sign * H(i, j)[l - first];
          transmission[l][j * n + i] = sign * K(i, j)[l - first];
        }
  }
}

void joint(int size, const double* a, const double* b, double* out) {
  Dense m(size, size);
  m.noalias() = -(View(a, size, size) * View(b, size, size));
  m.diagonal().array() += 1.0;
  Eigen::Map<Dense>(out, size, size) = m.partialPivLu().inverse();
}

void multiply(int rows, int inner, int columns, const double* a, const double* b, double* out) {
  Eigen::Map<Dense>(out, rows, columns).noalias() = View(a, rows, inner) * View(b, inner, columns);
}

}  // namespace

const MatrixKernels LAMINA_KERNELS = {LAMINA_KERNELS_NAME, slab, lanes, slabs, joint, multiply};

}  // namespace lamina::detail
