// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"

namespace lamina::detail {

/// A file of a reproduction with its alternatives `{draft|full}` chosen and its "for" written out.
/// @throws InvalidInput where a "for" is no object of lists, or makes more than 10 000 elements.
[[nodiscard]] JsonOutput expanded(const JsonInput& input, bool is_full);

}  // namespace lamina::detail
