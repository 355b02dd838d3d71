// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lamina {

/// A folder that keeps results which are costly to make, each under the key that it follows from.
///
/// Many processes may use it at once: a file appears whole or not at all. A file that is damaged,
/// or belongs to another key or another kind of machine, counts as missing. What cannot be written
/// is not kept, in silence: a cache never makes work fail.
struct DiskCache {
  std::filesystem::path folder;            ///< made when something is first kept
  std::uintmax_t most_bytes = 256u << 20;  ///< beyond, what was used longest ago is removed
};

/// The user's cache: the folder LAMINA_CACHE of the environment, else lamina in XDG_CACHE_HOME,
/// else .cache/lamina in HOME. Absent if LAMINA_CACHE is "off" or no variable names a folder.
[[nodiscard]] std::optional<DiskCache> user_cache();

/// Bytes that were kept under a key.
[[nodiscard]] std::optional<std::string> load_cached(const DiskCache& cache, std::string_view key);

/// Keeps a value under a key. Returns whether that worked.
bool save_cached(const DiskCache& cache, std::string_view key, std::string_view value);

}  // namespace lamina
