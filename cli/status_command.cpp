// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "cluster_files.h"
#include "cluster_state.h"
#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/shell_text.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;
using Is = PartState::Is;

struct StatusOptions {
  std::string folder, json;
};

/// "40 s", "12 min", "3.4 h".
std::string time_text(double seconds) {
  if (seconds < 99.5) return fmt::format("{:.0f} s", seconds);
  if (seconds < 99.5 * 60) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string why(const PartState& part) {
  if (part.is == Is::failed) return fmt::format("failed with exit code {}", part.exit_code);
  if (part.is == Is::killed) return fmt::format("killed on {}", part.host);
  return "not started";
}

std::string name_of(Is is) {
  switch (is) {
    case Is::not_started:
      return "not started";
    case Is::waiting:
      return "waiting";
    case Is::running:
      return "running";
    case Is::done:
      return "done";
    case Is::failed:
      return "failed";
    case Is::killed:
      return "killed";
  }
  return "";
}

std::string missing_text(const ClusterState& state, const ClusterFiles& files,
                         const std::vector<int>& missing) {
  constexpr std::size_t most_told = 20;
  std::string text;
  for (std::size_t i = 0; i < missing.size() && i < most_told; ++i) {
    const std::string name = fmt::format("{}", missing[i]);
    const bool has_log = fs::exists(files.log(name));
    text += fmt::format("  {}: {}{}: sh {} {}\n", name,
                        why(state.shards[static_cast<std::size_t>(missing[i])]),
                        has_log ? ", " + files.log(name).string() : "",
                        shell_quoted(files.script("shard").string()), name);
  }
  if (missing.size() > most_told)
    text += fmt::format("  and {} more\n", missing.size() - most_told);
  return text;
}

void run_status(const StatusOptions& options) {
  const ClusterFiles files(options.folder);
  if (!fs::exists(files.job()))
    throw InvalidInput(options.folder + ": must be the folder of a job, but holds no job.json");
  const ClusterJob job = load_cluster_job(files.job(), {});
  const ClusterState state = find_cluster_state(job, files);
  for (const std::string& warning : state.warnings) say("warning: " + warning);
  const auto done = state.shards_that_are({Is::done}).size();
  const auto running = state.shards_that_are({Is::running}).size();
  const auto waiting = state.shards_that_are({Is::waiting}).size();
  const std::vector<int> failed = state.shards_that_are({Is::failed, Is::killed});
  const std::vector<int> missing = state.shards_that_are({Is::failed, Is::killed, Is::not_started});
  const std::optional<double> left = state.seconds_left();

  JsonOutput json = make_result("status");
  json["folder"] = files.folder.string();
  json["shards"] = job.shards;
  json["done"] = done;
  json["running"] = running;
  json["waiting"] = waiting;
  json["failed"] = failed;
  json["missing"] = missing;
  if (left) json["seconds_left"] = *left;
  json["prepare"] = name_of(state.prepare.is);
  json["merge"] = name_of(state.merge.is);
  CommonOptions common;
  common.json = options.json;
  write_json(json, common);

  std::string text =
      fmt::format("{}: {} of {} shards done, {} running, {} waiting, {} failed, {} not started{}\n",
                  files.folder.filename().string(), done, job.shards, running, waiting,
                  failed.size(), missing.size() - failed.size(),
                  left && done < state.shards.size() && running + waiting > 0
                      ? "; about " + time_text(*left) + " left"
                      : "");
  if (state.prepare.is == Is::failed || state.prepare.is == Is::killed)
    text += fmt::format("the preparation {}: sh {}\n", why(state.prepare),
                        shell_quoted(files.script("prepare").string()));
  if (!missing.empty())
    text +=
        fmt::format("missing, with the command that makes each; lamina submit {} submits them:\n",
                    shell_quoted(fs::proximate(files.folder).string())) +
        missing_text(state, files, missing);
  const bool has_failed = state.merge.is == Is::failed || state.merge.is == Is::killed;
  if (has_failed || state.merge.is == Is::not_started) {
    if (has_failed) text += "merge: " + why(state.merge) + "\n";
    if (done == state.shards.size())
      text +=
          fmt::format("the merge is left: sh {}\n", shell_quoted(files.script("merge").string()));
  } else {
    text += "merge: " + name_of(state.merge.is) + "\n";
  }
  print(common, text);
}

}  // namespace

void add_status_command(CLI::App& app) {
  auto options = std::make_shared<StatusOptions>();
  const Command command(app, "status",
                        "Tells how far a job of lamina submit is, and what makes what is missing.");
  command.add_option("folder", options->folder, "the job's folder, RESULT.job")
      .type_name("FOLDER")
      .required();
  command.add_output_file("--json", options->json,
                          "write the result as JSON to FILE, or - for stdout");
  command.footer(
      "Looks at the files of the job, and asks Slurm's squeue where it was submitted.\n"
      "Example: lamina status sphere.job");
  command.callback([options] { run_status(*options); });
}

}  // namespace lamina::cli
