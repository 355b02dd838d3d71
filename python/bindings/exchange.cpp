// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "exchange.h"

#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "choices.h"
#include "lamina/exchange/export_format.h"
#include "lamina/exchange/material_import.h"
#include "lamina/exchange/medium_fit/homogeneous_fit.h"
#include "lamina/layers/materials/material.h"
#include "work.h"

namespace lamina::python {
namespace {

py::dict misfit_dict(const LightMisfit& misfit) {
  py::dict result;
  result["wanted_total"] = misfit.wanted_total;
  result["obtained_total"] = misfit.obtained_total;
  if (misfit.spread) {
    result["wanted_mean_square_radius"] = misfit.spread->wanted_mean_square_radius;
    result["obtained_mean_square_radius"] = misfit.spread->obtained_mean_square_radius;
    result["profile_rms"] = misfit.spread->profile_rms;
  }
  return result;
}

py::list export_files(const Material& material, const std::vector<std::string>& formats,
                      double mm_per_unit, const std::string& goal, int gaussians,
                      const std::optional<std::string>& channels, const std::optional<double>& g,
                      const std::optional<double>& ior, const std::string& glb, bool scatter,
                      const py::object& callback) {
  std::vector<const ExportFormat*> found;
  for (const std::string& name : formats) found.push_back(&find_export_format(name));
  ExportOptions options{.mm_per_unit = mm_per_unit,
                        .channels = std::nullopt,
                        .g = g,
                        .ior = ior,
                        .goal = choice<FitGoal>(goal),
                        .gaussians = gaussians,
                        .glb = glb,
                        .gltf_scatter = scatter};
  if (channels) options.channels = choice<ExportChannels>(*channels);
  Work work(callback);
  const std::vector<ExportedMaterial> exported = work.run([&](const Progress& progress) {
    options.progress = progress;
    return export_material(material, found, options);
  });
  py::list result;
  for (const ExportedMaterial& one : exported) {
    py::dict files, misfits;
    for (const ExportedFile& file : one.files) files[file.name.c_str()] = py::bytes(file.bytes);
    for (const ChannelMisfit& misfit : one.misfits) {
      py::dict channel;
      channel["reflectance"] = misfit_dict(misfit.reflectance);
      if (misfit.transmittance) channel["transmittance"] = misfit_dict(*misfit.transmittance);
      misfits[misfit.channel.c_str()] = channel;
    }
    result.append(py::make_tuple(files, one.notes, misfits));
  }
  return result;
}

/// The text of a material file.
std::string import_text(const std::string& source, const std::string& blender,
                        const std::array<double, 3>& color, const std::array<double, 3>& radius,
                        double scale, double g, double ior, double roughness, double mm_per_unit,
                        const py::object& callback) {
  const ImportedParameters parameters{.source = choice<ImportSource>(source),
                                      .blender = choice<BlenderRules>(blender),
                                      .color = color,
                                      .radius = radius,
                                      .scale = scale,
                                      .g = g,
                                      .ior = ior,
                                      .roughness = roughness,
                                      .mm_per_unit = mm_per_unit};
  Work work(callback);
  return work.run([&](const Progress& progress) {
    return format_material(import_material(parameters, progress).material);
  });
}

}  // namespace

void bind_exchange(py::module_& module) {
  module.def("export_formats", [] {
    py::list formats;
    for (const ExportFormat& format : export_formats())
      formats.append(py::make_tuple(std::string(format.name), std::string(format.about)));
    return formats;
  });
  module.def("export_files", &export_files);
  module.def("import_text", &import_text);
}

}  // namespace lamina::python
