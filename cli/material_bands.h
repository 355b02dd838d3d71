// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/io/json_output.h"
#include "lamina/materials/material.h"

namespace lamina::cli {

/// The "bands" of a JSON result: "R", "G", "B", or wavelengths in nm.
[[nodiscard]] JsonOutput bands_json(const BandSet& bands);

/// A table as an array of rows.
/// @param table  [row][column]
[[nodiscard]] JsonOutput table_json(std::span<const double> table, std::size_t columns);

}  // namespace lamina::cli
