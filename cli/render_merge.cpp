// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "lamina/base/core/error.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/image/compare.h"
#include "lamina/base/image/denoise.h"
#include "lamina/render/film/film_shard.h"
#include "merge_options.h"
#include "picture_files.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

const std::vector<std::string> color_channels = {"R", "G", "B", "samples", "variance"};

bool are_colors(const std::vector<std::string>& channels) {
  return !channels.empty() && std::ranges::all_of(channels, [](const std::string& name) {
    return std::ranges::find(color_channels, name) != color_channels.end();
  });
}

/// Standard errors of the tiles that `lamina render --noise` looks at.
class TileNoise {
 public:
  void add(const FilmAccumulator& rows) {
    for (int x = 0; x < rows.width(); x += film_band_rows)
      tiles_.push_back(
          rows.luminance_of(x, 0, std::min(x + film_band_rows, rows.width()), rows.height()));
  }

  struct Verdict {
    std::size_t tiles = 0, noisy = 0;
    double worst = 0.0;  ///< standard error over brightness
  };
  /// What is darker than a quarter of the picture's mean counts as that bright.
  [[nodiscard]] Verdict verdict(double noise) const {
    Verdict verdict{.tiles = tiles_.size()};
    double mean = 0.0;
    for (const auto& tile : tiles_) mean += tile.mean / static_cast<double>(tiles_.size());
    for (const auto& [brightness, variance] : tiles_) {
      const double shown = std::max(brightness, 0.25 * mean);
      const double error = shown > 0.0 ? std::sqrt(variance) / shown : 0.0;
      verdict.worst = std::max(verdict.worst, error);
      if (error > noise) ++verdict.noisy;
    }
    return verdict;
  }

 private:
  std::vector<FilmAccumulator::Luminance> tiles_;
};

/// What all shards together show.
struct MergedPicture {
  Image image;
  std::vector<PixelCover> covers;
  TileNoise noise;
};

std::size_t words_per_pixel(const MergeOptions& options) {
  return options.channels.empty() || !are_colors(options.channels) ? 18 : color_channels.size();
}

MergedPicture merged_picture(const std::vector<FilmShard>& shards, const MergeOptions& options) {
  const FilmShardInfo& info = shards[0].info();
  const bool only_colors = words_per_pixel(options) == color_channels.size();
  MemoryBudget memory = options.common.memory;
  take_memory(memory,
              static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height) *
                  words_per_pixel(options),
              sizeof(float), "the merged picture");
  const Progress progress = make_progress("merging", Keeps::nothing);
  MergedPicture picture;
  const int bands = film_bands(info.height);
  for (int band = 0; band < bands; ++band) {
    (void)report_progress(progress, static_cast<double>(band) / bands);
    const FilmAccumulator rows = merged_band(shards, band, only_colors);
    Image image = rows.image(info.has_alpha);
    if (only_colors) image = select_channels(image, color_channels);
    if (band == 0) picture.image = make_image(info.width, info.height, image.channels);
    std::ranges::copy(image.pixels, picture.image.at(0, band * film_band_rows));
    std::ranges::copy(rows.covers(), std::back_inserter(picture.covers));
    picture.noise.add(rows);
  }
  return picture;
}

/// The sums of all shards in a file, which is a shard again.
void write_sums(const std::vector<FilmShard>& shards, const FilmShardInfo& info,
                const MergeOptions& options) {
  const Progress progress = make_progress("merging", Keeps::nothing);
  const int bands = film_bands(info.height);
  std::optional<FilmAccumulator> rows;
  save_film_shard(options.output, info, [&](int band) {
    (void)report_progress(progress, static_cast<double>(band) / bands);
    rows = merged_band(shards, band);
    return std::span<const FilmPixel>(std::as_const(*rows).pixels());
  });
}

}  // namespace

bool is_render_shard(const std::string& file) { return is_film_shard(file); }

void merge_render(const MergeOptions& options) {
  const bool to_sums = lower_case_ending(options.output) == ".shard";
  PictureFiles files;
  const PictureLook look(options.look);
  if (to_sums)
    require_writable(options.output);
  else
    files = picture_files(options.output, options.files[0]);
  std::vector<FilmShard> shards;
  for (const std::string& file : options.files) shards.emplace_back(file);
  for (const FilmShard& shard : shards)
    require_different({{"--output", to_sums ? options.output : files.exr},
                       {"--output", files.png},
                       {"--json", options.common.json},
                       {"a shard", shard.file().string()}});
  const FilmShardInfo info = merged_info(shards);
  std::int64_t samples = 0;
  for (const IndexRange& range : info.ranges) samples += range.size();
  const auto make = [&](int shard) {
    std::vector<std::string> words = info.command;
    if (!words.empty())
      words.insert(words.end(), {"--shard", fmt::format("{}/{}", shard, info.shards), "-o",
                                 fmt::format("{}.shard", shard)});
    return words;
  };
  if (!to_sums || options.needs_all)
    report_missing(missing_shards(info), info.shards, options.needs_all, make);

  JsonOutput json = make_result("merge");
  json["kind"] = "render";
  json["shards"] = info.shards;
  json["samples_per_pixel"] = samples;
  json["is_complete"] = samples == info.samples;
  json["cpu_seconds_of_shards"] = info.cpu_seconds;
  if (to_sums) {
    write_sums(shards, info, options);
    write_json(json, options.common);
    print(options.common,
          fmt::format("{}: {} of {} samples per pixel\n", options.output, samples, info.samples));
    return;
  }
  MergedPicture picture = merged_picture(shards, options);
  const std::vector<bool> is_measured = measured_pixels(picture.covers);
  const std::optional<double> noise = relative_noise(picture.image, is_measured);
  const std::optional<double> rms = relative_noise_rms(picture.image, is_measured);
  if (options.denoises) picture.image = denoise(picture.image);
  std::vector<ImageNote> notes = info.notes;
  notes.push_back({"lamina/version", info.version});
  const std::string written = look.write(picture.image, files, notes,
                                         {info.view, info.exposure, info.frame}, options.channels);
  if (noise) json["relative_noise"] = *noise;
  if (rms) json["relative_noise_rms"] = *rms;
  std::string noisy;
  if (options.noise > 0.0f) {
    const auto limit = static_cast<double>(options.noise);
    const TileNoise::Verdict verdict = picture.noise.verdict(limit);
    const double factor = verdict.worst / limit;
    json["noisy_tiles"] = verdict.noisy;
    json["tiles"] = verdict.tiles;
    if (verdict.noisy > 0)
      noisy = fmt::format(
          "{} of {} tiles have more noise than {:.3g} %, the worst {:.3g} %: about {:.0f} samples "
          "per pixel would do",
          verdict.noisy, verdict.tiles, 100.0 * limit, 100.0 * verdict.worst,
          std::ceil(static_cast<double>(samples) * factor * factor));
  }
  write_json(json, options.common);
  print(options.common,
        fmt::format("{}\n{} of {} samples per pixel, {}{:.1f} s CPU of all shards\n", written,
                    samples, info.samples, describe_noise(noise, rms), info.cpu_seconds));
  if (!noisy.empty()) throw std::runtime_error(noisy);
}

}  // namespace lamina::cli
