// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling/adding_doubling_matrix.h"

namespace lamina::detail {

extern const MatrixKernels matrix_kernels_baseline;
#ifdef LAMINA_X86_KERNELS
extern const MatrixKernels matrix_kernels_v3;
extern const MatrixKernels matrix_kernels_v4;
#endif

std::vector<const MatrixKernels*> runnable_matrix_kernels() {
  std::vector<const MatrixKernels*> kernels;
#ifdef LAMINA_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4")) kernels.push_back(&matrix_kernels_v4);
  if (__builtin_cpu_supports("x86-64-v3")) kernels.push_back(&matrix_kernels_v3);
#endif
  kernels.push_back(&matrix_kernels_baseline);
  return kernels;
}

const MatrixKernels& matrix_kernels() {
  static const MatrixKernels* best = runnable_matrix_kernels().front();
  return *best;
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out(a.rows, b.columns);
  matrix_kernels().multiply(static_cast<int>(a.rows), static_cast<int>(a.columns),
                            static_cast<int>(b.columns), a.values.data(), b.values.data(),
                            out.values.data());
  return out;
}

Matrix between(const Matrix& a, const Matrix& b) {
  Matrix out(a.rows, a.columns);
  matrix_kernels().joint(static_cast<int>(a.rows), a.values.data(), b.values.data(),
                         out.values.data());
  return out;
}

std::vector<double> product(const Matrix& m, const std::vector<double>& x) {
  std::vector<double> y(m.rows, 0.0);
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i) y[i] += m(i, j) * x[j];
  return y;
}

}  // namespace lamina::detail
