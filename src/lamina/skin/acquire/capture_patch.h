// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/inversion/patch_tiles.h"

namespace lamina {

/// A capture as inversions with transport take it, part by part: without what the surface mirrors,
/// and with pixels that are not used as ones that are not known. Light from all sides counts as
/// light from 57 degrees, of which as much enters.
///
/// @param capture  must outlive what is returned
[[nodiscard]] LargePatch patch_of(const Capture& capture);

/// Pixels of a capture that are used and lit, evenly spread over it, at most so many, in one row:
/// enough for make_inversion_tables, but light does not go from one to the next.
/// @throws InvalidInput if there are none.
[[nodiscard]] PatchCapture sampled_patch(const Capture& capture, std::size_t most);

}  // namespace lamina
