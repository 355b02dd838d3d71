// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/image/bilinear.h"
#include "lamina/base/image/map_description.h"
#include "lamina/base/io/files_read.h"
#include "lamina/base/io/kept_readings.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/scene/description/file_materials.h"
#include "lamina/scene/description/internal/scene_file.h"
#include "lamina/scene/mesh/files/gltf_image.h"
#include "lamina/scene/mesh/files/materialx_file.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "lamina/scene/mesh/mesh_subdivision.h"

namespace lamina::scene_file {

bool fits_pattern(std::string_view name, std::string_view pattern) {
  std::size_t n = 0, p = 0, star = std::string_view::npos, after = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (star != std::string_view::npos) {  // the star takes one letter more
      p = star + 1;
      n = ++after;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// A turn by an angle [rad] about an axis of unit length, counterclockwise seen from its tip.
Transform rotation(const Vec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](const Vec3& v) {  // Rodrigues' formula
    return c * v + s * cross(axis, v) + (1.0 - c) * dot(axis, v) * axis;
  };
  return {.x_axis = turned({1, 0, 0}), .y_axis = turned({0, 1, 0}), .z_axis = turned({0, 0, 1})};
}

Transform decode_rotation(const JsonInput& value) {
  const NumberRange degrees = closed_interval(-1e6, 1e6, "deg");
  if (value.is_array()) {
    const std::vector<double> turns = value.numbers(3, degrees);
    Transform result;
    for (int a = 0; a < 3; ++a) {
      Vec3 axis;
      axis[a] = 1.0;
      result = combine_transforms(
          rotation(axis, turns[static_cast<std::size_t>(a)] * radians_per_degree), result);
    }
    return result;
  }
  const JsonObject object = value.object({"axis", "degrees"});
  return rotation(decode_direction(object.required("axis")),
                  object.required("degrees").number(degrees) * radians_per_degree);
}

/// Scale, then rotate, then translate.
Transform decode_transform(const JsonInput& value) {
  Transform result;
  const JsonObject object = value.object({"scale", "rotate", "translate"});
  if (const auto scale = object.optional("scale")) {
    const std::vector<double> s = scale->number_or_numbers(3, closed_interval(-1e9, 1e9));
    result = {.x_axis = {s[0], 0, 0}, .y_axis = {0, s[1], 0}, .z_axis = {0, 0, s[2]}};
    if (determinant(result) == 0.0) scale->fail("must not be 0 along any axis");
  }
  if (const auto rotate = object.optional("rotate"))
    result = combine_transforms(decode_rotation(*rotate), result);
  if (const auto translate = object.optional("translate"))
    result.translation = decode_vector(*translate, 1.0);
  return result;
}

/// From the units of the file to mm.
Transform to_mm(const std::optional<JsonInput>& transform, double mm_per_unit) {
  const Transform scaled{
      .x_axis = {mm_per_unit, 0, 0}, .y_axis = {0, mm_per_unit, 0}, .z_axis = {0, 0, mm_per_unit}};
  return combine_transforms(scaled, transform ? decode_transform(*transform) : Transform{});
}

double positive(const JsonObject& object, std::string_view key, double otherwise) {
  const auto value = object.optional(key);
  return value ? value->number({.low = 0.0, .high = 1e9, .includes_low = false}) : otherwise;
}

int tessellation(const JsonObject& object, int otherwise) {
  const auto value = object.optional("tessellation");
  return value ? static_cast<int>(value->integer(1, 1000)) : otherwise;
}

/// A shape with keys of its own and those that all shapes have.
JsonObject shape_object(const JsonInput& value, std::initializer_list<std::string_view> own) {
  std::vector<std::string_view> keys = {"shape",        "material",  "subdivision", "creases",
                                        "displacement", "instances", "normals",     "transform"};
  keys.insert(keys.end(), own);
  return value.object(keys);
}

PolygonMesh decode_shape(const JsonInput& value) {
  enum class Shape { rectangle, disk, sphere, box, bumpy_sphere, bust };
  const auto shape = value.peek("shape")->choice<Shape>({{"rectangle", Shape::rectangle},
                                                         {"disk", Shape::disk},
                                                         {"sphere", Shape::sphere},
                                                         {"box", Shape::box},
                                                         {"bumpy_sphere", Shape::bumpy_sphere},
                                                         {"bust", Shape::bust}});
  if (shape == Shape::rectangle) {
    const JsonObject object = shape_object(value, {"width", "height", "tessellation"});
    return make_rectangle(positive(object, "width", 1.0), positive(object, "height", 1.0),
                          tessellation(object, 1));
  }
  if (shape == Shape::box) {
    const JsonObject object = shape_object(value, {"size", "tessellation"});
    Vec3 size{1, 1, 1};
    if (const auto given = object.optional("size")) {
      const auto s = given->number_or_numbers(3, {.low = 0.0, .high = 1e9, .includes_low = false});
      size = {s[0], s[1], s[2]};
    }
    return make_box(size, tessellation(object, 1));
  }
  if (shape == Shape::bust) {
    const JsonObject object = shape_object(value, {"height", "tessellation"});
    return make_bust(positive(object, "height", 1.0), tessellation(object, 128));
  }
  const JsonObject object = shape_object(value, {"radius", "tessellation"});
  const double radius = positive(object, "radius", 1.0);
  switch (shape) {
    case Shape::disk:
      return make_disk(radius, tessellation(object, 96));
    case Shape::bumpy_sphere:
      return make_bumpy_sphere(radius, tessellation(object, 50));
    default:
      return make_sphere(radius, tessellation(object, 64));
  }
}

int uv_set_of(const JsonInput& value) {
  const auto given = value.peek("uv_set");
  return given ? static_cast<int>(given->integer(0, 1000)) : 0;
}

PolygonMesh decode_polygons(const JsonInput& value) {
  const auto file = value.peek("file"), shape = value.peek("shape");
  if (file && shape) value.fail("must have \"file\" or \"shape\", but has both");
  if (shape) return decode_shape(value);
  (void)value.object({"file", "shape", "material", "parts", "materials_file", "uv_set",
                      "close_holes", "subdivision", "creases", "displacement", "instances",
                      "normals", "transform"});
  if (!file) value.fail("must have \"file\" or \"shape\", but has neither");
  const std::filesystem::path path = file->file_path();
  const int uv_set = uv_set_of(value);
  const auto load = [&] { return load_polygon_mesh(path, file->memory(), {.uv_set = uv_set}); };
  return kept_reading<PolygonMesh>("polygons " + std::to_string(uv_set) + " " + path.string(),
                                   [&] { return load_for(*file, load); });
}

std::uint32_t find_surface(const JsonInput& name, const SceneMaterials& materials) {
  if (name.is_object() || name.is_array())
    name.refuse("must be the name of a material (\"parts\" has one for each part)");
  const std::string wanted = name.string();
  std::vector<std::string_view> names;
  for (std::size_t m = 0; m < materials.listed; ++m)
    names.push_back(materials.list[m].material.name);
  const auto found = std::ranges::find(names, wanted);
  if (found == names.end())
    name.fail("there is no material \"" + wanted + "\" in this scene" +
              did_you_mean(wanted, names));
  return static_cast<std::uint32_t>(found - names.begin());
}

/// Gives parts the materials of a MaterialX file that have one of their names.
void add_materials_file(const JsonInput& file, PolygonMesh& polygons) {
  const std::filesystem::path path = file.file_path();
  if (path.extension() != ".mtlx") file.refuse("must be a MaterialX file (.mtlx)");
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  std::vector<FileMaterial> said =
      load_for(file, [&] { return load_materialx(path, file.memory()); });
  bool is_used = false;
  for (FileMaterial& material : said) {
    // Images lie beside this file, not beside the mesh.
    for (std::optional<FileTexture>* texture :
         {&material.base_color_texture, &material.normal_texture, &material.bump_texture})
      if (*texture) (*texture)->map = (folder / (*texture)->map).string();
    for (MeshPart& part : polygons.parts)
      if (std::ranges::find(part.labels, material.name) != part.labels.end()) {
        part.material = static_cast<std::uint32_t>(polygons.file_materials.size());
        is_used = true;
      }
    polygons.file_materials.push_back(std::move(material));
  }
  if (!is_used)
    file.fail("none of its " + std::to_string(said.size()) +
              " materials has the name of a part of " + polygons.name);
}

bool is_pattern(std::string_view label) {
  return label.find_first_of("*?") != std::string_view::npos;
}

/// Materials by the names of parts and by patterns of them, in the order of the file.
class PartTable {
 public:
  PartTable(const JsonInput& parts, const PolygonMesh& polygons, const SceneMaterials& materials) {
    std::set<std::string_view> labels;
    for (const MeshPart& part : polygons.parts)
      labels.insert(part.labels.begin(), part.labels.end());
    const std::vector<std::string_view> known(labels.begin(), labels.end());
    for (const auto& [label, material] : parts.entries()) {
      const bool is_exact = labels.contains(label);
      const auto fits = [&pattern = label](std::string_view name) {
        return fits_pattern(name, pattern);
      };
      if (!is_exact && is_pattern(label) && std::ranges::none_of(known, fits))
        material.fail(polygons.name + " has no part whose name fits that pattern");
      if (!is_exact && !is_pattern(label))
        material.fail(polygons.name + " has no part of that name" + did_you_mean(label, known));
      const std::uint32_t surface =
          material.is_null() ? no_index : find_surface(material, materials);
      if (is_exact)
        exact_[label] = surface;
      else
        patterns_.emplace_back(label, surface);
    }
  }

  /// no_index if the part is left out; absent if nothing names it.
  [[nodiscard]] std::optional<std::uint32_t> find(const MeshPart& part) const {
    for (const std::string& label : part.labels)
      if (const auto found = exact_.find(label); found != exact_.end()) return found->second;
    for (const auto& [pattern, surface] : patterns_)
      for (const std::string& label : part.labels)
        if (fits_pattern(label, pattern)) return surface;
    return std::nullopt;
  }

 private:
  std::map<std::string, std::uint32_t, std::less<>> exact_;
  std::vector<std::pair<std::string, std::uint32_t>> patterns_;
};

/// Names the line of the mesh file, or of its library, whose texture is not there.
void require_textures(const JsonInput& value, const FileMaterial& said,
                      const std::filesystem::path& folder) {
  for (const auto& texture : {said.base_color_texture, said.normal_texture, said.bump_texture}) {
    if (!texture || texture->place.empty() || gltf_image_name(texture->map)) continue;
    std::error_code ignored;
    note_file(folder / texture->map);  // also where it may come to be
    if (!std::filesystem::exists(folder / texture->map, ignored))
      throw FileError(value.where() + ": " + texture->place +
                      ": must name an image, but there is no " + (folder / texture->map).string());
  }
}

/// The scene material of one of a mesh file: one that the scene lists under its name, or else one
/// made of what the file says, which is decoded once.
std::uint32_t file_surface(const JsonInput& value, const PolygonMesh& polygons, std::uint32_t index,
                           SceneMaterials& materials, Images& images, double mm_per_unit) {
  const FileMaterial& said = polygons.file_materials[index];
  for (std::size_t m = 0; m < materials.listed; ++m)
    if (!said.name.empty() && materials.list[m].material.name == said.name)
      return static_cast<std::uint32_t>(m);
  const int uv_set = uv_set_of(value);
  const std::string key =
      polygons.name + "\n" + std::to_string(index) + "\n" + std::to_string(uv_set);
  if (const auto found = materials.of_files.find(key); found != materials.of_files.end())
    return found->second;
  require_textures(value, said, std::filesystem::path(polygons.name).parent_path());
  const SceneMaterialText text = scene_material_text(said, mm_per_unit, uv_set);
  const std::string name =
      polygons.name + ": " + (said.name.empty() ? std::to_string(index) : said.name);
  DecodedMaterial decoded = load_for(value, [&] {
    const JsonDocument document = parse_json(text.json, polygons.name, value.memory());
    DecodedMaterial result = decode_surface_material(name, document.root(), images);
    result.tiled.clear();  // which would outlive the document; files name no tiles
    return result;
  });
  if (!text.ignored.empty()) {
    std::string list;
    for (const std::string& each : text.ignored) list += (list.empty() ? "" : "; ") + each;
    decoded.warnings.push_back("not taken from the mesh file: " + list);
  }
  const auto place = static_cast<std::uint32_t>(materials.list.size());
  materials.list.push_back(std::move(decoded));
  return materials.of_files[key] = place;
}

std::string quoted_part(const MeshPart& part) {
  return part.labels.empty() ? "without a name" : "\"" + part.labels.front() + "\"";
}

/// [part], its material; no_index for parts that are left out.
std::vector<std::uint32_t> decode_parts(const JsonInput& value, const PolygonMesh& polygons,
                                        SceneMaterials& materials, Images& images,
                                        double mm_per_unit) {
  std::optional<PartTable> table;
  if (const auto parts = value.peek("parts")) table.emplace(*parts, polygons, materials);
  const auto otherwise = value.peek("material");
  std::vector<std::uint32_t> material_of_part;
  for (const MeshPart& part : polygons.parts) {
    const auto named = table ? table->find(part) : std::nullopt;
    if (named)
      material_of_part.push_back(*named);
    else if (otherwise)
      material_of_part.push_back(find_surface(*otherwise, materials));
    else if (part.material)
      material_of_part.push_back(
          file_surface(value, polygons, *part.material, materials, images, mm_per_unit));
    else
      value.fail(polygons.parts.size() == 1 ? std::string("\"material\" is required, but missing")
                                            : "\"material\" is required, but missing: neither "
                                              "\"parts\" nor the file has one for part " +
                                                  quoted_part(part));
  }
  return material_of_part;
}

/// Whether the holes of each part are closed: of all parts, of those that a list names, or none.
std::vector<bool> decode_close_holes(const JsonInput& value, const PolygonMesh& polygons) {
  const auto given = value.peek("close_holes");
  if (!given) return {};
  if (!given->is_array())
    return std::vector<bool>(given->boolean() ? polygons.parts.size() : 0, true);
  std::vector<bool> closes(polygons.parts.size(), false);
  for (const JsonInput& name : given->array()) {
    const std::string label = name.string();
    bool is_found = false;
    for (std::size_t p = 0; p < polygons.parts.size(); ++p)
      if (std::ranges::any_of(polygons.parts[p].labels, [&](const std::string& known) {
            return known == label || (is_pattern(label) && fits_pattern(known, label));
          }))
        closes[p] = is_found = true;
    if (!is_found) name.fail(polygons.name + " has no part of that name");
  }
  return closes;
}

CreaseOptions decode_creases(const JsonInput& value, int subdivision) {
  const JsonObject object = value.object({"angle", "sharpness"});
  CreaseOptions creases;
  creases.angle = object.required("angle").number(
                      {.low = 0.0, .high = 180.0, .includes_low = false, .unit = "deg"}) *
                  radians_per_degree;
  if (const auto sharpness = object.optional("sharpness"))
    creases.sharpness =
        static_cast<float>(sharpness->number({.low = 0.0, .high = 10.0, .includes_low = false}));
  if (subdivision == 0) value.fail("is for \"subdivision\" only, which is 0");
  return creases;
}

[[noreturn]] void refuse_missing_tile(const JsonInput& file, Vec2f middle) {
  if (!(middle.x >= 0.0F && middle.x < 10.0F && middle.y >= 0.0F && middle.y < 100.0F))
    file.fail("a face has texture coordinates beyond the tiles that <UDIM> can count, near " +
              number_text(middle.x) + ", " + number_text(middle.y));
  const std::size_t index =
      10 * static_cast<std::size_t>(middle.y) + static_cast<std::size_t>(middle.x);
  file.fail("the tile " + tile_path(file, index).string() +
            " is missing, though faces have texture coordinates in it");
}

/// An image as heights: scale * (value - mid).
Displacement decode_displacement(const JsonInput& value, Images& images) {
  const JsonObject object =
      value.object({"map", "channel", "encoding", "repeat", "rotate", "shift", "scale", "mid"});
  const JsonInput file = object.required("map");
  const MapDescription map{.self = value,
                           .file = file,
                           .noise = {},
                           .value = {},
                           .channel = object.optional("channel"),
                           .encoding = object.optional("encoding"),
                           .repeat = object.optional("repeat"),
                           .rotate = object.optional("rotate"),
                           .shift = object.optional("shift")};
  const auto scale =
      static_cast<float>(object.required("scale").number(closed_interval(-1e6, 1e6, "mm")));
  const auto mid = static_cast<float>(object.required("mid").number(closed_interval(-1e6, 1e6)));
  const ColorEncoding encoding = encoding_of(map, false);
  ImageMap source{.placement = placement_of(map)};
  if (is_tiled(file)) {
    refuse_placement(map, "must be left out, for the tiles of <UDIM> do not repeat");
    source.tiles = images.load_tiles(file, encoding, map.channel, false);
    source.image = images_of(source).front();
  } else {
    source.image = map.channel ? images.load_channel(file, encoding, *map.channel)
                               : images.load(file, encoding);
  }
  return [source, scale, mid, file, &images](Vec2f uv, Vec2f middle) {
    Vec2f at = place_uv(source.placement, uv);
    std::size_t index = source.image;
    const bool is_tile = !source.tiles.empty();
    if (is_tile) {
      const auto tile = tile_at(source, middle);
      if (!tile) refuse_missing_tile(file, middle);
      index = *tile;
      at = {std::clamp(uv.x - std::floor(middle.x), 0.0F, 1.0F),
            std::clamp(uv.y - std::floor(middle.y), 0.0F, 1.0F)};
    }
    const Image& image = images[index];
    const bool is_color = channel_index(image, "R") && image.channel_count() >= 3;
    const auto value_at = [&](int x, int y) {
      const float* texel = image.at(x, y);
      return is_color
                 ? luminance({texel[*channel_index(image, "R")], texel[*channel_index(image, "G")],
                              texel[*channel_index(image, "B")]})
                 : texel[0];
    };
    const float x = at.x * static_cast<float>(image.width);
    const float y = (1.0F - at.y) * static_cast<float>(image.height);
    const float found =
        is_tile ? bilinear_clamped(x, y, image.width, image.height).interpolate(value_at)
                : bilinear_repeated(x, y, image.width, image.height).interpolate(value_at);
    return scale * (found - mid);
  };
}

/// The placements of a mesh: none, or at least one.
std::vector<Transform> decode_instances(const JsonInput& value, double mm_per_unit) {
  std::vector<Transform> result;
  for (const JsonInput& instance : value.array(1, 1'000'000)) {
    Transform placed = decode_transform(instance);
    placed.translation = mm_per_unit * placed.translation;
    result.push_back(placed);
  }
  return result;
}

/// A copy of a mesh at another place.
Mesh placed_copy(const Mesh& mesh, const Transform& transform, const std::string& name) {
  Mesh copy = mesh;
  copy.name = name;
  PolygonMesh moved;  // for its positions and normals
  moved.name = name;
  moved.positions = std::move(copy.positions);
  moved.normals = std::move(copy.normals);
  transform_mesh(transform, moved);
  settle_in_world(moved);
  copy.positions = std::move(moved.positions);
  copy.normals = std::move(moved.normals);
  if (determinant(transform) < 0.0)
    for (auto& triangle : copy.triangles) std::swap(triangle[1], triangle[2]);
  for (OpenPart& part : copy.open_parts)
    part.place = to_float(transform_point(transform, to_double(part.place)));
  return copy;
}

std::size_t bytes_of(const Mesh& mesh) {
  return (mesh.positions.size() + mesh.normals.size() + mesh.colors.size()) * sizeof(Vec3f) +
         mesh.uvs.size() * sizeof(Vec2f) +
         mesh.triangles.size() * (sizeof mesh.triangles[0] + sizeof mesh.material[0]);
}

/// Takes out the faces of parts without a material.
PolygonMesh keep_parts(PolygonMesh polygons, const std::vector<std::uint32_t>& material_of_part) {
  if (std::ranges::find(material_of_part, no_index) == material_of_part.end()) return polygons;
  PolygonMesh kept = polygons;
  kept.corners.clear();
  kept.face_begin = {0};
  kept.part.clear();
  for (std::size_t f = 0; f < face_count(polygons); ++f)
    if (material_of_part[polygons.part[f]] != no_index)
      add_face(kept, face(polygons, f), polygons.part[f]);
  return kept;
}

/// Key of a mesh without displacement: all that its vertices and triangles follow from.
std::string key_of(const PolygonMesh& polygons, const MeshOptions& options,
                   const std::vector<std::uint32_t>& material_of_part) {
  Hash hash;
  const auto add = [&](const auto& values) {
    hash.add_bytes(std::as_bytes(std::span(values)));
  };
  add(std::span(&polygons.origin, 1));
  add(polygons.positions);
  add(polygons.normals);
  add(polygons.uvs);
  add(polygons.colors);
  add(polygons.corners);
  add(polygons.face_begin);
  add(polygons.part);
  add(polygons.creases);
  for (const MeshPart& part : polygons.parts) {
    hash.add(part.labels.size());
    for (const std::string& label : part.labels) hash.add_text(label);
  }
  for (const std::string& note : polygons.notes) hash.add_text(note);
  add(std::span(&options.to_world, 1));
  hash.add(options.subdivision);
  hash.add(options.normals);
  hash.add(options.creases.angle);
  hash.add(options.creases.sharpness);
  for (const bool closes : options.closes) hash.add(closes);
  hash.add(material_of_part);
  return "mesh " + std::to_string(hash.value()) + " " + polygons.name;
}

/// Maps are of no use without texture coordinates.
void check_uvs(const JsonInput& value, const Mesh& mesh,
               const std::vector<DecodedMaterial>& materials) {
  for (const std::uint32_t used :
       std::set<std::uint32_t>(mesh.material.begin(), mesh.material.end())) {
    if (mesh.uvs.empty() && !materials[used].mapped.empty())
      value.fail(mesh.name + " must have texture coordinates, because " + materials[used].mapped +
                 " is an image, but has none");
    if (mesh.colors.empty() && !materials[used].vertex_colored.empty())
      value.fail(mesh.name + " must have colors of its vertices, because " +
                 materials[used].vertex_colored + " is \"vertex_colors\", but has none");
  }
}

/// Tiles must be there wherever a triangle is.
void check_tiles(const Mesh& mesh, const std::vector<DecodedMaterial>& materials) {
  if (mesh.uvs.empty()) return;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const TiledTexture& texture : materials[mesh.material[t]].tiled) {
      const auto [a, b, c] = mesh.triangles[t];
      const Vec2f middle = (1.0F / 3.0F) * (mesh.uvs[a] + mesh.uvs[b] + mesh.uvs[c]);
      if (!tile_at(texture.map, middle)) refuse_missing_tile(texture.file, middle);
    }
}

}  // namespace

