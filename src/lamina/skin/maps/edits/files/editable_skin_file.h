// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lamina/base/core/memory_budget.h"
#include "lamina/skin/maps/edits/editable_skin.h"

namespace lamina {

/// Reads a folder with a patch.json or a material.json (with both the maps are those of the patch),
/// or such a file; of the maps NAME.exr also their standard deviations, NAME.sd.exr, where these
/// lie beside them (saturation.sd.exr is that of both saturations), and where there is skin,
/// mask.exr. What such a file says that names further images is left out, with a warning.
/// @throws FileError if there is none or an image is unreadable or not finite; InvalidInput naming
///         file, line and field.
[[nodiscard]] EditableSkin load_editable_skin(const std::filesystem::path& file_or_folder,
                                              MemoryBudget memory = {});

/// Writes maps, standard deviations and mask into a folder, and then the files that load the maps.
/// Images say in their headers what their numbers are, and "lamina.edited_from". Standard
/// deviations that lie there of maps that have none now are removed.
///
/// @param version  of lamina
/// @throws WriteError
void save_editable_skin(const EditableSkin& skin, const std::filesystem::path& folder,
                        const std::string& version, const std::string& edited_from);

}  // namespace lamina
