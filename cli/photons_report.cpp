// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "photons_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "lamina/base/core/number_text.h"

namespace lamina::cli {
namespace {

using Results = std::vector<MonteCarloResult>;
using Pick = std::function<const Estimate&(const MonteCarloResult&, std::size_t)>;

/// Estimates as nested arrays of these sizes, the band last.
JsonOutput nested(const Results& results, const Pick& pick, std::span<const std::size_t> sizes,
                  bool is_error, std::size_t first = 0) {
  JsonOutput array = JsonOutput::array();
  if (sizes.empty()) {
    for (const MonteCarloResult& result : results) {
      const Estimate& estimate = pick(result, first);
      array.push_back(is_error ? estimate.standard_error : estimate.value);
    }
    return array;
  }
  std::size_t stride = 1;
  for (const std::size_t size : sizes.subspan(1)) stride *= size;
  for (std::size_t i = 0; i < sizes[0]; ++i)
    array.push_back(nested(results, pick, sizes.subspan(1), is_error, first + i * stride));
  return array;
}

/// Adds a tally and its standard error.
void add(JsonOutput& to, const std::string& name, const Results& results, const Pick& pick,
         const std::vector<std::size_t>& sizes = {}) {
  to[name] = nested(results, pick, sizes, false);
  to["standard_error"][name] = nested(results, pick, sizes, true);
}

template <class Member>
void add_total(JsonOutput& to, const std::string& name, const Results& results, Member member) {
  add(to, name, results,
      [member](const MonteCarloResult& r, std::size_t) -> const Estimate& { return r.*member; });
}

template <class Member>
void add_grid(JsonOutput& to, const std::string& name, const Results& results, Member member,
              const std::vector<std::size_t>& sizes) {
  add(
      to, name, results,
      [member](const MonteCarloResult& r, std::size_t i) -> const Estimate& {
        return (r.*member)[i];
      },
      sizes);
}

/// Reflected and transmitted light as two tallies.
void add_sides(JsonOutput& to, const std::string& name, const Results& results,
               TwoSided MonteCarloResult::*member, const std::vector<std::size_t>& sizes) {
  add(
      to, name + "_reflected", results,
      [member](const MonteCarloResult& r, std::size_t i) -> const Estimate& {
        return (r.*member).reflection[i];
      },
      sizes);
  add(
      to, name + "_transmitted", results,
      [member](const MonteCarloResult& r, std::size_t i) -> const Estimate& {
        return (r.*member).transmission[i];
      },
      sizes);
}

/// Amplitudes and phases as two tallies.
void add_modulation(
    JsonOutput& to, const std::string& amplitude, const std::string& phase, const Results& results,
    const std::function<const Modulation&(const MonteCarloResult&, std::size_t)>& at,
    const std::vector<std::size_t>& sizes) {
  add(
      to, amplitude, results,
      [&](const MonteCarloResult& r, std::size_t i) -> const Estimate& {
        return at(r, i).amplitude;
      },
      sizes);
  add(
      to, phase, results,
      [&](const MonteCarloResult& r, std::size_t i) -> const Estimate& { return at(r, i).phase; },
      sizes);
}

void add_modulated_sides(JsonOutput& to, const std::string& amplitude, const std::string& phase,
                         const Results& results, TwoSidedModulation MonteCarloResult::*member,
                         const std::vector<std::size_t>& sizes) {
  for (const bool is_reflected : {true, false}) {
    const std::string side = is_reflected ? "_reflected" : "_transmitted";
    add_modulation(
        to, amplitude + side, phase + side, results,
        [&](const MonteCarloResult& r, std::size_t i) -> const Modulation& {
          const TwoSidedModulation& both = r.*member;
          return (is_reflected ? both.reflection : both.transmission)[i];
        },
        sizes);
  }
}

std::vector<double> middles(int count, double width) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back((i + 0.5) * width);
  return values;
}

std::size_t size_of(int count) { return static_cast<std::size_t>(std::max(count, 1)); }

/// Light by radius, angle and depth.
void add_places(JsonOutput& to, const PhotonTallies& t, const Results& results) {
  if (t.r.count > 0) to["r_mm"] = middles(t.r.count, t.r.width);
  if (t.angles > 0) to["theta_deg"] = middles(t.angles, 90.0 / t.angles);
  if (t.depth.count > 0) to["z_mm"] = middles(t.depth.count, t.depth.width);
  if (t.r.count > 0)
    add_sides(to, "radial", results, &MonteCarloResult::radial, {size_of(t.r.count)});
  if (t.angles > 0)
    add_sides(to, "angular", results, &MonteCarloResult::angular, {size_of(t.angles)});
  if (t.r.count > 0 && t.angles > 0)
    add_sides(to, "radial_angular", results, &MonteCarloResult::radial_angular,
              {size_of(t.r.count), size_of(t.angles)});
  if (t.log_r.count > 0) {
    std::vector<double> edges;
    for (int i = 0; i <= t.log_r.count; ++i)
      edges.push_back(t.log_r.low *
                      std::pow(t.log_r.high / t.log_r.low, static_cast<double>(i) / t.log_r.count));
    to["log_r_edges_mm"] = edges;
    add_sides(to, "log_radial", results, &MonteCarloResult::log_radial, {size_of(t.log_r.count)});
    add_sides(to, "log_radial_outside", results, &MonteCarloResult::log_radial_outside, {2});
  }
  if (t.r.count > 0 && t.depth.count > 0) {
    add_grid(to, "absorption", results, &MonteCarloResult::absorption,
             {size_of(t.r.count), size_of(t.depth.count)});
    if (t.fluence)
      add_grid(to, "fluence", results, &MonteCarloResult::fluence,
               {size_of(t.r.count), size_of(t.depth.count)});
  }
}

/// Light by both angles and by the number of times that it was scattered.
void add_scattering(JsonOutput& to, const PhotonTallies& t, const Results& results) {
  if (t.bsdf_cosines > 0) {
    to["bsdf_cos_theta"] = middles(t.bsdf_cosines, 1.0 / t.bsdf_cosines);
    to["bsdf_phi_deg"] =
        middles(std::max(t.bsdf_azimuths, 1), 360.0 / std::max(t.bsdf_azimuths, 1));
    add_sides(to, "bsdf", results, &MonteCarloResult::bsdf,
              {size_of(t.bsdf_cosines), size_of(t.bsdf_azimuths)});
    if (t.orders)
      add_sides(to, "bsdf_by_order", results, &MonteCarloResult::bsdf_by_order,
                {std::size_t{photon_orders}, size_of(t.bsdf_cosines), size_of(t.bsdf_azimuths)});
  }
  if (t.orders) {
    add_sides(to, "by_order", results, &MonteCarloResult::by_order, {std::size_t{photon_orders}});
    if (t.angles > 0)
      add_sides(to, "angular_by_order", results, &MonteCarloResult::angular_by_order,
                {std::size_t{photon_orders}, size_of(t.angles)});
  }
}

/// Light by the length and time of its path, and as modulated light.
void add_times(JsonOutput& to, const PhotonTallies& t, const Results& results) {
  if (t.mean_path_length || t.path_length.count > 0) {
    add_total(to, "mean_path_reflected_mm", results, &MonteCarloResult::mean_path_reflected);
    add_total(to, "mean_path_transmitted_mm", results, &MonteCarloResult::mean_path_transmitted);
  }
  if (t.path_length.count > 0) {
    to["path_mm"] = middles(t.path_length.count, t.path_length.width);
    add_sides(to, "path_length", results, &MonteCarloResult::path_length,
              {size_of(t.path_length.count)});
  }
  if (t.time.count > 0) {
    to["time_ps"] = middles(t.time.count, t.time.width);
    add_total(to, "mean_time_reflected_ps", results, &MonteCarloResult::mean_time_reflected);
    add_total(to, "mean_time_transmitted_ps", results, &MonteCarloResult::mean_time_transmitted);
    for (const bool is_reflected : {true, false})
      add(to, is_reflected ? "mean_layer_path_reflected_mm" : "mean_layer_path_transmitted_mm",
          results,
          [&](const MonteCarloResult& r, std::size_t layer) -> const Estimate& {
            const TwoSided& both = r.mean_layer_path;
            return (is_reflected ? both.reflection : both.transmission)[layer];
          },
          {results[0].mean_layer_path.reflection.size()});
    add_sides(to, "time", results, &MonteCarloResult::time, {size_of(t.time.count)});
    if (t.r.count > 0)
      add_sides(to, "radial_time", results, &MonteCarloResult::radial_time,
                {size_of(t.r.count), size_of(t.time.count)});
  }
  if (!t.frequencies.empty()) {
    to["frequency_mhz"] = t.frequencies;
    add_modulated_sides(to, "amplitude", "phase_rad", results, &MonteCarloResult::modulation,
                        {t.frequencies.size()});
    if (t.r.count > 0)
      add_modulated_sides(to, "radial_amplitude", "radial_phase_rad", results,
                          &MonteCarloResult::radial_modulation,
                          {size_of(t.r.count), t.frequencies.size()});
  }
}

void add_detectors(JsonOutput& to, const PhotonTallies& t, const Results& results) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  if (!t.detectors.empty()) {
    to["detectors_mm"] = t.detectors;
    add_grid(to, "detectors", results, &MonteCarloResult::detectors, {t.detectors.size()});
    if (t.time.count > 0)
      add_grid(to, "detectors_time", results, &MonteCarloResult::detector_time,
               {t.detectors.size(), size_of(t.time.count)});
    if (!t.frequencies.empty())
      add_modulation(to, "detectors_amplitude", "detectors_phase_rad", results,
                     [](const MonteCarloResult& r, std::size_t i) -> const Modulation& {
                       return r.detector_modulation[i];
                     },
                     {t.detectors.size(), t.frequencies.size()});
  }
  if (!t.directions.empty()) {
    JsonOutput list = JsonOutput::array();
    for (const ExitDirection& d : t.directions)
      list.push_back({{"theta_deg", d.theta * degrees},
                      {"phi_deg", d.phi * degrees},
                      {"side", d.is_below ? "below" : "above"}});
    to["directions"] = list;
    add_grid(to, "direction_bsdf", results, &MonteCarloResult::directions,
             {t.directions.size()});
  }
}

