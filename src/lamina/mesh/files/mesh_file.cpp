// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/mesh/files/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "lamina/core/error.h"
#include "lamina/io/file_bytes.h"
#include "lamina/mesh/files/internal/mtl_materials.h"

namespace lamina {

namespace {

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

/// What people may well try, and how they get there.
void refuse_known(const std::string& ending, const std::filesystem::path& file) {
  const bool is_usd =
      ending == ".usd" || ending == ".usda" || ending == ".usdc" || ending == ".usdz";
  if (!is_usd && ending != ".abc" && ending != ".fbx" && ending != ".blend" && ending != ".stl")
    return;
  const std::string what = is_usd               ? "USD"
                           : ending == ".abc"   ? "Alembic"
                           : ending == ".fbx"   ? "FBX"
                           : ending == ".blend" ? "a file of Blender"
                                                : "STL";
  throw FileError(file.string() + ": is " + what +
                  ", which lamina does not read: export it as glTF (.glb), from Blender by File > "
                  "Export > glTF 2.0");
}

/// What the libraries that an OBJ file names say of the materials of its parts. They are often lost
/// on the way, so a missing one is a note.
void read_material_libraries(PolygonMesh& mesh, const std::filesystem::path& file,
                             MemoryBudget& memory) {
  for (const std::string& library : mesh.material_libraries) {
    const std::filesystem::path path = library;
    const bool leads_out = path.is_absolute() || std::ranges::find(path, "..") != path.end();
    if (leads_out || library.find('\0') != std::string::npos) {
      mesh.notes.push_back(file.string() + ": mtllib " + library +
                           " is left out: it must lie in the folder of the OBJ file or below it");
      continue;
    }
    std::string bytes;
    try {
      bytes = read_file_bytes(file.parent_path() / path, memory);
    } catch (const FileError& error) {
      mesh.notes.push_back(std::string(error.what()) + ": its materials are left out");
      continue;
    }
    for (FileMaterial& material : parse_mtl(bytes, (file.parent_path() / path).string()))
      mesh.file_materials.push_back(std::move(material));
  }
  for (MeshPart& part : mesh.parts)
    for (std::uint32_t m = 0; m < mesh.file_materials.size(); ++m)
      if (!part.labels.empty() && part.labels.front() == mesh.file_materials[m].name)
        part.material = m;
}

PolygonMesh parse(const std::filesystem::path& file, MemoryBudget memory,
                  const MeshFileOptions& options) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  refuse_known(ending, file);
  const bool is_gltf = ending == ".gltf" || ending == ".glb";
  if (ending != ".obj" && ending != ".ply" && !is_gltf)
    throw FileError(file.string() + ": a mesh must be .obj, .ply, .gltf or .glb, but is \"" +
                    ending + "\"");
  const std::string bytes = read_file_bytes(file, memory);
  if (is_gltf) return parse_gltf(bytes, file, memory, options);
  PolygonMesh mesh = ending == ".obj" ? parse_obj(bytes, file.string(), memory)
                                      : parse_ply(bytes, file.string(), memory);
  read_material_libraries(mesh, file, memory);
  if (options.uv_set > 0)
    throw FileError(file.string() + ": has no set " + std::to_string(options.uv_set) +
                    " of texture coordinates, but " + (mesh.uvs.empty() ? "none" : "one"));
  return mesh;
}

}  // namespace

PolygonMesh load_polygon_mesh(const std::filesystem::path& file, MemoryBudget& memory,
                              const MeshFileOptions& options) {
  PolygonMesh mesh = parse(file, memory, options);
  take_memory(memory,
              bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.uvs) +
                  bytes_of(mesh.colors) + bytes_of(mesh.corners) + bytes_of(mesh.face_begin) +
                  bytes_of(mesh.part),
              file.string());
  return mesh;
}

PolygonMesh load_polygon_mesh(const std::filesystem::path& file) {
  MemoryBudget memory;
  return load_polygon_mesh(file, memory);
}

}  // namespace lamina
