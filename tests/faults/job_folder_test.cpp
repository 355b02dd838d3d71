// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Folders of jobs whose notes are damaged.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "cluster_files.h"
#include "cluster_state.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;
using Is = PartState::Is;

class JobFolder : public testing::Test {
 protected:
  JobFolder()
      : folder_(fs::temp_directory_path() / ("lamina_job_" + std::to_string(getpid()))),
        files_(folder_) {
    fs::create_directories(folder_ / "state");
  }
  ~JobFolder() override { fs::remove_all(folder_); }

  void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

  ClusterState state(const std::string& submitted, const std::string& queue) {
    write(files_.submitted(), submitted);
    return find_cluster_state({.command = {"render"}, .shards = 4}, files_, [&] { return queue; });
  }

  fs::path folder_;
  ClusterFiles files_;
};

TEST_F(JobFolder, TasksOfSlurmAreThoseOfTheLinesOfSubmitted) {
  const ClusterState state = this->state("prepare 0 16\nshards 1 17\nmerge 0 18\n",
                                         "17 0 R\n17 2 PD\n18 N/A PD\n99 1 R\n");
  EXPECT_EQ(state.shards[0].is, Is::not_started);
  EXPECT_EQ(state.shards[1].is, Is::running);
  EXPECT_EQ(state.shards[3].is, Is::waiting);
  EXPECT_EQ(state.merge.is, Is::waiting);
  EXPECT_EQ(state.slurm_jobs, std::vector<std::string>{"17"});
  EXPECT_TRUE(state.warnings.empty());
}

TEST_F(JobFolder, LinesThatAreNoPartAreLeftOutWithAWarning) {
  for (const char* line : {"shards -1 17", "shards -1000000000 17", "shards 4 17",
                           "shards 99999999999999999999 17", "shards 0 $(touch x)", "shards 0 -17",
                           "merge 3 17", "other 0 17", "shards 0", "", "\x01"}) {
    const ClusterState state =
        this->state(std::string(line) + "\nshards 2 18\n", "17 0 R\n17 3 R\n$(touch 0 R\n18 1 R\n");
    ASSERT_EQ(state.warnings.size(), 1U) << line;
    EXPECT_NE(state.warnings[0].find("submitted:1: must be"), std::string::npos) << line;
    EXPECT_EQ(state.shards_that_are({Is::running}), std::vector<int>{3}) << line;
    EXPECT_EQ(state.slurm_jobs, std::vector<std::string>{"18"}) << line;
  }
}

TEST_F(JobFolder, TasksOfSlurmBeyondTheJobAreLeftOut) {
  for (const char* task : {"4", "2147483647", "99999999999999999999", "-1", "x"}) {
    const ClusterState state = this->state("shards 3 17\n", std::string("17 ") + task + " R\n");
    EXPECT_TRUE(state.shards_that_are({Is::running}).empty()) << task;
  }
}

TEST_F(JobFolder, NotesThatNoScriptWritesAreOfPartsThatWereNotStartedOrKilled) {
  const auto is = [&](const std::string& text) {
    write(files_.state("0"), text);
    return state("", "").shards[0].is;
  };
  EXPECT_EQ(is("start elsewhere 1 1\nend 3 5\n"), Is::failed);
  EXPECT_EQ(is("start elsewhere 1 1\n"), Is::running);
  for (const char* text : {"", "start", "start a 1", "begin a 1 1", "start a 1 x", "start a 1 -5",
                           "start a 1 9223372036854775807"})
    EXPECT_EQ(is(text), Is::not_started) << text;
  EXPECT_EQ(is("start a 1 " + std::string(10000, '1')), Is::not_started);
  EXPECT_EQ(is("start a 1 1\nend 1000 5"), Is::running);  // its last line is not yet whole
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  for (const char* process : {"0", "-1", "99999999999999999999", "x"})
    EXPECT_EQ(is(std::string("start ") + host.data() + " " + process + " 1\n"), Is::killed)
        << process;
}

TEST_F(JobFolder, PipesInPlaceOfNotesAreNotWaitedFor) {
  ASSERT_EQ(mkfifo(files_.state("0").c_str(), 0600), 0);
  EXPECT_EQ(state("", "").shards[0].is, Is::not_started);
}

}  // namespace
}  // namespace lamina::cli
