// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>

#include "commands.h"
#include "console.h"
#include "fit_shard.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/folder_names.h"
#include "merge_options.h"
#include "photons_report.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

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

void merge_photons(const MergeOptions& options) {
  std::vector<PhotonRun> sum = load_photon_runs(options.files[0], options.common.memory);
  for (std::size_t i = 1; i < options.files.size(); ++i)
    add_runs(sum, load_photon_runs(options.files[i], options.common.memory), options.files[i]);
  const std::set<int>& done = sum[0].shards;
  const int of = sum[0].of;
  std::vector<int> missing;
  for (int i = 0; i < of; ++i)
    if (!done.contains(i)) missing.push_back(i);
  report_missing(missing, of, options.needs_all,
                 [](int) { return std::vector<std::string>(); });  // the files do not say
  if (missing.empty())
    for (PhotonRun& run : sum) run.shards = {0}, run.of = 1;
  print_photon_runs(sum, "merge", options.common, true, options.plot);
}

/// The files, and in place of folders the shards in them.
std::vector<std::string> found_files(const std::vector<std::string>& named) {
  std::vector<std::string> files;
  for (const std::string& name : named) {
    std::error_code error;
    if (!fs::is_directory(name, error)) {
      files.push_back(name);
      continue;
    }
    const std::size_t before = files.size();
    for (const std::string& inside : folder_names(name, error))
      if (inside.ends_with(".shard")) files.push_back((fs::path(name) / inside).string());
    if (error) throw FileError(name + ": " + error.message());
    if (files.size() == before) throw InvalidInput(name + ": holds no file that ends in .shard");
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  return files;
}

void refuse(const Command& command, const std::vector<std::string_view>& names,
            const std::string& why) {
  for (const std::string_view name : names)
    if (command.is_given(std::string(name))) throw InvalidInput(fmt::format("{}: {}", name, why));
}

/// The options that only pictures have.
std::vector<std::string_view> of_pictures() {
  std::vector<std::string_view> names = {"--channels", "--noise", "--denoise"};
  names.insert(names.end(), look_option_names.begin(), look_option_names.end());
  return names;
}

void run_merge(MergeOptions& options, const Command& command) {
  options.files = found_files(options.files);
#ifdef LAMINA_RENDER
  if (is_render_shard(options.files[0])) {
    refuse(command, {"--plot"}, "is for shards of photons, but these are of a picture");
    return merge_render(options);
  }
#endif
  if (is_fit_shard(options.files[0], options.common.memory)) {
    refuse(command, {"--plot"}, "is not for shards of fits, which these are");
    refuse(command, of_pictures(), "is not for shards of fits, which these are");
    if (!options.output.empty() && lower_case_ending(options.output) != ".csv")
      throw InvalidInput("--output: must end in .csv, the table of fits, but is " + options.output);
    require_different({{"--output", options.output}, {"--json", options.common.json}});
    return merge_fits(options);
  }
  refuse(command, {"--output"}, "is for shards of a picture, but these are of photons");
  refuse(command, of_pictures(), "is for shards of a picture, but these are of photons");
  merge_photons(options);
}

}  // namespace

void report_missing(const std::vector<int>& missing, int of, bool needs_all,
                    const std::function<std::vector<std::string>(int shard)>& make) {
  if (missing.empty()) return;
  constexpr std::size_t most_told = 20;
  std::vector<std::string> told;
  for (const int shard : missing) {
    if (told.size() == most_told) break;
    told.push_back(fmt::format("{}/{}", shard, of));
  }
  const std::string what =
      fmt::format("{} of {} shards are missing: {}{}", missing.size(), of, fmt::join(told, ", "),
                  missing.size() > told.size() ? ", ..." : "");
  for (std::size_t i = 0; i < told.size(); ++i) {
    const std::vector<std::string> words = make(missing[i]);
    if (!words.empty()) say("missing: " + command_line(words));
  }
  if (needs_all) throw FileError(what);
  say("warning: " + what);
}

void add_merge_command(CLI::App& app) {
  auto options = std::make_shared<MergeOptions>();
  const Command command(app, "merge",
                        "Adds the shards of photon runs, of pictures and of fits; all of them make "
                        "the whole, bit by bit.");
  command
      .add_option(
          "files", options->files,
          "what `lamina photons --shard I/N --json`, `lamina render --shard I/N` or `lamina fit "
          "--batch --shard I/N --json` wrote, in any order, or folders of files that end in "
          ".shard")
      .required()
      .type_name("FILE");
  command.add_flag("--all", options->needs_all,
                   "ends with exit code 2 where shards are missing, in place of a warning");
  command
      .add_option("-o,--output", options->output,
                  "IMAGE as of `lamina render`; or X.shard, which holds the sums of all files and "
                  "can be merged again; of fits the table, .csv")
      .type_name("FILE");
  command
      .add_option("--channels", options->channels,
                  "of IMAGE.exr, as in R,G,B,variance; all, if it is not given. Colors and noise "
                  "alone take less memory and time")
      .type_name("NAME,NAME,...")
      .delimiter(',')
      .group("Pictures");
  command
      .add_option("--noise", options->noise,
                  "says where the standard error is above this fraction of the brightness, and how "
                  "many samples would do; exit code 1 then, with the picture written")
      .type_name("X")
      .range(0.0, 1.0)
      .group("Pictures");
  command
      .add_flag("--denoise", options->denoises,
                "averages over what looks alike within the noise, as `lamina render` does")
      .group("Pictures");
  add_look_options(command, options->look);
  command
      .add_output_file("--plot", options->plot, "plot of R(r), R(angle) and R(t), as SVG", ".svg")
      .group("Photons");
  add_common_options(command, options->common);
  command.footer(
      "Shards of other scenes, seeds, versions or splits, and samples that are there twice, are "
      "refused by name.\n"
      "Example: two machines share a run\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 0/2 --json a.json\n"
      "  lamina photons donner_jensen_skin --photons 1e9 --shard 1/2 --json b.json\n"
      "  lamina merge a.json b.json --json all.json\n"
      "and a picture\n"
      "  lamina render scenes/sphere_skin.json --shard 0/2 -o a.shard\n"
      "  lamina render scenes/sphere_skin.json --shard 1/2 -o b.shard\n"
      "  lamina merge a.shard b.shard -o sphere.png");
  command.callback([options, command] { run_merge(*options, command); });
}

}  // namespace lamina::cli
