// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/files/internal/gltf_data.h"
#include "lamina/scene/mesh/files/internal/gltf_materials.h"
#include "lamina/scene/mesh/files/mesh_file.h"

namespace lamina {
namespace {

constexpr std::size_t most_corners = 100'000'000;

/// A corner of a triangle, with its share of what there is for each face.
constexpr std::size_t per_corner = sizeof(MeshCorner) + sizeof(std::uint32_t);

/// Extensions that say nothing about where the surface is.
bool is_harmless(std::string_view extension) {
  return extension.starts_with("KHR_materials_") || extension.starts_with("KHR_texture_") ||
         extension.starts_with("EXT_texture_") || extension == "KHR_lights_punctual" ||
         extension == "KHR_mesh_quantization";  // whose integers are read as they are
}

std::string name_of(const JsonInput& value) {
  const auto name = value.peek("name");
  return name && name->is_string() ? name->string() : std::string();
}

Vec3 vector_or(const JsonInput& node, std::string_view key, const Vec3& otherwise) {
  const auto given = node.peek(key);
  if (!given) return otherwise;
  const std::vector<double> v = given->numbers(3);
  return {v[0], v[1], v[2]};
}

/// The transform of a node to its parent. Source: [glTF2] §3.5.2.
Transform node_transform(const JsonInput& node) {
  if (const auto matrix = node.peek("matrix")) {
    const std::vector<double> m = matrix->numbers(16);  // column by column
    return {.x_axis = {m[0], m[1], m[2]},
            .y_axis = {m[4], m[5], m[6]},
            .z_axis = {m[8], m[9], m[10]},
            .translation = {m[12], m[13], m[14]}};
  }
  const Vec3 scale = vector_or(node, "scale", {1, 1, 1});
  double x = 0, y = 0, z = 0, w = 1;  // unit quaternion
  if (const auto rotation = node.peek("rotation")) {
    const std::vector<double> q = rotation->numbers(4);
    const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    if (!(norm > 0.0)) rotation->fail("must not be zero");
    x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
  }
  return {
      .x_axis = scale.x * Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
      .y_axis = scale.y * Vec3{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
      .z_axis = scale.z * Vec3{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)},
      .translation = vector_or(node, "translation", {})};
}

/// Vertex indices of triangles, three each. Source: [glTF2] §3.7.2.1.
std::vector<std::uint32_t> triangle_indices(std::span<const std::uint32_t> given,
                                            const JsonInput& primitive) {
  constexpr int triangles = 4, strip = 5;
  const auto mode = primitive.peek("mode");
  const int kind = mode ? static_cast<int>(mode->integer(4, 6)) : triangles;
  if (kind == triangles) {
    if (given.size() % 3 != 0)
      primitive.fail("triangles must have 3 indices each, but there are " +
                     std::to_string(given.size()));
    return {given.begin(), given.end()};
  }
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i + 2 < given.size(); ++i) {
    const std::size_t odd = i % 2;  // a strip turns every other triangle
    if (kind == strip)
      indices.insert(indices.end(), {given[i], given[i + 1 + odd], given[i + 2 - odd]});
    else
      indices.insert(indices.end(), {given[i + 1], given[i + 2], given[0]});
  }
  return indices;
}

/// A primitive as its mesh has it, before any node moves it.
struct Piece {
  PolygonMesh polygons;
  std::vector<std::string> labels;  // of its material and mesh
  std::optional<std::uint32_t> material;
  JsonInput input;
};

class GltfReader {
 public:
  GltfReader(const JsonInput& root, std::string_view binary, const std::filesystem::path& file,
             const MeshFileOptions& options)
      : options_(options),
        root_(root),
        data_(root, binary, file),
        nodes_(gltf_list(root, "nodes")),
        meshes_(gltf_list(root, "meshes")),
        pieces_(meshes_.size()) {
    mesh_.name = file.string();
    mesh_.file_materials = decode_gltf_materials(root, file);
    named_materials_ = mesh_.file_materials.size();
  }

  /// Reads all there is, also what no node has; compressed meshes are passed over.
  void check() {
    passes_over_compressed_ = true;
    check_header();
    for (const JsonInput& node : nodes_) (void)node_transform(node);
    for (const JsonInput& index : gltf_list(root_, "scenes")) (void)index.peek("nodes");
    for (std::size_t m = 0; m < meshes_.size(); ++m) (void)pieces_at(m);
  }

