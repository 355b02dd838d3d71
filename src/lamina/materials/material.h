// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "lamina/optics/layer_stack.h"
#include "lamina/spectrum/band_set.h"

namespace lamina {

/// One part of a layer that is mixed by volume, as pigment in epidermis.
/// Coefficients are those of the pure part. Source: [HanrahanKrueger1993] §3.
struct MixturePart {
  double fraction = 0.0;        ///< of the volume, in (0, 1]
  std::vector<double> sigma_a;  ///< [band], [1/mm]
  std::vector<double> sigma_s;  ///< [band], [1/mm]
  std::vector<double> g;        ///< [band]
};

/// A layer as a material file states it, with lengths in mm.
/// Either `mixture` is empty or it replaces the coefficients sigma_a, sigma_s and g.
struct MaterialLayer {
  std::string name;
  std::vector<double> sigma_a;  ///< [band], [1/mm]
  std::vector<double> sigma_s;  ///< [band], [1/mm]
  std::vector<double> g;        ///< [band]
  std::vector<double> ior;      ///< [band]
  double thickness = std::numeric_limits<double>::infinity();  ///< [mm]
  Interface top;
  std::vector<MixturePart> mixture;
};

/// A layered material: what a file with `"lamina": "material"` says, units turned to mm.
struct Material {
  std::string name;
  std::string source;
  BandSet bands = BandSet::rgb();
  std::vector<double> ior_above;  ///< [band]
  std::vector<double> ior_below;  ///< [band]
  Ground ground;
  std::vector<MaterialLayer> layers;
};

/// The optical layers of one band.
/// @throws InvalidInput as LayerStack does.
[[nodiscard]] LayerStack layer_stack(const Material& material, std::size_t band);

/// Reads a material file.
/// @throws FileError if it is missing or unreadable; InvalidInput with file, line and field if what
///         it says is wrong.
[[nodiscard]] Material load_material(const std::filesystem::path& file);

/// Decodes the text of a material file; `name` stands for the file in messages.
[[nodiscard]] Material parse_material(const std::string& text, const std::string& name);

/// A material as the text of a file that load_material reads back to equal numbers.
[[nodiscard]] std::string format_material(const Material& material);

/// The materials that lamina brings, in the order of the list that users see.
[[nodiscard]] const std::vector<Material>& builtin_materials();

/// The built-in material of that name, or else the file of that path.
/// @throws as load_material; an unknown name suggests the nearest one.
[[nodiscard]] Material find_material(const std::string& name_or_path);

}  // namespace lamina
