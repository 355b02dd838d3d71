// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/solve/scattering/adding_doubling/slab_derivatives.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
//
#include "lamina/solve/scattering/adding_doubling/internal/differentiated_matrix-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

DifferentiatedSlab double_slab_with_derivatives(
    const SlabProblem& problem, std::span<const SlabProblemDerivative> derivatives) {
  const auto n = static_cast<std::size_t>(problem.size);
  const auto even = static_cast<std::size_t>(problem.even);
  Differentiated A{padded(problem.forward, n, n), {}}, B{padded(problem.backward, n, n), {}};
  for (const SlabProblemDerivative& derivative : derivatives) {
    A.derivatives.push_back(padded(derivative.forward, n, n));
    B.derivatives.push_back(padded(derivative.backward, n, n));
  }
  auto [H, K] = thin_slab(A, B, 0.5 * problem.step, even);
  for (int done = 0; done < problem.doublings; ++done) {
    double_once(H, K, even);
    if (problem.conserved != nullptr) restore_energy(problem.conserved, H.value, K.value);
    if (problem.opaque > 0.0 && all_less(K.value, problem.opaque)) break;
  }
  const auto with_signs = [&](const Single& symmetric) {
    Matrix m(n, n);
    unpad(symmetric, m.values.data());
    for (std::size_t k = even * n; k < n * n; ++k) m.values[k] *= -1.0;
    return m;
  };
  DifferentiatedSlab slab{with_signs(H.value), with_signs(K.value), {}, {}};
  for (std::size_t k = 0; k < derivatives.size(); ++k) {
    slab.reflection_derivatives.push_back(with_signs(H.derivatives[k]));
    slab.transmission_derivatives.push_back(with_signs(K.derivatives[k]));
  }
  return slab;
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina::detail {

HWY_EXPORT(double_slab_with_derivatives);

DifferentiatedSlab double_slab_with_derivatives(
    const SlabProblem& problem, std::span<const SlabProblemDerivative> derivatives) {
  return HWY_DYNAMIC_DISPATCH(double_slab_with_derivatives)(problem, derivatives);
}

}  // namespace lamina::detail
#endif
