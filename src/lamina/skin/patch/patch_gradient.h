// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/skin/patch/skin_patch.h"

namespace lamina {

/// Derivatives of a number by the maps of a patch.
struct PatchGradient {
  struct OfMap {
    std::string name;  ///< of the parameter of skin
    Plane values;      ///< of the patch's size
  };
  std::vector<OfMap> maps;  ///< as SkinPatch::skin has them
  Plane light;              ///< by the irradiance
};

/// A patch of skin whose light can be differentiated by its maps: how any number that follows from
/// the light that leaves, such as its distance from a photograph, changes with every texel of every
/// map, by reverse accumulation.
///
/// What leaves is that of render_skin_patch, but for operators that hold for the absorption of all
/// texels, not only of paths: within 2 % for maps that are smooth over texels (test), percents
/// where melanin is noise from texel to texel. Maps may be of any number but those that change
/// scattering or thickness.
class DifferentiableSkinPatch {
 public:
  /// Solves for the light.
  /// @throws InvalidInput for a patch of another material, a map that is not of absorption or not
  ///         of the patch's size, a texture `albedo`; as render_skin_patch; Interrupted.
  explicit DifferentiableSkinPatch(SkinPatch patch, const std::optional<DiskCache>& cache = {},
                                   const Progress& progress = {});
  ~DifferentiableSkinPatch();
  DifferentiableSkinPatch(DifferentiableSkinPatch&&) noexcept;

  [[nodiscard]] const SkinPatch& patch() const;

  /// Exitance, [band].
  [[nodiscard]] const std::vector<Plane>& light() const;

  /// @param by_light  derivatives of a number by the exitance, [band]
  /// @throws InvalidInput if there are not as many as bands, of the patch's size; Interrupted.
  [[nodiscard]] PatchGradient gradient(std::span<const Plane> by_light,
                                       const Progress& progress = {});

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace lamina
