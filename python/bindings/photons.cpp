// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "photons.h"

#include <pybind11/stl.h>

#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"
#include "lamina/solve/scattering/photon_bands/band_photons.h"
#include "layer_stacks.h"
#include "photon_options.h"
#include "work.h"

namespace lamina::python {
namespace {

UniformBins bins_of(const py::handle& bins) {
  const auto [count, width] = bins.cast<std::pair<int, double>>();
  return {count, width};
}

PhotonTallies tallies_of(const py::dict& asked) {
  PhotonTallies t;
  if (asked.contains("r")) t.r = bins_of(asked["r"]);
  if (asked.contains("angles")) t.angles = asked["angles"].cast<int>();
  if (asked.contains("log_r")) {
    const auto [count, low, high] = asked["log_r"].cast<std::tuple<int, double, double>>();
    t.log_r = {count, low, high};
  }
  if (asked.contains("depth")) t.depth = bins_of(asked["depth"]);
  t.fluence = asked.contains("fluence");
  if (asked.contains("bsdf"))
    std::tie(t.bsdf_cosines, t.bsdf_azimuths) = asked["bsdf"].cast<std::pair<int, int>>();
  t.orders = asked.contains("orders");
  if (asked.contains("path_length")) {
    t.path_length = bins_of(asked["path_length"]);
    t.mean_path_length = true;
  }
  if (asked.contains("time")) t.time = bins_of(asked["time"]);
  if (asked.contains("frequencies"))
    t.frequencies = asked["frequencies"].cast<std::vector<double>>();
  if (asked.contains("detectors")) {
    t.detectors = asked["detectors"].cast<std::vector<double>>();
    t.detector_width = asked["detector_width"].cast<double>();
  }
  if (asked.contains("directions"))
    for (const auto& [theta, phi, is_below] :
         asked["directions"].cast<std::vector<std::tuple<double, double, bool>>>())
      t.directions.push_back({theta, phi, is_below});
  return t;
}

/// Arrays of a result of each stack, with the standard errors beside them.
class Arrays {
 public:
  Arrays(const std::vector<MonteCarloResult>& results, const LayerStacks& stacks)
      : results_(results), shape_(stacks.shape) {}

  /// A list of estimates of each result, as an array with these axes of its own.
  template <class Read>
  void add(const char* name, std::initializer_list<std::size_t> axes, const Read& read) {
    if (read(results_[0]).empty()) return;
    Shape shape = shape_;
    for (const std::size_t axis : axes) shape = with_axis(std::move(shape), axis);
    std::vector<double> value, error;
    for (const MonteCarloResult& result : results_)
      for (const Estimate& one : read(result)) {
        value.push_back(one.value);
        error.push_back(one.standard_error);
      }
    values_[name] = to_array(std::move(value), shape);
    errors_[name] = to_array(std::move(error), shape);
  }

  void add_total(const char* name, Estimate MonteCarloResult::*estimate) {
    add(name, {}, [=](const MonteCarloResult& r) { return std::vector{r.*estimate}; });
  }

  /// Both sides, as NAME_reflected and NAME_transmitted.
  void add_sides(const std::string& name, std::initializer_list<std::size_t> axes,
                 TwoSided MonteCarloResult::*sides) {
    add((name + "_reflected").c_str(),
        axes, [=](const MonteCarloResult& r) -> const auto& { return (r.*sides).reflection; });
    add((name + "_transmitted").c_str(),
        axes, [=](const MonteCarloResult& r) -> const auto& { return (r.*sides).transmission; });
  }

  /// Amplitudes and phases of modulated light.
  template <class Read>
  void add_modulation(const std::string& name, std::initializer_list<std::size_t> axes,
                      const Read& read) {
    const auto part = [&](const char* what, Estimate Modulation::*of) {
      add((name + what).c_str(), axes, [=](const MonteCarloResult& r) {
        std::vector<Estimate> list;
        for (const Modulation& one : read(r)) list.push_back(one.*of);
        return list;
      });
    };
    part("_amplitude", &Modulation::amplitude);
    part("_phase", &Modulation::phase);
  }

  py::dict values() const { return values_; }
  py::dict errors() const { return errors_; }

