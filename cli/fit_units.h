// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lamina::cli {

/// The unit of a number of a material file, by its path; empty without one.
/// @param length_unit  of the file
[[nodiscard]] std::string unit_of(std::string_view path, std::string_view length_unit);

}  // namespace lamina::cli
