// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// Message of the error, or "" if there is none.
inline std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Writes numbers as bytes, for files made by tests.
class ByteWriter {
 public:
  explicit ByteWriter(bool big_endian = false) : big_endian_(big_endian) {}

  template <class T>
  ByteWriter& put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof value);
    if (big_endian_) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
    return *this;
  }

  std::string bytes;

 private:
  bool big_endian_;
};

inline std::string obj_text(const PolygonMesh& mesh) {
  std::ostringstream out;
  out.precision(9);
  for (const Vec3f& p : mesh.positions) out << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const Vec2f& t : mesh.uvs) out << "vt " << t.x << ' ' << t.y << '\n';
  for (const Vec3f& n : mesh.normals) out << "vn " << n.x << ' ' << n.y << ' ' << n.z << '\n';
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    out << 'f';
    for (const MeshCorner& c : face(mesh, f)) {
      out << ' ' << c.position + 1;
      if (c.uv != no_index || c.normal != no_index) out << '/';
      if (c.uv != no_index) out << c.uv + 1;
      if (c.normal != no_index) out << '/' << c.normal + 1;
    }
    out << '\n';
  }
  return out.str();
}

/// A PLY file of the positions and faces of a mesh. `format` is as in its header.
inline std::string ply_bytes(const PolygonMesh& mesh, const std::string& format,
                             bool with_confidence = false) {
  std::string bytes = "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
                      std::to_string(mesh.positions.size()) +
                      "\nproperty double x\nproperty float y\nproperty float32 z\n" +
                      (with_confidence ? "property list uchar short confidence\n" : "") +
                      "element face " + std::to_string(face_count(mesh)) +
                      "\nproperty list uchar uint vertex_indices\nend_header\n";
  if (format == "ascii") {
    std::ostringstream out;
    out.precision(9);
    for (const Vec3f& p : mesh.positions)
      out << p.x << ' ' << p.y << ' ' << p.z << (with_confidence ? " 2 7 -7" : "") << '\n';
    for (std::size_t f = 0; f < face_count(mesh); ++f) {
      out << face(mesh, f).size();
      for (const MeshCorner& c : face(mesh, f)) out << ' ' << c.position;
      out << '\n';
    }
    return bytes + out.str();
  }
  ByteWriter out(format == "binary_big_endian");
  for (const Vec3f& p : mesh.positions) {
    out.put(static_cast<double>(p.x)).put(p.y).put(p.z);
    if (with_confidence)
      out.put(std::uint8_t{2}).put(std::int16_t{7}).put(static_cast<std::int16_t>(-7));
  }
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    out.put(static_cast<std::uint8_t>(face(mesh, f).size()));
    for (const MeshCorner& c : face(mesh, f)) out.put(c.position);
  }
  return bytes + out.bytes;
}

/// JSON and a binary chunk as GLB.
inline std::string glb_bytes(std::string json, std::string binary) {
  while (json.size() % 4 != 0) json += ' ';
  while (binary.size() % 4 != 0) binary += '\0';
  ByteWriter out;
  out.bytes = "glTF";
  out.put(std::uint32_t{2}).put(static_cast<std::uint32_t>(28 + json.size() + binary.size()));
  out.put(static_cast<std::uint32_t>(json.size())).bytes += "JSON" + json;
  out.put(static_cast<std::uint32_t>(binary.size())).bytes += std::string("BIN\0", 4) + binary;
  return out.bytes;
}

/// A glTF of two right triangles that form the square [0, 1]² at z = 0, with `replacements` in its
/// text. Interleaved positions and texture coordinates, then 16-bit indices.
struct SquareGltf {
  std::string json = R"({ "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"name": "square", "mesh": 0}],
 "materials": [{"name": "paper"}],
 "meshes": [{"name": "sheet", "primitives": [
   {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
 "accessors": [
   {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
   {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 4, "type": "VEC2"},
   {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
 "bufferViews": [
   {"buffer": 0, "byteOffset": 0, "byteLength": 80, "byteStride": 20},
   {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
 "buffers": [{"byteLength": 92}] })";
  std::string binary = [] {
    ByteWriter out;
    for (const float y : {0.0F, 1.0F})
      for (const float x : {0.0F, 1.0F}) out.put(x).put(y).put(0.0F).put(x).put(1.0F - y);
    for (const int i : {0, 1, 3, 0, 3, 2}) out.put(static_cast<std::uint16_t>(i));
    return out.bytes;
  }();

  SquareGltf& replace(std::string_view from, const std::string& to) {
    const std::size_t at = json.find(from);
    if (at == std::string::npos) throw std::logic_error("the text to replace is not there");
    json.replace(at, from.size(), to);
    return *this;
  }
  [[nodiscard]] std::string glb() const { return glb_bytes(json, binary); }
};

/// A mesh as scenes have it, all parts of one material.
inline PreparedMesh prepared(PolygonMesh mesh, const MeshOptions& options = {}) {
  const std::vector<std::uint32_t> materials(mesh.parts.size());
  return make_mesh(std::move(mesh), options, materials);
}

/// Whether a line has these words.
inline bool says(const std::vector<std::string>& lines, std::string_view words) {
  return std::ranges::any_of(
      lines, [&](const std::string& line) { return line.find(words) != std::string::npos; });
}

}  // namespace lamina
