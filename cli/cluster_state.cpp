// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "cluster_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "run_program.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;
using Is = PartState::Is;

std::string name_of_host() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

bool lives(long process) {
  return process > 0 && (kill(static_cast<pid_t>(process), 0) == 0 || errno == EPERM);
}

/// Slurm's queue: for each of its jobs the tasks in it, and whether they run.
struct Queue {
  bool is_known = false;
  std::map<std::string, std::map<int, bool>> tasks;  ///< [job][task, 0 without array]
};

/// A line of the file `submitted`: "shards 1000 17".
struct Submitted {
  std::string part;
  int first = 0;
  std::string job;
};

std::vector<Submitted> read_submitted(const fs::path& file) {
  std::vector<Submitted> all;
  std::ifstream input(file);
  for (Submitted one; input >> one.part >> one.first >> one.job;) all.push_back(one);
  return all;
}

Queue read_queue(const std::vector<Submitted>& submitted) {
  Queue queue;
  if (submitted.empty()) return queue;
  std::set<std::string> ours;
  for (const Submitted& one : submitted) ours.insert(one.job);
  // Of all of the user's jobs: Slurm refuses to list one that it has forgotten.
  const auto run = run_program(
      {"squeue", "--array", "--noheader", "--format=%F %K %t", fmt::format("--user={}", geteuid())},
      "/");
  if (!run || run->exit_code != 0) return queue;
  queue.is_known = true;
  std::istringstream lines(run->output);
  for (std::string job, task, state; lines >> job >> task >> state;) {
    if (!ours.contains(job)) continue;
    const bool waits = state == "PD" || state == "CF" || state == "RQ" || state == "RH" ||
                       state == "S" || state == "RD";
    if (waits || state == "R" || state == "CG")
      queue.tasks[job][task == "N/A" ? 0 : std::atoi(task.c_str())] = !waits;
  }
  return queue;
}

/// What its script has noted.
PartState read_state(const fs::path& file, bool is_known_to_queue) {
  static const std::string host = name_of_host();
  PartState state;
  std::ifstream input(file);
  std::string word;
  long process = 0, begin = 0, end = 0;
  if (!(input >> word >> state.host >> process >> begin)) return state;
  const auto now = static_cast<long>(std::time(nullptr));
  if (input >> word >> state.exit_code >> end) {
    state.is = state.exit_code == 0 ? Is::done : Is::failed;
    state.seconds = static_cast<double>(std::max(0L, end - begin));
    return state;
  }
  state.seconds = static_cast<double>(std::max(0L, now - begin));
  const bool is_gone = state.host == host ? !lives(process) : is_known_to_queue;
  state.is = is_gone ? Is::killed : Is::running;
  return state;
}

}  // namespace

std::vector<int> ClusterState::shards_that_are(std::initializer_list<Is> states) const {
  std::vector<int> found;
  for (std::size_t i = 0; i < shards.size(); ++i)
    if (std::ranges::find(states, shards[i].is) != states.end())
      found.push_back(static_cast<int>(i));
  return found;
}

std::optional<double> ClusterState::seconds_left() const {
  double done_seconds = 0.0, left = 0.0;
  int done = 0, running = 0;
  for (const PartState& shard : shards)
    if (shard.is == Is::done) {
      done_seconds += shard.seconds;
      ++done;
    }
  if (done == 0) return std::nullopt;
  const double mean = done_seconds / done;
  for (const PartState& shard : shards) {
    if (shard.is == Is::done) continue;
    const bool runs = shard.is == Is::running;
    running += runs ? 1 : 0;
    left += runs ? std::max(0.0, mean - shard.seconds) : mean;
  }
  return left / std::max(1, running);
}

ClusterState find_cluster_state(const ClusterJob& job, const ClusterFiles& files) {
  const std::vector<Submitted> submitted = read_submitted(files.submitted());
  const Queue queue = read_queue(submitted);
  ClusterState state;
  state.prepare = read_state(files.state("prepare"), queue.is_known);
  state.merge = read_state(files.state("merge"), queue.is_known);
  state.shards.resize(static_cast<std::size_t>(job.shards));
  for (int i = 0; i < job.shards; ++i) {
    PartState& shard = state.shards[static_cast<std::size_t>(i)];
    shard = read_state(files.state(fmt::format("{}", i)), queue.is_known);
    std::error_code error;
    if (fs::exists(files.shard(i), error))
      shard.is = Is::done;
    else if (shard.is == Is::done)  // it was removed since
      shard = {};
  }
  for (const Submitted& one : submitted) {
    const auto tasks = queue.tasks.find(one.job);
    if (tasks == queue.tasks.end()) continue;
    for (const auto& [task, runs] : tasks->second) {
      const int index = one.first + task;
      PartState* part = one.part == "merge"     ? &state.merge
                        : one.part == "prepare" ? &state.prepare
                        : index < static_cast<int>(job.shards)
                            ? &state.shards[static_cast<std::size_t>(index)]
                            : nullptr;
      if (!part || (one.part == "shards" && part->is == Is::done)) continue;
      part->is = runs ? Is::running : Is::waiting;
      if (!runs) part->seconds = 0.0;
    }
    if (one.part == "shards") state.slurm_jobs.push_back(one.job);
  }
  return state;
}

}  // namespace lamina::cli
