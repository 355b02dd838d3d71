// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What lamina keeps for itself: the cache on disk, light on surfaces, unfinished pictures. The
// first byte chooses which; an odd one has the checksum put right, so that what comes behind it is
// read.
#include <cstring>

#include "fuzz_input.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/render/film/internal/checkpoint.h"
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"

namespace {

using namespace lamina;

std::uint64_t hash_of(std::string_view text) {
  Hash hash;
  hash.add_text(text);
  return hash.value();
}

void read_cache(std::string bytes, bool mends) {
  const std::string key = "key";
  const DiskCache cache{fuzz::scratch_folder() / "cache"};
  if (mends && bytes.size() > 40) {
    Hash hash;  // magic, version, size of the key, size of the value, checksum; key and value
    hash.add_text(key);
    const std::string value = bytes.substr(std::min(bytes.size(), std::size_t{40} + key.size()));
    if (!value.empty()) hash.add_text(value);
    const std::uint64_t sum = hash.value();
    std::memcpy(bytes.data() + 32, &sum, sizeof sum);
  }
  static_cast<void>(save_cached(cache, key, "value"));
  std::array<char, 17> name{};
  std::snprintf(name.data(), name.size(), "%016llx", static_cast<unsigned long long>(hash_of(key)));
  fuzz::scratch_file(std::string("cache/") + name.data() + ".lamina", bytes);
  static_cast<void>(load_cached(cache, key));
}

void read_clouds(std::string bytes, bool mends) {
  const std::string word = "comment checksum ";
  const std::size_t at = bytes.find(word);
  if (mends && at != std::string::npos && bytes.size() >= at + word.size() + 16) {
    bytes.replace(at + word.size(), 16, 16, '0');
    std::array<char, 17> sum{};
    std::snprintf(sum.data(), sum.size(), "%016llx",
                  static_cast<unsigned long long>(hash_of(bytes)));
    bytes.replace(at + word.size(), 16, sum.data());
  }
  static_cast<void>(load_irradiance_clouds(fuzz::scratch_file("light.ply", bytes), {1, 2, 3, 4, 5},
                                           {fuzz::most_memory}));
}

void read_checkpoint(std::string bytes, bool mends) {
  constexpr std::size_t head = 72;  // magic, checksum, key, tiles, ...; samples, is_quiet, film
  std::uint64_t tiles = 0;
  if (bytes.size() >= head) std::memcpy(&tiles, bytes.data() + 32, sizeof tiles);
  if (mends && bytes.size() >= head && tiles <= (bytes.size() - head) / 5) {
    const std::span<const std::byte> all = std::as_bytes(std::span(bytes));
    Hash hash;
    hash.add_bytes(all.subspan(24, head - 24));
    hash.add_bytes(all.subspan(head, 4 * tiles));
    hash.add_bytes(all.subspan(head + 4 * tiles, tiles));
    hash.add_bytes(all.subspan(head + 5 * tiles));
    const std::uint64_t sum = hash.value();
    std::memcpy(bytes.data() + 16, &sum, sizeof sum);
  }
  FilmAccumulator film(2, 2);
  static_cast<void>(load_checkpoint(fuzz::scratch_file("film", bytes), 7, film));
  static_cast<void>(film.image());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool mends = data[0] % 2 == 1;
  const std::string bytes(fuzz::text_of(data + 1, size - 1));
  return fuzz::read_or_refuse([&] {
    switch (data[0] / 2 % 3) {
      case 0:
        return read_cache(bytes, mends);
      case 1:
        return read_clouds(bytes, mends);
      default:
        return read_checkpoint(bytes, mends);
    }
  });
}