  PolygonMesh read() {
    check_header();
    std::vector<std::pair<JsonInput, Transform>> stack;  // nodes to visit
    for (const JsonInput& node : root_nodes()) stack.emplace_back(node, Transform{});
    std::vector<bool> seen(nodes_.size());
    while (!stack.empty()) {
      const auto [index, outer] = stack.back();
      stack.pop_back();
      const JsonInput& node = gltf_element(nodes_, index);
      const auto place = static_cast<std::size_t>(index.number());
      if (seen[place])
        index.fail("a node must have one parent, but node " + std::to_string(place) +
                   " has several");
      seen[place] = true;
      const Transform to_world = combine_transforms(outer, node_transform(node));
      if (const auto mesh = node.peek("mesh")) add_mesh(*mesh, node, to_world);
      if (const auto children = node.peek("children"))
        for (const JsonInput& child : children->array()) stack.emplace_back(child, to_world);
    }
    if (face_count(mesh_) == 0) throw FileError(mesh_.name + ": holds no triangles");
    set_positions(mesh_, positions_);
    if (options_.uv_set > 0 && options_.uv_set >= mesh_.uv_sets)
      throw FileError(mesh_.name + ": has no set " + std::to_string(options_.uv_set) +
                      " of texture coordinates, but " + std::to_string(mesh_.uv_sets) +
                      " of them, counted from 0");
    return std::move(mesh_);
  }

 private:
  void check_header() const {
    const auto asset = root_.peek("asset");
    const auto version = asset ? asset->peek("version") : std::nullopt;
    if (!version) throw FileError(mesh_.name + ": must be glTF, but has no asset.version");
    if (!version->string().starts_with("2.")) version->refuse("must be 2.0");
    for (const JsonInput& extension : gltf_list(root_, "extensionsRequired")) {
      const std::string name = extension.string();
      if (passes_over_compressed_) continue;
      if (name == "KHR_draco_mesh_compression")
        extension.fail(
            "the mesh is Draco compressed (KHR_draco_mesh_compression), which lamina does not "
            "read; save it without compression");
      if (!is_harmless(name)) extension.fail("lamina does not read the extension " + name);
    }
  }

  /// Values of the file that are indices of nodes.
  std::vector<JsonInput> root_nodes() {
    const std::vector<JsonInput> scenes = gltf_list(root_, "scenes");
    if (scenes.empty()) throw FileError(mesh_.name + ": holds no scene");
    const auto index = root_.peek("scene");
    const JsonInput& scene = index ? gltf_element(scenes, *index) : scenes[0];
    if (scenes.size() > 1)
      mesh_.notes.push_back(scene.where() + ": of " + std::to_string(scenes.size()) +
                            " scenes this one is read");
    const auto nodes = scene.peek("nodes");
    return nodes ? nodes->array() : std::vector<JsonInput>{};
  }

  void add_mesh(const JsonInput& index, const JsonInput& node, const Transform& to_world) {
    if (node.peek("skin"))
      mesh_.notes.push_back(node.where() + ": the mesh is read at rest, without its skeleton");
    const auto extensions = node.peek("extensions");
    if (extensions && extensions->peek("EXT_mesh_gpu_instancing"))
      mesh_.notes.push_back(node.where() +
                            ": its instances (EXT_mesh_gpu_instancing) are left out but for one");
    if (determinant(to_world) == 0.0) {
      mesh_.notes.push_back(node.where() + ": its mesh is left out, for the node flattens it");
      return;
    }
    for (const Piece& piece : pieces_of(index)) append(piece, name_of(node), to_world);
  }

  /// What a mesh is made of, which is read once for all nodes that have it.
  const std::vector<Piece>& pieces_of(const JsonInput& index) {
    (void)gltf_element(meshes_, index);
    return pieces_at(static_cast<std::size_t>(index.number()));
  }

