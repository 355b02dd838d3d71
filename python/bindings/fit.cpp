// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit.h"

#include <pybind11/stl.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "json_files.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "work.h"

namespace lamina::python {
namespace {

py::dict number_dict(const FittedNumber& number, const Measurement& measurement) {
  const FittedParameter& f = number.fitted;
  py::dict result;
  result["parameter"] = measurement.free[number.free].parameter.name;
  result["band"] =
      number.band ? py::object(py::str(band_name(measurement.bands, *number.band))) : py::none();
  result["value"] = f.value;
  result["low_error"] = f.low_error;
  result["high_error"] = f.high_error;
  result["standard_deviation"] = f.standard_deviation;
  result["prior_share"] = f.prior_share;
  result["is_at_bound"] = f.is_at_bound;
  return result;
}

py::dict series_dict(const Measurement& measurement, const MeasurementFit& fit, std::size_t s) {
  const MeasuredSeries& series = measurement.series[s];
  std::vector<double> at, r, value, deviation;
  std::vector<std::string> band, quantity;
  for (const MeasuredPoint& point : series.points) {
    band.push_back(band_name(measurement.bands, point.band));
    quantity.emplace_back(name_of(point.quantity));
    at.push_back(point.at);
    r.push_back(point.r);
    value.push_back(point.value);
    deviation.push_back(point.standard_deviation);
  }
  py::dict result;
  result["kind"] = std::string(name_of(series.kind));
  result["band"] = band;
  result["quantity"] = quantity;
  result["at"] = to_array(std::move(at));
  result["r"] = to_array(std::move(r));
  result["measured"] = to_array(std::move(value));
  result["sd"] = to_array(std::move(deviation));
  result["predicted"] = to_array(std::vector<double>(fit.predicted[s]));
  result["residual"] = to_array(std::vector<double>(fit.residual[s]));
  return result;
}

py::dict fit_dict(const Measurement& measurement, const MeasurementFit& fit) {
  py::list numbers, series, groups;
  for (const FittedNumber& number : fit.numbers) numbers.append(number_dict(number, measurement));
  for (std::size_t s = 0; s < measurement.series.size(); ++s)
    series.append(series_dict(measurement, fit, s));
  for (const FittedGroup& group : fit.groups) {
    const std::size_t n = group.numbers.size();
    std::vector<double> correlation;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) correlation.push_back(group.correlation(i, j));
    groups.append(py::make_tuple(group.numbers,
                                 to_array(std::move(correlation), with_axis(with_axis({}, n), n))));
  }
  py::dict result;
  result["name"] = measurement.name;
  result["numbers"] = numbers;
  result["series"] = series;
  result["groups"] = groups;
  result["chi_squared"] = fit.chi_squared;
  result["prior_squares"] = fit.prior_squares;
  result["degrees_of_freedom"] = static_cast<double>(fit.degrees_of_freedom);
  result["has_converged"] = fit.has_converged;
  result["notes"] = fit.notes;
  result["material_text"] = format_material(material_with(measurement, fit.values));
  return result;
}

using Source = std::pair<std::string, std::optional<std::string>>;

/// All fits, and whether they were interrupted: None then stands for those that have not ended.
py::tuple fit_all(const std::vector<Source>& sources, const std::vector<std::string>& settings,
                  std::uint64_t seed, const py::object& callback) {
  std::vector<Measurement> measurements;
  for (const auto& [path, text] : sources)
    measurements.push_back(load_unlocked(json_file(path, text), [&](const JsonFile& file) {
      return load_measurement(file, {}, settings);
    }));
  Work work(callback);
  const auto fits = work.run_partly([&](const Progress& progress) {
    const bool is_one = measurements.size() == 1;
    return solve_each<MeasurementFit>(measurements.size(), progress, [&](std::size_t i) {
      return fit_measurement(
          measurements[i],
          {.seed = seed, .progress = is_one ? progress : of_unknown_length(progress)});
    });
  });
  py::list result;
  for (std::size_t i = 0; i < fits.size(); ++i)
    result.append(fits[i] ? py::object(fit_dict(measurements[i], *fits[i])) : py::none());
  return py::make_tuple(result, work.was_interrupted());
}

}  // namespace

void bind_fit(py::module_& module) { module.def("fit", &fit_all); }

}  // namespace lamina::python
