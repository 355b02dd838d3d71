// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/files_read.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class FilesReadTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("files_read." + std::to_string(getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  fs::path folder_;
};

TEST_F(FilesReadTest, HasWhatIsReadAndWhatIsMissingOnceEach) {
  const fs::path before = file("before", "1"), read = file("read", "22");
  (void)read_file_bytes(before);
  const FilesRead reading;
  (void)read_file_bytes(read);
  (void)read_stream_bytes(read, 100);
  EXPECT_THROW((void)read_file_bytes(folder_ / "missing"), FileError);
  const std::vector<FileState> files = reading.files();
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0].file, folder_ / "missing");
  EXPECT_FALSE(files[0].is_there);
  EXPECT_EQ(files[1].file, read);
  EXPECT_EQ(files[1].size, 2U);
}

TEST_F(FilesReadTest, TellsAnotherSizeTimeOrFileInThePlaceOfOne) {
  const fs::path one = file("one", "1");
  const FileState state = state_of(one);
  EXPECT_EQ(state_of(one), state);
  (void)file("one", "12");
  EXPECT_NE(state_of(one), state);
  (void)file("one", "1");
  fs::last_write_time(one, fs::last_write_time(one) + std::chrono::seconds(1));
  EXPECT_NE(state_of(one), state);
  const fs::path other = file("other", "2");
  const FileState now = state_of(one);
  fs::last_write_time(other, fs::last_write_time(one));
  fs::rename(other, one);
  EXPECT_NE(state_of(one), now);
  fs::remove(one);
  EXPECT_FALSE(state_of(one).is_there);
}

TEST_F(FilesReadTest, InnerOneTellsTheOuterOneAtItsEnd) {
  const fs::path one = file("one", "1"), two = file("two", "2");
  const FilesRead outer;
  {
    const FilesRead inner;
    (void)read_file_bytes(one);
    EXPECT_EQ(inner.files().size(), 1U);
    EXPECT_TRUE(outer.files().empty());
  }
  (void)read_file_bytes(two);
  ASSERT_EQ(outer.files().size(), 2U);
  EXPECT_EQ(outer.files()[0].file, one);
  EXPECT_EQ(outer.files()[1].file, two);
}

}  // namespace
}  // namespace lamina
