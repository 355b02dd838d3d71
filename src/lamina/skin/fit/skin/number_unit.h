// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lamina {

/// Unit of the values of a number of skin, and the curve of absorption they count by; empty for
/// a name that is none of skin_fit_numbers.
[[nodiscard]] std::string unit_of_number(const std::string& name);

}  // namespace lamina
