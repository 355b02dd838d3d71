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

/// Adds the runs of one file to the sum. `done` holds the shards that the sum has.
void add_runs(std::vector<PhotonRun>& sum, const std::vector<PhotonRun>& runs,
              const std::string& file, std::set<int>& done) {
  if (runs.size() != sum.size())
    throw InvalidInput(fmt::format("{}: must have {} runs, as the files before it, but has {}",
                                   file, sum.size(), runs.size()));
  if (runs[0].shards != sum[0].shards)
    throw InvalidInput(
        fmt::format("{}: must be a shard of {}, as the files before it, but is of {}", file,
                    sum[0].shards, runs[0].shards));
  if (!done.insert(runs[0].shard).second)
    throw InvalidInput(fmt::format("{}: shard {}/{} must be given once, but is given twice", file,
                                   runs[0].shard, runs[0].shards));
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (runs[i].counts.size() != sum[i].counts.size())
      throw InvalidInput(fmt::format("{}: must have {} bands, but has {}", file,
                                     sum[i].counts.size(), runs[i].counts.size()));
    for (std::size_t band = 0; band < sum[i].counts.size(); ++band) {
      try {
        sum[i].counts[band] = merge(sum[i].counts[band], runs[i].counts[band]);
      } catch (const InvalidInput& error) {
        throw InvalidInput(file + ": " + error.what());
      }
    }
  }
}

void run_merge(const MergeOptions& options) {
  std::vector<PhotonRun> sum = load_photon_runs(options.files[0], options.common.memory);
  std::set<int> done = {sum[0].shard};
  for (std::size_t i = 1; i < options.files.size(); ++i)
    add_runs(sum, load_photon_runs(options.files[i], options.common.memory), options.files[i],
             done);
  const int shards = sum[0].shards;
  const bool is_whole = static_cast<int>(done.size()) == shards;
  if (!is_whole) {
    std::vector<std::string> missing;
    for (int i = 0; i < shards && missing.size() < 20; ++i)
      if (!done.contains(i)) missing.push_back(fmt::format("{}/{}", i, shards));
    const std::size_t absent = static_cast<std::size_t>(shards) - done.size();
    say(fmt::format("warning: {} of {} shards are missing: {}{}", absent, shards,
                    fmt::join(missing, ", "), absent > missing.size() ? ", ..." : ""));
  }
  for (PhotonRun& run : sum) {
    if (is_whole) run.shard = 0, run.shards = 1;
    if (!is_whole) run.name += fmt::format(" ({} of {} shards)", done.size(), shards);
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
  command.add_output_file("--plot", options->plot, "plot of R(r), or of R(angle), as SVG", ".svg");
  add_common_options(command, options->common);
  command.footer(
      "Example: two machines share a run\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 0/2 --json a.json\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 1/2 --json b.json\n"
      "  lamina merge a.json b.json --json all.json");
  command.callback([options] { run_merge(*options); });
}

}  // namespace lamina::cli
