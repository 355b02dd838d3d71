// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "lamina/core/error.h"
#include "lamina/core/file_bytes.h"

namespace lamina {

PolygonMesh load_polygon_mesh(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".obj") return parse_obj(read_file_bytes(file), file.string());
  if (ending == ".ply") return parse_ply(read_file_bytes(file), file.string());
  if (ending == ".gltf" || ending == ".glb") return parse_gltf(read_file_bytes(file), file);
  throw FileError(file.string() + ": a mesh must be .obj, .ply, .gltf or .glb, but is \"" + ending +
                  "\"");
}

}  // namespace lamina
