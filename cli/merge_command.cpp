// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <set>

#include "commands.h"
#include "console.h"
#include "lamina/core/error.h"
#include "photons_report.h"

namespace lamina::cli {
namespace {

struct MergeOptions {
  CommonOptions common;
  std::vector<std::string> files;
  std::string plot;
};

/// Adds the runs of one file to the sum.
void add_runs(std::vector<PhotonRun>& sum, const std::vector<PhotonRun>& runs,
              const std::string& file) {
  if (runs.size() != sum.size())
    throw InvalidInput(fmt::format("{}: must have {} runs, as the files before it, but has {}",
                                   file, sum.size(), runs.size()));
  if (runs[0].of != sum[0].of)
    throw InvalidInput(
        fmt::format("{}: must be a shard of {}, as the files before it, but is of {}", file,
                    sum[0].of, runs[0].of));
  for (const int shard : runs[0].shards)
    if (sum[0].shards.contains(shard))
      throw InvalidInput(fmt::format("{}: shard {}/{} must be given once, but is given twice", file,
                                     shard, runs[0].of));
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (runs[i].bands != sum[i].bands || runs[i].name != sum[i].name)
      throw InvalidInput(fmt::format("{}: must be of the bands {} of {}, but is of {} of {}", file,
                                     fmt::join(sum[i].bands, " "), sum[i].name,
                                     fmt::join(runs[i].bands, " "), runs[i].name));
    for (std::size_t band = 0; band < sum[i].counts.size(); ++band) {
      try {
        sum[i].counts[band] = merge_counts(sum[i].counts[band], runs[i].counts[band]);
      } catch (const InvalidInput& error) {
        throw InvalidInput(file + ": " + error.what());
      }
    }
    sum[i].shards.insert(runs[i].shards.begin(), runs[i].shards.end());
  }
}

void run_merge(const MergeOptions& options) {
  std::vector<PhotonRun> sum = load_photon_runs(options.files[0], options.common.memory);
  for (std::size_t i = 1; i < options.files.size(); ++i)
    add_runs(sum, load_photon_runs(options.files[i], options.common.memory), options.files[i]);
  const std::set<int>& done = sum[0].shards;
  const int of = sum[0].of;
  const std::size_t absent = static_cast<std::size_t>(of) - done.size();
  if (absent > 0) {
    std::vector<std::string> missing;
    for (int i = 0; i < of && missing.size() < 20; ++i)
      if (!done.contains(i)) missing.push_back(fmt::format("{}/{}", i, of));
    say(fmt::format("warning: {} of {} shards are missing: {}{}", absent, of,
                    fmt::join(missing, ", "), absent > missing.size() ? ", ..." : ""));
  } else {
    for (PhotonRun& run : sum) run.shards = {0}, run.of = 1;
  }
  print_photon_runs(sum, "merge", options.common, true, options.plot);
}

}  // namespace

void add_merge_command(CLI::App& app) {
  auto options = std::make_shared<MergeOptions>();
  const Command command(app, "merge",
                        "Adds the shards of a photon run; all of them make the whole.");
  command.add_option("files", options->files, "what `lamina photons --shard I/N --json` wrote")
      .required()
      .type_name("FILE");
  command.add_output_file("--plot", options->plot, "plot of R(r), R(angle) and R(t), as SVG",
                          ".svg");
  add_common_options(command, options->common);
  command.footer(
      "Example: two machines share a run\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 0/2 --json a.json\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 1/2 --json b.json\n"
      "  lamina merge a.json b.json --json all.json");
  command.callback([options] { run_merge(*options); });
}

}  // namespace lamina::cli
