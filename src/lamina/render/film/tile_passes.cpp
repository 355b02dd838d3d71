// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/tile_passes.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <system_error>
#include <vector>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/render/film/internal/checkpoint.h"

namespace lamina {
namespace {

constexpr int tile_size = 16;        // [pixel]
constexpr int least_samples = 16;    // before a tile may end early
constexpr int samples_at_once = 16;  // of each pixel of a tile; what a stop may lose
constexpr std::chrono::seconds between_checkpoints{30};
constexpr int least_share = 19;  // of the time is for samples, and 1 for checkpoints

/// Treats subnormal numbers as 0 on this thread: Embree and the tails of profiles would be slow.
class FlushSubnormals {
 public:
#if defined(__SSE2__)
  FlushSubnormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushSubnormals() { _mm_setcsr(before_); }
#else
  FlushSubnormals() = default;
  ~FlushSubnormals() = default;
#endif
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
  unsigned before_ = 0;
};

/// Samples per pixel after the pass that starts with `from`: twice as many, and with a noise to
/// reach only half as many again, so as not to overshoot it by much.
int end_of_pass(int from, const TilePassOptions& options) {
  const bool steps_small = options.noise > 0.0f && from >= least_samples;
  const std::int64_t to = from == 0 ? 1 : steps_small ? from + from / 2 : 2 * std::int64_t{from};
  const int most = from < options.samples ? options.samples : options.goes_on_to;
  return static_cast<int>(std::min<std::int64_t>(to, most));
}

using Clock = std::chrono::steady_clock;

class Passes {
 public:
  Passes(const std::function<CameraSample(int, int, int)>& sample, const TilePassOptions& options,
         const Progress& progress, FilmAccumulator& film)
      : sample_(sample),
        options_(options),
        progress_(progress),
        film_(film),
        columns_((film.width() + tile_size - 1) / tile_size),
        rows_((film.height() + tile_size - 1) / tile_size) {
    const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
    if (options.resumes && !options.checkpoint.empty())
      if (auto kept = load_checkpoint(options.checkpoint, options.key, film)) tiles_ = *kept;
    if (tiles_.samples.size() == count) {
      require_same_light();
      require_enough_samples();
    } else {
      tiles_ = {.samples = std::vector<std::int32_t>(count),
                .is_quiet = std::vector<std::uint8_t>(count),
                .noise = options.noise,
                .light = options.light};
    }
    if (tiles_.noise != options.noise) set_noise();
    count_finished();
  }

  bool run() {
    while (tiles_.from < std::max(options_.samples, options_.goes_on_to) && !is_stopped_) {
      const int to = end_of_pass(tiles_.from, options_);
      parallel_for(tiles_.samples.size(), [&](std::size_t tile) { add_to_tile(tile, to); });
      if (is_stopped_) break;
      tiles_.from = to;
      if (options_.goes_on_to > 0 && options_.on_image)
        options_.on_image(options_.image_of ? options_.image_of(film_) : film_.image());
      if (options_.noise > 0.0f && to >= least_samples) find_quiet_tiles();
    }
    if (!options_.checkpoint.empty()) {
      std::error_code ignored;
      if ((is_stopped_ && finished_ > 0) || (!is_stopped_ && options_.keeps)) keep();
      if (!is_stopped_ && !options_.keeps) std::filesystem::remove(options_.checkpoint, ignored);
    }
    return !is_stopped_;
  }

 private:
  struct Rectangle {
    int x0, y0, x1, y1;
  };
  Rectangle rectangle(std::size_t tile) const {
    const int x0 = static_cast<int>(tile % static_cast<std::size_t>(columns_)) * tile_size;
    const int y0 = static_cast<int>(tile / static_cast<std::size_t>(columns_)) * tile_size;
    return {x0, y0, std::min(x0 + tile_size, film_.width()),
            std::min(y0 + tile_size, film_.height())};
  }

  void add_to_tile(std::size_t tile, int to) {
    while (!is_stopped_ && !tiles_.is_quiet[tile] && tiles_.samples[tile] < to) {
      add_samples(tile, std::min(to, tiles_.samples[tile] + samples_at_once));
      keep_now_and_then();
      show_now_and_then();
    }
  }

  /// @throws FileError if the light on surfaces was sampled for other numbers of samples
  void require_same_light() const {
    if (tiles_.light != options_.light)
      throw FileError(
          options_.checkpoint.string() +
          ": its light was sampled for fewer or more samples per pixel than are wanted, "
          "and would not be seen as often; render.hierarchy.irradiance_samples makes "
          "it the same for all");
  }

  /// @throws FileError if the image that is there has more than are wanted
  void require_enough_samples() const {
    const std::int32_t most = std::ranges::max(tiles_.samples);
    if (most > options_.samples)
      throw FileError(options_.checkpoint.string() + ": has up to " + std::to_string(most) +
                      " samples per pixel, so that many or more must be wanted, but it is " +
                      std::to_string(options_.samples));
  }

  /// Another noise than that of the image which is there: its tiles are looked at anew.
  void set_noise() {
    tiles_.noise = options_.noise;
    tiles_.from = std::ranges::min(tiles_.samples);
    std::ranges::fill(tiles_.is_quiet, std::uint8_t{0});
    if (options_.noise > 0.0f && tiles_.from >= least_samples) find_quiet_tiles();
  }

