// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling_matrix.h"

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

}  // namespace lamina::detail
