// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/scene/description/scene.h"
#include "lamina/solve/scattering/profile/profile.h"
#include "lamina/solve/scattering/transport_profile/thickness_profiles.h"

namespace lamina {

/// By radiative transfer, to some 2 % of all light in the mean; kept in the cache. The lowest
/// boundary counts as smooth, its roughness being the renderer's business.
/// @throws InvalidInput as transfer_profile; Interrupted if progress asks to stop.
[[nodiscard]] Profile diffuse_transfer_profile(std::span<const LayerStack> bands,
                                               const std::optional<DiskCache>& cache,
                                               const Progress& progress = {});

/// Profile of a material by layered diffusion, in a millisecond.
[[nodiscard]] Profile diffusion_profile(const Material& material);

/// Why radiative transfer does not take the layers of a material, or thin slabs of them; absent if
/// it does.
[[nodiscard]] std::optional<std::string> transfer_refusal(const Material& material);

/// Makes the profiles that a scene asks for, as rendering wants them: of diffuse light, per flux
/// that entered, all directions of exit together. Layers are those of a material, or made of them;
/// what its recipe says decides on their totals: profiles by diffusion get those of radiative
/// transfer for skin whose constants are made for them, see skin_totals.h.
class ProfileMaker {
 public:
  using Source = RenderSettings::Profile;

  /// @param progress  what takes long reports to it: solutions, not what the cache has
  explicit ProfileMaker(const RenderSettings& settings, Progress progress = {});

  /// Where the profiles of a material come from: profile_of(settings), but diffusion where that is
  /// radiative transfer and nothing is named, if there is a transfer_refusal or the coefficients
  /// were found by diffusion.
  [[nodiscard]] Source source(const Material& material) const;

  /// The profile of layers, [band].
  /// @throws InvalidInput as the solver; Interrupted if progress asks to stop.
  [[nodiscard]] Profile operator()(const Material& material,
                                   std::span<const LayerStack> bands) const;

  /// Profiles of layers of which the last is infinite, and of slabs of them up to one that lets
  /// nothing through, three to an octave.
  struct ByThickness {
    std::vector<double> thickness;  ///< [slab] [mm]
    std::vector<Profile> slabs;     ///< [slab]
    Profile half_space;
  };
  /// @param thinnest_place  of objects of the material [mm]: slabs begin below it
  /// @throws as operator().
  [[nodiscard]] ByThickness by_thickness(const Material& material,
                                         std::span<const LayerStack> bands,
                                         double thinnest_place) const;
  /// The thinnest slab that is made of layers, and a thickness that none reaches [mm].
  struct SlabThicknesses {
    double thinnest, thickest;
  };
  [[nodiscard]] static SlabThicknesses slab_thicknesses(const LayerStack& half_space);

  /// Function that makes profiles of given layers with any absorption, of which many are wanted: by
  /// radiative transfer, half-spaces of one layer come from tables, see half_space_table.h.
  using OfAnyAbsorption = std::function<Profile(std::span<const LayerStack> bands)>;
  [[nodiscard]] OfAnyAbsorption of_any_absorption(const Material& material,
                                                  std::span<const LayerStack> bands) const;

 private:
  /// Half-spaces that `thickness_profiles` takes, by radiative transfer; absent for others.
  [[nodiscard]] std::optional<ByThickness> together(const Material& material,
                                                    std::span<const LayerStack> bands,
                                                    const ThicknessRange& range) const;

  RenderSettings settings_;
  Progress progress_;
};

}  // namespace lamina
