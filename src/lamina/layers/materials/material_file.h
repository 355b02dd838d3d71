// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/base/spectrum/spectrum_table.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/skin.h"

// What the decoders of a material file share: one for `layers`, one per recipe.

namespace lamina {

/// A material file as a value, as in a scene that holds the whole of it.
/// @throws InvalidInput as parse_material.
/// @param wavelengths  [nm], in place of the bands of the file; empty: those
[[nodiscard]] Material decode_material(const JsonInput& root, const MaterialMaps& maps = {},
                                       std::span<const double> wavelengths = {});

/// The material that an object changes, which has "base", with the object laid over it.
/// @throws InvalidInput if "base" is neither a built-in material nor a file; FileError
[[nodiscard]] JsonDocument material_with_base(const JsonInput& object);

/// Finds a material at these wavelengths [nm] in place of the bands of its file; empty: at those.
/// @param settings  changes, as parse_json takes them
/// @throws as find_material; InvalidInput if the material has arrays of numbers for its own bands.
[[nodiscard]] Material find_sampled_material(const std::string& name_or_path,
                                             std::span<const double> wavelengths,
                                             MemoryBudget memory = {},
                                             std::span<const std::string> settings = {});

}  // namespace lamina

namespace lamina::material_file {

/// Context that the rest of the file gives to its numbers.
struct Context {
  std::size_t bands = 0;              ///< how many numbers stand for a quantity per band
  bool has_own_bands = true;          ///< those of the file, which arrays of numbers are for
  std::string length_unit;            ///< as written: "mm", "cm", "um" or "m"
  double mm_per_unit = 1.0;           ///< the length of that unit
  std::vector<double> wavelengths;    ///< [nm]; empty for RGB, which recipes do not get
  std::vector<std::string> channels;  ///< what images call the bands, as "R" or "540nm"
  MaterialMaps maps;
};

/// Coefficients beyond this [1/mm] and lengths beyond this [mm] are taken for mistakes; so are
/// indices outside [0.1, 10].
inline constexpr double largest_number = 1e9;

/// The array `layers`. @throws InvalidInput
[[nodiscard]] std::vector<MaterialLayer> decode_layers(const JsonInput& layers,
                                                       const Context& context);

/// The recipes: each fills in the layers and adds to the source which curves and constants it took.
/// @throws InvalidInput
void decode_skin(const JsonInput& recipe, const Context& context, Material& material);
void decode_leaf(const JsonInput& recipe, const Context& context, Material& material);
void decode_paint(const JsonInput& recipe, const Context& context, Material& material);
void decode_snow(const JsonInput& recipe, const Context& context, Material& material);

/// A number in [low, high], or the mean of the map that stands for it. Where maps are not for here,
/// the message says so.
[[nodiscard]] double mappable_number(const JsonInput& value, const MappableNumber& number,
                                     const Context& context);

/// Length in the file's unit, turned to mm; low and high are in mm.
[[nodiscard]] double mappable_length(const JsonInput& value, MappableNumber number,
                                     const Context& context);

/// Whether a map stands for a value. @throws InvalidInput if maps are not for here.
[[nodiscard]] bool is_map(const JsonInput& value, const Context& context);

/// Whether an object gives numbers over wavelengths: by a table in a file, a chromophore, a law, or
/// as a sum of these.
[[nodiscard]] bool is_spectral(const JsonInput& value);

/// Decodes coefficients of a spectrum, [band], in 1/mm. @throws InvalidInput naming file and line.
[[nodiscard]] std::vector<double> decode_spectral_coefficients(const JsonInput& value,
                                                               const Context& context);

/// @throws InvalidInput if an array is for the bands of the file, and others are asked for.
void require_own_bands(const JsonInput& value, const Context& context);

/// Numbers without unit, [band]: one, one per band, or a column of a file.
[[nodiscard]] std::vector<double> decode_numbers(const JsonInput& value, const NumberRange& range,
                                                 const Context& context);

/// A column of a file at its own wavelengths, numbers without unit.
[[nodiscard]] SpectrumTable decode_table(const JsonInput& value, const NumberRange& range);

/// A number of a recipe that cannot be a map.
[[nodiscard]] double plain_number(const JsonInput& value, const NumberRange& range);

/// A length of a recipe in [low, high] mm, stated in the file's unit, turned to mm.
[[nodiscard]] double plain_length(const JsonInput& value, double low, double high,
                                  const Context& context);

/// The numbers of a recipe of skin, its inks, and how oily it is.
struct DecodedSkin {
  SkinRecipe recipe;
  double oiliness = 0.0;
};
[[nodiscard]] DecodedSkin decode_skin_recipe(const JsonInput& recipe, const Context& context);

/// @throws InvalidInput if a wavelength lies outside the tables of a recipe [nm].
void require_wavelengths(const JsonInput& recipe, const Context& context, double shortest,
                         double longest);

/// The layers of a recipe from its stacks, [band], all of the same build. Phase functions are
/// Henyey-Greenstein.
[[nodiscard]] std::vector<MaterialLayer> material_layers(std::span<const LayerStack> bands,
                                                         const std::vector<std::string>& names);

/// Adds what a recipe has to say to the source that the file gives.
void add_to_source(Material& material, const std::string& text);

/// A boundary's keys "roughness" and "distribution". @throws InvalidInput
///
/// @param context  of a boundary whose roughness may be a map, that of the lit surface
[[nodiscard]] Interface decode_interface(const JsonObject& object,
                                         const Context* context = nullptr);

/// A refractive index, one number or one per band.
[[nodiscard]] std::vector<double> decode_ior(const JsonInput& value, const Context& context);

}  // namespace lamina::material_file
