// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/mesh/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "lamina/core/error.h"
#include "lamina/io/file_bytes.h"

namespace lamina {

namespace {

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

PolygonMesh parse(const std::filesystem::path& file, MemoryBudget memory) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_gltf = ending == ".gltf" || ending == ".glb";
  if (ending != ".obj" && ending != ".ply" && !is_gltf)
    throw FileError(file.string() + ": a mesh must be .obj, .ply, .gltf or .glb, but is \"" +
                    ending + "\"");
  const std::string bytes = read_file_bytes(file, memory);
  if (is_gltf) return parse_gltf(bytes, file, memory);
  return ending == ".obj" ? parse_obj(bytes, file.string(), memory)
                          : parse_ply(bytes, file.string(), memory);
}

}  // namespace

PolygonMesh load_polygon_mesh(const std::filesystem::path& file, MemoryBudget& memory) {
  PolygonMesh mesh = parse(file, memory);
  take_memory(memory,
              bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.uvs) +
                  bytes_of(mesh.corners) + bytes_of(mesh.face_begin) + bytes_of(mesh.part),
              file.string());
  return mesh;
}

PolygonMesh load_polygon_mesh(const std::filesystem::path& file) {
  MemoryBudget memory;
  return load_polygon_mesh(file, memory);
}

}  // namespace lamina
