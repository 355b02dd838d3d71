// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/material_profiles.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

Material stone() {
  Material material{.name = "stone", .ior_above = {1, 1, 1}, .ior_below = {1.5, 1.5, 1.5}};
  material.layers = {{.name = "stone",
                      .sigma_a = {0.01, 0.02, 0.2},
                      .sigma_s = {2, 2.5, 3},
                      .g = {0, 0, 0},
                      .ior = {1.5, 1.5, 1.5},
                      .thickness = std::numeric_limits<double>::infinity()}};
  return material;
}

/// Thickness of the first slab that profiles of the stone are made of, and their number.
struct Slabs {
  std::size_t count;
  float first_blend;  ///< from the first slab to the next, of an object of the thickness asked
};

Slabs slabs_of(Mesh mesh, float thickness, float given_thickness = 0.0f) {
  Scene scene = translucent_scene(RenderSettings::Method::hierarchy, std::move(mesh), stone(),
                                  DirectionalLight{.direction = {0, 0, 1}});
  std::get<SubsurfaceSurface>(scene.materials[0].surface).thickness.value = given_thickness;
  scene.render.profile = RenderSettings::Profile::radiative_transfer;
  const RenderScene prepared(scene);
  const BandConversion<4> conversion{};
  const MaterialProfiles<4> profiles(prepared, conversion, 0, ProfileMaker(scene.render));
  const auto local = profiles.profiles_for(thickness, {1, 1, 1});
  return {profiles.by_thickness().size() - 1,
          local.low == &profiles.by_thickness().front() ? local.blend : -1.0f};
}

TEST(MaterialProfiles, MakesSlabsThatObjectsAskFor) {
  // One way to the far side all over: the first slab is thinner by less than an octave.
  const Slabs thin = slabs_of(make_plate(20.0f, 1.0f), 1.0f);
  EXPECT_GT(thin.count, 4u);
  EXPECT_EQ(thin.first_blend, -1.0f);  // it lies between later ones
  const Slabs thick = slabs_of(make_plate(60.0f, 20.0f), 20.0f);
  EXPECT_LT(thick.count, thin.count);
  // No far side at all, and one that is so deep that nothing gets there.
  EXPECT_EQ(slabs_of(make_square(20.0f), 1.0f).count, 0u);
  EXPECT_EQ(slabs_of(make_plate(400.0f, 180.0f), 1.0f).count, 0u);
  // A thickness that is given counts, not that of the mesh.
  EXPECT_EQ(slabs_of(make_square(20.0f), 1.0f, 1.0f).count, thin.count);
}

}  // namespace
}  // namespace lamina
