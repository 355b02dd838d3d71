// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lamina {

/// The memory that reading files may still take. A small file can claim a huge picture, so readers
/// take what they are about to allocate from a budget, and refuse the file if that is not left.
///
/// Whoever reads several files for one purpose, as a scene does, passes one budget to all of them:
/// what is kept of a file stays taken, what was needed only while it was read comes back.
struct MemoryBudget {
  std::size_t left = std::size_t{4} << 30;  ///< [bytes]
};

/// Takes memory off a budget; to be called before it is allocated.
/// @param what  needs it, as messages call it: "head.png: 8192 x 8192 pixels of 3 channels".
/// @throws FileError `WHAT would take 7.3 GiB of memory, but only 4 GiB are left of the budget`.
void take_memory(MemoryBudget& budget, std::size_t bytes, std::string_view what);

/// Takes memory for `count` things of `size` bytes each.
void take_memory(MemoryBudget& budget, std::size_t count, std::size_t size, std::string_view what);

/// A size in the largest unit that it reaches, with two digits at least: "4 GiB", "1.5 MiB".
[[nodiscard]] std::string memory_size_text(std::size_t bytes);

/// The bytes that a text such as "512MiB" or "1.5 GiB" says; units are B, KiB, MiB, GiB and TiB.
/// @throws InvalidInput if it is no number > 0 with a unit.
[[nodiscard]] std::size_t parse_memory_size(std::string_view text);

}  // namespace lamina
