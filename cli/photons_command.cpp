// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numbers>

#include "commands.h"
#include "console.h"
#include "degrees.h"
#include "incidence_option.h"
#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/layers/materials/material.h"
#include "material_bands.h"
#include "photons_options.h"

namespace lamina::cli {
namespace {

constexpr std::string_view tally_names[] = {"r",    "angle",  "rz",   "fluence", "log_r",
                                            "bsdf", "orders", "path", "time"};

void read_tallies(const PhotonsOptions& options, PhotonTallies& t) {
  for (const std::string& name : options.tallies) {
    if (name == "r")
      t.r = {options.r_bins, options.dr};
    else if (name == "angle")
      t.angles = options.angles;
    else if (name == "rz" || name == "fluence") {
      t.r = {options.r_bins, options.dr};
      t.depth = {options.z_bins, options.dz};
      t.fluence = t.fluence || name == "fluence";
    } else if (name == "log_r")
      t.log_r = {options.log_bins, options.log_r[0], options.log_r[1]};
    else if (name == "bsdf") {
      t.bsdf_cosines = options.cosines;
      t.bsdf_azimuths = options.azimuths;
    } else if (name == "orders")
      t.orders = true;
    else if (name == "path") {
      t.path_length = {options.path_bins, options.dl};
      t.mean_path_length = true;
    } else if (name == "time")
      t.time = {options.time_bins, options.dt};
    else
      throw InvalidInput(
          fmt::format("--tally: unknown tally \"{}\"{}", name, did_you_mean(name, tally_names)));
  }
  t.frequencies = options.frequencies;
  t.detectors = options.detectors;
  if (!t.detectors.empty()) t.detector_width = options.detector_width;
  if (options.directions.size() % 2 != 0)
    throw InvalidInput("--direction: must be pairs THETA PHI in degrees, but one is left over");
  for (std::size_t i = 0; i < options.directions.size(); i += 2) {
    const double theta = options.directions[i];
    if (!(theta >= 0.0 && theta < 180.0 && theta != 90.0))
      throw InvalidInput(fmt::format(
          "--direction: THETA must lie in [0, 180) and not be 90 degrees, but is {}", theta));
    t.directions.push_back({.theta = (theta < 90.0 ? theta : 180.0 - theta) * degree,
                            .phi = options.directions[i + 1] * degree,
                            .is_below = theta > 90.0});
  }
}

MonteCarloOptions read_options(const PhotonsOptions& options, std::size_t band) {
  MonteCarloOptions o = monte_carlo_options(options.effort, options.common, band);
  o.incidence = parse_incidence(options.incidence);
  if (options.beam != Beam::Shape::pencil) o.beam = {options.beam, options.beam_radius};
  o.shard = read_shard(options.shard);
  o.max_events = options.max_events;
  read_tallies(options, o.tallies);
  return o;
}

bool is_mcml(const PhotonsOptions& options) {
  return std::filesystem::path(options.material).extension() == ".mci";
}

/// @throws InvalidInput if an option was given that nothing would read.
void check_options(const Command& command, const PhotonsOptions& options) {
  const auto is_given = [&](const std::string& name) { return command.is_given(name); };
  const auto refuse = [&](const std::string& name, const std::string& reason) {
    if (is_given(name)) throw InvalidInput(name + ": " + reason);
  };
  if (is_mcml(options))
    for (const char* name : {"--tally", "--incidence", "--beam", "--detector", "--direction",
                             "--frequency", "--bands", "--set", "--check"})
      refuse(name, "must be left out for a .mci file, which says what to count");
  else
    refuse("--output", "is for the .mco files of a .mci file; --json writes all other results");
  if (read_shard(options.shard).count > 1 && options.common.json.empty())
    refuse("--shard", "needs --json FILE, which keeps the part for `lamina merge`");
  const std::vector<MethodOption> needs = {{"--r-bins", {"r", "rz", "fluence"}},
                                           {"--dr", {"r", "rz", "fluence"}},
                                           {"--z-bins", {"rz", "fluence"}},
                                           {"--dz", {"rz", "fluence"}},
                                           {"--angle-bins", {"angle"}},
                                           {"--log-bins", {"log_r"}},
                                           {"--log-range", {"log_r"}},
                                           {"--bsdf-cosines", {"bsdf"}},
                                           {"--bsdf-azimuths", {"bsdf"}},
                                           {"--path-bins", {"path"}},
                                           {"--dl", {"path"}},
                                           {"--time-bins", {"time"}},
                                           {"--dt", {"time"}}};
  for (const auto& [name, tallies] : needs)
    if (std::ranges::find_first_of(tallies, options.tallies) == tallies.end())
      refuse(name, fmt::format("needs --tally {}, which is not given", fmt::join(tallies, " or ")));
  const std::vector<std::string> plotted = {"r", "angle", "time"};
  if (!is_mcml(options) && std::ranges::find_first_of(plotted, options.tallies) == plotted.end())
    refuse("--plot", "needs --tally r, angle or time, which is not given");
  if (options.detectors.empty()) refuse("--detector-width", "needs --detector, which is not given");
  if (options.checkpoint.empty()) refuse("--resume", "needs --checkpoint FILE, which is not given");
  if (options.beam == Beam::Shape::pencil) refuse("--beam-radius", "needs --beam gaussian or flat");
}

/// The material, once all that is asked for of it can be done.
Material load_checked(const PhotonsOptions& options) {
  Material material =
      find_material_at({options.material, options.bands, options.settings}, options.common.memory);
  const PhotonTallies tallies = read_options(options, 0).tallies;
  require_readable(
      options, checked_product("the sums of all bands",
                               {material.bands.size(), cells_of(tallies, material.layers.size())}));
  return material;
}

/// Says what would be traced.
void print_check(const PhotonsOptions& options) {
  const Material material = load_checked(options);
  const double photons =
      options.effort.photons.value_or(static_cast<double>(read_options(options, 0).photons));
  JsonOutput json = make_result("photons");
  json["name"] = material.name;
  json["bands"] = material.bands.size();
  json["photons"] = photons;
  write_json(json, options.common);
  print(options.common, fmt::format("{}: {} bands, {:.4g} photons each\n", material.name,
                                    material.bands.size(), photons));
}

/// The bands of a material, one after the other.
void trace_material(const PhotonsOptions& options, PhotonWork& work) {
  const Material material = load_checked(options);
  const std::size_t bands = material.bands.size();
  for (std::size_t band = 0; band < bands && !was_interrupted(); ++band) {
    const std::string name = band_name(material.bands, band);
    MonteCarloOptions photons = read_options(options, band);
    photons.seconds /= static_cast<double>(bands);
    photons.progress = make_progress(fmt::format("band {}", name));
    work.count({.run = 0, .name = material.name, .band = band, .band_name = name},
               layer_stack(material, band), photons);
  }
}

void run_photons(const PhotonsOptions& options) {
  if (options.only_checks) return print_check(options);
  PhotonWork work(options);
  is_mcml(options) ? trace_mcml(options, work) : trace_material(options, work);
  print_photon_runs(work.runs(), "photons", options.common, writes_counts(options), options.plot);
  work.finish();  // not before the result is written
}

void add_tally_options(const Command& command, PhotonsOptions& options) {
  const std::string tallies = "Tallies";
  command
      .add_option("--tally", options.tallies,
                  "r, angle, rz, fluence, log_r, bsdf, orders, path, time; separated by commas")
      .delimiter(',')
      .group(tallies);
  const auto bins = [&](const char* name, int& value, const char* text) {
    command.add_option(name, value, text)
        .type_name("N")
        .range(1, 1'000'000'000)
        .group(tallies)
        .show_default();
  };
  const auto width = [&](const char* name, double& value, const char* text) {
    command.add_option(name, value, text).type_name("MM").length().group(tallies).show_default();
  };
  bins("--r-bins", options.r_bins, "rings of r");
  width("--dr", options.dr, "width of a ring");
  bins("--z-bins", options.z_bins, "layers of z");
  width("--dz", options.dz, "height of a layer");
  bins("--angle-bins", options.angles, "bins over 90 degrees");
  bins("--log-bins", options.log_bins, "bins of log_r");
  command.add_option("--log-range", options.log_r, "lowest and highest radius of log_r [mm]")
      .expected(2)
      .length()
      .group(tallies)
      .show_default();
  bins("--bsdf-cosines", options.cosines, "rows of bsdf");
  bins("--bsdf-azimuths", options.azimuths, "columns of bsdf");
  bins("--path-bins", options.path_bins, "bins of path length");
  width("--dl", options.dl, "width of a bin of path length");
  bins("--time-bins", options.time_bins, "bins of the time of flight");
  command.add_option("--dt", options.dt, "width of a bin of time")
      .type_name("PS")
      .range(1e-9, 1e9)
      .group(tallies)
      .show_default();
  command
      .add_option("--frequency", options.frequencies,
                  "frequencies of modulated light [MHz]: its amplitude and phase")
      .delimiter(',')
      .range(0.0, 1e6)
      .group(tallies);
  command.add_option("--detector", options.detectors, "distances of ring detectors [mm]")
      .delimiter(',')
      .range(0.0, 1e9)
      .group(tallies);
  width("--detector-width", options.detector_width, "width of their rings");
  command
      .add_option("--direction", options.directions,
                  "THETA PHI in degrees: radiance there by next-event estimation; THETA > 90 below")
      .group(tallies);
}

void add_output_options(const Command& command, PhotonsOptions& options) {
  const std::string output = "Output";
  command
      .add_option("-o,--output", options.output,
                  "folder of the .mco files of a .mci file, made if it is not there")
      .type_name("DIR")
      .group(output)
      .show_default();
  command.add_output_file("--plot", options.plot, "plot of R(r), R(angle) and R(t), as SVG", ".svg")
      .group(output);
  command
      .add_flag("--counts", options.with_counts,
                "put the raw sums into the JSON, for `lamina merge`; --shard does so too")
      .group(output);
  command
      .add_output_file(
          "--checkpoint", options.checkpoint,
          "keep the sums in FILE every half minute and when stopped, until all is done")
      .group(output);
  command
      .add_flag("--resume", options.resumes,
                "go on from the file of --checkpoint, if there is one; the result is that of a run "
                "that was not stopped")
      .group(output);
}

}  // namespace

void add_photons_command(CLI::App& app) {
  auto options = std::make_shared<PhotonsOptions>();
  const Command command(
      app, "photons",
      "Photon Monte Carlo through flat layers, with all tallies; reads MCML's files.");
  command
      .add_option("material", options->material, "built-in material, material file or MCML's .mci")
      .required()
      .type_name("MATERIAL|FILE.mci");
  add_material_options(command, options->bands, options->settings);
  add_effort_options(command, options->effort);
  command.add_option("--shard", options->shard, "do part I of N; `lamina merge` adds the parts")
      .type_name("I/N");
  command.add_option("--max-events", options->max_events, "give a photon up after so many events")
      .type_name("N")
      .range(1u, 4'000'000'000u)
      .show_default();
  command.add_flag("--check", options->only_checks,
                   "read the material and say what would be traced, without doing it");
  const std::string light = "Light";
  command.add_option("--incidence", options->incidence, "normal, diffuse or an angle in degrees")
      .group(light)
      .show_default();
  command.add_choice("--beam", options->beam, "irradiance over the surface").group(light);
  command.add_option("--beam-radius", options->beam_radius, "radius [mm]; gaussian: to 1/e^2")
      .length()
      .group(light);
  add_tally_options(command, *options);
  add_output_options(command, *options);
  add_common_options(command, options->common);
  command.footer(
      "Examples: reflected light by radius; MCML's file; half of a long run\n"
      "  lamina photons donner_jensen_skin --photons 1e6 --tally r,angle --json skin.json\n"
      "  lamina photons tissue.mci -o results\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 0/2 --json half.json");
  command.callback([options, command] {
    check_options(command, *options);
    run_photons(*options);
  });
}

}  // namespace lamina::cli
