// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/heterogeneous/blurs/cell_blurs.h"

namespace lamina {

/// Dims cells that have more than twice the light of each of their neighbours to that much. Found
/// by a few random paths, light that few of them carry (mirrored by one surface onto another) makes
/// single cells glare, and spreads around them. A little of it is lost; what lights two cells side
/// by side is not.
template <int N>
void clamp_fireflies(const CellLevel& cells, CellField<N>& light);

}  // namespace lamina
