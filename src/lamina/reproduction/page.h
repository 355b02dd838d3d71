// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "lamina/base/io/json_output.h"
#include "lamina/reproduction/run_item.h"

namespace lamina {

/// All results as one HTML page that needs nothing else: plots, pictures, checks, inputs and
/// commands, by paper.
/// @throws FileError if a picture that an item promises cannot be read.
[[nodiscard]] std::string format_page(std::span<const ReproductionResult> results,
                                      ReproductionQuality quality);

/// The verdicts with what decides each, and the numbers of all checks; the same for any number of
/// threads.
[[nodiscard]] JsonOutput reproduction_json(std::span<const ReproductionResult> results,
                                           ReproductionQuality quality);

/// Verdicts that are worse than those of an earlier reproduction_json, a line each; empty if none.
/// What was not made, now or then, and what is new is not compared.
/// @throws InvalidInput if `before` is no such file.
[[nodiscard]] std::vector<std::string> worse_verdicts(std::span<const ReproductionResult> results,
                                                      const JsonInput& before);

}  // namespace lamina
