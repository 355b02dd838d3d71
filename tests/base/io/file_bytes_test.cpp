// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/file_bytes.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "lamina/base/core/error.h"

namespace {
thread_local std::vector<std::string> steps;  // that the test below looks at
}

// In place of the C library's, to see their order.
extern "C" int fsync(int file) {
  struct stat status {};
  fstat(file, &status);
  steps.push_back(S_ISDIR(status.st_mode) ? "folder on the disk" : "file on the disk");
  return static_cast<int>(syscall(SYS_fsync, file));
}
extern "C" int rename(const char* from, const char* to) noexcept {
  steps.push_back("renamed");
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

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
    MemoryBudget budget{most};
    (void)read_file_bytes(file, budget);
  } catch (const FileError& error) {
    return error.what();
  }
  return "read";
}

TEST_F(FileBytes, AreReadToTheLimit) {
  std::ofstream(file_) << std::string(100, 'x');
  MemoryBudget budget{120};
  EXPECT_EQ(read_file_bytes(file_, budget), std::string(100, 'x'));
  EXPECT_EQ(budget.left, 20U);
  EXPECT_EQ(refusal(file_, 99), file_.string() +
                                    ": is larger than 99 B, what is left of the "
                                    "memory budget (--memory-budget)");
}

/// What a shell makes of <(...).
struct OpenPipe {
  OpenPipe() { EXPECT_EQ(pipe(ends.data()), 0); }
  OpenPipe(const OpenPipe&) = delete;
  OpenPipe& operator=(const OpenPipe&) = delete;
  ~OpenPipe() { close(ends[0]); }

  /// Until all is taken, or nobody reads any more.
  void send(const std::string& text) {
    std::size_t sent = 0;
    while (sent < text.size()) {
      const ssize_t got = write(ends[1], text.data() + sent, text.size() - sent);
      if (got <= 0) break;
      sent += static_cast<std::size_t>(got);
    }
    close(ends[1]);
  }

  std::array<int, 2> ends{};
  std::filesystem::path name() const { return "/dev/fd/" + std::to_string(ends[0]); }
};

TEST_F(FileBytes, OfAPipeAreReadToItsEnd) {
  OpenPipe open;
  const std::string sent(200'000, 'y');
  std::thread writer([&] { open.send(sent); });
  EXPECT_EQ(read_stream_bytes(open.name(), sent.size()), sent);
  writer.join();
}

TEST_F(FileBytes, OfAPipeBeyondTheLimitAreRefused) {
  OpenPipe open;
  std::thread writer([&] { open.send(std::string(2000, 'y')); });
  EXPECT_THROW((void)read_stream_bytes(open.name(), 1999), FileError);
  writer.join();
}

TEST_F(FileBytes, OfAPipeInAFolderAreRefusedAtOnce) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_THROW((void)read_stream_bytes(file_, 100), FileError);
  EXPECT_THROW(require_regular_file(file_), FileError);
}

// Nobody writes into this pipe: whoever opens it waits for ever.
TEST_F(FileBytes, OfAPipeThatAnotherFileNamesAreRefusedAtOnce) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_EQ(refusal(file_), file_.string() + ": is a pipe, but must be a file");
}

TEST_F(FileBytes, OfWhatIsNoFileAreRefused) {
  EXPECT_EQ(refusal("missing"), "missing: there is no such file");
  EXPECT_EQ(refusal("/"), "/: is a folder, but must be a file");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device, but must be a file");
}

class WrittenFile : public testing::Test {
 protected:
  WrittenFile()
      : folder(std::filesystem::path(testing::TempDir()) /
               ("written_file." + std::to_string(getpid()))),
        file(folder / "result") {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directory(folder);
  }
  ~WrittenFile() override { std::filesystem::remove_all(folder); }

  static void write(const std::filesystem::path& to, std::string_view text) {
    write_file_bytes(to, std::as_bytes(std::span(text)));
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      all.push_back(entry.path().filename());
    std::ranges::sort(all);
    return all;
  }
  std::filesystem::path folder, file;
};

// Else a loss of power could leave the new name with nothing behind it, where a good file was.
TEST_F(WrittenFile, IsOnTheDiskBeforeItTakesItsPlace) {
  steps.clear();
  write(file, "new");
  EXPECT_EQ(steps, (std::vector<std::string>{"file on the disk", "renamed", "folder on the disk"}));
  EXPECT_EQ(read_file_bytes(file), "new");
}

TEST_F(WrittenFile, KeepsItsPermissions) {
  write(file, "secret");
  chmod(file.c_str(), 0600);
  write(file, "new secret");
  struct stat status {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
}

// Names that can be foreseen are links to somewhere else, put there by somebody else.
TEST_F(WrittenFile, FollowsNoLinkThatWasPlantedForIt) {
  const std::filesystem::path victim = folder / "victim";
  std::ofstream(victim) << "untouched";
  for (const std::string& name : {"." + std::to_string(getpid()) + ".tmp", std::string(".tmp")})
    std::filesystem::create_symlink(victim, file.string() + name);
  write(file, "new");
  EXPECT_EQ(read_file_bytes(victim), "untouched");
  EXPECT_EQ(read_file_bytes(file), "new");
}

TEST_F(WrittenFile, FollowsLinksOfItsUserOnly) {
  const std::filesystem::path mine = folder / "mine", link = folder / "link";
  write(mine, "old");
  std::filesystem::create_symlink("mine", link);
  write(link, "new");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_file_bytes(mine), "new");
  if (geteuid() != 0) GTEST_SKIP() << "only root can make links of somebody else";
  ASSERT_EQ(lchown(link.c_str(), 12345, 12345), 0);
  write(link, "newer");
  EXPECT_FALSE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_file_bytes(mine), "new");
  EXPECT_EQ(read_file_bytes(link), "newer");
}

TEST_F(WrittenFile, SweepsAwayWhatKilledProcessesLeft) {
  std::ofstream(folder / ".lamina-0123456789abcdef.tmp") << "of a process that is gone";
  std::ofstream(folder / ".lamina-fedcba9876543210.tmp") << "of another one at work";
  std::ofstream(folder / "mine.tmp") << "of a user";
  const int other = open((folder / ".lamina-fedcba9876543210.tmp").c_str(), O_RDONLY);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  write(file, "new");
  EXPECT_EQ(names(),
            (std::vector<std::string>{".lamina-fedcba9876543210.tmp", "mine.tmp", "result"}));
  close(other);
}

TEST_F(WrittenFile, MayBeADeviceOrAPipe) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  write("/dev/fd/" + std::to_string(ends[1]), "through a pipe");
  std::array<char, 20> got{};
  EXPECT_EQ(read(ends[0], got.data(), got.size()), 14);
  EXPECT_STREQ(got.data(), "through a pipe");
  for (const int end : ends) close(end);
  try {
    write("/dev/full", "text");
    ADD_FAILURE() << "written to a full device";
  } catch (const WriteError& error) {
    EXPECT_STREQ(error.what(), "/dev/full: cannot be written: No space left on device");
  }
}

}  // namespace
}  // namespace lamina
