// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/folder_names.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace lamina {
namespace {

namespace fs = std::filesystem;

TEST(FolderNames, AreAllThatLiesInAFolder) {
  const fs::path folder =
      fs::temp_directory_path() / ("lamina_folder_names_" + std::to_string(getpid()));
  fs::create_directories(folder / "b");
  std::ofstream(folder / "a.txt") << "text";
  std::ofstream(folder / ".hidden") << "text";
  std::error_code error;
  std::vector<std::string> names = folder_names(folder, error);
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{".hidden", "a.txt", "b"}));
  EXPECT_FALSE(error);
  EXPECT_TRUE(folder_names(folder / "b", error).empty());
  EXPECT_FALSE(error);
  EXPECT_TRUE(folder_names(folder / "missing", error).empty());
  EXPECT_EQ(error, std::errc::no_such_file_or_directory);
  EXPECT_TRUE(folder_names(folder / "a.txt", error).empty());
  EXPECT_EQ(error, std::errc::not_a_directory);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace lamina
