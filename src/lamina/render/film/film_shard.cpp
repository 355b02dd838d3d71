// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/film_shard.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <memory>
#include <numeric>
#include <utility>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/image/pixel_rectangle.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"
#include "lamina/render/film/internal/packed_plane.h"

// The file: a Start, the FilmShardInfo as JSON, the packed planes band by band, their sizes and
// checksums, an End.
namespace lamina {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 16> magic = {'l', 'a', 'm', 'i', 'n', 'a', ' ',
                                        's', 'h', 'a', 'r', 'd', ' ', '3'};
constexpr std::ptrdiff_t magic_name_bytes = 13;  // before the number of the version
constexpr std::uint64_t most_info_bytes = std::uint64_t{16} << 20;

struct Start {
  std::array<char, 16> magic{};
  std::uint64_t info_bytes = 0;
  std::uint64_t checksum = 0;  ///< of the number before, and of the JSON
};
struct Entry {
  std::uint64_t bytes = 0, checksum = 0;
};
struct End {
  std::uint64_t checksum = 0;  ///< of all entries
  std::array<char, 16> magic{};
};

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  Hash hash;
  hash.add_bytes(bytes);
  return hash.value();
}

std::string text_of(const FilmShardInfo& info) {
  JsonOutput ranges = JsonOutput::array();
  for (const IndexRange& range : info.ranges)
    ranges.push_back(JsonOutput::array({range.begin, range.end}));
  JsonOutput notes = JsonOutput::array();
  for (const ImageNote& note : info.notes)
    notes.push_back(JsonOutput::array({note.name, note.text}));
  const JsonOutput json = {{"version", info.version},
                           {"program", std::to_string(info.program)},
                           {"key", std::to_string(info.key)},
                           {"method", info.method},
                           {"seed", std::to_string(info.seed)},
                           {"width", info.width},
                           {"height", info.height},
                           {"frame", JsonOutput::array({info.frame.x, info.frame.y,
                                                        info.frame.width, info.frame.height})},
                           {"samples", info.samples},
                           {"shards", info.shards},
                           {"ranges", ranges},
                           {"view", name_of(info.view)},
                           {"exposure", info.exposure},
                           {"alpha", info.has_alpha},
                           {"notes", notes},
                           {"command", info.command},
                           {"cpu_seconds", info.cpu_seconds}};
  return json.text();
}

std::uint64_t whole_number(const JsonInput& input) {
  const std::string text = input.string();
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    input.fail("must be a whole number in quotes");
  return value;
}

FilmShardInfo read_info(const std::string& text, const std::string& name) {
  const JsonDocument document = parse_json(text, name);
  const JsonObject json = document.root().object(
      {"version", "program", "key", "method", "seed", "width", "height", "frame", "samples",
       "shards", "ranges", "view", "exposure", "alpha", "notes", "command", "cpu_seconds"});
  FilmShardInfo info;
  info.version = json.required("version").string();
  info.program = whole_number(json.required("program"));
  info.key = whole_number(json.required("key"));
  info.method = json.required("method").string();
  info.seed = whole_number(json.required("seed"));
  info.width = static_cast<int>(json.required("width").integer(1, 65536));
  info.height = static_cast<int>(json.required("height").integer(1, 65536));
  const auto frame = json.required("frame").array(4, 4);
  const auto of_frame = [&](std::size_t i) { return static_cast<int>(frame[i].integer(0, 65536)); };
  info.frame = {of_frame(0), of_frame(1), of_frame(2), of_frame(3)};
  if (info.frame.width > 0)
    require_inside({info.frame.x, info.frame.y, info.width, info.height}, info.frame.width,
                   info.frame.height, name + ": the region");
  info.samples = json.required("samples").integer(1, 1 << 24);
  info.shards = static_cast<int>(json.required("shards").integer(1, 1 << 24));
  std::int64_t end = 0;
  for (const JsonInput& entry : json.required("ranges").array(1)) {
    const auto ends = entry.array(2, 2);
    const std::int64_t begin = ends[0].integer(end, info.samples - 1);
    end = ends[1].integer(begin + 1, info.samples);
    info.ranges.push_back({begin, end});
  }
  info.view = json.required("view").choice<View>();
  info.exposure = json.required("exposure").number();
  info.has_alpha = json.required("alpha").boolean();
  for (const JsonInput& note : json.required("notes").array()) {
    const auto parts = note.array(2, 2);
    info.notes.push_back({parts[0].string(), parts[1].string()});
  }
  for (const JsonInput& word : json.required("command").array())
    info.command.push_back(word.string());
  info.cpu_seconds = json.required("cpu_seconds").number(at_least(0.0));
  return info;
}

