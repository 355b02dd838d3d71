// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/subsurface/irradiance_cloud.h"

namespace lamina {

/// Writes the light on all translucent materials of a scene as one PLY file, binary: a vertex per
/// sample with x y z [mm], nx ny nz, u v, area [mm²], red green blue (the material's colour),
/// thickness [mm] (0: thick), material (its index), and of each band irradiance_0 …; of light that
/// has spread exitance_0 …, reflectance_0 … and, of sheets, transmittance_0 … instead. Ratios to
/// planar light are an element `ratio` of their own. What the file was made for, and a checksum of
/// all of it, are said in comments.
///
/// @param clouds  at least one, all of the same number of bands, and all spread or none
/// @param ratios  any number, of the same bands
/// @throws WriteError
void save_irradiance_clouds(const std::vector<IrradianceCloud>& clouds,
                            const std::vector<LightRatioCloud>& ratios,
                            const LightFingerprint& made_for, const std::filesystem::path& file);

/// Content of a file of clouds, or why it is of no use: it may be made anew in its place.
struct KeptClouds {
  std::vector<IrradianceCloud> clouds;
  std::vector<LightRatioCloud> ratios;
  std::string why_unusable;  ///< damaged, of another version, made for another scene; else empty
};

/// Pictures whose light a file may have.
enum class CloudOrigin {
  own,  ///< made for the scene, whole by its checksum
  any,  ///< of another program or scene: only its numbers must be such as surfaces have
};

/// Reads such a file back.
///
/// @param memory  what reading may take.
/// @throws FileError if it cannot be read, takes more than there is, or is no such file: then it is
/// someone else's.
[[nodiscard]] KeptClouds load_irradiance_clouds(const std::filesystem::path& file,
                                                const LightFingerprint& wanted,
                                                MemoryBudget memory = {},
                                                CloudOrigin origin = CloudOrigin::own);

}  // namespace lamina
