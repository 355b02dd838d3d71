// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/band_conversion.h"

namespace lamina {

template <int N>
BandConversion<N> make_band_conversion(const BandSet& bands, const BandWeights& weights) {
  BandConversion<N> conversion;
  const BandBasis basis = make_band_basis(bands, weights);
  for (std::size_t b = 0; b < bands.size(); ++b)
    for (std::size_t c = 0; c < 3; ++c) {
      conversion.basis[c][b] = static_cast<float>(basis[b][c]);
      conversion.weights[c][b] = static_cast<float>(weights[b][c]);
    }
  return conversion;
}

template BandConversion<4> make_band_conversion<4>(const BandSet&, const BandWeights&);
template BandConversion<8> make_band_conversion<8>(const BandSet&, const BandWeights&);
template BandConversion<16> make_band_conversion<16>(const BandSet&, const BandWeights&);

}  // namespace lamina
