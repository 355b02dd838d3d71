// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Runs of MCML's input files.
#include <fmt/format.h>

#include <ctime>
#include <filesystem>

#include "lamina/base/core/error.h"
#include "lamina/base/io/write_places.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"
#include "lamina/solve/scattering/monte_carlo/mcml_output.h"
#include "photons_options.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// Where a run is in its file, for messages.
std::string place_of(const PhotonsOptions& options, const McmlRun& run) {
  return fmt::format("{}:{}: ", options.material, run.line);
}

/// Before the work: where the runs write. The file that names the places may come from anywhere, so
/// that they stay inside the folder of --output, which is made if need be.
std::vector<std::string> output_files(const PhotonsOptions& options,
                                      const std::vector<McmlRun>& runs) {
  const fs::path folder = options.output;
  make_folder(folder);
  std::vector<std::string> files;
  std::vector<NamedFile> named = {{"the input", options.material},
                                  {"--json", options.common.json},
                                  {"--plot", options.plot},
                                  {"--checkpoint", options.checkpoint}};
  for (const McmlRun& run : runs) {
    const fs::path file = folder / run.output_file;
    if (fs::path(run.output_file).is_absolute() || !is_inside(file, folder) ||
        is_inside(folder, file))
      throw InvalidInput(
          fmt::format("{}the output file must be inside the folder of --output, {}, but is {}",
                      place_of(options, run), folder.string(), run.output_file));
    if (!is_utf8(run.output_file))
      throw InvalidInput(place_of(options, run) + "the name of the output file must be UTF-8");
    named.push_back({fmt::format("the output of line {}", run.line), file.string()});
    try {
      require_different(named);
    } catch (const InvalidInput& error) {
      throw InvalidInput(place_of(options, run) + error.what());
    }
    make_folder(file.parent_path());
    require_writable(file.string());
    files.push_back(file.string());
  }
  return files;
}

MonteCarloOptions options_of(const PhotonsOptions& options, const McmlRun& run, std::size_t index) {
  MonteCarloOptions photons = monte_carlo_options(run);
  const MonteCarloOptions asked = monte_carlo_options(options.effort, options.common, index);
  if (options.effort.photons) photons.photons = asked.photons;
  photons.seed = asked.seed;
  photons.relative_error = asked.relative_error;
  photons.seconds = asked.seconds;
  photons.max_events = options.max_events;
  photons.shard = read_shard(options.shard);
  return photons;
}

}  // namespace

void trace_mcml(const PhotonsOptions& options, PhotonWork& work) {
  const std::vector<McmlRun> asked_for = load_mcml(options.material, options.common.memory);
  const std::vector<std::string> files = output_files(options, asked_for);
  std::size_t cells = 0;
  for (const McmlRun& run : asked_for)
    cells += cells_of(monte_carlo_options(run).tallies, run.layers.size());
  require_readable(options, cells);
  for (std::size_t i = 0; i < asked_for.size() && !was_interrupted(); ++i) {
    const McmlRun& run = asked_for[i];
    MonteCarloOptions photons = options_of(options, run, i);
    photons.progress = make_progress(run.output_file);
    const std::clock_t start = std::clock();
    try {
      work.count({.run = i, .name = run.output_file, .band = 0, .band_name = ""}, layer_stack(run),
                 photons);
    } catch (const InvalidInput& error) {
      throw InvalidInput(place_of(options, run) + error.what());
    }
    if (photons.shard.count > 1) continue;
    const PhotonCounts& counts = work.runs()[i].counts[0];
    McmlRun counted = run;
    counted.photons = counts.photons;
    write_file(files[i], format_mcml(counted, summarize(counts),
                                     static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC));
  }
}

}  // namespace lamina::cli
