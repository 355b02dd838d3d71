// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "cluster_scripts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lamina/base/io/shell_text.h"
#include "run_program.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

std::string quoted(const std::filesystem::path& file) { return shell_quoted(file.string()); }

std::string quoted(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_quoted(word);
  return line;
}

/// A line of a comment: what a command has in it cannot end it.
std::string comment(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return "# " + text + "\n";
}

/// The first lines of each script.
/// @param usage  more lines of comment
std::string beginning(const ClusterJob& job, const ClusterFiles& files, const std::string& what,
                      const std::string& usage = "") {
  return "#!/bin/sh\n" + comment(what) + comment("  " + command_line(job.command)) +
         comment("Written by lamina submit " LAMINA_VERSION ".") + usage +
         fmt::format(
             "set -u\n"
             "job={}\n"
             "lamina=${{LAMINA:-{}}}\n"
             "threads=${{LAMINA_THREADS:-${{SLURM_CPUS_PER_TASK:-{}}}}}\n"
             "cd {} || exit 2\n",
             quoted(files.folder), shell_quoted(this_program()), job.cores,
             shell_quoted(job.folder));
}

/// Around the work of a part: lamina status reads when it was started and how it ended.
std::string with_state(const std::string& part, const std::string& work) {
  return fmt::format(
      "state=$job/state/{}\n"
      "echo \"start $(uname -n) $$ $(date +%s)\" >\"$state\"\n"
      "{}code=$?\n"
      "echo \"end $code $(date +%s)\" >>\"$state\"\n"
      "exit $code\n",
      part, work);
}

std::string shard_work(const ClusterJob& job, const ClusterPlan& plan) {
  const std::string words = quoted(plan.shard);
  const std::string part =
      fmt::format("\"$lamina\" {} --shard \"$i/{}\" --threads \"$threads\"", words, job.shards);
  // A run that is stopped writes what it has, which is not the shard.
  const std::string json =
      " --json \"$job/shards/$i.$$.json\" &&\n"
      "  mv \"$job/shards/$i.$$.json\" \"$job/shards/$i.shard\"\n";
  switch (plan.kind) {
    case ShardKind::picture:
      return part + (plan.finds_method ? " --method \"$method\"" : "") +
             " -o \"$job/shards/$i.shard\" --resume\n";
    case ShardKind::photons:
      return part + " --checkpoint \"$job/shards/$i.unfinished\" --resume" + json;
    case ShardKind::fits:
    case ShardKind::kept:
      break;
  }
  return part + json;
}

/// What makes the whole of the shards.
std::string merge_work(const ClusterJob& job, const ClusterPlan& plan) {
  const std::string words = quoted(plan.merge);
  if (plan.kind != ShardKind::kept)
    return fmt::format("\"$lamina\" {} --all --threads \"$threads\" \"$job/shards\"\n", words);
  return fmt::format(
      "missing=0 i=0\n"
      "while [ $i -lt {0} ]; do\n"
      "  [ -e \"$job/shards/$i.shard\" ] || missing=$((missing + 1))\n"
      "  i=$((i + 1))\n"
      "done\n"
      "if [ $missing -gt 0 ]; then\n"
      "  echo \"$missing of {0} shards are missing; lamina status $job names them\" >&2\n"
      "  (exit 2)\n"
      "else\n"
      "  \"$lamina\" {1} --threads \"$threads\"\n"
      "fi\n",
      job.shards, words);
}

/// "0-15" or "3,7,9-12".
std::string ranges_of(std::span<const int> numbers, int first) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += text.empty() ? "" : ",";
    text += end - i > 1 ? fmt::format("{}-{}", numbers[i] - first, numbers[end - 1] - first)
                        : fmt::format("{}", numbers[i] - first);
    i = end;
  }
  return text;
}

/// What all jobs are asked for with.
std::string sbatch_options(const ClusterJob& job, const ClusterPlan& plan) {
  std::vector<std::string> words = {"--parsable", "--requeue", "--open-mode=append",
                                    "--job-name=lamina-" + plan.result.stem().string(),
                                    fmt::format("--cpus-per-task={}", job.cores)};
  if (!job.partition.empty()) words.push_back("--partition=" + job.partition);
  if (!job.time.empty()) words.push_back("--time=" + job.time);
  if (!job.memory.empty()) words.push_back("--mem=" + job.memory);
  words.insert(words.end(), job.sbatch.begin(), job.sbatch.end());
  return quoted(words);
}

}  // namespace

