// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lamina {

/// A text without the signs of numbers that are rounded to 0: "-0.00000" becomes " 0.00000", as
/// wide. Numbers are what stands behind a blank, a line's begin, a comma, semicolon, colon or
/// bracket.
[[nodiscard]] std::string without_negative_zeros(std::string_view text);

}  // namespace lamina
