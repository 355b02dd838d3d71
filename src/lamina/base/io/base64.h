// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lamina {

/// Bytes as text, with padding. Source: RFC 4648 §4.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

}  // namespace lamina
