// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace lamina {

/// A whole number as a person reads it in a range: `1000`, from a million on `1e9`, `2^24` or
/// `2^64 - 1` where it is one of these.
[[nodiscard]] std::string whole_number_text(std::int64_t value);
[[nodiscard]] std::string whole_number_text(std::uint64_t value);

}  // namespace lamina