  void count_finished() {
    finished_ = 0;
    for (std::size_t tile = 0; tile < tiles_.samples.size(); ++tile)
      finished_ += tiles_.is_quiet[tile] ? options_.samples : tiles_.samples[tile];
  }

  /// Adds samples to all pixels of a tile, or none if asked to stop meanwhile.
  void add_samples(std::size_t tile, int to) {
    const std::shared_lock whole_tile = begin_tile();
    const FlushSubnormals flush;
    const Rectangle r = rectangle(tile);
    const int from = tiles_.samples[tile];
    std::vector<CameraSample> samples;  // [y][x][i]
    for (int y = r.y0; y < r.y1; ++y) {
      for (int x = r.x0; x < r.x1; ++x)
        for (int i = from; i < to; ++i) samples.push_back(sample_(x, y, i));
      if (!is_told()) return;
    }
    std::size_t next = 0;
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        for (int i = from; i < to; ++i) film_.add(x, y, samples[next++]);
    finished_ += to - from;
    tiles_.samples[tile] = to;
    (void)is_told();
  }

  /// Reports how far the image is. Returns whether to go on.
  bool is_told() {
    const double all =
        static_cast<double>(options_.samples) * static_cast<double>(tiles_.samples.size());
    if (!report_progress(progress_, std::min(static_cast<double>(finished_) / all, 1.0)))
      is_stopped_ = true;
    return !is_stopped_;
  }

  /// Waits while a checkpoint is written, or is about to be.
  std::shared_lock<std::shared_mutex> begin_tile() {
    const std::scoped_lock in_turn(gate_);
    return std::shared_lock(tiles_in_work_);
  }

  /// A checkpoint that cannot be written is none: the image goes on without.
  void keep() {
    const auto start = Clock::now();
    std::string why;
    try {
      save_checkpoint(options_.checkpoint, options_.key, film_, tiles_);
    } catch (const WriteError& error) {
      why = error.what();
    }
    if (options_.on_checkpoint) options_.on_checkpoint(why);
    const auto end = Clock::now();
    next_checkpoint_ =
        end + std::max<Clock::duration>(between_checkpoints, least_share * (end - start));
  }

  /// One thread writes a checkpoint if the last is old, once all tiles in work are whole.
  void keep_now_and_then() {
    const auto now = Clock::now();
    if (options_.checkpoint.empty() || now < next_checkpoint_.load()) return;
    const std::scoped_lock in_turn(gate_);
    const std::unique_lock all_tiles(tiles_in_work_);
    if (now >= next_checkpoint_.load()) keep();  // else another thread did
  }

  /// One thread shows the image if the last is old: as all tiles have it when they are whole.
  void show_now_and_then() {
    if (!options_.on_image || tiles_.from < 1 || Clock::now() < next_image_.load()) return;
    const std::unique_lock alone(image_in_work_, std::try_to_lock);
    if (!alone || Clock::now() < next_image_.load()) return;
    const auto start = Clock::now();
    const Image image = [&] {
      const std::scoped_lock in_turn(gate_);
      const std::unique_lock all_tiles(tiles_in_work_);
      return options_.image_of ? options_.image_of(film_) : film_.image();
    }();
    options_.on_image(image);
    const auto wait = std::chrono::duration_cast<Clock::duration>(options_.between_images);
    const auto end = Clock::now();
    next_image_ = end + std::max(wait, 9 * (end - start));
  }

  /// Tiles whose pixels have a small enough standard error end. What is darker than a quarter of
  /// the picture's mean counts as that bright: its noise is not seen.
  void find_quiet_tiles() {
    const std::size_t count = tiles_.samples.size();
    std::vector<FilmAccumulator::Luminance> tile_luminance(count);
    double mean = 0.0;
    for (std::size_t tile = 0; tile < count; ++tile) {
      const Rectangle r = rectangle(tile);
      tile_luminance[tile] = film_.luminance_of(r.x0, r.y0, r.x1, r.y1);
      mean += tile_luminance[tile].mean / static_cast<double>(count);
    }
    for (std::size_t tile = 0; tile < count; ++tile) {
      const double brightness = std::max(tile_luminance[tile].mean, 0.25 * mean);
      const double allowed = static_cast<double>(options_.noise) * brightness;
      if (tile_luminance[tile].variance <= allowed * allowed) tiles_.is_quiet[tile] = 1;
    }
    count_finished();
  }

  const std::function<CameraSample(int, int, int)>& sample_;
  const TilePassOptions& options_;
  const Progress& progress_;
  FilmAccumulator& film_;
  int columns_, rows_;
  TileProgress tiles_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<std::int64_t> finished_ = 0;  ///< samples per pixel, over all tiles
  std::shared_mutex tiles_in_work_;         ///< shared by who adds to a tile
  std::mutex gate_;                         ///< before it, so that a checkpoint gets its turn
  std::atomic<Clock::time_point> next_checkpoint_ = Clock::now() + between_checkpoints;
  std::mutex image_in_work_;  ///< held by who shows it
  std::atomic<Clock::time_point> next_image_ = Clock::now() + std::chrono::seconds(1);
};

}  // namespace

bool add_tile_passes(const std::function<CameraSample(int, int, int)>& sample,
                     const TilePassOptions& options, const Progress& progress,
                     FilmAccumulator& film) {
  return Passes(sample, options, progress, film).run();
}

}  // namespace lamina
