// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// A folder of a job as `lamina status` reads it: job.json, the notes of its scripts, and what Slurm
// says, in this order with a null between.
#include <algorithm>

#include "cluster_files.h"
#include "cluster_state.h"
#include "fuzz_input.h"

namespace {

using namespace lamina;

/// The text up to a null, which is taken off with it.
std::string_view next_text(std::string_view& rest) {
  const std::string_view text = rest.substr(0, rest.find('\0'));
  rest.remove_prefix(std::min(rest.size(), text.size() + 1));
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest = fuzz::text_of(data, size);
  std::filesystem::create_directories(fuzz::scratch_folder() / "state");
  return fuzz::read_or_refuse([&] {
    for (const char* name : {"job.json", "submitted", "state/0", "state/merge"})
      fuzz::scratch_file(name, next_text(rest));
    const cli::ClusterFiles files(fuzz::scratch_folder());
    cli::ClusterJob job = cli::load_cluster_job(files.job(), {fuzz::most_memory});
    constexpr int most = 64;  // each is a file that is looked for
    job.shards = std::min(job.shards, most);
    const auto state = cli::find_cluster_state(job, files, [&] { return std::string(rest); });
    static_cast<void>(state.seconds_left());
  });
}
