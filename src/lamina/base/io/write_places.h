// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

// Where this process may write. What strangers' files name can be held to stay inside of folders.

namespace lamina {

/// Whether a file or folder, which need not be there, is the folder or lies inside of it, after the
/// links on its way.
[[nodiscard]] bool is_inside(const std::filesystem::path& place,
                             const std::filesystem::path& folder);

/// From now on this process writes files and makes folders inside of these only. None: anywhere, as
/// at the start. Call it before other threads write.
void write_only_inside(std::vector<std::filesystem::path> folders);

/// @throws WriteError if this process may not write there
void require_write_place(const std::filesystem::path& place);

/// Makes a folder, and those that it lies in. @throws WriteError
void make_folder(const std::filesystem::path& folder);

}  // namespace lamina
