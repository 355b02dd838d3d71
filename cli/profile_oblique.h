// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "console.h"
#include "lamina/base/io/json_output.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/profile/hankel.h"

namespace lamina::cli {

/// `lamina profile --incidence DEG`: the profile over the plane by its moments in azimuth.
/// @param stacks  [band], lit from above
/// @param head    what the JSON starts with after the method
void run_profile_oblique(const Material& material, const std::vector<LayerStack>& stacks,
                         double degrees, const RadialGrid& grid, int moments,
                         const JsonOutput& head, const CommonOptions& common);

}  // namespace lamina::cli