/// The names and units of the grids are those of docs/photons.md.
void add_tallies(JsonOutput& to, const PhotonTallies& t, const Results& results) {
  add_places(to, t, results);
  add_scattering(to, t, results);
  add_times(to, t, results);
  add_detectors(to, t, results);
}

JsonOutput band_list(const std::vector<std::string>& bands) {
  JsonOutput list = JsonOutput::array();
  for (const std::string& band : bands) {
    const bool is_wavelength = band.size() > 1;
    if (is_wavelength)
      list.push_back(rounded_number(band));
    else
      list.push_back(band);
  }
  return list;
}

Results summaries(const PhotonRun& run) {
  Results results;
  for (const PhotonCounts& counts : run.counts) results.push_back(summarize(counts));
  return results;
}

}  // namespace

std::string title_of(const PhotonRun& run) {
  const bool is_whole = static_cast<int>(run.shards.size()) == run.of;
  return is_whole ? run.name
                  : fmt::format("{} ({} of {} shards)", run.name, run.shards.size(), run.of);
}

JsonOutput photon_json(const PhotonRun& run) {
  const Results results = summaries(run);
  JsonOutput to;
  to["method"] = "monte_carlo";
  to["material"] = title_of(run);
  to["bands"] = band_list(run.bands);
  JsonOutput photons = JsonOutput::array(), stopped = JsonOutput::array(),
             events = JsonOutput::array();
  for (const MonteCarloResult& result : results) {
    photons.push_back(result.photons);
    events.push_back(result.events);
    stopped.push_back(result.was_stopped);
  }
  to["photons"] = photons;
  to["events"] = events;
  to["was_stopped"] = stopped;
  to["standard_error"] = JsonOutput::object();
  add_total(to, "specular_reflectance", results, &MonteCarloResult::specular_reflectance);
  add_total(to, "diffuse_reflectance", results, &MonteCarloResult::diffuse_reflectance);
  add_total(to, "transmittance", results, &MonteCarloResult::transmittance);
  add_total(to, "unscattered_reflectance", results, &MonteCarloResult::unscattered_reflectance);
  add_total(to, "unscattered_transmittance", results, &MonteCarloResult::unscattered_transmittance);
  add_grid(to, "absorptance", results, &MonteCarloResult::absorptance, {run.counts[0].layers});
  add_total(to, "unfinished", results, &MonteCarloResult::unfinished);
  add_tallies(to, run.counts[0].tallies, results);
  // Errors last: people read the values first.
  JsonOutput errors = to["standard_error"];
  to.erase("standard_error");
  to["standard_error"] = errors;
  return to;
}

