// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "lamina/io/nearest_name.h"
#include "lamina/mesh/mesh.h"
#include "lamina/mesh/mesh_file.h"
#include "lamina/mesh/mesh_shapes.h"
#include "lamina/mesh/mesh_subdivision.h"
#include "lamina/scene/internal/scene_file.h"

namespace lamina::scene_file {
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

/// From the units of the file to mm: scale, then rotate, then translate, then mm_per_unit.
Transform decode_transform(const std::optional<JsonInput>& value, double mm_per_unit) {
  Transform result;
  if (value) {
    const JsonObject object = value->object({"scale", "rotate", "translate"});
    if (const auto scale = object.optional("scale")) {
      const std::vector<double> s = scale->number_or_numbers(3, closed_interval(-1e9, 1e9));
      result = {.x_axis = {s[0], 0, 0}, .y_axis = {0, s[1], 0}, .z_axis = {0, 0, s[2]}};
      if (determinant(result) == 0.0) scale->fail("must not be 0 along any axis");
    }
    if (const auto rotate = object.optional("rotate"))
      result = combine_transforms(decode_rotation(*rotate), result);
    if (const auto translate = object.optional("translate"))
      result.translation = decode_vector(*translate, 1.0);
  }
  const Transform to_mm{
      .x_axis = {mm_per_unit, 0, 0}, .y_axis = {0, mm_per_unit, 0}, .z_axis = {0, 0, mm_per_unit}};
  return combine_transforms(to_mm, result);
}

double positive(const JsonObject& object, std::string_view key, double otherwise) {
  const auto value = object.optional(key);
  return value ? value->number({.low = 0.0, .high = 1e9, .includes_low = false}) : otherwise;
}

int tessellation(const JsonObject& object, int otherwise) {
  const auto value = object.optional("tessellation");
  return value ? static_cast<int>(value->integer(1, 1000)) : otherwise;
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
    const JsonObject object = value.object({"shape", "material", "subdivision", "normals",
                                            "transform", "width", "height", "tessellation"});
    return make_rectangle(positive(object, "width", 1.0), positive(object, "height", 1.0),
                          tessellation(object, 1));
  }
  if (shape == Shape::box) {
    const JsonObject object = value.object(
        {"shape", "material", "subdivision", "normals", "transform", "size", "tessellation"});
    Vec3 size{1, 1, 1};
    if (const auto given = object.optional("size")) {
      const auto s = given->number_or_numbers(3, {.low = 0.0, .high = 1e9, .includes_low = false});
      size = {s[0], s[1], s[2]};
    }
    return make_box(size, tessellation(object, 1));
  }
  if (shape == Shape::bust) {
    const JsonObject object = value.object(
        {"shape", "material", "subdivision", "normals", "transform", "height", "tessellation"});
    return make_bust(positive(object, "height", 1.0), tessellation(object, 128));
  }
  const JsonObject object = value.object(
      {"shape", "material", "subdivision", "normals", "transform", "radius", "tessellation"});
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

PolygonMesh decode_polygons(const JsonInput& value) {
  const auto file = value.peek("file"), shape = value.peek("shape");
  if (file && shape) value.fail("must have \"file\" or \"shape\", but has both");
  if (shape) return decode_shape(value);
  (void)value.object(
      {"file", "shape", "material", "parts", "close_holes", "subdivision", "normals", "transform"});
  if (!file) value.fail("must have \"file\" or \"shape\", but has neither");
  return load_for(*file, [&] { return load_polygon_mesh(file->file_path(), file->memory()); });
}

std::uint32_t find_surface(const JsonInput& name, const std::vector<DecodedMaterial>& materials) {
  const std::string wanted = name.string();
  std::vector<std::string_view> names;
  for (const DecodedMaterial& candidate : materials) names.push_back(candidate.material.name);
  const auto found = std::ranges::find(names, wanted);
  if (found == names.end())
    name.fail("there is no material \"" + wanted + "\" in this scene" +
              did_you_mean(wanted, names));
  return static_cast<std::uint32_t>(found - names.begin());
}

/// [part], its material; no_index for parts that are left out.
std::vector<std::uint32_t> decode_parts(const JsonInput& value, const PolygonMesh& polygons,
                                        const std::vector<DecodedMaterial>& materials) {
  std::vector<std::uint32_t> material_of_part(polygons.parts.size(), no_index);
  std::map<std::string, std::uint32_t, std::less<>> by_label;
  if (const auto parts = value.peek("parts")) {
    std::set<std::string_view> labels;
    for (const MeshPart& part : polygons.parts)
      labels.insert(part.labels.begin(), part.labels.end());
    const std::vector<std::string_view> known(labels.begin(), labels.end());
    for (const auto& [label, material] : parts->entries()) {
      if (!labels.contains(label))
        material.fail(polygons.name + " has no part of that name" + did_you_mean(label, known));
      by_label[label] = material.is_null() ? no_index : find_surface(material, materials);
    }
  }
  const auto otherwise = value.peek("material");
  const std::uint32_t rest = otherwise ? find_surface(*otherwise, materials) : no_index;
  for (std::size_t p = 0; p < polygons.parts.size(); ++p) {
    const auto& labels = polygons.parts[p].labels;
    const auto named =
        std::ranges::find_if(labels, [&](const auto& label) { return by_label.contains(label); });
    if (named == labels.end() && !otherwise)
      value.fail("\"material\" is required, but missing: \"parts\" does not name all parts");
    material_of_part[p] = named != labels.end() ? by_label.find(*named)->second : rest;
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
      if (std::ranges::find(polygons.parts[p].labels, label) != polygons.parts[p].labels.end())
        closes[p] = is_found = true;
    if (!is_found) name.fail(polygons.name + " has no part of that name");
  }
  return closes;
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

/// Maps are of no use without texture coordinates.
void check_uvs(const JsonInput& value, const Mesh& mesh,
               const std::vector<DecodedMaterial>& materials) {
  if (!mesh.uvs.empty()) return;
  for (const std::uint32_t used :
       std::set<std::uint32_t>(mesh.material.begin(), mesh.material.end()))
    if (!materials[used].mapped.empty())
      value.fail(mesh.name + " must have texture coordinates, because " + materials[used].mapped +
                 " is an image, but has none");
}

}  // namespace

DecodedMesh decode_mesh(const JsonInput& value, const std::vector<DecodedMaterial>& materials,
                        double mm_per_unit) {
  // What is cheap to check comes before the file.
  MeshOptions options{.to_world = decode_transform(value.peek("transform"), mm_per_unit)};
  if (const auto material = value.peek("material")) (void)find_surface(*material, materials);
  if (const auto levels = value.peek("subdivision"))
    options.subdivision = static_cast<int>(levels->integer(0, most_subdivisions));
  if (const auto normals = value.peek("normals"))
    options.normals = normals->choice<NormalSource>({{"file", NormalSource::file},
                                                     {"smooth", NormalSource::smooth},
                                                     {"flat", NormalSource::flat}});
  PolygonMesh polygons = decode_polygons(value);
  const std::vector<std::uint32_t> material_of_part = decode_parts(value, polygons, materials);
  options.closes = decode_close_holes(value, polygons);
  options.memory = value.memory();
  PreparedMesh prepared = load_for(value, [&] {
    return make_mesh(keep_parts(std::move(polygons), material_of_part), options, material_of_part);
  });
  check_uvs(value, prepared.mesh, materials);
  return {.mesh = std::move(prepared.mesh), .warnings = std::move(prepared.warnings)};
}

}  // namespace lamina::scene_file
