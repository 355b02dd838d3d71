// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "lamina/scattering/adding_doubling/adding_doubling_matrix.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/scattering/adding_doubling/slab_derivatives.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
//
#include "lamina/scattering/adding_doubling/internal/differentiated_matrix-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

SlopedSlab double_slab_with_slopes(const SlabProblem& problem, std::span<const SlabSlope> slopes) {
  const auto n = static_cast<std::size_t>(problem.size);
  const auto even = static_cast<std::size_t>(problem.even);
  Sloped A{padded(problem.forward, n, n), {}}, B{padded(problem.backward, n, n), {}};
  for (const SlabSlope& slope : slopes) {
    A.slopes.push_back(padded(slope.forward, n, n));
    B.slopes.push_back(padded(slope.backward, n, n));
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
  SlopedSlab slab{with_signs(H.value), with_signs(K.value), {}, {}};
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    slab.reflection_slopes.push_back(with_signs(H.slopes[k]));
    slab.transmission_slopes.push_back(with_signs(K.slopes[k]));
  }
  return slab;
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina::detail {

HWY_EXPORT(double_slab_with_slopes);

SlopedSlab double_slab_with_slopes(const SlabProblem& problem, std::span<const SlabSlope> slopes) {
  return HWY_DYNAMIC_DISPATCH(double_slab_with_slopes)(problem, slopes);
}

}  // namespace lamina::detail
#endif
