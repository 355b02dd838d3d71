// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lamina/scene/description/scene.h"

namespace lamina {

/// Why random walks do not take the meshes or maps of a material, and what to do; absent if they
/// do. RandomWalk says what else there may be.
[[nodiscard]] std::optional<std::string> walk_refusal(const Scene& scene, std::uint32_t material);

/// Whether there are point, spot or distant lights, which no path meets.
[[nodiscard]] bool has_lights_without_area(const Scene& scene);

/// Whether random walks take a material for sure, by what is known before they are made: no
/// walk_refusal, no other medium in a mesh, no refraction between its layers that hides a light.
[[nodiscard]] bool takes_walks(const Scene& scene, std::uint32_t material);

}  // namespace lamina