  const std::vector<Piece>& pieces_at(std::size_t place) {
    const JsonInput& mesh = meshes_[place];
    std::optional<std::vector<Piece>>& pieces = pieces_[place];
    if (pieces) return *pieces;
    pieces.emplace();
    const auto primitives = mesh.peek("primitives");
    if (const auto weights = mesh.peek("weights"))
      for (const JsonInput& weight : weights->array())
        if (weight.number() != 0.0) {
          mesh_.notes.push_back(weights->where() +
                                ": morph targets are left out, though not all weights are 0");
          break;
        }
    if (!primitives) mesh.fail("\"primitives\" is required, but missing");
    for (const JsonInput& primitive : primitives->array()) {
      const auto mode = primitive.peek("mode");
      if (mode && mode->integer(0, 6) < 4) {
        mesh_.notes.push_back(primitive.where() + ": points and lines are left out");
        continue;
      }
      if (passes_over_compressed_ && is_compressed(primitive)) continue;
      Piece piece{
          .polygons = read_primitive(primitive), .labels = {}, .material = {}, .input = primitive};
      if (const auto material = primitive.peek("material")) {
        if (named_materials_ == 0) material->fail("is an index into a list that is empty");
        const auto last = static_cast<std::int64_t>(named_materials_) - 1;
        piece.material = static_cast<std::uint32_t>(material->integer(0, last));
        piece.labels.push_back(mesh_.file_materials[*piece.material].name);
      } else {
        if (mesh_.file_materials.size() == named_materials_)
          mesh_.file_materials.push_back(default_gltf_material());
        piece.material = static_cast<std::uint32_t>(named_materials_);
      }
      if (!piece.polygons.colors.empty())
        mesh_.file_materials[*piece.material].has_vertex_colors |=
            std::ranges::any_of(piece.polygons.colors, [](const Vec3f& color) {
              return color != Vec3f{1, 1, 1};
            });
      piece.labels.push_back(name_of(mesh));
      pieces->push_back(std::move(piece));
    }
    return *pieces;
  }

  static bool is_compressed(const JsonInput& primitive) {
    const auto extensions = primitive.peek("extensions");
    return extensions && extensions->peek("KHR_draco_mesh_compression");
  }

  PolygonMesh read_primitive(const JsonInput& primitive) {
    if (is_compressed(primitive))
      primitive.fail(
          "is Draco compressed (KHR_draco_mesh_compression), which lamina does not read; save it "
          "without compression");
    const auto attributes = primitive.peek("attributes");
    const auto position = attributes ? attributes->peek("POSITION") : std::nullopt;
    if (!position) primitive.fail("attribute POSITION is required, but missing");
    const GltfAccessor& positions = data_.accessor(*position, 3);
    const auto optional = [&](std::string_view key, std::size_t components) {
      const auto input = attributes->peek(key);
      const GltfAccessor* accessor = input ? &data_.accessor(*input, components) : nullptr;
      if (accessor && accessor->count() != positions.count())
        input->fail("has not one element for each position");
      return accessor;
    };
    const GltfAccessor* normals = optional("NORMAL", 3);
    const std::string texcoord = "TEXCOORD_" + std::to_string(options_.uv_set);
    const GltfAccessor* uvs = optional(texcoord, 2);
    int sets = 0;
    while (attributes->peek("TEXCOORD_" + std::to_string(sets))) ++sets;
    mesh_.uv_sets = std::max(mesh_.uv_sets, sets);
    const auto color = attributes->peek("COLOR_0");
    const GltfAccessor* colors = color ? &color_accessor(*color, positions.count()) : nullptr;

    const std::vector<std::uint32_t> indices =
        triangle_indices(read_indices(primitive, positions.count()), primitive);
    const std::vector<std::uint32_t> used = used_vertices(indices, positions.count());
    constexpr std::size_t per_vertex = 3 * sizeof(Vec3f) + sizeof(Vec2f);
    take_memory(
        primitive.memory(),
        checked_sum("a primitive", {checked_product("a primitive", {used.size(), per_vertex}),
                                    checked_product("a primitive", {indices.size(), per_corner})}),
        primitive.where());
    PolygonMesh piece;
    piece.positions = read_vectors(positions, used, &*position);
    if (normals) piece.normals = read_vectors(*normals, used, nullptr);
    if (uvs) piece.uvs = read_uvs(*uvs, used, *attributes->peek(texcoord));
    if (colors) piece.colors = read_colors(*colors, used, *color);
    piece.corners.reserve(indices.size());
    const bool are_all = used.size() == positions.count();
    for (const std::uint32_t index : indices) {
      const std::uint32_t i =
          are_all
              ? index
              : static_cast<std::uint32_t>(std::ranges::lower_bound(used, index) - used.begin());
      piece.corners.push_back({.position = i,
                               .normal = normals ? i : no_index,
                               .uv = uvs ? i : no_index,
                               .color = colors ? i : no_index});
    }
    return piece;
  }

