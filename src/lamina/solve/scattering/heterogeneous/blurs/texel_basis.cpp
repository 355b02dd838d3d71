// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/texel_basis.h"

#include "lamina/solve/scattering/heterogeneous/blurs/internal/basis_row.h"

namespace lamina {

template <class T>
void add_times_basis(const TexelBasisOf<T>& basis, int y,
                     std::type_identity_t<std::span<const T>> values,
                     std::type_identity_t<std::span<const T>> coefficients,
                     std::type_identity_t<std::span<T>> sum) {
  detail::BasisRow<T> functions(basis);
  functions.move_to(y);
  functions.add_times_sum(values.data(), coefficients, sum.data(), nullptr, sum.size());
}

template <class T>
PlaneOf<T> times_basis(const TexelBasisOf<T>& basis, const PlaneOf<T>& plane,
                       std::type_identity_t<std::span<const T>> coefficients) {
  PlaneOf<T> result = make_plane<T>(plane.width, plane.height);
  detail::BasisRow<T> functions(basis);
  for (int y = 0; y < plane.height; ++y) {
    functions.move_to(y);
    functions.add_times_sum(detail::row_of(plane, y), coefficients, detail::row_of(result, y),
                            nullptr, static_cast<std::size_t>(plane.width));
  }
  return result;
}

template <class T>
PlaneAndSlope<T> times_basis_and_slope(const TexelBasisOf<T>& basis, const PlaneOf<T>& plane,
                                       std::type_identity_t<std::span<const T>> coefficients) {
  PlaneAndSlope<T> result{make_plane<T>(plane.width, plane.height),
                          make_plane<T>(plane.width, plane.height)};
  detail::BasisRow<T> functions(basis);
  for (int y = 0; y < plane.height; ++y) {
    functions.move_to(y);
    functions.add_times_sum(detail::row_of(plane, y), coefficients, detail::row_of(result.plane, y),
                            detail::row_of(result.slope, y), static_cast<std::size_t>(plane.width));
  }
  return result;
}

#define LAMINA_INSTANTIATE(T)                                                                     \
  template void add_times_basis(const TexelBasisOf<T>&, int, std::span<const T>,                  \
                                std::span<const T>, std::span<T>);                                \
  template PlaneOf<T> times_basis(const TexelBasisOf<T>&, const PlaneOf<T>&, std::span<const T>); \
  template PlaneAndSlope<T> times_basis_and_slope(const TexelBasisOf<T>&, const PlaneOf<T>&,      \
                                                  std::span<const T>)
LAMINA_INSTANTIATE(float);
LAMINA_INSTANTIATE(double);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
