// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/files/skin_maps_file.h"

namespace lamina {
namespace {

constexpr double longest = 1e6;  // [mm]

/// The faces of a part of a mesh file, in mm.
Mesh decode_surface(const JsonInput& value) {
  const JsonObject object = value.object({"file", "part", "mm_per_unit", "subdivision"});
  const double scale = object.required("mm_per_unit").number(closed_interval(1e-6, 1e6, "mm"));
  MeshOptions options{.to_world = {.x_axis = {scale, 0, 0},
                                   .y_axis = {0, scale, 0},
                                   .z_axis = {0, 0, scale},
                                   .translation = {}}};
  if (const auto levels = object.optional("subdivision"))
    options.subdivision = static_cast<int>(levels->integer(0, 6));
  const JsonInput file = object.required("file");
  try {
    PolygonMesh all = load_polygon_mesh(file.file_path(), file.memory()), kept = all;
    if (const auto part = object.optional("part")) {
      const std::string name = part->string();
      kept.corners.clear();
      kept.face_begin = {0};
      kept.part.clear();
      for (std::size_t f = 0; f < face_count(all); ++f) {
        const auto& labels = all.parts[all.part[f]].labels;
        if (std::ranges::find(labels, name) != labels.end())
          add_face(kept, face(all, f), all.part[f]);
      }
      if (face_count(kept) == 0) part->fail("the mesh has no part of that name");
    }
    const std::vector<std::uint32_t> materials(all.parts.size(), 0);
    options.memory = file.memory();
    Mesh mesh = make_mesh(std::move(kept), options, materials).mesh;
    if (mesh.uvs.empty()) file.fail("the mesh must have texture coordinates, but has none");
    return mesh;
  } catch (const FileError& error) {
    file.fail(error.what());
  }
}

Vec3f decode_place(const JsonInput& value, double mm_per_unit) {
  const std::vector<double> at =
      value.numbers(3, closed_interval(-longest / mm_per_unit, longest / mm_per_unit));
  return {static_cast<float>(mm_per_unit * at[0]), static_cast<float>(mm_per_unit * at[1]),
          static_cast<float>(mm_per_unit * at[2])};
}

SurfacePlaces decode_places(const JsonInput& value, double mm_per_unit) {
  SurfacePlaces where;
  for (const JsonInput& place : value.array(1, 1000)) {
    const JsonObject object = place.object({"at", "radius", "mirrored"});
    const Vec3f at = decode_place(object.required("at"), mm_per_unit);
    const auto radius =
        static_cast<float>(mm_per_unit * object.required("radius").number(greater_than(0.0)));
    where.places.push_back({at, radius});
    if (const auto mirrored = object.optional("mirrored"); mirrored && mirrored->boolean())
      where.places.push_back({{-at.x, at.y, at.z}, radius});
  }
  return where;
}

VesselNet decode_net(const JsonInput& value) {
  const JsonObject object = value.object({"size", "width", "hemoglobin", "saturation"});
  VesselNet net;
  if (const auto size = object.optional("size"))
    net.size = size->number(closed_interval(0.1, 1e4, "mm"));
  if (const auto width = object.optional("width"))
    net.width = width->number(closed_interval(0.01, 100.0, "mm"));
  if (const auto blood = object.optional("hemoglobin"))
    net.hemoglobin = blood->number(closed_interval(0.0, 1.0));
  if (const auto saturation = object.optional("saturation"))
    net.saturation = saturation->number(closed_interval(0.0, 1.0));
  return net;
}

Flush decode_flush(const JsonInput& value) {
  const JsonObject object = value.object({"melanin", "hemoglobin_epidermis", "hemoglobin_dermis"});
  Flush flush;
  if (const auto melanin = object.optional("melanin"))
    flush.melanin = melanin->number(closed_interval(-0.5, 0.5));
  if (const auto blood = object.optional("hemoglobin_epidermis"))
    flush.hemoglobin_epidermis = blood->number(closed_interval(-0.1, 0.1));
  if (const auto blood = object.optional("hemoglobin_dermis"))
    flush.hemoglobin_dermis = blood->number(closed_interval(-0.1, 0.1));
  return flush;
}

ColorOfSkin decode_color(const JsonInput& value) {
  const JsonObject object = value.object({"image", "encoding", "exposure"});
  const auto encoding = of_colors(object.required("encoding").choice<ColorEncoding>());
  const JsonInput file = object.required("image");
  try {
    const Image image = load_image(file.file_path(), encoding, file.memory());
    require_finite(image, file.file_path());
    ColorOfSkin color{rgb_image(image)};
    if (const auto exposure = object.optional("exposure"))
      color.exposure = exposure->number(closed_interval(0.01, 100.0));
    return color;
  } catch (const FileError& error) {
    file.fail(error.what());
  }
}

SurfaceTattoo decode_surface_tattoo(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object({"image", "at", "width", "absorbance", "ink", "angle"});
  SurfaceTattoo tattoo{.ink = decode_ink(object),
                       .at = decode_place(object.required("at"), mm_per_unit)};
  if (const auto angle = object.optional("angle"))
    tattoo.turn = angle->number(closed_interval(-360.0, 360.0, "deg")) * std::numbers::pi / 180.0;
  return tattoo;
}

SurfacePress decode_press(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object({"at", "diameter", "share", "refill", "hyperemia"});
  return {.disc = decode_disc(object), .at = decode_place(object.required("at"), mm_per_unit)};
}

SurfaceVein decode_vein(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object({"from", "to", "branches", "levels", "diameter", "depth",
                                          "hemoglobin", "saturation", "absorbance"});
  SurfaceVein vein{.look = decode_vein_look(object),
                   .from = decode_place(object.required("from"), mm_per_unit),
                   .to = decode_place(object.required("to"), mm_per_unit)};
  if (const auto branches = object.optional("branches"))
    vein.branches = static_cast<int>(branches->integer(0, 20));
  return vein;
}

SurfaceFeature decode_feature(const JsonInput& value, double mm_per_unit) {
  const JsonObject object =
      value.object({"freckles", "moles", "vessels", "flush", "unevenness", "color", "synthesis",
                    "tattoo", "pressed", "vein", "where"});
  SurfaceFeature feature;
  if (const auto where = object.optional("where"))
    feature.where = decode_places(*where, mm_per_unit);
  if (value.entries().size() != (object.has("where") ? 2u : 1u))
    value.fail("must have exactly one key beside \"where\", the kind of the feature");
  for (const std::string_view kind : {"freckles", "moles"})
    if (const auto spots = object.optional(kind))
      feature.kind = std::get<MelaninSpots>(decode_skin_feature(kind, *spots));
  if (const auto uneven = object.optional("unevenness"))
    feature.kind = std::get<Unevenness>(decode_skin_feature("unevenness", *uneven));
  if (const auto net = object.optional("vessels")) feature.kind = decode_net(*net);
  if (const auto flush = object.optional("flush")) feature.kind = decode_flush(*flush);
  if (const auto color = object.optional("color")) feature.kind = decode_color(*color);
  if (const auto synthesis = object.optional("synthesis"))
    feature.kind = std::get<Synthesis>(decode_skin_feature("synthesis", *synthesis));
  if (const auto tattoo = object.optional("tattoo"))
    feature.kind = decode_surface_tattoo(*tattoo, mm_per_unit);
  if (const auto press = object.optional("pressed"))
    feature.kind = decode_press(*press, mm_per_unit);
  if (const auto vein = object.optional("vein")) feature.kind = decode_vein(*vein, mm_per_unit);
  return feature;
}

}  // namespace

std::optional<SurfaceMapRecipe> load_surface_map_recipe(const JsonFile& file, MemoryBudget memory,
                                                        std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  if (!document.root().peek("surface")) return std::nullopt;
  const JsonObject object = document.root().file_object(
      "maps", 1, {"width", "height", "surface", "seed", "skin", "features"});
  SurfaceMapRecipe recipe;
  recipe.width = static_cast<int>(object.required("width").integer(1, 16384));
  recipe.height = static_cast<int>(object.required("height").integer(1, 16384));
  if (const auto seed = object.optional("seed"))
    recipe.seed = static_cast<std::uint64_t>(seed->integer(0, std::int64_t{1} << 53));
  const JsonInput skin = object.required("skin");
  recipe.base = decode_skin_maps(skin);
  if (first_map(recipe.base)) skin.fail("must have numbers only: the features make maps of them");
  const JsonInput surface = object.required("surface");
  const double mm_per_unit = surface.object({"file", "part", "mm_per_unit", "subdivision"})
                                 .required("mm_per_unit")
                                 .number(closed_interval(1e-6, 1e6, "mm"));
  for (const JsonInput& feature : object.required("features").array()) {
    recipe.features.push_back(decode_feature(feature, mm_per_unit));
    if (const auto* tattoo = std::get_if<SurfaceTattoo>(&recipe.features.back().kind))
      require_ink(tattoo->ink, recipe.base.skin, feature);
  }
  recipe.meshes.push_back(decode_surface(surface));
  return recipe;
}

}  // namespace lamina