DecodedMesh decode_mesh(const JsonInput& value, SceneMaterials& materials, Images& images,
                        double mm_per_unit) {
  // What is cheap to check comes before the file.
  MeshOptions options{.to_world = to_mm(value.peek("transform"), mm_per_unit)};
  if (const auto material = value.peek("material")) (void)find_surface(*material, materials);
  if (const auto levels = value.peek("subdivision"))
    options.subdivision = static_cast<int>(levels->integer(0, most_subdivisions));
  if (const auto creases = value.peek("creases"))
    options.creases = decode_creases(*creases, options.subdivision);
  if (const auto normals = value.peek("normals"))
    options.normals = normals->choice<NormalSource>({{"file", NormalSource::file},
                                                     {"smooth", NormalSource::smooth},
                                                     {"flat", NormalSource::flat}});
  std::vector<Transform> instances;
  if (const auto given = value.peek("instances")) instances = decode_instances(*given, mm_per_unit);
  PolygonMesh polygons = decode_polygons(value);
  if (const auto materials_file = value.peek("materials_file"))
    add_materials_file(*materials_file, polygons);
  const std::vector<std::uint32_t> material_of_part =
      decode_parts(value, polygons, materials, images, mm_per_unit);
  options.closes = decode_close_holes(value, polygons);
  if (const auto displacement = value.peek("displacement"))
    options.displacement = decode_displacement(*displacement, images);
  options.memory = value.memory();
  const auto make = [&] {
    return load_for(value, [&] {
      return make_mesh(keep_parts(std::move(polygons), material_of_part), options,
                       material_of_part);
    });
  };
  PreparedMesh prepared =
      are_readings_kept() && !options.displacement
          ? kept_reading<PreparedMesh>(key_of(polygons, options, material_of_part), make)
          : make();
  check_uvs(value, prepared.mesh, materials.list);
  check_tiles(prepared.mesh, materials.list);
  DecodedMesh result{.meshes = {}, .warnings = std::move(prepared.warnings)};
  if (instances.empty()) {
    result.meshes.push_back(std::move(prepared.mesh));
    return result;
  }
  load_for(value, [&] {
    take_memory(value.memory(), instances.size(), bytes_of(prepared.mesh),
                std::to_string(instances.size()) + " instances of " + prepared.mesh.name);
  });
  for (std::size_t i = 0; i < instances.size(); ++i)
    result.meshes.push_back(placed_copy(prepared.mesh, instances[i],
                                        prepared.mesh.name + " #" + std::to_string(i + 1)));
  return result;
}

}  // namespace lamina::scene_file
