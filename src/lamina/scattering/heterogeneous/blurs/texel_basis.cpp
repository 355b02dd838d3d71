// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/blurs/texel_basis.h"

#include "lamina/scattering/heterogeneous/blurs/internal/basis_row.h"

namespace lamina {

void add_times_basis(const TexelBasis& basis, int y, std::span<const float> values,
                     std::span<const float> coefficients, std::span<float> sum) {
  detail::BasisRow functions(basis);
  functions.move_to(y);
  functions.add_times_sum(values.data(), coefficients, sum.data(), sum.size());
}

}  // namespace lamina
