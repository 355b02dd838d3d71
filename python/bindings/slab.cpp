// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "slab.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "derivatives.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/photon_bands/band_photons.h"
#include "layer_stacks.h"
#include "photon_options.h"
#include "work.h"

namespace lamina::python {
namespace {

py::dict totals_dict(const std::vector<SlabTotals>& totals, const LayerStacks& stacks) {
  std::vector<double> absorptance;
  for (const SlabTotals& t : totals)
    absorptance.insert(absorptance.end(), t.absorptance.begin(), t.absorptance.end());
  const Shape& shape = stacks.shape;
  py::dict result;
  result["specular_reflectance"] =
      read_array(totals, shape, [](const SlabTotals& t) { return t.specular_reflectance; });
  result["diffuse_reflectance"] =
      read_array(totals, shape, [](const SlabTotals& t) { return t.diffuse_reflectance; });
  result["transmittance"] =
      read_array(totals, shape, [](const SlabTotals& t) { return t.transmittance; });
  result["absorptance"] = to_array(std::move(absorptance), with_axis(shape, stacks.layers()));
  return result;
}

/// What is known of totals by radiative transfer besides them.
void add_trust(const std::vector<AddingDoublingTotals>& solved, const Shape& shape,
               py::dict& result) {
  const auto add = [&](const char* name, const auto& read) {
    result[name] = read_array(solved, shape, read);
  };
  add("unscattered_reflectance",
      [](const AddingDoublingTotals& t) { return t.unscattered_reflectance; });
  add("unscattered_transmittance",
      [](const AddingDoublingTotals& t) { return t.unscattered_transmittance; });
  add("estimated_error", [](const AddingDoublingTotals& t) { return t.estimated_error; });
}

template <class Solved>
std::vector<SlabTotals> totals_of(const std::vector<Solved>& solved) {
  std::vector<SlabTotals> totals;
  for (const Solved& one : solved) totals.push_back(one.totals);
  return totals;
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What stands for stacks that are not solved when work is stopped: NaN everywhere.
template <class Solved>
Solved unsolved(const LayerStacks& stacks) {
  const std::size_t layers = stacks.layers();
  const SlabTotals totals{.specular_reflectance = nan,
                          .diffuse_reflectance = nan,
                          .transmittance = nan,
                          .absorptance = std::vector<double>(layers, nan)};
  if constexpr (std::is_same_v<Solved, SlabTotals>)
    return totals;
  else if constexpr (std::is_same_v<Solved, AddingDoublingTotals>)
    return {.totals = totals,
            .unscattered_transmittance = nan,
            .unscattered_reflectance = nan,
            .estimated_error = nan};
  else {
    const std::vector<LayerDerivatives> by(layers, {nan, nan, nan, nan});
    return {unsolved<AddingDoublingTotals>(stacks), by, by, by, by};
  }
}

/// All stacks, each by `solve(i)`.
template <class Solved, class Solve>
std::vector<Solved> solve_stacks(Work& work, const LayerStacks& stacks, const Solve& solve) {
  return work.run_partly([&](const Progress& progress) {
    std::vector<Solved> all;
    for (auto& one : solve_each<Solved>(stacks.stacks.size(), progress, solve))
      all.push_back(one ? std::move(*one) : unsolved<Solved>(stacks));
    return all;
  });
}

py::dict slab_by_radiative_transfer(const LayerStacks& stacks, bool is_diffuse, double theta,
                                    double accuracy, const py::object& callback) {
  const std::span<const LayerStack> all = stacks.stacks;
  // Blocks that all threads share, so that a stop loses no more than one of them.
  const std::size_t block = 128 * static_cast<std::size_t>(thread_count());
  Work work(callback);
  const std::vector<AddingDoublingTotals> solved = work.run_partly([&](const Progress& progress) {
    std::vector<AddingDoublingTotals> found;
    const auto fraction = [&](std::size_t done) {
      return static_cast<double>(done) / static_cast<double>(all.size());
    };
    try {
      while (found.size() < all.size()) {
        const std::size_t begin = found.size(), count = std::min(block, all.size() - begin);
        const Progress part = part_of(progress, fraction(begin), fraction(begin + count));
        const auto more = adding_doubling(all.subspan(begin, count), {is_diffuse, theta},
                                          {.accuracy = accuracy, .progress = part});
        found.insert(found.end(), more.begin(), more.end());
      }
    } catch (const Interrupted&) {
      if (found.empty()) throw;
      found.resize(all.size(), unsolved<AddingDoublingTotals>(stacks));
    }
    return found;
  });
  py::dict result = totals_dict(totals_of(solved), stacks);
  add_trust(solved, stacks.shape, result);
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

py::dict with_derivatives(const LayerStacks& stacks, bool is_diffuse, double theta, double accuracy,
                          const py::object& callback) {
  Work work(callback);
  const auto solved = solve_stacks<AddingDoublingDerivatives>(work, stacks, [&](std::size_t i) {
    try {
      return adding_doubling_derivatives(stacks.stacks[i], {is_diffuse, theta},
                                         {.accuracy = accuracy});
    } catch (const InvalidInput& error) {
      throw InvalidInput("derivatives: " + place_text(i, stacks.shape) + error.what());
    }
  });
  std::vector<AddingDoublingTotals> totals;
  for (const AddingDoublingDerivatives& one : solved) totals.push_back(one.totals);
  py::dict result = totals_dict(totals_of(totals), stacks);
  add_trust(totals, stacks.shape, result);
  const auto add = [&](const char* name,
                       std::vector<LayerDerivatives> AddingDoublingDerivatives::*of) {
    std::vector<LayerDerivatives> all;
    for (const AddingDoublingDerivatives& one : solved)
      all.insert(all.end(), (one.*of).begin(), (one.*of).end());
    result[name] = derivatives_dict(all, with_axis(stacks.shape, stacks.layers()));
  };
  add("d_diffuse_reflectance", &AddingDoublingDerivatives::diffuse_reflectance);
  add("d_transmittance", &AddingDoublingDerivatives::transmittance);
  add("d_unscattered_transmittance", &AddingDoublingDerivatives::unscattered_transmittance);
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

py::dict slab_by_diffusion(const LayerStacks& stacks, bool is_diffuse, double theta,
                           const std::string& interreflections, const py::object& callback) {
  const DiffusionOptions options{.interreflections = choice<Interreflections>(interreflections)};
  Work work(callback);
  const auto totals = solve_stacks<SlabTotals>(work, stacks, [&](std::size_t i) {
    try {
      return diffusion_totals(stacks.stacks[i], {is_diffuse, theta}, options);
    } catch (const InvalidInput& error) {
      throw InvalidInput(place_text(i, stacks.shape) + error.what());
    }
  });
  py::dict result = totals_dict(totals, stacks);
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

py::dict slab_by_monte_carlo(const LayerStacks& stacks, bool is_diffuse, double theta,
                             const py::dict& effort, const py::object& callback) {
  MonteCarloOptions options = photon_options(effort);
  options.incidence = {is_diffuse, theta};
  Work work(callback);
  const std::vector<MonteCarloResult> traced = work.run_partly([&](const Progress& progress) {
    options.progress = progress;
    return trace_bands(stacks.stacks, options, are_independent(effort));
  });
  const auto part = [&](double Estimate::*of) {
    std::vector<SlabTotals> totals;
    for (const MonteCarloResult& one : traced) totals.push_back(slab_totals(one, of));
    return totals_dict(totals, stacks);
  };
  py::dict result = part(&Estimate::value);
  result["standard_error"] = part(&Estimate::standard_error);
  result["unfinished"] = read_array(
      traced, stacks.shape, [](const MonteCarloResult& one) { return one.unfinished.value; });
  result["photons"] = read_array(traced, stacks.shape, [](const MonteCarloResult& one) {
    return static_cast<double>(one.photons);
  });
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

}  // namespace

void bind_slab(py::module_& module) {
  module.def("slab_by_radiative_transfer", &slab_by_radiative_transfer);
  module.def("slab_with_derivatives", &with_derivatives);
  module.def("slab_by_diffusion", &slab_by_diffusion);
  module.def("slab_by_monte_carlo", &slab_by_monte_carlo);
}

}  // namespace lamina::python
