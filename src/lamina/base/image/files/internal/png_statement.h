// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "lamina/base/image/files/internal/color_statement.h"

namespace lamina {

/// Reads the colors that chunks of a PNG state: the first of cICP, iCCP, sRGB, and gAMA with cHRM
/// that is there. Source: [PNG2025] §4.3, Table 1.
///
/// 0.45455 for gAMA is what sRGB files have for readers that do not know its curve (§11.3.2.5), and
/// many programs write nothing else: with primaries of Rec.709, or none, it is sRGB's curve.
[[nodiscard]] ColorStatement png_color_statement(const EncodedImage& file);

/// By the chunk eXIf; 1 where there is none.
[[nodiscard]] int png_orientation(std::span<const std::byte> bytes);

}  // namespace lamina
