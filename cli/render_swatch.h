// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/layers/materials/material.h"

namespace lamina::cli {

/// Renders a ball of a material and writes it as it looks, a PNG.
/// @throws WriteError; Interrupted
void save_swatch(const Material& material, const std::string& file);

}  // namespace lamina::cli