std::size_t pixels_of_band(const FilmShardInfo& info, int band) {
  const int rows = std::min(film_band_rows, info.height - band * film_band_rows);
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(info.width);
}

template <class T>
std::span<std::byte> bytes_of(T& value) {
  return std::as_writable_bytes(std::span(&value, 1));
}

/// Ranges in their order; neighbours become one.
std::vector<IndexRange> joined(std::vector<IndexRange> ranges) {
  std::ranges::sort(ranges, {}, &IndexRange::begin);
  std::vector<IndexRange> result;
  for (const IndexRange& range : ranges)
    if (!result.empty() && result.back().end == range.begin)
      result.back().end = range.end;
    else
      result.push_back(range);
  return result;
}

bool overlap(const IndexRange& a, const IndexRange& b) {
  return a.begin < b.end && b.begin < a.end;
}

/// @throws InvalidInput if a shard is no part of the same picture as the first.
void require_same(const FilmShard& first, const FilmShard& shard) {
  const FilmShardInfo &a = first.info(), &b = shard.info();
  const auto require = [&](bool holds, const std::string& what, const auto& expected,
                           const auto& given) {
    if (holds) return;
    JsonOutput values = JsonOutput::array({expected, given});
    throw InvalidInput(shard.file().string() + ": " + what + " must be that of " +
                       first.file().string() + ", " + JsonOutput(expected).text() + ", but is " +
                       JsonOutput(given).text());
  };
  require(a.version == b.version, "the version of lamina", a.version, b.version);
  require(a.program == b.program, "the build of lamina", std::to_string(a.program),
          std::to_string(b.program));
  require(a.width == b.width, "the width", a.width, b.width);
  require(a.height == b.height, "the height", a.height, b.height);
  require(a.seed == b.seed, "the seed", std::to_string(a.seed), std::to_string(b.seed));
  require(a.samples == b.samples, "the number of samples of the whole picture", a.samples,
          b.samples);
  require(a.shards == b.shards, "the number of shards", a.shards, b.shards);
  require(a.method == b.method, "the method", a.method, b.method);
  if (a.key != b.key)
    throw InvalidInput(shard.file().string() + ": must be of the scene and settings of " +
                       first.file().string() + ", but is of others");
}

}  // namespace

int film_bands(int height) { return (height + film_band_rows - 1) / film_band_rows; }

void save_film_shard(const fs::path& file, const FilmShardInfo& info,
                     const std::function<std::span<const FilmPixel>(int band)>& band_pixels) {
  const std::string text = text_of(info);
  Hash hash;
  hash.add(std::uint64_t{text.size()});
  hash.add_text(text);
  Start start{.magic = magic, .info_bytes = text.size(), .checksum = hash.value()};
  write_file_parts(file, [&](const WritePart& write) {
    write(bytes_of(start));
    write(std::as_bytes(std::span(text)));
    std::vector<Entry> entries;
    for (int band = 0; band < film_bands(info.height); ++band) {
      const std::span<const FilmPixel> pixels = band_pixels(band);
      std::array<std::vector<std::byte>, film_planes> packed;
      parallel_for(film_planes, [&](std::size_t plane) {
        packed[plane] = pack_plane(all_film_planes[plane], pixels);
      });
      for (const std::vector<std::byte>& bytes : packed) {
        write(bytes);
        entries.push_back({bytes.size(), checksum_of(bytes)});
      }
    }
    write(std::as_bytes(std::span(entries)));
    End end{.checksum = checksum_of(std::as_bytes(std::span(entries))), .magic = magic};
    write(bytes_of(end));
  });
}

void save_film_shard(const fs::path& file, const FilmShardInfo& info, const FilmAccumulator& film) {
  const std::size_t whole_band =
      static_cast<std::size_t>(film_band_rows) * static_cast<std::size_t>(info.width);
  save_film_shard(file, info, [&](int band) {
    return film.pixels().subspan(static_cast<std::size_t>(band) * whole_band,
                                 pixels_of_band(info, band));
  });
}

bool is_film_shard(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const FileParts parts(file);
  Start start;
  if (parts.size() < sizeof start) return false;
  parts.read(0, bytes_of(start));
  return std::equal(magic.begin(), magic.begin() + magic_name_bytes, start.magic.begin());
}

