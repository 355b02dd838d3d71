// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/shard.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/files/image_frame.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/io/file_parts.h"
#include "lamina/render/film/film_accumulator.h"

// Sums of a part of a picture's samples in files, which are larger than what should be in memory:
// they are written and added up by bands of rows.
namespace lamina {

class PlaneSum;

/// Identity of the sums in a file: scene, version, seed, size and samples.
struct FilmShardInfo {
  std::string version;                 ///< of lamina
  std::uint64_t program = 0, key = 0;  ///< as program_key(), picture_key()
  std::string method;                  ///< its name
  std::uint64_t seed = 0;
  int width = 0, height = 0;
  ImageFrame frame;                ///< where they lie in the picture, if they are a region of it
  std::int64_t samples = 0;        ///< per pixel, of the whole picture
  int shards = 1;                  ///< into which it was split
  std::vector<IndexRange> ranges;  ///< of samples that the sums hold; apart and in their order
  View view = View::filmic;
  double exposure = 0.0;
  bool has_alpha = false;
  std::vector<ImageNote> notes;      ///< of the picture's file
  std::vector<std::string> command;  ///< makes a shard once --shard and --output are added
  double cpu_seconds = 0.0;
};

/// Rows that are read and written together.
inline constexpr int film_band_rows = 16;
[[nodiscard]] int film_bands(int height);

/// Writes a file of sums, whole or not at all.
/// @param band_pixels  the pixels [y][x] of each band, asked for in their order
/// @throws WriteError
void save_film_shard(const std::filesystem::path& file, const FilmShardInfo& info,
                     const std::function<std::span<const FilmPixel>(int band)>& band_pixels);
void save_film_shard(const std::filesystem::path& file, const FilmShardInfo& info,
                     const FilmAccumulator& film);

/// A file of sums. It is open only while it is read, as there may be thousands.
class FilmShard {
 public:
  /// @throws FileError if it is no such file, or is damaged as far as it was read.
  explicit FilmShard(std::filesystem::path file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const FilmShardInfo& info() const { return info_; }

 private:
  friend FilmAccumulator merged_band(std::span<const FilmShard> shards, int band, bool only_colors);
  void add_plane(const FileParts& parts, int band, std::size_t plane, PlaneSum& sum) const;

  struct Chunk {
    std::uint64_t at = 0, bytes = 0, checksum = 0;
  };
  std::filesystem::path file_;
  FilmShardInfo info_;
  std::vector<Chunk> chunks_;  ///< [band][plane]
};

/// Whether a file starts as one of sums does, of whatever version.
[[nodiscard]] bool is_film_shard(const std::filesystem::path& file);

/// Identity of all shards together.
/// @throws InvalidInput naming a shard that is of another version, scene, seed, size, number of
///         samples or split than the first, or has samples that one before it has, too.
[[nodiscard]] FilmShardInfo merged_info(std::span<const FilmShard> shards);

/// Shards of the split whose samples are not all there.
[[nodiscard]] std::vector<int> missing_shards(const FilmShardInfo& info);

/// The rows of a band with the samples of all shards, which belong together as merged_info() says.
///
/// @param only_colors  leaves out the parts of light, normals, albedo and depth
/// @throws             FileError if one is damaged
[[nodiscard]] FilmAccumulator merged_band(std::span<const FilmShard> shards, int band,
                                          bool only_colors = false);

}  // namespace lamina
