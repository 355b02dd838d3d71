// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "lamina/core/error.h"

namespace lamina {

std::string read_bytes(const std::filesystem::path& file) {
  constexpr std::uintmax_t most = std::uintmax_t{4} << 30;  // indices are 32 bits wide
  const auto refuse = [&](const std::string& why) { throw FileError(file.string() + ": " + why); };
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (status.type() == std::filesystem::file_type::not_found) refuse("there is no such file");
  if (std::filesystem::is_directory(status)) refuse("is a folder, but must be a file");
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  const std::unique_ptr<std::FILE, Close> stream(std::fopen(file.c_str(), "rb"));
  if (!stream) refuse(std::string("cannot be read: ") + std::strerror(errno));
  const auto size = std::filesystem::file_size(file, code);
  if (code) refuse("cannot be read: " + code.message());
  if (size > most) refuse("is larger than 4 GiB");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (std::fread(bytes.data(), 1, bytes.size(), stream.get()) != bytes.size())
    refuse("cannot be read to its end");
  return bytes;
}

PolygonMesh load_polygon_mesh(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".obj") return parse_obj(read_bytes(file), file.string());
  if (ending == ".ply") return parse_ply(read_bytes(file), file.string());
  if (ending == ".gltf" || ending == ".glb") return parse_gltf(read_bytes(file), file);
  throw FileError(file.string() + ": a mesh must be .obj, .ply, .gltf or .glb, but is \"" + ending +
                  "\"");
}

}  // namespace lamina
