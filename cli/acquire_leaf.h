// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/base/io/json_output.h"
#include "lamina/skin/acquire/files/leaf_files.h"
#include "lamina/skin/acquire/leaf_acquisition.h"

namespace lamina::cli {

[[nodiscard]] std::string leaf_text(const LeafMaps& leaf);

/// Adds what was found to a result.
void add_leaf_json(const LeafMaps& leaf, const Capture& capture, const LeafFiles& files,
                   JsonOutput& json);

/// Maps of leaves as one HTML page that needs nothing else.
/// @param command  as it was typed
[[nodiscard]] std::string leaf_page(const LeafMaps& leaf, const Capture& capture,
                                    const std::string& command);

}  // namespace lamina::cli
