// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lamina/solve/albedo_inversion/subsurface_color.h"

namespace lamina {

/// An image that a material of a mesh file names, as a scene file would: a path relative to the
/// folder of the mesh file, or `NAME.glb#3` for an image inside it.
struct FileTexture {
  std::string map;
  int uv_set = 0;
  std::string encoding;  ///< of colors, where the file says it: one of rgb_encoding_names
  double repeat_u = 1.0, repeat_v = 1.0;  ///< factors of texture coordinates, v upward
  double rotate = 0.0;                    ///< then turned counterclockwise [rad]
  double shift_u = 0.0, shift_v = 0.0;    ///< then moved
  std::string place;                      ///< in the file, for messages: `head.mtl:12`
};

/// A material as mesh files say it: what glTF 2.0 has with its extensions of materials; MTL has
/// some of it. Colors are linear Rec. 709.
struct FileMaterial {
  std::string name;
  std::array<double, 3> base_color{1, 1, 1};
  std::optional<FileTexture> base_color_texture;
  bool has_vertex_colors = false;  ///< a factor of the base color, white where there are none
  double metallic = 0.0;
  double roughness = 1.0;  ///< perceptual: the square root of microfacet alpha
  double ior = 1.5;
  bool has_specular = true;  ///< a dielectric boundary over the base
  std::optional<FileTexture> normal_texture, bump_texture;
  double bump_scale = 1.0;    ///< of the bump texture, in units of the file
  double transmission = 0.0;  ///< through a boundary, as of glass
  double thickness = 0.0;     ///< of a volume; 0: a thin wall
  std::array<double, 3> attenuation_color{1, 1, 1};
  double attenuation_distance = 0.0;  ///< [unit of the file]; 0: the volume is clear
  /// Color of what scatters many times inside a volume, and by whose definition it is one.
  std::optional<std::array<double, 3>> multiscatter_color;
  SubsurfaceColor multiscatter_definition = SubsurfaceColor::khr_scatter;
  double scatter_anisotropy = 0.0;    ///< mean cosine g
  double diffuse_transmission = 0.0;  ///< share of what the base scatters that leaves behind
  std::array<double, 3> diffuse_transmission_color{1, 1, 1};
  double opacity = 1.0;      ///< where the alpha mode is not opaque
  bool has_cutouts = false;  ///< the alpha of the base color's texture is coverage
  std::array<double, 3> emission{0, 0, 0};
  std::vector<std::string> ignored;  ///< what the file says and lamina does not take, by its names
};

}  // namespace lamina
