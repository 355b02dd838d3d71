// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/disk_cache.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/folder_names.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view suffix = ".lamina";

/// Of one text, or of a key and a value.
std::uint64_t hash_of(std::string_view text, std::string_view more = {}) {
  Hash hash;
  hash.add_text(text);
  if (!more.empty()) hash.add_text(more);
  return hash.value();
}

/// What a file starts with; the key and the value follow. The numbers are as this machine has them.
struct Header {
  std::array<char, 8> magic = {'l', 'a', 'm', 'c', 'a', 'c', 'h', 'e'};
  std::uint64_t version = 2;
  std::uint64_t key_size = 0, value_size = 0;
  std::uint64_t checksum = 0;  ///< of key and value
};

fs::path file_of(const DiskCache& cache, std::string_view key) {
  std::array<char, 17> name{};
  std::snprintf(name.data(), name.size(), "%016llx", static_cast<unsigned long long>(hash_of(key)));
  return cache.folder / (name.data() + std::string(suffix));
}

/// Removes what was used longest ago until a fourth of the cache is free, if it is too large.
void prune(const DiskCache& cache) {
  struct Kept {
    fs::file_time_type used;
    std::uintmax_t size;
    fs::path file;
  };
  std::error_code error;
  std::vector<Kept> all;
  std::uintmax_t total = 0;
  for (const std::string& name : folder_names(cache.folder, error)) {
    fs::path file = cache.folder / name;
    if (file.extension() != suffix) continue;
    std::error_code no_size, no_time;  // another process may be pruning, too
    const auto size = fs::file_size(file, no_size);
    const auto used = fs::last_write_time(file, no_time);
    if (no_size || no_time) continue;
    all.push_back({used, size, std::move(file)});
    total += size;
  }
  if (total <= cache.most_bytes) return;
  std::ranges::sort(all, {}, &Kept::used);
  for (const Kept& kept : all) {
    if (total <= cache.most_bytes / 4 * 3) break;
    fs::remove(kept.file, error);
    total -= kept.size;
  }
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::optional<DiskCache> user_cache() {
  const std::string own = variable("LAMINA_CACHE");
  if (own == "off") return std::nullopt;
  if (!own.empty()) return DiskCache{own};
  // The standard has relative folders ignored (XDG Base Directory Specification).
  if (const fs::path caches = variable("XDG_CACHE_HOME"); caches.is_absolute())
    return DiskCache{caches / "lamina"};
  if (const fs::path home = variable("HOME"); home.is_absolute())
    return DiskCache{home / ".cache" / "lamina"};
  return std::nullopt;
}

std::optional<std::string> load_cached(const DiskCache& cache, std::string_view key) {
  const fs::path file = file_of(cache, key);
  std::error_code error;
  const std::uintmax_t size = fs::is_regular_file(file, error) ? fs::file_size(file, error) : 0;
  Header found;
  if (error || size < sizeof found + key.size() || size > cache.most_bytes) return std::nullopt;
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
  std::memcpy(&found, bytes.data(), sizeof found);
  const std::string_view rest = std::string_view(bytes).substr(sizeof found);
  if (!rest.starts_with(key)) return std::nullopt;
  const std::string_view value = rest.substr(key.size());
  const Header expected{
      .key_size = key.size(), .value_size = value.size(), .checksum = hash_of(key, value)};
  if (std::memcmp(&found, &expected, sizeof found) != 0) return std::nullopt;
  fs::last_write_time(file, fs::file_time_type::clock::now(), error);  // used just now
  return std::string(value);
}

bool save_cached(const DiskCache& cache, std::string_view key, std::string_view value) {
  const Header header{
      .key_size = key.size(), .value_size = value.size(), .checksum = hash_of(key, value)};
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(key).append(value);
  std::error_code error;
  fs::create_directories(cache.folder, error);
  try {
    write_file_bytes(file_of(cache, key), std::as_bytes(std::span(bytes)), Lasting::process);
  } catch (const WriteError&) {
    return false;
  }
  prune(cache);
  return true;
}

}  // namespace lamina
