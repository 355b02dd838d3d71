// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "cluster_job.h"
#include "cluster_scripts.h"
#include "cluster_state.h"
#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/shell_text.h"
#include "lamina/base/io/write_places.h"
#include "run_program.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct SubmitOptions {
  std::string job, output, json;
  int shards = 0, cores = 1;
  std::string partition, time, memory;
  std::vector<std::string> sbatch;
  bool only_writes = false;
  Option cores_given;
};

/// A job as it was submitted, in its folder.
bool is_job_folder(const std::string& name) { return fs::exists(fs::path(name) / "job.json"); }

ClusterJob job_of(const SubmitOptions& options) {
  ClusterJob job;
  const bool is_file =
      lower_case_ending(options.job) == ".json" && options.job.find(' ') == std::string::npos;
  if (is_job_folder(options.job))
    job = load_cluster_job(fs::path(options.job) / "job.json", {});
  else if (fs::is_directory(options.job))
    throw InvalidInput(options.job + ": must hold a job.json, as lamina submit writes it");
  else if (is_file)
    job = load_cluster_job(options.job, {});
  else
    job = {.command = shell_words(options.job), .folder = fs::current_path().string()};
  if (!job.command.empty() && job.command[0] == "lamina") job.command.erase(job.command.begin());
  if (options.shards > 0) job.shards = options.shards;
  if (job.shards == 0)
    throw InvalidInput("--shards: must say into how many parts the work is split, but is missing");
  if (options.cores_given.is_given()) job.cores = options.cores;
  if (!options.partition.empty()) job.partition = options.partition;
  if (!options.time.empty()) job.time = options.time;
  if (!options.memory.empty()) job.memory = options.memory;
  if (!options.sbatch.empty()) job.sbatch = options.sbatch;
  return job;
}

/// That of the job, if it is known without its command.
fs::path given_folder(const SubmitOptions& options) {
  if (is_job_folder(options.job)) return fs::absolute(options.job);
  return options.output.empty() ? fs::path() : fs::absolute(options.output);
}

fs::path folder_of(const SubmitOptions& options, const ClusterJob& job, const ClusterPlan& plan) {
  if (const fs::path given = given_folder(options); !given.empty()) return given;
  return (fs::path(job.folder) / plan.result).replace_extension(".job");
}

/// What was split otherwise cannot be gone on with.
void require_same(const ClusterJob& job, const ClusterFiles& files) {
  if (!fs::exists(files.job())) return;
  const ClusterJob before = load_cluster_job(files.job(), {});
  if (before.command == job.command && before.folder == job.folder && before.shards == job.shards)
    return;
  throw InvalidInput(fmt::format(
      "{}: must be of this job, but holds {} shards of {}; name another folder by --output, or "
      "remove it",
      files.folder.string(), before.shards, command_line(before.command)));
}

void make_folders(const ClusterFiles& files) {
  for (const fs::path& folder : {files.shards(), files.folder / "log", files.folder / "state"})
    make_folder(folder);
}

std::string how_by_hand(const ClusterJob& job, const ClusterPlan& plan, const ClusterFiles& files) {
  const auto script = [&](const char* name) { return shell_quoted(files.script(name).string()); };
  return fmt::format("{}seq 0 {} | xargs -n 1 -P {} sh {} && sh {}",
                     plan.prepare.empty() ? "" : fmt::format("sh {} && ", script("prepare")),
                     job.shards - 1, std::max(1L, sysconf(_SC_NPROCESSORS_ONLN) / job.cores),
                     script("shard"), script("merge"));
}

void hand_over(const ClusterJob& job, const ClusterPlan& plan, const ClusterFiles& files) {
  if (!run_program({"sbatch", "--version"}, files.folder.string()))
    throw std::runtime_error(
        "sbatch: there is no such program here, so that nothing was submitted; by hand: " +
        how_by_hand(job, plan, files));
  const auto run = run_program({"sh", files.script("submit").string()}, files.folder.string());
  if (run && run->exit_code == 0) return;
  std::string errors = run ? run->errors : "sh: there is no such program";
  while (errors.ends_with('\n')) errors.pop_back();
  std::ranges::replace(errors, '\n', ' ');
  throw std::runtime_error(fmt::format("{}: {}", files.script("submit").string(), errors));
}

