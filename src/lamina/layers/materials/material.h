// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/spectrum/band_set.h"
#include "lamina/layers/materials/leaf.h"
#include "lamina/layers/materials/mappable_number.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// How particles scatter, as material files name it.
enum class ParticlePhase {
  henyey_greenstein,  ///< with the mean cosine g
  rayleigh            ///< particles much smaller than the wavelength; g is 0
};

template <>
inline constexpr auto enum_names<ParticlePhase> =
    std::to_array<EnumName<ParticlePhase>>({{"henyey_greenstein", ParticlePhase::henyey_greenstein},
                                            {"rayleigh", ParticlePhase::rayleigh}});

/// One part of a layer that is mixed by volume, as pigment in epidermis.
/// Coefficients are those of the pure part. Source: [HanrahanKrueger1993] §3.
struct MixturePart {
  std::string name;
  double fraction = 0.0;        ///< of the layer's volume, in [0, 1]
  std::vector<double> sigma_a;  ///< [band], [1/mm], >= 0
  std::vector<double> sigma_s;  ///< [band], [1/mm], >= 0
  std::vector<double> g;        ///< [band], in (-1, 1)
  ParticlePhase phase = ParticlePhase::henyey_greenstein;
  friend bool operator==(const MixturePart&, const MixturePart&) = default;
};

/// A layer as a material file states it, with lengths in mm.
/// With a mixture, sigma_a, sigma_s and g are those of what fills the rest of the volume, or empty
/// if the fractions of the parts sum to 1.
struct MaterialLayer {
  std::string name;
  std::vector<double> sigma_a;  ///< [band], [1/mm], >= 0
  std::vector<double> sigma_s;  ///< [band], [1/mm], >= 0
  std::vector<double> g;        ///< [band], in (-1, 1)
  ParticlePhase phase = ParticlePhase::henyey_greenstein;
  std::vector<double> ior;                                     ///< [band], > 0
  double thickness = std::numeric_limits<double>::infinity();  ///< [mm]
  Interface top;
  std::vector<MixturePart> mixture;
  friend bool operator==(const MaterialLayer&, const MaterialLayer&) = default;
};

/// How far the fractions of a mixture without a rest may be from a sum of 1.
inline constexpr double mixture_tolerance = 1e-6;

/// A layered material: what a file with `"lamina": "material"` says, units turned to mm.
struct Material {
  std::string name;
  std::string source;  ///< where its numbers come from
  BandSet bands = BandSet::rgb();
  std::vector<double> ior_above;  ///< [band]
  std::vector<double> ior_below;  ///< [band]; of the last layer if that is infinite
  Ground ground;
  std::vector<MaterialLayer> layers;
  double oiliness = 0.0;  ///< strength of an oily coat for the renderer, in [0, 1]; solvers of
                          ///< layers do not see it
  /// Microfacet alpha of what the lit surface mirrors in renders, in [0, 1]; absent: that of the
  /// first layer's top, which is what all else sees.
  std::optional<double> specular_roughness;
  /// Recipes `skin` and `leaf`, if the material has one. Where parameters are maps, these and the
  /// layers have their means.
  std::optional<SkinRecipe> skin;
  std::optional<LeafParameters> leaf;
  bool is_by_diffusion = false;  ///< coefficients were found from a color by diffusion, so that
                                 ///< profiles by diffusion show that color
};

/// The lit surface as renders mirror in it: the first layer's top with the specular roughness.
[[nodiscard]] inline Interface specular_top(const Material& material) {
  Interface top = material.layers.front().top;
  top.roughness = material.specular_roughness.value_or(top.roughness);
  return top;
}

/// The optical layers of one band.
///
/// A mixture adds up by volume fractions w: sigma_a = sum w sigma_a, sigma_s = sum w sigma_s, and
/// its phase function is the mean of the parts' weighted with w sigma_s. Source:
/// [HanrahanKrueger1993] §3. Holds where the parts are many and small against the mean free path,
/// and where each scatters as if alone.
///
/// @param band  less than material.bands.size().
/// @throws InvalidInput as LayerStack does, or if a vector has not a number for the band.
[[nodiscard]] LayerStack layer_stack(const Material& material, std::size_t band);

/// Layer stacks of all bands, [band].
[[nodiscard]] std::vector<LayerStack> layer_stacks(const Material& material);

/// The layers of a recipe of skin at some wavelengths [nm].
/// @throws InvalidInput as skin_layer_stack.
[[nodiscard]] std::vector<MaterialLayer> skin_layers(const SkinParameters& skin,
                                                     std::span<const double> wavelengths);

/// Reads a material file; docs/materials.md has the format.
/// @param memory  what reading it may take
/// @param maps    takes numbers that are maps; empty: they are refused
/// @throws FileError if it is missing or unreadable; InvalidInput with file, line and field if what
///         it says is wrong.
[[nodiscard]] Material load_material(const std::filesystem::path& file);
[[nodiscard]] Material load_material(const std::filesystem::path& file, MemoryBudget& memory,
                                     const MaterialMaps& maps = {});

/// Decodes the text of a material file; `name` stands for the file in messages.
[[nodiscard]] Material parse_material(const std::string& text, const std::string& name);

/// One layer without end below vacuum, of a medium per channel; it has no name yet.
[[nodiscard]] Material half_space_material(std::span<const Medium> channels, const Interface& top);

/// A material as the text of a file that load_material reads back to equal numbers.
[[nodiscard]] std::string format_material(const Material& material);

/// The materials that lamina brings, in the order of the list that users see. Their names are
/// those that find_material knows them by.
[[nodiscard]] const std::vector<Material>& builtin_materials();

/// The text of a built-in material's file, with comments that say where each number comes from.
/// @throws InvalidInput if there is no such material; suggests the nearest name.
[[nodiscard]] std::string builtin_material_text(const std::string& name);

/// The built-in material of that name, or else the file of that path. A file that is called as a
/// built-in material is found by a path with a folder, as in ./jade.
/// @throws as load_material; an unknown name suggests the nearest one.
[[nodiscard]] Material find_material(const std::string& name_or_path, MemoryBudget memory = {});

}  // namespace lamina
