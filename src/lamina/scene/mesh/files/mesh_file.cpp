// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>
#include <set>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/scene/mesh/files/internal/mtl_materials.h"

namespace lamina {

namespace {

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
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

bool is_there(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored);
}

/// The files that the rest of a line `mtllib` names: one, whose name may have blanks, if there is
/// such a file; else several, each up to a word that ends in .mtl.
std::vector<std::string> library_names(const std::string& line,
                                       const std::filesystem::path& folder) {
  if (line.find('\0') != std::string::npos || is_there(folder / line)) return {line};
  std::vector<std::string> names;
  std::string name;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    name += line.substr(at, end - at);
    if (lower_case(std::filesystem::path(name).extension().string()) == ".mtl" ||
        is_there(folder / name)) {
      names.push_back(name);
      name.clear();
      at = std::min(line.find_first_not_of(" \t", end), line.size());
    } else {
      at = std::min(line.find_first_not_of(" \t", end), line.size());
      name += line.substr(end, at - end);
    }
  }
  if (!name.empty()) names.push_back(name);
  return names;
}

/// Where a library lies that may come of another computer: beside the OBJ file or below it, by its
/// last name if its path is absolute or leads out. Absent, with a note, if it is not there.
std::optional<std::filesystem::path> find_library(std::string name,
                                                  const std::filesystem::path& file,
                                                  std::vector<std::string>& notes) {
  const auto left_out = [&](const std::string& why) {
    notes.push_back(file.string() + ": mtllib " + name + " is left out: " + why);
    return std::nullopt;
  };
  if (name.find('\0') != std::string::npos) return left_out("it is no name of a file");
  if (!is_there(file.parent_path() / name)) std::ranges::replace(name, '\\', '/');
  std::filesystem::path path = name;
  const bool has_drive = name.size() > 1 && name[1] == ':';
  if (!has_drive && !path.is_absolute() && std::ranges::find(path, "..") == path.end()) return path;
  if (path.filename().empty() || !is_there(file.parent_path() / path.filename()))
    return left_out("it must lie in the folder of the OBJ file or below it");
  notes.push_back(file.string() + ": mtllib " + name +
                  " lies elsewhere: " + path.filename().string() + " beside the OBJ file is taken");
  return path.filename();
}

/// What the libraries that an OBJ file names say of the materials of its parts. They are often lost
/// on the way, so a missing one is a note.
void read_material_libraries(PolygonMesh& mesh, const std::filesystem::path& file,
                             MemoryBudget& memory) {
  std::set<std::filesystem::path> read;
  for (const std::string& line : mesh.material_libraries)
    for (const std::string& name : library_names(line, file.parent_path())) {
      const auto path = find_library(name, file, mesh.notes);
      if (!path || !read.insert(*path).second || read.size() > 100) continue;
      std::string bytes;
      try {
        bytes = read_file_bytes(file.parent_path() / *path, memory);
      } catch (const FileError& error) {
        mesh.notes.push_back(std::string(error.what()) + ": its materials are left out");
        continue;
      }
      MtlFile library = parse_mtl(bytes, file.parent_path() / *path, path->parent_path());
      std::ranges::move(library.materials, std::back_inserter(mesh.file_materials));
      std::ranges::move(library.notes, std::back_inserter(mesh.notes));
    }
  for (MeshPart& part : mesh.parts)
    for (std::uint32_t m = 0; m < mesh.file_materials.size(); ++m)
      if (!part.labels.empty() && part.labels.front() == mesh.file_materials[m].name)
        part.material = m;
}

PolygonMesh parse(const std::filesystem::path& file, MemoryBudget memory,
                  const MeshFileOptions& options) {
  const std::string ending = lower_case(file.extension().string());
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