void run_submit(const SubmitOptions& options) {
  const ClusterJob job = job_of(options);
  const ClusterPlan plan = make_cluster_plan(job, given_folder(options));
  const ClusterFiles files(folder_of(options, job, plan));
  require_same(job, files);
  make_folders(files);
  const ClusterState state = find_cluster_state(job, files);
  for (const std::string& warning : state.warnings) say("warning: " + warning);
  using State = PartState::Is;
  const std::vector<int> missing =
      state.shards_that_are({State::not_started, State::failed, State::killed});
  const bool is_done = state.shards_that_are({State::done}).size() == state.shards.size();
  save_cluster_job(job, files.job());
  const auto write = [&](const char* name, const std::string& text) {
    write_file(files.script(name).string(), text);
  };
  if (!plan.prepare.empty()) write("prepare", prepare_script(job, plan, files));
  write("shard", shard_script(job, plan, files));
  write("merge", merge_script(job, plan, files));
  write("submit", submit_script(job, plan, files, missing, state.slurm_jobs));

  const bool is_left =
      !missing.empty() || (is_done && state.merge.is != State::done &&
                           state.merge.is != State::waiting && state.merge.is != State::running);
  JsonOutput json = make_result("submit");
  json["folder"] = files.folder.string();
  json["shards"] = job.shards;
  json["submitted"] = JsonOutput::array();
  if (is_left && !options.only_writes) {
    hand_over(job, plan, files);
    for (const int shard : missing) json["submitted"].push_back(shard);
  }
  CommonOptions common;
  common.json = options.json;
  write_json(json, common);
  const std::string name = fs::path(files.folder).filename().string();
  if (!is_left)
    print(common, fmt::format("{}: nothing is left to submit\n", name));
  else if (options.only_writes)
    print(common, fmt::format("{}: {} of {} shards to be made; nothing was submitted\n"
                              "to Slurm: sh {}\nby hand: {}\n",
                              name, missing.size(), job.shards,
                              shell_quoted(files.script("submit").string()),
                              how_by_hand(job, plan, files)));
  else
    print(common, fmt::format("{0}: submitted {1} of {2} shards and the merge; lamina status {3} "
                              "tells how far they are\n",
                              name, missing.size(), job.shards,
                              shell_quoted(fs::proximate(files.folder).string())));
}

}  // namespace

void add_submit_command(CLI::App& app) {
  auto options = std::make_shared<SubmitOptions>();
  const Command command(app, "submit",
                        "Splits work that takes long over a cluster: Slurm, or plain scripts.");
  command
      .add_option("job", options->job,
                  "what is to be made: a command in quotes, 'render scene.json -o picture'; a job "
                  "file; or the folder of a job, whose missing shards are submitted again")
      .type_name("FILE.json|FOLDER|COMMAND")
      .required();
  command.add_option("--shards", options->shards, "parts that the work is split into")
      .type_name("N")
      .range(1, most_shards);
  command
      .add_option("-o,--output", options->output,
                  "folder of the job: scripts, shards, logs. RESULT.job beside the result, if it "
                  "is not given")
      .type_name("FOLDER");
  command.add_flag("--dry-run", options->only_writes, "writes the scripts, and submits nothing");
  command.add_output_file("--json", options->json,
                          "write the result as JSON to FILE, or - for stdout");
  const std::string slurm = "Slurm";
  command.add_option("--partition", options->partition, "where the shards run")
      .type_name("NAME")
      .group(slurm);
  command.add_option("--time", options->time, "most time that a shard may take, as in 2:00:00")
      .type_name("TIME")
      .group(slurm);
  command.add_option("--memory", options->memory, "memory of a shard, as in 4G")
      .type_name("SIZE")
      .group(slurm);
  options->cores_given = command.add_option("--cores", options->cores, "cores of a shard")
                             .type_name("N")
                             .range(1, 4096)
                             .show_default()
                             .group(slurm);
  command
      .add_option("--sbatch", options->sbatch,
                  "one more option of sbatch, as in --sbatch=--account=light; as often as needed")
      .type_name("OPTION")
      .repeated()
      .group(slurm);
  command.footer(
      "Scripts, shards and logs stay in the folder. All can be repeated: a shard that is there is "
      "not made again, one that was stopped goes on, and the sum is bit by bit what one machine "
      "makes.\n"
      "Example: a picture in 200 shards, and what to do when some have died\n"
      "  lamina submit 'render scenes/sphere_skin.json --samples 4000 -o sphere' --shards 200 "
      "--partition cpu --time 1:00:00\n"
      "  lamina status sphere.job\n"
      "  lamina submit sphere.job");
  command.callback([options] { run_submit(*options); });
}

}  // namespace lamina::cli
