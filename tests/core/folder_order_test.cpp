// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

namespace {

namespace fs = std::filesystem;

// The data flow. A folder may include itself and the folders before it.
constexpr std::array<std::string_view, 8> order = {"core",      "spectrum",   "image",  "optics",
                                                   "materials", "scattering", "render", "acquire"};

std::size_t place(std::string_view folder) {
  return static_cast<std::size_t>(std::ranges::find(order, folder) - order.begin());
}

TEST(Folders, IncludeOnlyFoldersAboveThemInTheDataFlow) {
  const fs::path root = fs::path(LAMINA_SOURCE_DIR) / "src/lamina";
  const std::regex include(R"re(^\s*#include "lamina/([a-z_]+)/)re");
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    ++files;
    const std::string folder = fs::relative(entry.path(), root).begin()->string();
    ASSERT_LT(place(folder), order.size()) << folder << " is not in the data flow";
    std::ifstream stream(entry.path());
    for (std::string line; std::getline(stream, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string included = match[1];
      EXPECT_LE(place(included), place(folder)) << entry.path() << " includes " << included;
      EXPECT_FALSE(folder == "scattering" && included == "materials")
          << entry.path() << ": scattering knows layers, not skin";
    }
  }
  EXPECT_GT(files, 10);
}

}  // namespace
