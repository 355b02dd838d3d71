// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lamina/render/render.h"

namespace lamina {

/// The lights of a layer.
struct LightGroup {
  std::string name;
  std::vector<std::size_t> lights;       ///< indices into Scene::lights
  std::vector<std::uint32_t> materials;  ///< that shine, indices into Scene::materials
};

/// The lights of a scene by their names: those of one name are together, in the order of their
/// first. A light without a name is called after its kind, with a number where there are several of
/// it ("rectangle_2"); a surface that shines after its material, with _ for what is no letter,
/// digit or -.
[[nodiscard]] std::vector<LightGroup> light_groups(const Scene& scene);

/// Renders a scene group by group of its lights, one after the other: with the same samples, in the
/// memory of one picture and 12 bytes more per pixel and group.
///
/// @param scene  its lights are changed meanwhile, and afterwards as they were
/// @return  R, G, B, subsurface and specular are the sums of the groups; all that is not light is
///          that of the first. Channels light.NAME.R, .G, .B of each group come last: what render()
///          makes of the scene with these lights alone. The variance is the most that it can be, as
///          errors of one pixel are not independent. There is no relative noise.
/// @throws InvalidInput if the scene has no light or more than 64 groups; if options ask for a
///         part, for going on, for a cache or for images as they grow, or if noise is not 0.
/// @throws Interrupted if progress asked to stop before the last
/// @throws as render()
[[nodiscard]] RenderResult render_light_layers(Scene& scene, RenderOptions options = {},
                                               const Progress& progress = {});

}  // namespace lamina
