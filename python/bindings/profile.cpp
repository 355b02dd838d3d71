// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "profile.h"

#include <pybind11/stl.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "derivatives.h"
#include "heard.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/dipole_profile.h"
#include "lamina/solve/scattering/photon_bands/band_photons.h"
#include "lamina/solve/scattering/transport_profile/doubtful_profile.h"
#include "lamina/solve/scattering/transport_profile/gaussian_profile.h"
#include "lamina/solve/scattering/transport_profile/oblique_profile.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"
#include "layer_stacks.h"
#include "photon_options.h"
#include "work.h"

namespace lamina::python {
namespace {

/// A table [row][band][column] as an array of the bands' shape and (rows,), or (rows, columns).
py::array_t<double> by_band(std::span<const double> table, const LayerStacks& stacks,
                            std::size_t columns = 0) {
  const std::size_t bands = stacks.stacks.size(), width = columns == 0 ? 1 : columns;
  const std::size_t rows = table.size() / (bands * width);
  std::vector<double> values(table.size());
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t band = 0; band < bands; ++band)
      for (std::size_t column = 0; column < width; ++column)
        values[(band * rows + row) * width + column] = table[(row * bands + band) * width + column];
  Shape shape = with_axis(stacks.shape, rows);
  if (columns != 0) shape = with_axis(std::move(shape), columns);
  return to_array(std::move(values), shape);
}

py::dict profile_dict(Profile profile, const LayerStacks& stacks) {
  py::dict result;
  result["per"] = std::string(name_of(profile.per));
  result["r"] = to_array(std::move(profile.r));
  result["reflectance"] = by_band(profile.reflectance_profile, stacks);
  result["transmittance"] = by_band(profile.transmittance_profile, stacks);
  result["total_reflectance"] = to_array(std::move(profile.total_reflectance), stacks.shape);
  result["total_transmittance"] = to_array(std::move(profile.total_transmittance), stacks.shape);
  return result;
}

RadialGrid grid_of(const py::tuple& grid) {
  return {grid[0].cast<double>(), grid[1].cast<double>(), grid[2].cast<std::size_t>()};
}

TransferProfileOptions transfer_options(const py::dict& options) {
  return {.accuracy = options["accuracy"].cast<double>(),
          .illumination = options["is_diffuse"].cast<bool>() ? Illumination::diffuse
                                                             : Illumination::normal_beam,
          .is_from_below = options["is_from_below"].cast<bool>()};
}

py::dict profile_by_radiative_transfer(const LayerStacks& stacks, const py::tuple& grid,
                                       const py::dict& options, bool is_cached,
                                       const py::object& callback) {
  TransferProfileOptions asked = transfer_options(options);
  const RadialGrid radii = grid_of(grid);
  Work work(callback);
  auto [found, was_cached] = work.run([&](const Progress& progress) {
    asked.progress = progress;
    return cached_transfer_profile(is_cached ? user_cache() : std::nullopt, stacks.stacks, radii,
                                   asked);
  });
  refuse_doubtful(found.mean_error, "method=\"monte_carlo\"");
  py::dict result = profile_dict(std::move(found.profile), stacks);
  result["relative_error"] = by_band(found.relative_error, stacks);
  result["transmittance_error"] = by_band(found.transmittance_error, stacks);
  result["estimated_error"] = to_array(std::move(found.estimated_error), stacks.shape);
  result["mean_error"] = to_array(std::move(found.mean_error), stacks.shape);
  result["was_cached"] = was_cached;
  return result;
}

py::dict profile_by_diffusion(const LayerStacks& stacks, const py::tuple& grid,
                              const std::string& interreflections) {
  const DiffusionOptions options{.interreflections = choice<Interreflections>(interreflections)};
  const RadialGrid radii = grid_of(grid);
  DiffusionProfile found =
      heard([&] { return make_diffusion_profile(stacks.stacks, options, radii); });
  py::dict result = profile_dict(std::move(found.profile), stacks);
  result["thin_layers"] = found.thin_layers;
  std::vector<double> clamped = std::move(found.clamped_reflectance);
  for (std::size_t band = 0; band < clamped.size(); ++band)
    clamped[band] += found.clamped_transmittance[band];
  result["clamped"] = to_array(std::move(clamped), stacks.shape);
  return result;
}

py::dict by_dipole(const LayerStacks& stacks, const py::tuple& grid) {
  const RadialGrid radii = grid_of(grid);
  Profile found = [&] {
    const py::gil_scoped_release unlocked;
    return make_dipole_profile(stacks.stacks, {}, radii);
  }();
  return profile_dict(std::move(found), stacks);
}

py::dict profile_by_monte_carlo(const LayerStacks& stacks, const py::tuple& grid,
                                const py::dict& effort, const py::object& callback) {
  const RadialGrid radii = grid_of(grid);
  MonteCarloOptions options = photon_options(effort);
  options.tallies.log_r = bins_around(radii);
  Work work(callback);
  const std::vector<MonteCarloResult> traced = work.run_partly([&](const Progress& progress) {
    options.progress = progress;
    return trace_bands(stacks.stacks, options, are_independent(effort));
  });
  py::dict result = profile_dict(photon_profile(traced, radii, &Estimate::value), stacks);
  result["standard_error"] =
      profile_dict(photon_profile(traced, radii, &Estimate::standard_error), stacks);
  result["unfinished"] = read_array(
      traced, stacks.shape, [](const MonteCarloResult& one) { return one.unfinished.value; });
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

py::dict oblique(const LayerStacks& stacks, double theta, const py::tuple& grid, int moments,
                 const py::object& callback) {
  const RadialGrid radii = grid_of(grid);
  Work work(callback);
  ObliqueProfile found = work.run([&](const Progress& progress) {
    return oblique_profile(stacks.stacks, theta, radii, moments, progress);
  });
  refuse_doubtful(found.mean_error, "lamina.photons with tally log_r");
  // [i][m][band] counts radius and moment as one row.
  const auto table = [&](const std::vector<double>& values) {
    const std::size_t bands = stacks.stacks.size();
    Shape shape = with_axis(with_axis(stacks.shape, found.r.size()), found.moments);
    std::vector<double> turned(values.size());
    const std::size_t rows = values.size() / bands;
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t band = 0; band < bands; ++band)
        turned[band * rows + row] = values[row * bands + band];
    return to_array(std::move(turned), shape);
  };
  py::dict result;
  result["reflectance_moments"] = table(found.reflectance_moments);
  result["transmittance_moments"] = table(found.transmittance_moments);
  result["relative_error"] = by_band(found.estimated_error, stacks);
  result["transmittance_error"] = by_band(found.transmittance_error, stacks);
  result["total_reflectance"] = to_array(std::move(found.total_reflectance), stacks.shape);
  result["total_transmittance"] = to_array(std::move(found.total_transmittance), stacks.shape);
  result["estimated_error"] = to_array(std::move(found.largest_error), stacks.shape);
  result["mean_error"] = to_array(std::move(found.mean_error), stacks.shape);
  result["r"] = to_array(std::move(found.r));
  return result;
}

/// Derivatives [k][band], [layer].
py::dict wave_derivatives(const std::vector<std::vector<LayerDerivatives>>& table,
                          const LayerStacks& stacks) {
  const std::size_t bands = stacks.stacks.size(), rows = table.size() / bands;
  std::vector<LayerDerivatives> all;
  for (std::size_t band = 0; band < bands; ++band)
    for (std::size_t row = 0; row < rows; ++row) {
      const std::vector<LayerDerivatives>& layers = table[row * bands + band];
      all.insert(all.end(), layers.begin(), layers.end());
    }
  return derivatives_dict(all, with_axis(with_axis(stacks.shape, rows), stacks.layers()));
}

py::dict frequency_response(const LayerStacks& stacks, const std::vector<double>& k,
                            const py::dict& options, bool has_derivatives,
                            const py::object& callback) {
  TransferProfileOptions asked = transfer_options(options);
  Work work(callback);
  const SpatialFrequencyDerivatives found = work.run([&](const Progress& progress) {
    asked.progress = progress;
    if (has_derivatives) return spatial_frequency_derivatives(stacks.stacks, k, asked);
    return SpatialFrequencyDerivatives{spatial_frequency_response(stacks.stacks, k, asked)};
  });
  py::dict result;
  result["reflectance"] = by_band(found.response.reflectance, stacks);
  result["transmittance"] = by_band(found.response.transmittance, stacks);
  result["reflectance_error"] = by_band(found.response.reflectance_error, stacks);
  result["transmittance_error"] = by_band(found.response.transmittance_error, stacks);
  result["estimated_error"] =
      to_array(std::vector<double>(found.response.largest_error), stacks.shape);
  if (has_derivatives) {
    result["d_reflectance"] = wave_derivatives(found.reflectance, stacks);
    result["d_transmittance"] = wave_derivatives(found.transmittance, stacks);
  }
  return result;
}

py::dict gaussians(const LayerStacks& stacks, int count, const py::dict& options,
                   const py::object& callback) {
  TransferProfileOptions asked = transfer_options(options);
  Work work(callback);
  const GaussianProfile found = work.run([&](const Progress& progress) {
    asked.progress = progress;
    return fit_gaussian_profile(stacks.stacks, count, asked);
  });
  py::dict result;
  const auto add = [&](const std::string& name, const std::vector<GaussianFit>& fits) {
    std::vector<double> weights;
    for (const GaussianFit& fit : fits)
      weights.insert(weights.end(), fit.sum.weights.begin(), fit.sum.weights.end());
    const auto put = [&](const char* what, py::array_t<double> values) {
      result[(name + what).c_str()] = std::move(values);
    };
    put("_weights", to_array(std::move(weights), with_axis(stacks.shape, found.variances.size())));
    put("_rms_error",
        read_array(fits, stacks.shape, [](const GaussianFit& fit) { return fit.rms_error; }));
    put("_largest_error",
        read_array(fits, stacks.shape, [](const GaussianFit& fit) { return fit.largest_error; }));
  };
  add("reflectance", found.reflectance);
  if (!found.transmittance.empty()) add("transmittance", found.transmittance);
  result["variances"] = to_array(std::vector<double>(found.variances));
  return result;
}

}  // namespace

void bind_profile(py::module_& module) {
  module.def("profile_by_radiative_transfer", &profile_by_radiative_transfer);
  module.def("profile_by_diffusion", &profile_by_diffusion);
  module.def("profile_by_dipole", &by_dipole);
  module.def("profile_by_monte_carlo", &profile_by_monte_carlo);
  module.def("oblique_profile", &oblique);
  module.def("spatial_frequency_response", &frequency_response);
  module.def("gaussian_profile", &gaussians);
}

}  // namespace lamina::python
