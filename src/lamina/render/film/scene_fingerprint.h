// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/render/film/render_options.h"
#include "lamina/render/kept/kept_parts.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Hashes of all that the light entering surfaces follows from, part by part: parts that differ
/// have other numbers, but for one case in 10^19. Camera, film and samples of the picture are no
/// part of it, nor names, nor the roughness of glass. That of a coat is: what it reflects does not
/// enter.
struct LightFingerprint {
  std::uint64_t meshes = 0, materials = 0, maps = 0, lights = 0;
  std::uint64_t settings = 0;  ///< the program, the method and how it samples, bounces and seed
  friend bool operator==(const LightFingerprint&, const LightFingerprint&) = default;
};

/// @param settings  in place of the scene's own
[[nodiscard]] LightFingerprint light_fingerprint(const Scene& scene, const RenderSettings& settings,
                                                 const RenderOptions& options);

/// Hashes of the aspects of a scene that is rendered with some settings, for KeptParts. Names are
/// no part of them.
[[nodiscard]] AspectHashes aspect_hashes(const Scene& scene, const RenderSettings& settings,
                                         const RenderOptions& options);

/// The program, as far as it makes pictures.
[[nodiscard]] std::uint64_t program_key();

/// All that the samples of a picture follow from, but for what is prepared by their number: the
/// scene with its camera, the size of the picture, how it is rendered, and the program.
/// @param settings  in place of the scene's own
[[nodiscard]] std::uint64_t picture_key(const Scene& scene, const RenderSettings& settings,
                                        const RenderOptions& options);

}  // namespace lamina
