// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/disk_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

namespace lamina {
namespace {

namespace fs = std::filesystem;

class DiskCacheTest : public testing::Test {
 protected:
  DiskCacheTest()
      : cache{fs::temp_directory_path() / ("lamina cache test " + std::to_string(getpid()))} {
    fs::remove_all(cache.folder);
  }
  ~DiskCacheTest() override { fs::remove_all(cache.folder); }

  [[nodiscard]] std::vector<fs::path> files() const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(cache.folder)) all.push_back(entry.path());
    return all;
  }
  DiskCache cache;
};

TEST_F(DiskCacheTest, GivesBackWhatItKept) {
  EXPECT_EQ(load_cached(cache, "key"), std::nullopt);
  const std::string value("any\0bytes\n", 10);
  ASSERT_TRUE(save_cached(cache, "key", value));
  EXPECT_EQ(load_cached(cache, "key"), value);
  EXPECT_EQ(load_cached(cache, "other key"), std::nullopt);
  ASSERT_TRUE(save_cached(cache, "key", ""));
  EXPECT_EQ(load_cached(cache, "key"), "");
  EXPECT_EQ(files().size(), 1u);
}

// Whoever may write into the folder could have whole disks read into memory.
TEST_F(DiskCacheTest, TakesFilesLargerThanItselfForMissing) {
  ASSERT_TRUE(save_cached(cache, "key", std::string(1000, 'x')));
  EXPECT_EQ(load_cached({.folder = cache.folder, .most_bytes = 999}, "key"), std::nullopt);
  EXPECT_TRUE(load_cached({.folder = cache.folder, .most_bytes = 2000}, "key").has_value());
}

// Every cut and every flipped byte must be seen; then the value can be kept again.
TEST_F(DiskCacheTest, TakesDamagedFilesForMissing) {
  ASSERT_TRUE(save_cached(cache, "key", "a value"));
  const fs::path file = files().at(0);
  std::string whole(fs::file_size(file), '\0');
  std::ifstream(file, std::ios::binary)
      .read(whole.data(), static_cast<std::streamsize>(whole.size()));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] ^= 1;
    std::ofstream(file, std::ios::binary) << flipped;
    EXPECT_EQ(load_cached(cache, "key"), std::nullopt) << "byte " << at;
    std::ofstream(file, std::ios::binary) << whole.substr(0, at);
    EXPECT_EQ(load_cached(cache, "key"), std::nullopt) << "cut at " << at;
  }
  std::ofstream(file, std::ios::binary) << whole << "more";
  EXPECT_EQ(load_cached(cache, "key"), std::nullopt);
  ASSERT_TRUE(save_cached(cache, "key", "a value"));
  EXPECT_EQ(load_cached(cache, "key"), "a value");
}

// The file of another key in its place, as two keys of one hash would have it.
TEST_F(DiskCacheTest, DoesNotMistakeOneKeyForAnother) {
  ASSERT_TRUE(save_cached(cache, "one", "value of one"));
  const fs::path file_of_one = files().at(0);
  ASSERT_TRUE(save_cached(cache, "two", "value of two"));
  fs::path file_of_two;
  for (const fs::path& file : files())
    if (file != file_of_one) file_of_two = file;
  fs::copy_file(file_of_one, file_of_two, fs::copy_options::overwrite_existing);
  EXPECT_EQ(load_cached(cache, "two"), std::nullopt);
}

TEST_F(DiskCacheTest, RemovesWhatWasUsedLongestAgo) {
  const std::string value(1000, 'x');
  cache.most_bytes = 8 * 1100;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(save_cached(cache, std::to_string(i), value));
    for (const fs::path& file : files())  // the clock of files may be slower than this loop
      fs::last_write_time(file, fs::last_write_time(file) - std::chrono::seconds(1));
  }
  ASSERT_TRUE(load_cached(cache, "0"));
  ASSERT_TRUE(save_cached(cache, "8", value));
  EXPECT_LE(files().size(), 6u);
  EXPECT_TRUE(load_cached(cache, "0"));
  EXPECT_TRUE(load_cached(cache, "8"));
  EXPECT_FALSE(load_cached(cache, "1"));
}

TEST_F(DiskCacheTest, ManyMayUseItAtOnce) {
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) {
        const std::string key = std::to_string(i % 3), value(5000, static_cast<char>('a' + i % 3));
        if ((i + t) % 2 == 0) save_cached(cache, key, value);
        if (const auto found = load_cached(cache, key); found && *found != value) ++wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(files().size(), 3u);  // and no temporary one
}

TEST_F(DiskCacheTest, KeepsNothingWhereItCannotWrite) {
  std::ofstream(cache.folder) << "a file in the place of the folder";
  EXPECT_FALSE(save_cached(cache, "key", "value"));
  EXPECT_EQ(load_cached(cache, "key"), std::nullopt);
}

TEST(UserCache, FollowsTheEnvironment) {
  for (const char* name : {"LAMINA_CACHE", "XDG_CACHE_HOME", "HOME"}) unsetenv(name);
  EXPECT_FALSE(user_cache());
  setenv("HOME", "/home/me", 1);
  EXPECT_EQ(user_cache()->folder, "/home/me/.cache/lamina");
  setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(user_cache()->folder, "/home/me/.cache/lamina");
  setenv("XDG_CACHE_HOME", "/caches", 1);
  EXPECT_EQ(user_cache()->folder, "/caches/lamina");
  setenv("LAMINA_CACHE", "/mine", 1);
  EXPECT_EQ(user_cache()->folder, "/mine");
  setenv("LAMINA_CACHE", "off", 1);
  EXPECT_FALSE(user_cache());
}

}  // namespace
}  // namespace lamina