std::string shard_script(const ClusterJob& job, const ClusterPlan& plan,
                         const ClusterFiles& files) {
  const int last = job.shards - 1;
  std::string text =
      beginning(job, files, fmt::format("One shard of 0 to {} of", last),
                fmt::format("#   sh shard.sh {0}                            one shard, here\n"
                            "#   seq 0 {0} | xargs -n 1 -P 4 sh shard.sh    all, four at a time\n"
                            "#   seq 0 {0} | parallel sh shard.sh           all, by GNU parallel\n"
                            "# Schedulers tell the number as below. A shard that is there is not "
                            "made again, and one\n"
                            "# that was stopped goes on.\n",
                            last));
  text += fmt::format(
      "i=${{1:-}}\n"
      "if [ -z \"$i\" ]; then\n"
      "  i=${{SLURM_ARRAY_TASK_ID:-${{PBS_ARRAY_INDEX:-${{AWS_BATCH_JOB_ARRAY_INDEX:-}}}}}}\n"
      "  [ -n \"$i\" ] && i=$((i + ${{LAMINA_FIRST_SHARD:-0}}))\n"
      "fi\n"
      "case $i in '' | *[!0-9]* | ????????*) i={1} ;; esac\n"
      "while :; do\n"
      "  case $i in 0?*) i=${{i#0}} ;; *) break ;; esac  # 02 is shard 2\n"
      "done\n"
      "if [ \"$i\" -ge {1} ]; then\n"
      "  echo \"usage: sh shard.sh I, with I from 0 to {0}\" >&2\n"
      "  exit 2\n"
      "fi\n"
      "[ -e \"$job/shards/$i.shard\" ] && exit 0\n",
      last, job.shards);
  if (!plan.prepare.empty())
    text +=
        "if [ ! -e \"$job/prepared.json\" ]; then\n"
        "  echo \"nothing is prepared yet: sh $job/prepare.sh\" >&2\n"
        "  exit 2\n"
        "fi\n";
  if (plan.finds_method)
    text +=
        "method=$(sed -n 's/^ *\"method\": *\"\\([a-z_]*\\)\".*/\\1/p' \"$job/prepared.json\")\n";
  return text + with_state("$i", shard_work(job, plan));
}

std::string prepare_script(const ClusterJob& job, const ClusterPlan& plan,
                           const ClusterFiles& files) {
  return beginning(job, files, "What all shards share, made once, of") +
         "[ -e \"$job/prepared.json\" ] && exit 0\n" +
         with_state("prepare", fmt::format("\"$lamina\" {} --json \"$job/prepared.json\" --threads "
                                           "\"$threads\"\n",
                                           quoted(plan.prepare)));
}

std::string merge_script(const ClusterJob& job, const ClusterPlan& plan,
                         const ClusterFiles& files) {
  return beginning(job, files, "The sum of all shards of") +
         with_state("merge", merge_work(job, plan));
}

std::string submit_script(const ClusterJob& job, const ClusterPlan& plan, const ClusterFiles& files,
                          std::span<const int> shards, std::span<const std::string> after) {
  std::string text = "#!/bin/sh\n" + comment("Hands to Slurm what is not there yet of") +
                     comment("  " + command_line(job.command)) +
                     comment("Written by lamina submit " LAMINA_VERSION ".") +
                     fmt::format("set -eu\njob={}\n", quoted(files.folder));
  text += fmt::format("submit() {{ sbatch {} \"$@\"; }}\n", sbatch_options(job, plan));
  text += "note() { echo \"$*\" >>\"$job/submitted\"; }\n";
  const bool prepares = !plan.prepare.empty() && !std::filesystem::exists(files.prepared());
  if (prepares && !shards.empty())
    text +=
        "prepare=$(submit --output=\"$job/log/prepare.log\" \"$job/prepare.sh\")\n"
        "prepare=${prepare%%;*}\n"
        "note prepare 0 \"$prepare\"\n";
  std::string waits = fmt::format("{}", fmt::join(after, ":"));
  for (std::size_t i = 0; i < shards.size();) {
    const int block = shards[i] / slurm_array_size, first = block * slurm_array_size;
    std::size_t end = i;
    while (end < shards.size() && shards[end] / slurm_array_size == block) ++end;
    // %a would be the number in its array.
    const std::string log = first == 0 ? "%a.log" : fmt::format("{}+%a.log", first);
    text += fmt::format(
        "shards=$(LAMINA_FIRST_SHARD={} submit --array={}{} --output=\"$job/log/{}\" "
        "\"$job/shard.sh\")\n"
        "shards=${{shards%%;*}}\n"
        "note shards {} \"$shards\"\n"
        "all=${{all:+$all:}}$shards\n",
        first, ranges_of(shards.subspan(i, end - i), first),
        prepares ? " --dependency=\"afterok:$prepare\" --kill-on-invalid-dep=yes" : "", log, first);
    i = end;
  }
  const std::string all = shards.empty() ? waits : waits.empty() ? "$all" : waits + ":$all";
  text += fmt::format(
      "merge=$(submit{} --output=\"$job/log/merge.log\" \"$job/merge.sh\")\n"
      "note merge 0 \"${{merge%%;*}}\"\n",
      all.empty() ? "" : fmt::format(" --dependency=\"afterany:{}\"", all));
  return text;
}

}  // namespace lamina::cli
