// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "render.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "images.h"
#include "json_files.h"
#include "lamina/base/image/denoise.h"
#include "lamina/render/light_layers.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/method_settings.h"
#include "lamina/scene/description/plausible_size.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "work.h"

namespace lamina::python {
namespace {

/// What a caller asks for in place of the scene; another method leaves out what it does not honour.
void apply(const py::dict& changes, Scene& scene) {
  const auto given = [&](const char* name) { return changes.contains(name); };
  if (given("quality"))
    set_quality(choice<RenderSettings::Quality>(changes["quality"].cast<std::string>()), scene);
  if (given("samples")) scene.render.samples_per_pixel = changes["samples"].cast<int>();
  if (given("noise")) scene.render.noise = changes["noise"].cast<float>();
  if (given("clamp")) scene.render.clamp = changes["clamp"].cast<float>();
  if (given("bounces")) scene.render.max_bounces = changes["bounces"].cast<int>();
  if (given("method"))
    scene.render.method = method_named("method", changes["method"].cast<std::string>());
  if (given("method") || given("quality"))
    for (std::string& line : leave_out_unhonoured(scene)) scene.warnings.push_back(std::move(line));
  if (given("single_scattering")) {
    scene.places["render.single_scattering"] = "single_scattering";
    scene.render.single_scattering =
        choice<RenderSettings::SingleScattering>(changes["single_scattering"].cast<std::string>());
  }
  if (given("correct")) {
    scene.places["render.correct"] = "correct";
    scene.render.is_corrected = changes["correct"].cast<bool>();
  }
  if (given("profile")) {
    scene.places["render.profile"] = "profile";
    scene.render.profile = choice<RenderSettings::Profile>(changes["profile"].cast<std::string>());
  }
  if (given("seed")) scene.render.seed = changes["seed"].cast<std::uint64_t>();
  if (given("alpha") && changes["alpha"].cast<bool>()) make_background_transparent(scene);
  if (given("exposure")) scene.film.exposure = changes["exposure"].cast<float>();
  // One side alone keeps the proportions.
  const double aspect = static_cast<double>(scene.film.width) / scene.film.height;
  const int width = given("width") ? changes["width"].cast<int>() : 0;
  const int height = given("height") ? changes["height"].cast<int>() : 0;
  if (width > 0 && height == 0)
    scene.film.height = std::max(1, static_cast<int>(std::lround(width / aspect)));
  if (height > 0 && width == 0)
    scene.film.width = std::max(1, static_cast<int>(std::lround(height * aspect)));
  if (width > 0) scene.film.width = width;
  if (height > 0) scene.film.height = height;
  if (given("region")) {
    const auto region = changes["region"].cast<std::array<int, 4>>();
    scene.film.region = {region[0], region[1], region[2], region[3]};
  }
  if (scene.film.region)
    require_inside(*scene.film.region, scene.film.width, scene.film.height, "region");
}

py::dict statistics_dict(const RenderStatistics& s, const Scene& scene) {
  py::dict result;
  result["method"] = std::string(s.method.name());
  result["method_chosen_because"] = s.why_method;
  result["expected_cpu_seconds"] = s.expected_cpu_seconds;
  result["wall_seconds"] = s.wall_seconds;
  result["cpu_seconds"] = s.cpu_seconds;
  result["samples_per_pixel"] = s.samples_per_pixel;
  result["noise"] = s.relative_noise;
  result["noise_rms"] = s.relative_noise_rms;
  result["is_complete"] = s.is_complete;
  py::list light, corrections, profiles;
  for (const LightSamples& one : s.light_samples) {
    py::dict entry;
    entry["material"] = scene.materials[one.material].name;
    entry["spacing_mm"] = one.spacing;
    entry["count"] = one.count;
    entry["change"] = one.change;
    light.append(entry);
  }
  for (const LightCorrection& one : s.corrections) {
    py::dict entry;
    entry["material"] = scene.materials[one.material].name;
    entry["walks"] = one.walks;
    entry["change"] = one.change;
    entry["error_left"] = one.error_left;
    entry["share"] = one.share;
    corrections.append(entry);
  }
  for (const ProfileUse& use : s.profiles) {
    py::dict entry;
    entry["material"] = scene.materials[use.material].name;
    entry["profile"] = std::string(name_of(use.source));
    profiles.append(entry);
  }
  result["light_samples"] = light;
  result["corrections"] = corrections;
  result["profiles"] = profiles;
  std::vector<std::string> warnings = scene.warnings;
  warnings.insert(warnings.end(), s.warnings.begin(), s.warnings.end());
  result["warnings"] = warnings;
  return result;
}

py::dict render_scene(const std::string& path, const std::optional<std::string>& text,
                      const std::vector<std::string>& settings, const py::dict& changes,
                      const std::string& cache, bool takes_foreign_light, bool denoises,
                      bool has_mattes, bool has_light_layers, const py::object& callback) {
  Scene scene = load_unlocked(json_file(path, text),
                              [&](const JsonFile& file) { return load_scene(file, {}, settings); });
  for (std::string& line : implausible_sizes(scene)) scene.warnings.push_back(std::move(line));
  apply(changes, scene);
  Work work(callback);
  RenderResult rendered = work.run_partly([&](const Progress& progress) {
    RenderOptions options;
    options.cache = cache;
    options.takes_foreign_light = takes_foreign_light;
    options.has_mattes = has_mattes;
    RenderResult result = has_light_layers ? render_light_layers(scene, options, progress)
                                           : render(scene, options, progress);
    if (denoises) result.image = denoise(result.image);
    return result;
  });
  py::dict result = statistics_dict(rendered.statistics, scene);
  result["exposure"] = scene.film.exposure;
  result["view"] = std::string(name_of(scene.film.view));
  std::map<std::string, std::string> notes;
  for (const ImageNote& note : rendered.notes) notes[note.name] = note.text;
  result["notes"] = notes;
  const ImageFrame frame = frame_of(scene.film);
  if (frame.width > 0)
    result["frame"] = py::make_tuple(frame.x, frame.y, frame.width, frame.height);
  else
    result["frame"] = py::none();
  result["channels"] = rendered.image.channels;
  result["pixels"] = image_array(std::move(rendered.image));
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

}  // namespace

void bind_render(py::module_& module) {
  module.def("render", &render_scene);
  module.def("method_names", [] {
    std::vector<std::string> names;
    for (const std::string_view name : method_names()) names.emplace_back(name);
    return names;
  });
}

}  // namespace lamina::python
