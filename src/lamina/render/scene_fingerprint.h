// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/render/render.h"
#include "lamina/render/scene.h"

namespace lamina {

/// What the light on surfaces follows from, part by part: parts that differ have other numbers, but
/// for one case in 10^19. The camera and the film are no part of it.
struct SceneFingerprint {
  std::uint64_t meshes = 0, materials = 0, maps = 0, lights = 0;
  std::uint64_t settings = 0;  ///< method and how it samples, bounces and seed
  friend bool operator==(const SceneFingerprint&, const SceneFingerprint&) = default;
};

[[nodiscard]] SceneFingerprint fingerprint(const Scene& scene);

/// All that the samples of a picture follow from: the scene with its camera, the size of the
/// picture, and how it is rendered.
[[nodiscard]] std::uint64_t picture_key(const Scene& scene, const RenderOptions& options);

}  // namespace lamina