  /// Source: [glTF2] §3.7.2.1.
  const GltfAccessor& color_accessor(const JsonInput& input, std::size_t count) {
    const GltfAccessor& colors = data_.accessor(input, 0);
    if (colors.components() != 3 && colors.components() != 4)
      input.fail("must have 3 or 4 components, but has " + std::to_string(colors.components()));
    if (colors.count() != count) input.fail("has not one element for each position");
    if (colors.largest_color() == 0.0)
      input.fail(
          "colors of vertices must be floats, unsigned bytes or unsigned shorts (componentType "
          "5126, 5121 or 5123)");
    if (colors.largest_color() > 1.0 && !colors.is_normalized())
      mesh_.notes.push_back(input.where() +
                            ": its integers must be \"normalized\" to be colors; they are read as "
                            "if they were");
    return colors;
  }

  /// Within [0, 1], as the standard has it.
  std::vector<Vec3f> read_colors(const GltfAccessor& given, std::span<const std::uint32_t> used,
                                 const JsonInput& input) {
    std::vector<Vec3f> colors = read_vectors(given, used, &input);
    const auto largest = static_cast<float>(given.is_normalized() ? 1.0 : given.largest_color());
    for (Vec3f& color : colors)
      for (int c = 0; c < 3; ++c) color[c] = std::clamp(color[c] / largest, 0.0F, 1.0F);
    return colors;
  }

  /// The vertices that a primitive reads, in rising order: all, unless it uses few of many.
  static std::vector<std::uint32_t> used_vertices(const std::vector<std::uint32_t>& indices,
                                                  std::size_t count) {
    std::vector<std::uint32_t> used = indices;
    if (count <= indices.size()) {
      used.resize(count);
      std::iota(used.begin(), used.end(), 0U);
      return used;
    }
    std::ranges::sort(used);
    used.erase(std::ranges::unique(used).begin(), used.end());
    return used;
  }

  /// @param must_be_finite  names them in messages if they must be.
  static std::vector<Vec3f> read_vectors(const GltfAccessor& given,
                                         std::span<const std::uint32_t> used,
                                         const JsonInput* must_be_finite) {
    std::vector<Vec3f> vectors;
    vectors.reserve(used.size());
    for (const std::uint32_t i : used) {
      Vec3f& vector = vectors.emplace_back();
      for (int c = 0; c < 3; ++c) {
        const double value = given(i, static_cast<std::size_t>(c));
        vector[c] = static_cast<float>(value);
        if (must_be_finite && !std::isfinite(vector[c]))
          must_be_finite->fail(
              "vertex " + std::to_string(i) + " of " + std::to_string(given.count()) +
              ": every coordinate must be finite, but one is " + number_text(value));
      }
    }
    return vectors;
  }

  static std::vector<Vec2f> read_uvs(const GltfAccessor& given, std::span<const std::uint32_t> used,
                                     const JsonInput& input) {
    std::vector<Vec2f> uvs;
    uvs.reserve(used.size());
    for (const std::uint32_t i : used) {
      uvs.push_back({static_cast<float>(given(i, 0)),
                     static_cast<float>(1.0 - given(i, 1))});  // glTF counts v downward
      if (!std::isfinite(uvs.back().x) || !std::isfinite(uvs.back().y))
        input.fail("texture coordinate " + std::to_string(i) + " must be finite");
    }
    return uvs;
  }

  /// Those that the primitive gives, or else one after another.
  std::vector<std::uint32_t> read_indices(const JsonInput& primitive, std::size_t count) {
    const auto input = primitive.peek("indices");
    const GltfAccessor* given = input ? &data_.accessor(*input, 1) : nullptr;
    const std::size_t size = given ? given->count() : count;
    // As they are given, as triangles, and as a list of the vertices used.
    take_memory(primitive.memory(), size, (1 + 3 + 3) * sizeof(std::uint32_t), primitive.where());
    std::vector<std::uint32_t> indices(size);
    std::iota(indices.begin(), indices.end(), 0U);
    for (std::size_t i = 0; given && i < size; ++i) {
      const double value = (*given)(i, 0);
      if (!(value >= 0.0 && value < static_cast<double>(count)))
        input->fail("index " + std::to_string(i) + " must be < " + std::to_string(count) +
                    ", but is " + number_text(value));
      indices[i] = static_cast<std::uint32_t>(value);
    }
    return indices;
  }

