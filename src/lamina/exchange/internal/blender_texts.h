// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace lamina::detail {

/// blender/lamina_materials/rules.py, and the nodes beside it.
extern const std::string_view blender_rules_text, blender_nodes_text;

}  // namespace lamina::detail
