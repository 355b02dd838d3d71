// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "acquire.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "images.h"
#include "json_files.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/acquire/files/acquired_files.h"
#include "lamina/skin/acquire/files/capture_file.h"
#include "lamina/skin/acquire/files/leaf_files.h"
#include "lamina/skin/acquire/leaf_acquisition.h"
#include "lamina/skin/acquire/skin_acquisition.h"
#include "lamina/skin/fit/skin/number_unit.h"
#include "natives.h"
#include "skin_numbers.h"
#include "work.h"

namespace lamina::python {
namespace {

/// What was found of a capture, as files are written of it.
struct Acquisition {
  Capture capture;
  std::optional<SkinAcquisition> skin;
  std::optional<LeafMaps> leaf;
};

py::object image_or_none(const Image& image) {
  return image.pixels.empty() ? py::object(py::none()) : py::object(image_array(image));
}

py::array_t<double> matrix_array(const DenseMatrix& matrix) {
  return to_array(
      std::vector<double>(matrix.values),
      Shape{static_cast<py::ssize_t>(matrix.rows), static_cast<py::ssize_t>(matrix.columns)});
}

/// [y][x], where a pixel is of a kind.
template <class Kind>
py::array_t<bool> mask_of(const std::vector<Kind>& kinds, Kind kind, int width, int height) {
  py::array_t<bool> mask(Shape{height, width});
  std::ranges::transform(kinds, mask.mutable_data(), [&](Kind each) { return each == kind; });
  return mask;
}

std::string coordinate_name(FitScale scale) {
  return scale == FitScale::logarithmic ? "logarithm"
         : scale == FitScale::logit     ? "logit"
                                        : "value";
}

/// The names by which recipes know a number; one number may be several.
py::list recipe_names(const SkinFitNumber& number) {
  py::list names;
  for (double SkinParameters::*const value : number.values)
    for (const SkinParameterRange& range : skin_parameter_ranges())
      if (range.value == value) names.append(std::string(range.name));
  return names;
}

/// A number for each band; the same for all where they are not worked out.
py::array_t<double> of_bands(const Capture& capture, const std::vector<double>& numbers,
                             double unknown) {
  return to_array(numbers.empty()
                      ? std::vector<double>(capture.reflectance.channel_count(), unknown)
                      : numbers);
}

py::dict skin_dict(const Acquisition& acquisition, const AcquisitionPlan& plan) {
  const Capture& capture = acquisition.capture;
  const auto& [skin, check, notes] = *acquisition.skin;
  py::dict result, maps, deviations, prior, within, units, coordinates, recipe;
  for (const AcquiredNumber& number : skin.numbers) {
    const std::string& name = number.number.parameter.name;
    const char* key = name.c_str();
    maps[key] = plane_array(number.values);
    deviations[key] = plane_array(number.deviations);
    prior[key] = number.prior_share;
    within[key] = number.within_share;
    units[key] = unit_of_number(name);
    coordinates[key] = coordinate_name(number.number.parameter.scale);
    recipe[key] = recipe_names(number.number);
  }
  result["maps"] = maps;
  result["deviations"] = deviations;
  result["prior_share"] = prior;
  result["within_share"] = within;
  result["number_units"] = units;
  result["coordinates"] = coordinates;
  result["recipe_names"] = recipe;
  result["fixed"] = numbers_dict(capture.skin.skin);
  result["constants"] = std::string(name_of(capture.skin.constants));
  result["mask"] = mask_of(skin.kinds, PixelKind::skin, skin.width, skin.height);
  result["measured"] = image_or_none(check.measured);
  result["predicted"] = image_or_none(check.predicted);
  result["residual"] = to_array(std::vector<double>(check.residual));
  result["chi_squared"] =
      of_bands(capture, skin.chi_squared, std::numeric_limits<double>::quiet_NaN());
  result["error_growth"] = of_bands(capture, skin.error_growth, 1.0);
  result["mean_ciede2000"] = check.mean_difference;
  result["by_calibration"] = matrix_array(check.by_calibration);
  result["correlation"] = matrix_array(check.correlation);
  result["lateral"] = plan.has_transport ? "transport" : "none";
  py::list history;
  if (skin.inversion) {
    for (const InversionStep& step : skin.inversion->history)
      history.append(py::make_tuple(step.forwards, step.residual, step.in_deviations));
    result["stop"] = std::string(name_of(skin.inversion->stop));
    result["smoothness"] = to_array(std::vector<double>(skin.inversion->smoothness));
  } else {
    result["stop"] = "each pixel by a table";
    result["smoothness"] = py::none();
  }
  result["history"] = history;
  result["has_errors"] = !skin.inversion || skin.inversion->stop != InversionStop::interrupted;
  return result;
}

py::dict leaf_dict(const LeafMaps& leaf) {
  py::dict result, maps, deviations, prior, coordinates;
  for (const LeafMap& map : leaf.maps) {
    const char* key = map.parameter.name.c_str();
    maps[key] = plane_array(map.values);
    deviations[key] = plane_array(map.deviations);
    prior[key] = map.prior_share;
    coordinates[key] = coordinate_name(map.parameter.scale);
  }
  result["maps"] = maps;
  result["deviations"] = deviations;
  result["prior_share"] = prior;
  result["coordinates"] = coordinates;
  result["mask"] = mask_of(leaf.kinds, LeafPixelKind::leaf, leaf.width, leaf.height);
  result["predicted"] = image_or_none(leaf.predicted);
  result["misfit"] = plane_array(leaf.misfit);
  result["residual"] = to_array(std::vector<double>(leaf.residual));
  result["bias"] = to_array(std::vector<double>(leaf.bias));
  result["noise"] = to_array(std::vector<double>(leaf.noise));
  result["chi_squared"] = to_array(std::vector<double>(leaf.chi_squared));
  result["error_growth"] = to_array(std::vector<double>(leaf.error_growth));
  result["correlation"] = matrix_array(leaf.correlation);
  return result;
}

/// @param start  maps of the numbers, by name, to go on from; empty: none
py::tuple acquire(const std::string& path, const std::optional<std::string>& text,
                  const std::vector<std::string>& settings, const py::dict& options,
                  const py::dict& start, const std::vector<double>& smoothness,
                  const py::object& callback) {
  auto acquisition = std::make_unique<Acquisition>();
  Capture& capture = acquisition->capture;
  capture = load_unlocked(json_file(path, text), [&](const JsonFile& file) {
    return develop_capture(load_capture(file, {}, settings));
  });
  Work work(callback);
  py::dict result;
  if (capture.leaf) {
    acquisition->leaf =
        work.run([&](const Progress& progress) { return acquire_leaf(capture, progress); });
    for (std::string& note : notes_of_misfit(capture, *acquisition->leaf))
      capture.notes.push_back(std::move(note));
    result = leaf_dict(*acquisition->leaf);
  } else {
    const AcquisitionPlan plan =
        plan_acquisition(capture, choice<LateralLight>(options["lateral"].cast<std::string>()));
    PatchAcquisitionOptions patch;
    patch.inversion.most_forwards = options["most_forwards"].cast<double>();
    patch.inversion.model_error = options["model_error"].cast<double>();
    patch.inversion.robust_limit = options["robust"].cast<double>();
    patch.inversion.seed = options["seed"].cast<std::uint64_t>();
    if (plan.has_table && options["is_of_transport"].cast<bool>())
      throw InvalidInput(
          "most_forwards, model_error, robust, start: are not read where a table has the "
          "fits of all colors");
    if (!start.empty()) {
      for (const SkinFitNumber& number : capture.numbers) {
        const char* name = number.parameter.name.c_str();
        if (!start.contains(name))
          throw InvalidInput("start: must have a map of " + number.parameter.name);
        const auto map = start[name].cast<Floats>();
        if (map.ndim() != 2 || map.shape(0) != capture.reflectance.height ||
            map.shape(1) != capture.reflectance.width)
          throw InvalidInput("start: maps must be of the size of the capture");
        patch.start.push_back(plane_image(map));
      }
      if (smoothness.size() == 2 * capture.numbers.size()) patch.inversion.smoothness = smoothness;
    }
    acquisition->skin = work.run_partly([&](const Progress& progress) {
      return acquire_skin(capture, plan, std::move(patch), user_cache(), progress);
    });
    const std::vector<std::string>& notes = acquisition->skin->notes;
    capture.notes.insert(capture.notes.end(), notes.begin(), notes.end());
    result = skin_dict(*acquisition, plan);
  }
  result["name"] = capture.name;
  result["notes"] = capture.notes;
  result["mm_per_pixel"] = capture.mm_per_pixel;
  result["bands"] = capture.reflectance.channels;
  result["was_interrupted"] = work.was_interrupted();
  return py::make_tuple(result, py::cast(std::move(acquisition)));
}

py::dict rating_dict(const BandInformation& information, const BandSetRating& rating) {
  py::dict result, deviations;
  std::vector<double> nm;
  for (const std::size_t band : rating.bands)
    nm.push_back(information.candidates()[band].wavelength);
  for (std::size_t n = 0; n < information.numbers().size(); ++n)
    deviations[information.numbers()[n].c_str()] = rating.deviations[n];
  result["wavelengths"] = to_array(std::move(nm));
  result["score"] = rating.score;
  result["standard_deviation"] = deviations;
  return result;
}

py::dict choose_bands(const std::vector<double>& wavelengths, const std::vector<double>& widths,
                      int count, double noise, const std::vector<std::string>& numbers,
                      const std::string& population, int skins_drawn, std::uint64_t seed,
                      const std::optional<std::vector<std::size_t>>& compared,
                      const py::object& callback) {
  std::vector<CandidateBand> candidates;
  for (std::size_t i = 0; i < wavelengths.size(); ++i)
    candidates.push_back({wavelengths[i], widths[i]});
  std::optional<SkinPopulation> known;
  if (!population.empty()) known = find_skin_population(population);
  const std::vector<SkinParameters> skins =
      known ? draw_skins(*known, skins_drawn, seed) : skins_of_choice();
  Work work(callback);
  const auto [information, best] = work.run([&](const Progress& progress) {
    BandInformation made(candidates, skins, numbers, noise, known ? &*known : nullptr, progress);
    BandSetRating chosen = made.choose(count, progress);
    return std::pair(std::move(made), std::move(chosen));
  });
  std::vector<std::size_t> all(candidates.size());
  for (std::size_t c = 0; c < all.size(); ++c) all[c] = c;
  py::dict result;
  result["best"] = rating_dict(information, best);
  result["evenly_spaced"] = rating_dict(information, information.evenly_spaced(count));
  result["all"] = rating_dict(information, information.rate(all));
  if (compared) result["compared"] = rating_dict(information, information.rate(*compared));
  std::vector<double> reflectance, changes;
  for (std::size_t s = 0; s < skins.size(); ++s) {
    const std::vector<double>& one = information.reflectance(s);
    const std::vector<double>& by = information.derivatives(s).values;
    reflectance.insert(reflectance.end(), one.begin(), one.end());
    changes.insert(changes.end(), by.begin(), by.end());
  }
  const Shape shape = with_axis(with_axis({}, skins.size()), candidates.size());
  result["reflectance"] = to_array(std::move(reflectance), shape);
  result["changes"] = to_array(std::move(changes), with_axis(shape, numbers.size()));
  return result;
}

}  // namespace

void bind_acquire(py::module_& module) {
  native_class<Acquisition>(module, "Acquisition")
      .def("save", [](const Acquisition& acquisition, const std::string& folder) {
        const py::gil_scoped_release unlocked;
        if (acquisition.leaf)
          save_leaf(*acquisition.leaf, acquisition.capture, folder, LAMINA_VERSION);
        else
          save_acquired(acquisition.skin->skin, acquisition.capture, folder, LAMINA_VERSION);
      });
  module.def("acquire", &acquire);
  module.def("choose_bands", &choose_bands);
}

}  // namespace lamina::python
