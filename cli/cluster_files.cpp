// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "cluster_files.h"

#include <fmt/format.h>

#include <span>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/shell_text.h"

namespace lamina::cli {

namespace fs = std::filesystem;

std::vector<std::string> read_words(const JsonInput& input) {
  if (input.is_string()) {
    try {
      return shell_words(input.string());
    } catch (const InvalidInput& error) {
      input.fail(error.what());
    }
  }
  std::vector<std::string> words;
  for (const JsonInput& word : input.array(1)) {
    words.push_back(word.string());
    if (words.back().find('\0') != std::string::npos) word.fail("must have no NUL");
  }
  return words;
}

ClusterJob load_cluster_job(const fs::path& file, MemoryBudget memory) {
  const JsonDocument document = load_json(file, memory);
  const JsonObject object = document.root().file_object(
      "job", 1, {"command", "shards", "folder", "partition", "time", "memory", "cores", "sbatch"});
  ClusterJob job;
  job.command = read_words(object.required("command"));
  job.shards = static_cast<int>(object.required("shards").integer(1, most_shards));
  job.folder = fs::absolute(file).parent_path().string();
  if (const auto folder = object.optional("folder"))
    job.folder = fs::absolute(folder->file_path()).lexically_normal().string();
  if (const auto partition = object.optional("partition")) job.partition = partition->string();
  if (const auto time = object.optional("time")) job.time = time->string();
  if (const auto size = object.optional("memory")) job.memory = size->string();
  if (const auto cores = object.optional("cores"))
    job.cores = static_cast<int>(cores->integer(1, 4096));
  if (const auto sbatch = object.optional("sbatch")) job.sbatch = read_words(*sbatch);
  return job;
}

void save_cluster_job(const ClusterJob& job, const fs::path& file) {
  JsonOutput json = {{"lamina", "job"}, {"version", 1}, {"command", JsonOutput(job.command)}};
  json["shards"] = job.shards;
  json["folder"] = job.folder;
  if (!job.partition.empty()) json["partition"] = job.partition;
  if (!job.time.empty()) json["time"] = job.time;
  if (!job.memory.empty()) json["memory"] = job.memory;
  json["cores"] = job.cores;
  if (!job.sbatch.empty()) json["sbatch"] = job.sbatch;
  const std::string text = json.text(1) + "\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

ClusterFiles::ClusterFiles(const fs::path& named) : folder(fs::absolute(named).lexically_normal()) {
  if (!folder.has_filename()) folder = folder.parent_path();  // "x.job/"
}
fs::path ClusterFiles::shard(int index) const { return shards() / fmt::format("{}.shard", index); }
fs::path ClusterFiles::state(const std::string& part) const { return folder / "state" / part; }
fs::path ClusterFiles::log(const std::string& part) const {
  return folder / "log" / (part + ".log");
}
fs::path ClusterFiles::script(const std::string& name) const { return folder / (name + ".sh"); }

}  // namespace lamina::cli
