// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "patch.h"

#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "images.h"
#include "json_files.h"
#include "lamina/skin/patch/files/skin_patch_file.h"
#include "lamina/skin/patch/patch_gradient.h"
#include "lamina/skin/patch/skin_patch.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "natives.h"
#include "skin_numbers.h"
#include "work.h"

namespace lamina::python {
namespace {

/// Skin of arrays, all of the patch's size, and numbers.
SkinPatch skin_patch_of(const py::dict& maps, const py::dict& numbers, const Floats& light,
                        double mm_per_pixel, const std::vector<double>& wavelengths, double theta,
                        const std::string& constants) {
  SkinPatch patch;
  patch.light = plane_image(light);
  patch.width = patch.light.width;
  patch.height = patch.light.height;
  patch.mm_per_texel = mm_per_pixel;
  patch.bands = BandSet(wavelengths);
  patch.theta = theta;
  patch.skin = skin_maps_of(maps, numbers, constants);
  return patch;
}

py::dict result_dict(SkinPatchResult result, const SkinPatch& patch) {
  py::dict out;
  std::vector<double> mean, error;
  for (const SkinPatchBand& band : result.bands) {
    mean.push_back(band.mean_reflectance);
    error.push_back(band.fit_error);
  }
  out["mean_reflectance"] = to_array(std::move(mean));
  out["fit_error"] = to_array(std::move(error));
  out["channels"] = result.image.channels;
  out["pixels"] = image_array(std::move(result.image));
  out["mm_per_pixel"] = patch.mm_per_texel;
  out["warnings"] = patch.warnings;
  const BandSet& bands = patch.material ? patch.material->material.bands : patch.bands;
  out["wavelengths"] = bands.is_rgb()
                           ? py::object(py::none())
                           : py::object(to_array(std::vector<double>(bands.wavelengths().begin(),
                                                                     bands.wavelengths().end())));
  return out;
}

py::dict solve(const SkinPatch& patch, const py::object& callback) {
  Work work(callback);
  return result_dict(work.run([&](const Progress& progress) {
    return render_skin_patch(patch, user_cache(), progress);
  }),
                     patch);
}

/// Planes by band as an array (band, height, width).
py::array_t<float> planes_array(const std::vector<Plane>& planes) {
  std::vector<float> values;
  for (const Plane& plane : planes)
    values.insert(values.end(), plane.values.begin(), plane.values.end());
  return to_array(std::move(values), Shape{static_cast<py::ssize_t>(planes.size()),
                                           planes[0].height, planes[0].width});
}

py::array_t<float> plane_array(Plane plane) {
  return to_array(std::move(plane.values), Shape{plane.height, plane.width});
}

}  // namespace

void bind_patch(py::module_& module) {
  native_class<SkinPatch>(module, "SkinPatch").def_static("made", &skin_patch_of);
  module.def("load_patch", [](const std::string& path, const std::optional<std::string>& text,
                              const std::vector<std::string>& settings) {
    return load_unlocked(json_file(path, text),
                         [&](const JsonFile& file) { return load_skin_patch(file, {}, settings); });
  });
  module.def("solve_patch", &solve);
  native_class<DifferentiableSkinPatch>(module, "DifferentiablePatch")
      .def_static("made",
                  [](const SkinPatch& patch, const py::object& callback) {
                    Work work(callback);
                    return work.run([&](const Progress& progress) {
                      return DifferentiableSkinPatch(patch, user_cache(), progress);
                    });
                  })
      .def_property_readonly(
          "light", [](const DifferentiableSkinPatch& patch) { return planes_array(patch.light()); })
      .def("gradient", [](DifferentiableSkinPatch& patch, const Floats& by_light,
                          const py::object& callback) {
        std::vector<Plane> planes;
        const auto width = static_cast<int>(by_light.shape(2)),
                   height = static_cast<int>(by_light.shape(1));
        const std::size_t texels =
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        for (py::ssize_t b = 0; b < by_light.shape(0); ++b) {
          const float* first = by_light.data() + static_cast<std::size_t>(b) * texels;
          planes.push_back({width, height, std::vector<float>(first, first + texels)});
        }
        Work work(callback);
        PatchGradient found =
            work.run([&](const Progress& progress) { return patch.gradient(planes, progress); });
        py::dict result;
        for (PatchGradient::OfMap& map : found.maps)
          result[map.name.c_str()] = plane_array(std::move(map.values));
        result["light"] = plane_array(std::move(found.light));
        return result;
      });
  module.def("patch_color_weights", [](const SkinPatch& patch) {
    std::vector<double> weights;
    for (const auto& band : make_skin_band_weights(patch.bands, patch.skin.skin))
      weights.insert(weights.end(), band.begin(), band.end());
    return to_array(std::move(weights), with_axis(with_axis({}, patch.bands.size()), 3));
  });
}

}  // namespace lamina::python