  void append(const Piece& piece, const std::string& node_name, const Transform& to_world) {
    PolygonMesh moved = piece.polygons;
    if (moved.corners.size() > most_corners - mesh_.corners.size() ||
        moved.positions.size() > most_corners - positions_.size())
      piece.input.fail("the file must not hold more than 100 million corners of triangles");
    std::vector<std::string> labels = piece.labels;
    labels.push_back(node_name);
    std::erase(labels, std::string());
    std::size_t label_bytes = sizeof(MeshPart);
    for (const std::string& label : labels) label_bytes += sizeof label + label.size();
    // Twice, for the room that vectors keep to grow.
    take_memory(piece.input.memory(),
                2 * (moved.corners.size() * per_corner +
                     moved.positions.size() * (sizeof(Vec3) + sizeof(Vec3f)) +
                     (moved.normals.size() + moved.colors.size()) * sizeof(Vec3f) +
                     moved.uvs.size() * sizeof(Vec2f) + label_bytes),
                piece.input.where());
    for (std::uint32_t c = 3; c <= moved.corners.size(); c += 3) moved.face_begin.push_back(c);
    const auto first_position = static_cast<std::uint32_t>(positions_.size());
    for (std::size_t i = 0; i < moved.positions.size(); ++i) {
      const Vec3 p = transform_point(to_world, to_double(moved.positions[i]));
      constexpr double most = std::numeric_limits<float>::max();
      if (!(std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most))
        piece.input.fail("the transform of its node must leave vertex " + std::to_string(i) +
                         " finite, but does not");
      positions_.push_back(p);
    }
    moved.positions.clear();
    transform_mesh(to_world, moved);  // normals and winding
    const auto offset = [](auto& from, auto& to) {
      const auto begin = static_cast<std::uint32_t>(to.size());
      to.insert(to.end(), from.begin(), from.end());
      return begin;
    };
    const std::uint32_t first_normal = offset(moved.normals, mesh_.normals);
    const std::uint32_t first_uv = offset(moved.uvs, mesh_.uvs);
    const std::uint32_t first_color = offset(moved.colors, mesh_.colors);
    for (MeshCorner& corner : moved.corners) {
      corner.position += first_position;
      if (corner.normal != no_index) corner.normal += first_normal;
      if (corner.uv != no_index) corner.uv += first_uv;
      if (corner.color != no_index) corner.color += first_color;
    }
    const auto part = static_cast<std::uint32_t>(mesh_.parts.size());
    mesh_.parts.push_back({.labels = std::move(labels), .material = piece.material});
    for (std::size_t f = 0; f < face_count(moved); ++f) add_face(mesh_, face(moved, f), part);
  }

  MeshFileOptions options_;
  JsonInput root_;
  GltfData data_;
  std::vector<JsonInput> nodes_, meshes_;
  std::vector<std::optional<std::vector<Piece>>> pieces_;  // [mesh], of those that nodes have
  std::size_t named_materials_ = 0;  // of the file; that of primitives without one comes behind
  bool passes_over_compressed_ = false;
  PolygonMesh mesh_;
  std::vector<Vec3> positions_;
};

JsonDocument parse_gltf_json(const GltfChunks& chunks, const std::filesystem::path& file,
                             MemoryBudget& memory) {
  std::string_view text = chunks.json;
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  return parse_json(text, file.string(), memory);
}

}  // namespace

PolygonMesh parse_gltf(std::string_view bytes, const std::filesystem::path& file,
                       MemoryBudget memory, const MeshFileOptions& options) {
  const GltfChunks chunks = split_gltf(bytes, file.string());
  const JsonDocument document = parse_gltf_json(chunks, file, memory);
  return GltfReader(document.root(), chunks.binary, file, options).read();
}

GltfChunks check_gltf(std::string_view bytes, const std::filesystem::path& file,
                      MemoryBudget memory) {
  const GltfChunks chunks = split_gltf(bytes, file.string());
  const JsonDocument document = parse_gltf_json(chunks, file, memory);
  GltfReader(document.root(), chunks.binary, file, {}).check();
  return chunks;
}

}  // namespace lamina
