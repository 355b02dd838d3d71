// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/file_material.h"

namespace lamina {

/// An index that points nowhere.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// One corner of a polygon: indices into the arrays of its PolygonMesh.
struct MeshCorner {
  std::uint32_t position = 0;
  std::uint32_t normal = no_index;
  std::uint32_t uv = no_index;
  std::uint32_t color = no_index;
};

/// An edge between two positions that subdivision keeps sharp, for as many steps as it says.
struct MeshCrease {
  std::uint32_t a = 0, b = 0;  ///< positions
  float sharpness = 0.0f;      ///< [subdivision steps], > 0
};

/// Faces that a scene can give a material of their own.
struct MeshPart {
  /// The names it answers to, the most telling first: material, group, object.
  std::vector<std::string> labels;
  std::optional<std::uint32_t> material = {};  ///< of the file: an index into `file_materials`
};

/// Polygons as files and shapes give them: positions, normals and texture coordinates are indexed
/// apart, so that the surface stays connected across seams of the texture.
struct PolygonMesh {
  std::string name;  ///< the file or shape, for messages
  /// Origin of the positions: 0 unless floats were too coarse for the mesh where it lies.
  Vec3 origin;
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< of corners; may be empty
  std::vector<Vec2f> uvs;      ///< v upward; may be empty
  std::vector<Vec3f> colors;   ///< of corners, linear; may be empty
  std::vector<MeshCorner> corners;
  std::vector<std::uint32_t> face_begin{0};  ///< [face], first corner; one more entry ends the last
  std::vector<std::uint32_t> part;           ///< [face], an index into `parts`
  std::vector<MeshPart> parts;
  std::vector<MeshCrease> creases;
  std::vector<FileMaterial> file_materials;     ///< what the file says of its materials
  std::vector<std::string> material_libraries;  ///< that an OBJ file names
  int uv_sets = 0;                              ///< that the file has, of which `uvs` is one
  std::vector<std::string> notes;               ///< what the reader left out, one line each
};

[[nodiscard]] inline std::size_t face_count(const PolygonMesh& mesh) {
  return mesh.face_begin.size() - 1;
}

[[nodiscard]] inline std::span<const MeshCorner> face(const PolygonMesh& mesh, std::size_t index) {
  return std::span(mesh.corners)
      .subspan(mesh.face_begin[index], mesh.face_begin[index + 1] - mesh.face_begin[index]);
}

/// Appends a face of a part.
void add_face(PolygonMesh& mesh, std::span<const MeshCorner> corners, std::uint32_t part);

/// Twice the vector area of a face: along its normal, counterclockwise seen from its tip.
[[nodiscard]] Vec3 doubled_area(const PolygonMesh& mesh, std::size_t face_index);

/// A linear map and a translation: p -> axes * p + translation.
struct Transform {
  Vec3 x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};  ///< images of the axes
  Vec3 translation;
};

[[nodiscard]] Vec3 transform_point(const Transform& transform, const Vec3& p);

/// The transform that applies `inner` first and `outer` then.
[[nodiscard]] Transform combine_transforms(const Transform& outer, const Transform& inner);

/// Negative if the transform mirrors, 0 if it flattens space.
[[nodiscard]] double determinant(const Transform& transform);

/// Makes positions of numbers in double. Far from the origin of its file, where floats lie more
/// than 1e-6 of the mesh's size apart, they are counted from the middle of its faces.
void set_positions(PolygonMesh& mesh, std::span<const Vec3> positions);

/// Says so if floats lie more than 1e-4 of a mesh's size apart where it lies, so that its shape
/// would be lost without `origin`.
/// @param unit  of its lengths, for the sentence
[[nodiscard]] std::optional<std::string> too_far_from_origin(const PolygonMesh& mesh,
                                                             std::string_view unit);

/// Counts positions [mm] from 0. @throws InvalidInput if the mesh lies too far away for that
void settle_in_world(PolygonMesh& mesh);

/// Moves positions and normals. A mirroring transform also reverses the order of the corners, so
/// that outside stays outside. The determinant must not be 0.
void transform_mesh(const Transform& transform, PolygonMesh& mesh);

/// Takes out corners that repeat the one before, and the faces that this leaves without area.
/// Indices must be unified.
/// @return how many faces went.
std::size_t drop_collapsed_faces(PolygonMesh& mesh);

/// Gives equal positions one index and, at each position, equal texture coordinates one index, and
/// equal colors, so that indices tell how the surface and its texture are connected. Along open
/// edges positions that differ by rounding become equal (join_borders); texture coordinates and
/// normals stay.
/// @return  how many positions became equal to another.
std::size_t unify_indices(PolygonMesh& mesh);

}  // namespace lamina
