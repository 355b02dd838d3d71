// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/base/io/json_input.h"

namespace lamina::input_detail {

/// Whether a number is finite and in a range.
[[nodiscard]] bool contains(const NumberRange& range, double value);

/// "must be >= 0 [1/mm]", "must lie in (0, 180) deg".
[[nodiscard]] std::string rule_of(const NumberRange& range);

/// Rule where something else than a number is given: "must be a number >= 0 [1/mm]", "must be a
/// number in (0, 180) deg".
[[nodiscard]] std::string number_rule_of(const NumberRange& range);

}  // namespace lamina::input_detail