FilmShard::FilmShard(fs::path file) : file_(std::move(file)) {
  const FileParts parts(file_);
  const auto refuse = [&](const std::string& why) { throw FileError(file_.string() + ": " + why); };
  const auto damaged = [&] { refuse("is damaged; remove it, and make it again"); };
  Start start;
  if (parts.size() < sizeof start) refuse("must be a shard of a picture, but is too short");
  parts.read(0, bytes_of(start));
  if (start.magic != magic) refuse("must be a shard of a picture of this version, but is not");
  if (start.info_bytes > std::min(most_info_bytes, parts.size() - sizeof start)) damaged();
  std::string text(start.info_bytes, '\0');
  parts.read(sizeof start, std::as_writable_bytes(std::span(text)));
  Hash hash;
  hash.add(start.info_bytes);
  hash.add_text(text);
  if (hash.value() != start.checksum) damaged();
  info_ = read_info(text, file_.string());

  const auto bands = static_cast<std::size_t>(film_bands(info_.height));
  std::vector<Entry> entries(bands * film_planes);
  const std::uint64_t before = sizeof start + text.size();
  const std::uint64_t behind = entries.size() * sizeof(Entry) + sizeof(End);
  if (parts.size() < before + behind) damaged();
  const std::uint64_t entries_at = parts.size() - behind;
  parts.read(entries_at, std::as_writable_bytes(std::span(entries)));
  End end;
  parts.read(parts.size() - sizeof end, bytes_of(end));
  if (end.magic != magic || end.checksum != checksum_of(std::as_bytes(std::span(entries))))
    damaged();
  std::uint64_t at = before;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::size_t pixels = pixels_of_band(info_, static_cast<int>(i / film_planes));
    if (entries[i].bytes > most_packed_bytes(pixels)) damaged();
    chunks_.push_back({at, entries[i].bytes, entries[i].checksum});
    at += entries[i].bytes;
  }
  if (at != entries_at) damaged();
}

void FilmShard::add_plane(const FileParts& parts, int band, std::size_t plane,
                          PlaneSum& sum) const {
  const Chunk& chunk = chunks_[static_cast<std::size_t>(band) * film_planes + plane];
  std::vector<std::byte> packed(chunk.bytes);
  parts.read(chunk.at, packed);
  if (checksum_of(packed) != chunk.checksum || !sum.add_packed(packed))
    throw FileError(file_.string() + ": is damaged; remove it, and make it again");
}

FilmShardInfo merged_info(std::span<const FilmShard> shards) {
  FilmShardInfo sum = shards[0].info();
  for (const FilmShard& shard : shards.subspan(1)) {
    require_same(shards[0], shard);
    for (const IndexRange& range : shard.info().ranges)
      for (const IndexRange& before : sum.ranges)
        if (overlap(range, before))
          throw InvalidInput(shard.file().string() + ": samples " +
                             std::to_string(std::max(range.begin, before.begin)) + " to " +
                             std::to_string(std::min(range.end, before.end) - 1) +
                             " must be given once, but a file before it has them, too");
    sum.ranges.insert(sum.ranges.end(), shard.info().ranges.begin(), shard.info().ranges.end());
    sum.ranges = joined(std::move(sum.ranges));
    sum.cpu_seconds += shard.info().cpu_seconds;
  }
  return sum;
}

std::vector<int> missing_shards(const FilmShardInfo& info) {
  std::vector<int> missing;
  for (int i = 0; i < info.shards; ++i) {
    const IndexRange wanted = range_of({i, info.shards}, info.samples);
    const bool is_there = std::ranges::any_of(info.ranges, [&](const IndexRange& range) {
      return range.begin <= wanted.begin && wanted.end <= range.end;
    });
    if (!is_there) missing.push_back(i);
  }
  return missing;
}

FilmAccumulator merged_band(std::span<const FilmShard> shards, int band, bool only_colors) {
  const FilmShardInfo& info = shards[0].info();
  const std::size_t pixels = pixels_of_band(info, band);
  std::vector<std::size_t> planes;
  for (std::size_t plane = 0; plane < film_planes; ++plane)
    if (!only_colors || all_film_planes[plane].is_color) planes.push_back(plane);
  std::vector<PlaneSum> sums;
  for (const FilmPlane& plane : all_film_planes)
    sums.emplace_back(plane, !only_colors || plane.is_color ? pixels : 0);
  std::int64_t samples = 0;
  for (const FilmShard& shard : shards) {
    const FileParts parts(shard.file_);
    parallel_for(planes.size(),
                 [&](std::size_t i) { shard.add_plane(parts, band, planes[i], sums[planes[i]]); });
    for (const IndexRange& range : shard.info().ranges) samples += range.size();
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      const std::int64_t hits = sums[hits_plane].low_word(pixel);
      if (sums[samples_plane].low_word(pixel) != samples || hits < 0 || hits > samples)
        throw FileError(shard.file_.string() + ": is damaged; remove it, and make it again");
    }
  }
  FilmAccumulator rows(info.width, static_cast<int>(pixels / static_cast<std::size_t>(info.width)));
  for (const std::size_t plane : planes) sums[plane].store(rows.pixels());
  return rows;
}

}  // namespace lamina
