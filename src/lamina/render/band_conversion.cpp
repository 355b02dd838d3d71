// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/band_conversion.h"

#include "lamina/core/error.h"

namespace lamina {

template <int N>
BandConversion<N> make_band_conversion(const BandSet& bands) {
  BandConversion<N> conversion;
  if (!bands.is_rgb()) throw InvalidInput("rendering by wavelength");
  for (int c = 0; c < 3; ++c) conversion.basis[c][c] = conversion.weights[c][c] = 1.0f;
  return conversion;
}

template BandConversion<4> make_band_conversion<4>(const BandSet&);
template BandConversion<8> make_band_conversion<8>(const BandSet&);
template BandConversion<16> make_band_conversion<16>(const BandSet&);

}  // namespace lamina
