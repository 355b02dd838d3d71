// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Shards as `lamina merge` reads them: of pictures, whose checksums are put right, and of photons.
#include <cstring>

#include "fuzz_input.h"
#include "lamina/base/core/hash.h"
#include "lamina/render/film/film_shard.h"
#include "photons_report.h"

namespace {

using namespace lamina;

constexpr std::size_t start_bytes = 32, end_bytes = 24, entry_bytes = 16, planes = 20;

void put(std::string& bytes, std::size_t at, std::uint64_t word) {
  std::memcpy(bytes.data() + at, &word, sizeof word);
}

std::uint64_t word_at(const std::string& bytes, std::size_t at) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// A picture of up to 16 rows: one band.
void mend(std::string& bytes) {
  const std::size_t entries = planes * entry_bytes;
  if (bytes.size() < start_bytes + entries + end_bytes) return;
  const std::uint64_t info = word_at(bytes, 16);
  if (info > bytes.size() - start_bytes - entries - end_bytes) return;
  Hash of_info;
  of_info.add(info);
  of_info.add_text(std::string_view(bytes).substr(start_bytes, info));
  put(bytes, 24, of_info.value());
  const std::size_t entries_at = bytes.size() - end_bytes - entries;
  std::size_t at = start_bytes + info;
  for (std::size_t i = 0; i < planes; ++i) {
    const std::uint64_t size = word_at(bytes, entries_at + i * entry_bytes);
    if (size > entries_at - at) return;
    Hash of_plane;
    of_plane.add_text(std::string_view(bytes).substr(at, size));
    put(bytes, entries_at + i * entry_bytes + 8, of_plane.value());
    at += size;
  }
  Hash of_entries;
  of_entries.add_text(std::string_view(bytes).substr(entries_at, entries));
  put(bytes, bytes.size() - end_bytes, of_entries.value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(fuzz::text_of(data, size));
  return fuzz::read_or_refuse([&] {
    if (!bytes.empty() && bytes[0] != 'l') {
      static_cast<void>(
          cli::load_photon_runs(fuzz::scratch_file("photons.json", bytes), {fuzz::most_memory}));
      return;
    }
    mend(bytes);
    const FilmShard shard(fuzz::scratch_file("shard", bytes));
    if (static_cast<std::int64_t>(shard.info().width) * shard.info().height > 1 << 16) return;
    static_cast<void>(missing_shards(merged_info({&shard, 1})));
    for (int band = 0; band < film_bands(shard.info().height); ++band)
      static_cast<void>(merged_band({&shard, 1}, band).image());
  });
}
