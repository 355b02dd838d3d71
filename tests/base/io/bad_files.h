// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace lamina {

/// Expects every JSON file of a folder to be refused in one line that begins as expected.txt there
/// says: its name, `:`, and the text; or, where the text begins with a table, the table's path.
/// FOLDER in the text stands for the folder.
/// @param message_of  what is said of a file
/// @param others      files that those listed name, and that are not themselves
/// @return  how many files are listed
template <class MessageOf>
std::size_t expect_refusals(const std::filesystem::path& folder, const MessageOf& message_of,
                            const std::set<std::string>& others = {}) {
  std::ifstream expected(folder / "expected.txt");
  std::set<std::string> listed;
  for (std::string line; std::getline(expected, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream fields(line);
    std::string file, level, text;
    fields >> file >> level >> std::ws;
    std::getline(fields, text);
    if (const auto at = text.find("FOLDER"); at != std::string::npos)
      text.replace(at, 6, folder.string());
    listed.insert(file);
    const std::filesystem::path path = folder / file;
    const std::string message = message_of(path);
    const std::size_t table = std::min(text.find(".csv:"), text.find(".rxt:"));
    const bool is_of_table = table != std::string::npos && text.find(' ') > table;
    const std::string start = is_of_table ? (folder / text).string() : path.string() + ":" + text;
    EXPECT_TRUE(message.starts_with(start)) << "expected  " << start << "\ngot       " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".json" || others.contains(name)) continue;
    EXPECT_TRUE(listed.contains(name)) << entry << " is not in expected.txt";
  }
  return listed.size();
}

}  // namespace lamina
