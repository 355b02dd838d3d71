// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Gives each test program a folder for temporary files of its own, removed at its end: tests run at
// the same time, in this checkout and in others, and the names of their files must not meet.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace {

/// Made before main, so that constants of tests see it, too.
const struct ScratchEnvironment {
  ScratchEnvironment() {
    std::string name = (std::filesystem::temp_directory_path() / "lamina_test.").string();
    name.append(6, 'X');                // what mkdtemp fills
    if (!mkdtemp(name.data())) return;  // then all share the common folder
    folder = name;
    setenv("TMPDIR", name.c_str(), 1);
    setenv("TEST_TMPDIR", name.c_str(), 1);  // testing::TempDir
    maker = getpid();
  }
  ~ScratchEnvironment() {
    std::error_code ignored;
    if (!folder.empty() && getpid() == maker) std::filesystem::remove_all(folder, ignored);
  }
  std::filesystem::path folder;
  pid_t maker = 0;  ///< children that a test forks leave it alone
} scratch_environment;

}  // namespace
