// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::cli {

/// Value of --incidence: normal, diffuse, or an angle from the normal in degrees, in [0, 90).
/// @throws InvalidInput for anything else.
[[nodiscard]] Incidence parse_incidence(const std::string& text);

/// Value of --incidence where it must be an angle [degrees].
[[nodiscard]] double parse_incidence_degrees(const std::string& text);

}  // namespace lamina::cli
