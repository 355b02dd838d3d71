// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "command.h"
#include "lamina/base/io/json_output.h"
#include "lamina/layers/materials/material.h"

namespace lamina::cli {

/// The "bands" of a JSON result: "R", "G", "B", or wavelengths in nm.
[[nodiscard]] JsonOutput bands_json(const BandSet& bands);

/// A material with what the command line changes of it.
struct MaterialChoice {
  std::string name;                   ///< built-in, or a file
  std::string bands;                  ///< of --bands: other wavelengths than those of the file
  std::vector<std::string> settings;  ///< of --set
};

/// Adds --bands and --set.
void add_material_options(const Command& command, std::string& bands,
                          std::vector<std::string>& settings);

/// The material with its numbers at the wavelengths of its bands, or at its own if there are none.
/// One without a name has that of its file, for titles and messages.
/// @throws as find_material; InvalidInput that starts with `--set KEY`
[[nodiscard]] Material find_material_at(const MaterialChoice& choice, const MemoryBudget& memory);

/// The material as find_material_at finds it, without a name where its file gives none.
[[nodiscard]] Material find_unnamed_material_at(const MaterialChoice& choice,
                                                const MemoryBudget& memory);

/// A table as an array of rows.
/// @param table  [row][column]
[[nodiscard]] JsonOutput table_json(std::span<const double> table, std::size_t columns);

}  // namespace lamina::cli
