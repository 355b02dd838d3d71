// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/write_places.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class WritePlaces : public testing::Test {
 protected:
  WritePlaces() : root_(fs::temp_directory_path() / ("lamina_places_" + std::to_string(getpid()))) {
    fs::create_directories(root_ / "inside");
    fs::create_directories(root_ / "outside");
    std::ofstream(root_ / "outside/kept") << "kept";
  }
  ~WritePlaces() override {
    write_only_inside({});
    fs::remove_all(root_);
  }

  static bool writes(const fs::path& file) try {
    const std::string text = "new";
    write_file_bytes(file, std::as_bytes(std::span(text)));
    return read_file_bytes(file) == text;
  } catch (const WriteError&) {
    return false;
  }

  fs::path root_;
};

TEST_F(WritePlaces, PlacesAreInsideByWhereTheirLinksLead) {
  const fs::path inside = root_ / "inside";
  fs::create_directory_symlink(root_ / "outside", inside / "way_out");
  fs::create_symlink("nothing", inside / "to_nothing_inside");
  fs::create_symlink("../outside/nothing", inside / "to_nothing_outside");
  fs::create_directory_symlink(inside, root_ / "way_in");
  for (const char* place :
       {".", "a", "a/b/c", "a/../b", "../inside/a", "to_nothing_inside", "..a", "../way_in/a"})
    EXPECT_TRUE(is_inside(inside / place, inside)) << place;
  EXPECT_TRUE(is_inside(inside / "a", root_ / "way_in"));
  for (const char* place : {"..", "../outside/kept", "a/../../b", "../inside_too", "way_out",
                            "way_out/kept", "way_out/new", "to_nothing_outside", "/etc/passwd"})
    EXPECT_FALSE(is_inside(inside / place, inside)) << place;
}

TEST_F(WritePlaces, NothingIsWrittenOutsideOfTheFoldersThatAreAllowed) {
  const fs::path inside = root_ / "inside";
  fs::create_directory_symlink(root_ / "outside", inside / "way_out");
  fs::create_symlink("../outside/new", inside / "to_nothing");
  fs::create_symlink("../outside/kept", inside / "to_kept");
  write_only_inside({inside});
  EXPECT_TRUE(writes(inside / "a"));
  make_folder(inside / "b/c");
  EXPECT_TRUE(writes(inside / "b/c/d"));
  for (const char* place :
       {"../outside/kept", "../outside/new", "way_out/new", "to_nothing", "to_kept"})
    EXPECT_FALSE(writes(inside / place)) << place;
  for (const char* place : {"../outside/folder", "way_out/folder", "../other"})
    EXPECT_THROW(make_folder(inside / place), WriteError) << place;
  EXPECT_FALSE(writes("/dev/null"));
  EXPECT_EQ(read_file_bytes(root_ / "outside/kept"), "kept");
  EXPECT_EQ(std::distance(fs::directory_iterator(root_ / "outside"), {}), 1);
  write_only_inside({});
  EXPECT_TRUE(writes(root_ / "outside/new"));
}

TEST_F(WritePlaces, AFolderThatIsAFileIsNotMade) {
  EXPECT_THROW(make_folder(root_ / "outside/kept"), WriteError);
  EXPECT_THROW(make_folder(root_ / "outside/kept/a"), WriteError);
}

}  // namespace
}  // namespace lamina
