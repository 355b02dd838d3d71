// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/render/subsurface/spacing_field.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// A small part of a triangle, and a random point on it.
struct SurfaceElement {
  std::uint32_t mesh = 0, triangle = 0;
  float u = 0.0f, v = 0.0f;  ///< of the point: barycentric weights of the second and third vertex
  float area = 0.0f;         ///< [mm²]
};

/// A number of the element among all, which follows from where it lies on its mesh.
[[nodiscard]] std::uint64_t element_key(const SurfaceElement& element);

/// A patch of surface: what lies nearer to its seed than to any other.
struct SurfaceCell {
  Vec3f position;  ///< mean over the patch [mm]
  Vec3f normal;    ///< mean over the patch, unit length
  float area = 0.0f;
  std::uint32_t first = 0, count = 0;  ///< its elements
};

/// The surface of a material, cut into cells of about the same size around blue-noise seeds.
struct SurfaceCells {
  std::vector<SurfaceCell> cells;
  std::vector<SurfaceElement> elements;  ///< those of a cell side by side
  double area = 0.0;                     ///< of all cells [mm²]

  [[nodiscard]] std::span<const SurfaceElement> elements_of(const SurfaceCell& cell) const {
    return std::span(elements).subspan(cell.first, cell.count);
  }
};

/// Area of all triangles of a material [mm²].
[[nodiscard]] double surface_area(const std::vector<Mesh>& meshes, std::uint32_t material);

/// Cuts the surface into elements, takes them in random order as seeds where no other seed is near
/// (a maximal Poisson-disk set), and gives every element to its nearest seed. So areas add up to
/// that of the mesh exactly, and the mean of a cell is where a sum over cells integrates best.
/// Faces whose normals part by more than 60 degrees share no cell.
///
/// @param spacing  square root of a cell's mean area [mm], > 0.
/// @param seed     the same one gives the same cells.
[[nodiscard]] SurfaceCells make_surface_cells(const std::vector<Mesh>& meshes,
                                              std::uint32_t material, float spacing,
                                              std::uint64_t seed);

/// Makes cells of the sizes that a field asks for, a set for each of its levels.
[[nodiscard]] std::vector<SurfaceCells> make_surface_cells(const std::vector<Mesh>& meshes,
                                                           std::uint32_t material,
                                                           const SpacingField& field,
                                                           std::uint64_t seed);

/// Makes the cells of the field's first level alone, such as lie in no part of the surface that is
/// further from what is seen. Those that do not touch the end of the level do not depend on where
/// it ends: fields of the same spacing have them in common, element by element.
[[nodiscard]] SurfaceCells make_surface_cells_of_first_level(const std::vector<Mesh>& meshes,
                                                             std::uint32_t material,
                                                             const SpacingField& field,
                                                             std::uint64_t seed);

/// About how many cells that makes, level by level.
[[nodiscard]] std::vector<double> expected_cells(const std::vector<Mesh>& meshes,
                                                 std::uint32_t material, const SpacingField& field);

}  // namespace lamina
