// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

// Characters of text that others wrote.

namespace lamina {

/// Bytes of the character of UTF-8 that the text begins with; 0 if there is none (RFC 3629: no
/// longer form than needed, no surrogates, nothing beyond U+10FFFF).
[[nodiscard]] std::size_t utf8_bytes(std::string_view text);

/// Bytes of the next character, 0 for one that ends a line for some reader, moves the cursor,
/// colors the text, turns the direction of reading, has no width or is none (U+FFFE and its like).
[[nodiscard]] std::size_t printable_bytes(std::string_view text);

/// The beginning of a text as messages show words of files: 40 bytes at most, then "...". It ends
/// with a whole character.
[[nodiscard]] std::string excerpt(std::string_view text);

}  // namespace lamina
