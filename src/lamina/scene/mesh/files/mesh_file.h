// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lamina/base/core/memory_budget.h"
#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

struct MeshFileOptions {
  int uv_set = 0;  ///< of glTF: which TEXCOORD_n the texture coordinates are
};

/// Reads a mesh of the format that its name ends in: .obj, .ply, .gltf or .glb. The units are those
/// of the file, indices are as in the file, every index is in range and every number is finite.
///
/// @param memory  what reading may take; what the mesh takes stays taken.
/// @throws FileError naming the file, the place in it, what is required and what was found:
///         missing, cut off, not of its format, an index out of range, a position that is not
///         finite, no faces, more memory than is left.
[[nodiscard]] PolygonMesh load_polygon_mesh(const std::filesystem::path& file, MemoryBudget& memory,
                                            const MeshFileOptions& options = {});
[[nodiscard]] PolygonMesh load_polygon_mesh(const std::filesystem::path& file);

// The same from the bytes of a file; `name` stands for it in messages. OBJ and PLY are read by
// lamina's own code because every number that is not one must be named with its place.

/// Wavefront OBJ: v with or without a color, vt, vn, f, g, o, usemtl and `t crease`; a part is what
/// shares a material, group and object. Colors are taken as sRGB, in [0, 1] or whole in [0, 255].
[[nodiscard]] PolygonMesh parse_obj(std::string_view bytes, const std::string& name,
                                    MemoryBudget memory = {});

/// PLY, ascii or binary: elements `vertex`, `face`, and `edge` with a crease; others are skipped.
/// Colors of integers are taken as sRGB, others as linear, unless they are whole and reach up to
/// 255.
[[nodiscard]] PolygonMesh parse_ply(std::string_view bytes, const std::string& name,
                                    MemoryBudget memory = {});

/// glTF 2.0, as text or as GLB: the triangles of the scene's nodes, at rest. A part is a primitive
/// of a node: its labels are the names of its material, mesh and node; a mesh that several nodes
/// have is there once for each. Materials are read, that of the standard where there is none, and
/// the colors COLOR_0, a factor of the base color. Buffers may be files in the folder of `file` or
/// below it.
[[nodiscard]] PolygonMesh parse_gltf(std::string_view bytes, const std::filesystem::path& file,
                                     MemoryBudget memory = {}, const MeshFileOptions& options = {});

/// The two parts of a glTF file; `binary` is empty unless it is a GLB that has such a part.
struct GltfChunks {
  std::string_view json, binary;
};

/// Reads all that a glTF file holds, as parse_gltf does, also what no node has, for who copies it:
/// compressed meshes and extensions that lamina does not know are passed over.
/// @return its parts, good as long as `bytes`.
/// @throws FileError, InvalidInput
[[nodiscard]] GltfChunks check_gltf(std::string_view bytes, const std::filesystem::path& file,
                                    MemoryBudget memory = {});

}  // namespace lamina
