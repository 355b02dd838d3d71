// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/base/io/internal/json_tree.h"

namespace lamina::json_detail {

/// Puts the files that "base" names in every object of lamina's below what the objects say: objects
/// are merged key by key, null removes a key of the base, all else replaces what the base has. The
/// base of a material that is no file, but a name, stays.
/// @throws InvalidInput if bases form a loop, or are deeper than json_max_bases; FileError
void resolve_bases(Tree& tree);

/// Lays an object of another tree over a base, whatever "base" it names.
void lay_over(Tree& base, const Tree& from, std::uint32_t object);

/// Changes one value, as `--set KEY=VALUE` asks for.
///
/// A string on the path, such as the name of a material, becomes an object that has it as "base".
///
/// @param setting  such as `camera.look_at=[0, 1, 0]`, `lights[2].scale=3` or `name=Anna`: a path
/// in
///                 the tree, and JSON or a bare string; null removes what is there, list[+] adds an
///                 element. Objects on the path that are missing are made. Files are relative to
///                 the working folder.
/// @throws InvalidInput that starts with `--set KEY`
void apply_setting(Tree& tree, const std::string& setting);

}  // namespace lamina::json_detail
