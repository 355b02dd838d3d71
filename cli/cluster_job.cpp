// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "cluster_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/shell_text.h"
#include "picture_look.h"
#include "run_program.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// What stands behind an option: "--json FILE", "--json=FILE"; "" if it is not given.
std::string value_of(const Words& words, std::span<const std::string_view> names) {
  std::string value;
  for (std::size_t i = 0; i < words.size(); ++i)
    for (const std::string_view name : names) {
      if (words[i] == name && i + 1 < words.size()) value = words[i + 1];
      if (name.starts_with("--") && words[i].starts_with(std::string(name) + "="))
        value = words[i].substr(name.size() + 1);
      if (!name.starts_with("--") && words[i].size() > name.size() && words[i].starts_with(name))
        value = words[i].substr(name.size());
    }
  return value;
}

bool is_option(const std::string& word, std::string_view name) {
  return word == name || word.starts_with(std::string(name) + "=");
}

/// Those options of the command, with their values.
Words only_options(const Words& words, std::span<const std::string_view> names) {
  Words kept;
  for (std::size_t i = 0; i < words.size(); ++i)
    for (const std::string_view name : names)
      if (is_option(words[i], name)) {
        kept.push_back(words[i]);
        if (words[i] == name && i + 1 < words.size()) kept.push_back(words[i + 1]);
      }
  return kept;
}

void refuse(const Words& words, std::span<const std::string_view> names, const std::string& why) {
  for (const std::string& word : words)
    for (const std::string_view name : names)
      if (is_option(word, name)) throw InvalidInput(fmt::format("{}: {}", name, why));
}

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// What the command says of itself with --check.
JsonDocument checked(const ClusterJob& job, const Words& words) {
  const std::optional<ProgramRun> run =
      run_program(joined({this_program()}, joined(words, {"--check", "--json", "-"})), job.folder);
  if (!run) throw Error(this_program() + ": cannot be started");
  if (run->exit_code != 0) {
    std::string_view errors = run->errors;
    while (errors.ends_with('\n')) errors.remove_suffix(1);
    errors.remove_prefix(errors.rfind('\n') + 1);  // the last line, or all of it
    if (errors.starts_with("lamina: ")) errors.remove_prefix(8);
    throw InvalidInput(std::string(errors));
  }
  return parse_json(run->output, "lamina " + words[0] + " --check");
}

constexpr std::array<std::string_view, 2> output_names = {"-o", "--output"};
constexpr std::array<std::string_view, 1> json_names = {"--json"};
// A shard goes on by itself from what it has; what another render has kept is no part of the job.
constexpr std::array<std::string_view, 2> flags_of_resuming = {"--resume", "--fresh"};

ClusterPlan plan_of_picture(const ClusterJob& job) {
  constexpr std::array<std::string_view, 5> of_shards = {"--shard", "--prepare", "--cache-only",
                                                         "--check", "--threads"};
  constexpr std::array<std::string_view, 3> of_one = {"--compare", "--keep", "--progressive"};
  refuse(job.command, of_shards, "is for the jobs, which have it without being told");
  refuse(job.command, of_one, "does not go with shards");
  constexpr std::array<std::string_view, 4> with_value = {"-o", "--output", "--json", "--noise"};
  constexpr std::array<std::string_view, 3> flags = {"--resume", "--fresh", "--denoise"};
  const Words words = without_options(without_options(job.command, with_value, flags),
                                      look_option_names, flags);  // which the merge has
  const JsonDocument said =
      checked(job, without_options(job.command, json_names, flags_of_resuming));
  const JsonInput root = said.root();
  const std::int64_t samples = root.peek("samples_per_pixel")->integer(1, 1 << 24);
  if (job.shards > samples)
    throw InvalidInput(
        fmt::format("--shards: a picture of {} samples per pixel can have at most as many shards, "
                    "but is to have {}",
                    samples, job.shards));
  const Words files = read_words(*root.peek("files"));
  ClusterPlan plan{.kind = ShardKind::picture, .result = files[0]};
  plan.finds_method = root.peek("method")->string() == "auto";
  const double noise = root.peek("noise")->number();
  // The merge tells the noise, which one shard does not know.
  plan.shard = noise > 0.0 ? joined(words, {"--noise", "0"}) : words;
  plan.prepare = joined(words, {"--prepare"});
  if (!value_of(words, std::array<std::string_view, 1>{"--cache"}).empty())
    plan.shard.emplace_back("--cache-only");
  const fs::path both = fs::path(files[0]).replace_extension();
  plan.merge = {"merge", "-o", files.size() > 1 ? both.string() : files[0]};
  if (noise > 0.0) plan.merge = joined(plan.merge, {"--noise", fmt::format("{}", noise)});
  if (std::ranges::find(job.command, "--denoise") != job.command.end())
    plan.merge.emplace_back("--denoise");
  plan.merge = joined(plan.merge, only_options(job.command, look_option_names));
  plan.merge = joined(plan.merge, only_options(job.command, json_names));
  return plan;
}

/// A result of so many parts, each of which a shard can be.
void require_parts(const ClusterJob& job, std::int64_t parts, const std::string& what) {
  if (job.shards > parts)
    throw InvalidInput(
        fmt::format("--shards: {} can have at most as many shards, but {} are asked for",
                    fmt::format("{} {}", parts, what), job.shards));
}

