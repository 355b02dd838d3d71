// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/base/io/json_file.h"
#include "lamina/scene/description/scene.h"
#include "lamina/skin/lookup/skin_lookup.h"
#include "lamina/skin/maps/skin_features.h"

namespace lamina {

/// Where on a surface a feature is: around points, less and less up to their radius. No points:
/// everywhere.
struct SurfacePlaces {
  struct Place {
    Vec3f at;  ///< [mm]
    float radius = 10.0f;
  };
  std::vector<Place> places;
  /// In [0, 1].
  [[nodiscard]] float weight(const Vec3f& position) const;
};

/// More of something around some places: a flush, lips, shadows under the eyes.
struct Flush {
  double melanin = 0.0, hemoglobin_epidermis = 0.0, hemoglobin_dermis = 0.0;  ///< added
};

/// A net of vessels, where smooth noise in space passes 0.
struct VesselNet {
  double size = 12.0;        ///< typical width of a mesh of the net [mm]
  double width = 0.8;        ///< of a vessel as it is seen [mm]
  double hemoglobin = 0.03;  ///< of the dermis, added at its middle
  double saturation = 0.45;  ///< of that blood
};

/// Numbers of uniform skin that looks like a texture of albedo: those that `lamina acquire` finds
/// in it (TextureSkin).
struct ColorOfSkin {
  Image image;
  /// Factor on the image. A photograph knows reflectances but for such a factor, and skin does not
  /// get as bright as textures are painted. Absent: by match_exposure, of the colors that the
  /// surface shows.
  std::optional<double> exposure = std::nullopt;
};

/// Ink at a place of the surface.
struct SurfaceTattoo {
  Tattoo ink;         ///< its image, width and absorbance
  Vec3f at;           ///< [mm]
  double turn = 0.0;  ///< [rad], counterclockwise; the image stands upright, +y of the mesh up
};

/// Blood pressed out of a disc at a place of the surface.
struct SurfacePress {
  PressedDisc disc;  ///< its diameter and share
  Vec3f at;          ///< [mm]
};

/// A tube of blood that wanders along the surface, and its branches, which have half as many.
struct SurfaceVein {
  Veins look;      ///< its diameter where it begins (the larger one), levels, depth, blood
  Vec3f from, to;  ///< [mm]
  int branches = 3;
};

/// A feature on a surface.
struct SurfaceFeature {
  std::variant<MelaninSpots, VesselNet, Flush, Unevenness, ColorOfSkin, Synthesis, SurfaceTattoo,
               SurfacePress, SurfaceVein>
      kind;
  SurfacePlaces where;
};

/// Recipe of maps on a mesh by `lamina maps`: images over its texture coordinates.
struct SurfaceMapRecipe {
  int width = 1024, height = 1024;
  std::uint64_t seed = 0;
  std::vector<Mesh> meshes;  ///< one, of one material
  SkinMaps base;             ///< numbers only
  std::vector<SurfaceFeature> features;
};

/// Reads a recipe with "surface"; docs/heterogeneous_skin.md has the format. Absent: the file has
/// none, it is for a flat patch.
/// @throws FileError, InvalidInput
[[nodiscard]] std::optional<SurfaceMapRecipe> load_surface_map_recipe(
    const JsonFile& file, MemoryBudget memory = {}, std::span<const std::string> settings = {});

/// How well a texture of colors is one of skin.
struct ColorMatch {
  double exposure = 1.0;  ///< factor on the colors
  double distance = 0.0;  ///< median over the colors, as of ColorFit
};

/// The exposure, in eighths of a stop from -3 to 1, at which colors are most like skin.
[[nodiscard]] ColorMatch match_exposure(const SkinLookup& lookup,
                                        std::span<const std::array<float, 3>> colors);

/// The maps of the parameters that vary. What lies next to the charts goes on as their borders do.
/// @param matches  of textures of colors without an exposure; null: not asked for
/// @throws InvalidInput for skin that SkinReflectanceTable does not take under a texture of colors;
///         Interrupted if progress asks to stop.
[[nodiscard]] std::vector<SkinMap> make_surface_maps(const SurfaceMapRecipe& recipe,
                                                     const Progress& progress = {},
                                                     std::vector<ColorMatch>* matches = nullptr);

}  // namespace lamina
