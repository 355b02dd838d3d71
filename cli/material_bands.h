// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "command.h"
#include "lamina/io/json_output.h"
#include "lamina/materials/material.h"

namespace lamina::cli {

/// The "bands" of a JSON result: "R", "G", "B", or wavelengths in nm.
[[nodiscard]] JsonOutput bands_json(const BandSet& bands);

/// Adds --bands, other wavelengths than those of the file.
void add_bands_option(const Command& command, std::string& bands);

/// The material with its numbers at the wavelengths that --bands says, or at its own if that is
/// empty. @throws as find_material.
[[nodiscard]] Material find_material_at(const std::string& name_or_path, const std::string& bands,
                                        const MemoryBudget& memory);

/// A table as an array of rows.
/// @param table  [row][column]
[[nodiscard]] JsonOutput table_json(std::span<const double> table, std::size_t columns);

}  // namespace lamina::cli