ClusterPlan plan_of_fits(const ClusterJob& job) {
  constexpr std::array<std::string_view, 3> of_shards = {"--shard", "--check", "--threads"};
  constexpr std::array<std::string_view, 2> of_one = {"--plot", "--report"};
  refuse(job.command, of_shards, "is for the jobs, which have it without being told");
  refuse(job.command, of_one, "does not go with shards");
  constexpr std::array<std::string_view, 1> batch = {"--batch"};
  if (value_of(job.command, batch).empty())
    throw InvalidInput("--batch: must name the samples that are split, but is missing");
  const std::string table = value_of(job.command, output_names);
  const std::string json = value_of(job.command, json_names);
  if (table.empty() && json.empty())
    throw InvalidInput("--output: must name the table of all fits in the command, but is missing");
  const JsonDocument said = checked(job, without_options(job.command, json_names, {}));
  require_parts(job, said.root().peek("samples")->integer(1, std::int64_t{1} << 40), "samples");
  for (const std::string& file : {table, json})
    if (!file.empty()) require_writable((fs::path(job.folder) / file).string());
  ClusterPlan plan{.kind = ShardKind::fits, .result = table.empty() ? json : table};
  constexpr std::array<std::string_view, 3> of_result = {"-o", "--output", "--json"};
  plan.shard = without_options(job.command, of_result, {});
  plan.merge = joined({"merge"}, only_options(job.command, of_result));
  return plan;
}

/// Of commands that keep what is done in a folder, and go on with it.
ClusterPlan plan_of_kept(const ClusterJob& job, const fs::path& job_folder) {
  const bool is_capture = job.command[0] == "acquire";
  constexpr std::array<std::string_view, 7> of_shards = {
      "--shard", "--prepare", "--check", "--threads", "--tiles", "--resume", "--list"};
  refuse(job.command, of_shards, "is for the jobs, which have it without being told");
  const JsonDocument said = checked(job, without_options(job.command, json_names, {}));
  const JsonInput count = *said.root().peek(is_capture ? "tiles" : "items");
  const std::int64_t parts = count.integer(0, std::int64_t{1} << 40);
  if (is_capture && parts == 1)
    throw InvalidInput(
        "acquire: must be of a capture that is solved by tiles, but this one is solved as a whole; "
        "--tile-memory makes tiles smaller");
  require_parts(job, is_capture ? parts - 1 : parts,
                is_capture ? "tiles behind the first" : "items");
  constexpr std::array<std::string_view, 2> of_all = {"--json", "--before"};
  const Words words = without_options(job.command, of_all, {});
  fs::path result = said.root().peek("output")->string();
  if (!result.has_filename()) result = result.parent_path();  // "maps/"
  ClusterPlan plan{.kind = ShardKind::kept, .result = result};
  if (!is_capture) {
    plan.shard = words;
    plan.merge = joined(job.command, {"--resume"});
    return plan;
  }
  const fs::path tiles =
      (job_folder.empty() ? fs::path(result).replace_extension(".job") : job_folder) / "tiles";
  plan.shard = joined(words, {"--tiles", fs::absolute(fs::path(job.folder) / tiles).string()});
  plan.prepare = joined(plan.shard, {"--prepare"});
  plan.merge = joined(plan.shard, only_options(job.command, json_names));
  return plan;
}

ClusterPlan plan_of_photons(const ClusterJob& job) {
  constexpr std::array<std::string_view, 4> of_shards = {"--shard", "--checkpoint", "--check",
                                                         "--threads"};
  constexpr std::array<std::string_view, 2> of_one = {"--time", "--relative-error"};
  refuse(job.command, of_shards, "is for the jobs, which have it without being told");
  refuse(job.command, of_one,
         "does not go with shards, which do not know each other's; --photons says how many are "
         "traced");
  const std::string json = value_of(job.command, json_names);
  if (json.empty() || json == "-")
    throw InvalidInput("--json: must name the file of the merged result in the command, but " +
                       std::string(json.empty() ? "is missing" : "is -"));
  constexpr std::array<std::string_view, 2> of_result = {"--json", "--plot"};
  constexpr std::array<std::string_view, 2> flags = {"--resume", "--counts"};
  (void)checked(job, without_options(job.command, json_names, flags));
  require_writable((fs::path(job.folder) / json).string());
  ClusterPlan plan{.kind = ShardKind::photons, .result = json};
  plan.shard = without_options(job.command, of_result, flags);
  plan.merge = joined({"merge"}, only_options(job.command, of_result));
  return plan;
}

}  // namespace

ClusterPlan make_cluster_plan(const ClusterJob& job, const fs::path& job_folder) {
  Words words = job.command;
  if (!words.empty() && words[0] == "lamina") words.erase(words.begin());
  ClusterJob without_name = job;
  without_name.command = words;
  const std::string command = words.empty() ? "" : words[0];
  for (const std::string& word : words)
    if (word == "-" || word == "-h" || word == "--help" || word.ends_with(".mci"))
      throw InvalidInput(
          fmt::format("{}: cannot be part of a command that many machines run", word));
#ifndef LAMINA_RENDER
  if (command == "render") throw InvalidInput("render: this lamina was built without it");
#endif
  if (command == "render") return plan_of_picture(without_name);
  if (command == "photons") return plan_of_photons(without_name);
  if (command == "fit") return plan_of_fits(without_name);
  if (command == "acquire" || command == "reproduce") return plan_of_kept(without_name, job_folder);
  throw InvalidInput(fmt::format(
      "the command must be render, photons, fit, acquire or reproduce, whose work can be "
      "parted, but is \"{}\"",
      command));
}

}  // namespace lamina::cli