 private:
  const std::vector<MonteCarloResult>& results_;
  Shape shape_;
  py::dict values_, errors_;
};

py::dict photons(const LayerStacks& stacks, bool is_diffuse, double theta, const std::string& beam,
                 double beam_radius, const py::dict& tallies, const py::dict& effort,
                 std::uint32_t max_events, const py::object& callback) {
  MonteCarloOptions options = photon_options(effort);
  options.incidence = {is_diffuse, theta};
  options.beam = {choice<Beam::Shape>(beam), beam_radius};
  options.tallies = tallies_of(tallies);
  options.max_events = max_events;
  Work work(callback);
  const std::vector<MonteCarloResult> traced = work.run_partly([&](const Progress& progress) {
    options.progress = progress;
    return trace_bands(stacks.stacks, options, are_independent(effort));
  });
  const auto size = [](int count) { return static_cast<std::size_t>(count); };
  const PhotonTallies& t = options.tallies;
  const std::size_t r = size(t.r.count), angles = size(t.angles), depth = size(t.depth.count),
                    time = size(t.time.count), frequencies = t.frequencies.size(),
                    detectors = t.detectors.size(), layers = stacks.layers();
  using Result = MonteCarloResult;
  Arrays arrays(traced, stacks);
  arrays.add_total("specular_reflectance", &Result::specular_reflectance);
  arrays.add_total("diffuse_reflectance", &Result::diffuse_reflectance);
  arrays.add_total("transmittance", &Result::transmittance);
  arrays.add_total("unscattered_reflectance", &Result::unscattered_reflectance);
  arrays.add_total("unscattered_transmittance", &Result::unscattered_transmittance);
  arrays.add_total("unfinished", &Result::unfinished);
  arrays.add(
      "absorptance", {layers}, [](const Result& one) -> const auto& { return one.absorptance; });
  arrays.add_sides("r", {r}, &Result::radial);
  arrays.add_sides("angle", {angles}, &Result::angular);
  if (r > 0) arrays.add_sides("r_angle", {r, angles}, &Result::radial_angular);
  arrays.add_sides("log_r", {size(t.log_r.count)}, &Result::log_radial);
  const std::size_t cosines = size(t.bsdf_cosines), azimuths = size(t.bsdf_azimuths);
  arrays.add_sides("bsdf", {cosines, azimuths}, &Result::bsdf);
  arrays.add_sides("bsdf_by_order", {size(photon_orders), cosines, azimuths},
                   &Result::bsdf_by_order);
  arrays.add_sides("order", {size(photon_orders)}, &Result::by_order);
  arrays.add_sides("angle_by_order", {size(photon_orders), angles}, &Result::angular_by_order);
  arrays.add_sides("path_length", {size(t.path_length.count)}, &Result::path_length);
  if (t.mean_path_length || time > 0) {
    arrays.add_total("mean_path_reflected", &Result::mean_path_reflected);
    arrays.add_total("mean_path_transmitted", &Result::mean_path_transmitted);
  }
  if (time > 0) {
    arrays.add_total("mean_time_reflected", &Result::mean_time_reflected);
    arrays.add_total("mean_time_transmitted", &Result::mean_time_transmitted);
  }
  arrays.add_sides("mean_layer_path", {layers}, &Result::mean_layer_path);
  arrays.add_sides("time", {time}, &Result::time);
  arrays.add_sides("r_time", {r, time}, &Result::radial_time);
  const auto modulation = [&](const std::string& name, std::initializer_list<std::size_t> axes,
                              TwoSidedModulation Result::*sides) {
    arrays.add_modulation(name + "_reflected", axes,
                          [=](const Result& one) { return (one.*sides).reflection; });
    arrays.add_modulation(name + "_transmitted", axes,
                          [=](const Result& one) { return (one.*sides).transmission; });
  };
  modulation("modulation", {frequencies}, &Result::modulation);
  modulation("r_modulation", {r, frequencies}, &Result::radial_modulation);
  arrays.add(
      "detector", {detectors}, [](const Result& one) -> const auto& { return one.detectors; });
  arrays.add(
      "detector_time", {detectors, time},
      [](const Result& one) -> const auto& { return one.detector_time; });
  arrays.add_modulation("detector_modulation", {detectors, frequencies},
                        [](const Result& one) { return one.detector_modulation; });
  arrays.add(
      "direction", {t.directions.size()},
      [](const Result& one) -> const auto& { return one.directions; });
  arrays.add(
      "absorption", {r, depth}, [](const Result& one) -> const auto& { return one.absorption; });
  arrays.add(
      "fluence", {r, depth}, [](const Result& one) -> const auto& { return one.fluence; });
  py::dict result;
  result["values"] = arrays.values();
  result["errors"] = arrays.errors();
  result["photons"] = read_array(
      traced, stacks.shape, [](const Result& one) { return static_cast<double>(one.photons); });
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

}  // namespace

void bind_photons(py::module_& module) {
  module.def("photons", &photons);
  module.def("load_mcml", [](const std::string& file) {
    py::list runs;
    for (const McmlRun& run : load_mcml(file)) {
      const MonteCarloOptions asked = monte_carlo_options(run);
      py::dict entry;
      entry["name"] = run.output_file;
      entry["stacks"] = LayerStacks{.stacks = {layer_stack(run)}, .shape = {}};
      entry["photons"] = asked.photons;
      entry["r"] = std::pair(asked.tallies.r.count, asked.tallies.r.width);
      entry["depth"] = std::pair(asked.tallies.depth.count, asked.tallies.depth.width);
      entry["angles"] = asked.tallies.angles;
      runs.append(entry);
    }
    return runs;
  });
}

}  // namespace lamina::python
