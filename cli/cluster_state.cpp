// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "cluster_state.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <ctime>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "run_program.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;
using Is = PartState::Is;

std::string name_of_host() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

bool lives(pid_t process) { return kill(process, 0) == 0 || errno == EPERM; }

/// The bytes of a note that scripts write; empty where there is none that can be read, as no file
/// or a pipe, or one longer than what they write.
std::string note_text(const fs::path& file, std::size_t longest) {
  try {
    MemoryBudget budget(longest);
    return read_file_bytes(file, budget);
  } catch (const FileError&) {
    return "";
  }
}

/// A whole number from low to high that is all of the text.
std::optional<std::int64_t> whole_number(std::string_view text, std::int64_t low,
                                         std::int64_t high) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < low || number > high)
    return std::nullopt;
  return number;
}

/// The words of a line.
std::vector<std::string> words_in(const std::string& line) {
  std::istringstream input(line);
  return {std::istream_iterator<std::string>(input), {}};
}

/// Slurm's queue: for each of its jobs the tasks in it, and whether they run.
struct Queue {
  bool is_known = false;
  std::map<std::string, std::map<std::int64_t, bool>> tasks;  ///< [job][task, 0 without array]
};

/// A line of the file `submitted`: "shards 1000 17".
struct Submitted {
  std::string part;
  std::int64_t first = 0;
  std::string job;  ///< digits
};

/// Absent if the line is no part of a job of so many shards.
std::optional<Submitted> read_submitted(const std::string& line, int shards) {
  const std::vector<std::string> words = words_in(line);
  if (words.size() != 3) return std::nullopt;
  const bool is_array = words[0] == "shards";
  const auto first = whole_number(words[1], 0, is_array ? shards - 1 : 0);
  if ((!is_array && words[0] != "prepare" && words[0] != "merge") || !first ||
      !whole_number(words[2], 0, std::numeric_limits<std::int64_t>::max()))
    return std::nullopt;
  return Submitted{.part = words[0], .first = *first, .job = words[2]};
}

/// Lines of the file "submitted" that are parts of the job.
std::vector<Submitted> read_submitted(const fs::path& file, int shards,
                                      std::vector<std::string>& warnings) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  MemoryBudget budget(std::size_t{64} << 20);
  std::istringstream lines(read_file_bytes(file, budget));
  std::vector<Submitted> all;
  int number = 0, wrong = 0, first_wrong = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (auto one = read_submitted(line, shards))
      all.push_back(std::move(*one));
    else if (wrong++ == 0)
      first_wrong = number;
  }
  if (wrong > 0)
    warnings.push_back(fmt::format(
        "{}:{}: must be a part of this job, its first shard and its number in Slurm; {}",
        file.string(), first_wrong,
        wrong == 1 ? "it is left out" : fmt::format("{} such lines are left out", wrong)));
  return all;
}

/// States of the submitted jobs, as Slurm lists them.
Queue read_queue(const std::vector<Submitted>& submitted, const std::string& text) {
  Queue queue{.is_known = true, .tasks = {}};
  std::set<std::string> ours;
  for (const Submitted& one : submitted) ours.insert(one.job);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> words = words_in(line);
    if (words.size() != 3 || !ours.contains(words[0])) continue;
    const std::string& state = words[2];
    const bool waits = state == "PD" || state == "CF" || state == "RQ" || state == "RH" ||
                       state == "S" || state == "RD";
    const auto task = words[1] == "N/A" ? 0 : whole_number(words[1], 0, most_shards);
    if (task && (waits || state == "R" || state == "CG")) queue.tasks[words[0]][*task] = !waits;
  }
  return queue;
}

/// Notes of a shard's script: "start HOST PROCESS TIME", and "end CODE TIME" in the next line.
PartState read_state(const fs::path& file, bool is_known_to_queue) {
  static const std::string host = name_of_host();
  constexpr std::size_t longest = 4096;
  constexpr std::int64_t latest = std::int64_t{1} << 40;  // [s] since 1970
  PartState state;
  const std::vector<std::string> words = words_in(note_text(file, longest));
  if (words.size() < 4 || words[0] != "start") return state;
  const auto begin = whole_number(words[3], 0, latest);
  if (!begin) return state;
  state.host = words[1];
  const auto code = words.size() > 5 ? whole_number(words[5], 0, 255) : std::nullopt;
  const auto end = words.size() > 6 ? whole_number(words[6], 0, latest) : std::nullopt;
  const std::int64_t until = end.value_or(static_cast<std::int64_t>(std::time(nullptr)));
  state.seconds = static_cast<double>(std::max<std::int64_t>(0, until - *begin));
  if (code && end) {
    state.exit_code = static_cast<int>(*code);
    state.is = state.exit_code == 0 ? Is::done : Is::failed;
    return state;
  }
  const auto process = whole_number(words[2], 1, std::numeric_limits<pid_t>::max());
  const bool is_gone =
      state.host == host ? !process || !lives(static_cast<pid_t>(*process)) : is_known_to_queue;
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

std::optional<std::string> slurm_queue() {
  // The list is of all the user's jobs: Slurm refuses to list one that it has forgotten.
  const auto run = run_program(
      {"squeue", "--array", "--noheader", "--format=%F %K %t", fmt::format("--user={}", geteuid())},
      "/");
  if (!run || run->exit_code != 0) return std::nullopt;
  return run->output;
}

ClusterState find_cluster_state(const ClusterJob& job, const ClusterFiles& files,
                                const SlurmQueue& slurm) {
  ClusterState state;
  const std::vector<Submitted> submitted =
      read_submitted(files.submitted(), job.shards, state.warnings);
  Queue queue;
  if (!submitted.empty())
    if (const std::optional<std::string> text = slurm()) queue = read_queue(submitted, *text);
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
      const std::int64_t index = one.first + task;
      PartState* part = one.part == "merge"     ? &state.merge
                        : one.part == "prepare" ? &state.prepare
                        : index < job.shards    ? &state.shards[static_cast<std::size_t>(index)]
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