std::string photon_text(const PhotonRun& run) {
  const Results results = summaries(run);
  std::string text = title_of(run) + "\n" + fmt::format("{:<26}", "");
  for (const std::string& band : run.bands) text += fmt::format("  {:>20}", band);
  text += "\n";
  const auto row = [&](const std::string& name, const Pick& pick, std::size_t index = 0) {
    text += fmt::format("{:<26}", name);
    for (const MonteCarloResult& result : results) {
      const Estimate& e = pick(result, index);
      text += fmt::format("  {:>10.6f} ±{:>8.1e}", e.value, e.standard_error);
    }
    text += "\n";
  };
  const auto total = [&](const std::string& name, Estimate MonteCarloResult::*member) {
    row(name,
        [member](const MonteCarloResult& r, std::size_t) -> const Estimate& { return r.*member; });
  };
  total("specular reflectance", &MonteCarloResult::specular_reflectance);
  total("diffuse reflectance", &MonteCarloResult::diffuse_reflectance);
  total("transmittance", &MonteCarloResult::transmittance);
  total("  unscattered", &MonteCarloResult::unscattered_transmittance);
  for (std::size_t i = 0; i < run.counts[0].layers; ++i)
    row(
        fmt::format("absorptance, layer {}", i),
        [](const MonteCarloResult& r, std::size_t k) -> const Estimate& {
          return r.absorptance[k];
        },
        i);
  if (std::ranges::any_of(results, [](const auto& r) { return r.unfinished.value > 0.0; }))
    total("unfinished", &MonteCarloResult::unfinished);
  text += fmt::format("{:<26}", "photons");
  for (const MonteCarloResult& result : results)
    text += fmt::format(
        "  {:>20}", fmt::format("{}{}", result.photons, result.was_stopped ? " (stopped)" : ""));
  return text + "\n";
}

void print_photon_runs(const std::vector<PhotonRun>& runs, const std::string& command,
                       const CommonOptions& options, bool with_counts, const std::string& plot) {
  std::string text;
  for (const PhotonRun& run : runs) text += (text.empty() ? "" : "\n") + photon_text(run);
  if (!options.json.empty()) {
    JsonOutput result = make_result(command);
    JsonOutput list = JsonOutput::array();
    for (const PhotonRun& run : runs) list.push_back(photon_json(run));
    // One material: its fields stand at the top, as in the other commands. Runs of MCML: a list.
    if (list.size() == 1)
      result.update(list.front());
    else
      result["runs"] = list;
    if (with_counts) result["counts"] = counts_json(runs);
    write_json(result, options);
  }
  if (!plot.empty() && !runs.empty()) plot_photons(runs[0], plot);
  print(options, text);
}

}  // namespace lamina::cli
