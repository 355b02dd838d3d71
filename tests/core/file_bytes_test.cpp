// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/core/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <thread>

#include "lamina/core/error.h"

namespace lamina {
namespace {

class FileBytes : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(testing::TempDir()) / ("file_bytes." + std::to_string(getpid()));
  }
  void TearDown() override { std::filesystem::remove(file_); }
  std::filesystem::path file_;
};

std::string refusal(const std::filesystem::path& file, std::size_t most = 100) {
  try {
    (void)read_file_bytes(file, most);
  } catch (const FileError& error) {
    return error.what();
  }
  return "read";
}

TEST_F(FileBytes, AreReadToTheLimit) {
  std::ofstream(file_) << std::string(100, 'x');
  EXPECT_EQ(read_file_bytes(file_, 100), std::string(100, 'x'));
  EXPECT_EQ(refusal(file_, 99), file_.string() + ": is larger than 99 bytes");
}

TEST_F(FileBytes, OfAPipeAreReadToItsEnd) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  const std::string sent(200'000, 'y');
  std::thread writer([&] { std::ofstream(file_) << sent; });
  EXPECT_EQ(read_file_bytes(file_), sent);
  writer.join();
}

TEST_F(FileBytes, OfWhatIsNoFileAreRefused) {
  EXPECT_EQ(refusal("missing"), "missing: there is no such file");
  EXPECT_EQ(refusal("/"), "/: is a folder, but must be a file");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device, but must be a file");
}

}  // namespace
}  // namespace lamina
