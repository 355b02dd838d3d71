// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "edit.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "heard.h"
#include "images.h"
#include "json_files.h"
#include "lamina/base/io/json_output.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/maps/edits/editable_skin.h"
#include "lamina/skin/maps/edits/files/editable_skin_file.h"
#include "lamina/skin/maps/edits/skin_edits.h"
#include "lamina/skin/maps/edits/skin_preview.h"
#include "lamina/skin/maps/edits/skin_variations.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/skin_features.h"
#include "lamina/skin/patch/skin_patch.h"
#include "natives.h"
#include "skin_numbers.h"
#include "work.h"

namespace lamina::python {
namespace {

/// Skin of maps, with the file that loads them: a patch where the size of a texel is known, else a
/// material.
EditableSkin editable_skin(SkinMaps maps, double mm_per_texel) {
  EditableSkin result;
  const Image* const first = first_map(maps);
  if (mm_per_texel > 0.0 && first) {
    result.width_mm = first->width * mm_per_texel;
    result.files.push_back({"patch.json",
                            {{"lamina", "patch"},
                             {"version", 1},
                             {"mm_per_pixel", mm_per_texel},
                             {"width", first->width},
                             {"height", first->height}}});
  }
  result.files.push_back(
      {"material.json", {{"lamina", "material"}, {"version", 1}, {"length_unit", "mm"}}});
  result.skin = std::move(maps);
  return result;
}

EditableSkin from_recipe(const std::string& path, const std::optional<std::string>& text,
                         const std::vector<std::string>& settings,
                         const std::optional<std::uint64_t>& seed, const py::object& callback) {
  const JsonFile file = json_file(path, text);
  if (auto on_mesh = load_unlocked(file, [&](const JsonFile& source) {
        return load_surface_map_recipe(source, {}, settings);
      })) {
    if (seed) on_mesh->seed = *seed;
    Work work(callback);
    SkinMaps maps = on_mesh->base;
    maps.maps =
        work.run([&](const Progress& progress) { return make_surface_maps(*on_mesh, progress); });
    return editable_skin(std::move(maps), 0.0);
  }
  SkinMapRecipe recipe = load_unlocked(
      file, [&](const JsonFile& source) { return load_skin_map_recipe(source, {}, settings); });
  if (seed) recipe.seed = *seed;
  Work work(callback);
  SkinMaps maps = recipe.base;
  maps.maps = work.run([&](const Progress& progress) { return make_skin_maps(recipe, progress); });
  return editable_skin(std::move(maps), recipe.mm_per_texel);
}

/// An image of one channel or of several, (height, width) or (height, width, channel).
py::array_t<float> map_array(const Image& map) {
  return map.channel_count() == 1 ? plane_array(map) : image_array(map);
}

py::dict maps_of(const EditableSkin& skin) {
  py::dict maps;
  for (const SkinMap& map : skin.skin.maps) maps[map.name.c_str()] = map_array(map.values);
  return maps;
}

/// @param what  number, amount, size, strength, mask, image, reference: what the kind has
py::tuple edited(const EditableSkin& skin, const std::string& kind, const py::dict& what) {
  SkinEdit edit{.kind = choice<SkinEditKind>(kind)};
  edit.strength = what["strength"].cast<double>();
  if (what.contains("amount")) edit.amount = what["amount"].cast<double>();
  if (what.contains("number")) edit.number = what["number"].cast<std::string>();
  if (what.contains("size")) edit.size = what["size"].cast<double>();
  if (what.contains("mask")) edit.mask = plane_image(what["mask"].cast<Floats>());
  if (what.contains("image")) edit.image = plane_image(what["image"].cast<Floats>());
  if (what.contains("reference")) edit.reference = what["reference"].cast<EditableSkin>();
  EditedSkin found = heard([&] { return edited_skin(skin, edit); });
  py::dict clamped;
  for (const ClampedTexels& each : found.clamped) clamped[each.name.c_str()] = each.count;
  return py::make_tuple(py::cast(std::move(found.skin)), clamped);
}

py::list persons(const EditableSkin& skin, const std::string& population, int count,
                 std::uint64_t seed) {
  py::list result;
  for (const SkinParameters& person : draw_skins(find_skin_population(population), count, seed))
    result.append(py::cast(skin_of_person(skin, person).skin));
  return result;
}

/// A patch of the maps under a pattern of light, of the size of the first map.
SkinPatch edited_patch_of(const EditableSkin& skin, const Floats& light,
                          const std::vector<double>& wavelengths, double theta) {
  SkinPatch patch;
  patch.skin = skin.skin;
  patch.light = plane_image(light);
  patch.width = patch.light.width;
  patch.height = patch.light.height;
  patch.mm_per_texel = skin.width_mm / patch.width;
  patch.bands = BandSet(wavelengths);
  patch.theta = theta;
  return patch;
}

}  // namespace

void bind_edit(py::module_& module) {
  native_class<EditableSkin>(module, "EditableSkin")
      .def_static("made",
                  [](const py::dict& maps, const py::dict& numbers, const std::string& constants,
                     double mm_per_pixel) {
                    return editable_skin(skin_maps_of(maps, numbers, constants), mm_per_pixel);
                  })
      .def_static("load",
                  [](const std::string& path) {
                    const py::gil_scoped_release unlocked;
                    return load_editable_skin(path);
                  })
      .def_static("from_recipe", &from_recipe)
      .def_property_readonly("maps", &maps_of)
      .def_property_readonly("deviations",
                             [](const EditableSkin& skin) {
                               py::dict maps;
                               for (const SkinMapDeviation& map : skin.deviations)
                                 maps[map.name.c_str()] = map_array(map.values);
                               return maps;
                             })
      .def_property_readonly("mask",
                             [](const EditableSkin& skin) -> py::object {
                               if (skin.mask.pixels.empty()) return py::none();
                               return plane_array(skin.mask);
                             })
      .def_property_readonly("numbers",
                             [](const EditableSkin& skin) { return numbers_dict(skin.skin.skin); })
      .def_property_readonly(
          "constants",
          [](const EditableSkin& skin) { return std::string(name_of(skin.skin.constants)); })
      .def_property_readonly("mm_per_pixel",
                             [](const EditableSkin& skin) -> std::optional<double> {
                               const Image* const first = first_map(skin.skin);
                               if (!first || !(skin.width_mm > 0.0)) return std::nullopt;
                               return skin.width_mm / first->width;
                             })
      .def_property_readonly("warnings",
                             [](const EditableSkin& skin) { return skin.skin.warnings; })
      .def("edited", &edited)
      .def("persons", &persons)
      .def("patch", &edited_patch_of)
      .def("preview",
           [](const EditableSkin& skin, int longest_side, const py::object& callback) {
             Work work(callback);
             return image_array(work.run([&](const Progress& progress) {
               return skin_preview(skin, longest_side, user_cache(), progress);
             }));
           })
      .def("save",
           [](const EditableSkin& skin, const std::string& folder, const std::string& edited_from) {
             const py::gil_scoped_release unlocked;
             save_editable_skin(skin, folder, LAMINA_VERSION, edited_from);
           });
  module.def("edit_kinds", [] {
    py::dict kinds;
    for (const auto& each : enum_names<SkinEditKind>) {
      const SkinEditRange range = skin_edit_range(each.value);
      kinds[std::string(each.name).c_str()] =
          py::make_tuple(range.low, range.high, range.size, range.has_number, range.needs_mask);
    }
    return kinds;
  });
}

}  // namespace lamina::python
