// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/render_session.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/stoppable_loops.h"
#include "lamina/base/io/kept_readings.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/kept/kept_parts.h"
#include "lamina/render/planning/method_choice.h"

namespace lamina {
namespace {

using Clock = std::chrono::steady_clock;

/// Pictures are no smaller than that, beside those of the film's own size [pixel]:
/// test RenderSession.ShowsSmallPicturesFirstAndFirstLooksOfAMovedCamera.
constexpr int least_side = 32;

/// Samples per pixel of a picture that is smaller than the film.
int samples_of(int fraction) { return fraction == 8 ? 4 : fraction == 4 ? 2 : 1; }

constexpr int endless_samples = std::numeric_limits<int>::max();

std::string_view path_of(std::string_view setting) { return setting.substr(0, setting.find('=')); }

/// Whether a path is another one or lies below it.
bool is_within(std::string_view path, std::string_view outer) {
  return path.starts_with(outer) &&
         (path.size() == outer.size() || path[outer.size()] == '.' || path[outer.size()] == '[');
}

int part_of_side(int side, int fraction) { return std::max(1, side / fraction); }

/// A film so many times as small, and its region.
Film smaller(const Film& film, int fraction) {
  Film small = film;
  small.width = part_of_side(film.width, fraction);
  small.height = part_of_side(film.height, fraction);
  if (film.region) {
    const auto& [x, y, width, height] = *film.region;
    const auto begin = [&](int at, int side) { return std::min(at / fraction, side - 1); };
    small.region->x = begin(x, small.width);
    small.region->y = begin(y, small.height);
    small.region->width =
        std::clamp((width + fraction - 1) / fraction, 1, small.width - small.region->x);
    small.region->height =
        std::clamp((height + fraction - 1) / fraction, 1, small.height - small.region->y);
  }
  return small;
}

double mean_samples(const Image& image) {
  const auto channel = channel_index(image, "samples");
  if (!channel || image.pixels.empty()) return 0.0;
  const std::size_t stride = image.channel_count();
  double sum = 0.0;
  for (std::size_t i = *channel; i < image.pixels.size(); i += stride)
    sum += static_cast<double>(image.pixels[i]);
  return sum / (static_cast<double>(image.pixels.size()) / static_cast<double>(stride));
}

}  // namespace

class RenderSession::Work {
 public:
  Work(JsonFile file, const std::vector<std::string>& settings, Options options)
      : file_(std::move(file)), options_(std::move(options)) {
    (void)set(settings);
    thread_ = std::thread([this] { run(); });
  }

  ~Work() {
    {
      const std::scoped_lock lock(mutex_);
      is_ended_ = true;
      ++stamp_;
    }
    changed_.notify_all();
    thread_.join();
  }

  std::uint64_t set(const std::vector<std::string>& settings) {
    const std::scoped_lock one_at_a_time(loading_);
    std::vector<std::string> all = settings_;
    for (const std::string& setting : settings) {
      if (setting.find('=') == std::string::npos)
        throw InvalidInput("--set: must be KEY=VALUE, but is " + setting);
      const bool removes = setting.ends_with("=null");  // which takes what there is
      std::erase_if(all, [&](const std::string& old) {
        return !removes && path_of(old).find('+') == std::string_view::npos &&
               is_within(path_of(old), path_of(setting));
      });
      all.push_back(setting);
    }
    const FilesRead reading;
    Scene scene;
    {
      const KeptReadings::Use use(readings_);
      try {
        scene = load_scene(file_, options_.memory, all);
        if (options_.prepare) options_.prepare(scene);
      } catch (const Error&) {
        const std::scoped_lock lock(mutex_);
        files_ = reading.files();
        throw;
      }
    }
    settings_ = std::move(all);
    const std::scoped_lock lock(mutex_);
    files_ = reading.files();
    warnings_ = scene.warnings;
    film_ = scene.film;
    if (region_) require_inside(*region_, film_.width, film_.height, "region");
    next_scene_ = std::move(scene);
    return begin_change();
  }

  std::uint64_t set_region(std::optional<PixelRectangle> region) {
    const std::scoped_lock one_at_a_time(loading_);
    const std::scoped_lock lock(mutex_);
    if (region) require_inside(*region, film_.width, film_.height, "region");
    region_ = region;
    return begin_change();
  }

  void cancel() {
    const std::scoped_lock lock(mutex_);
    ++stamp_;
    is_cancelled_ = true;
    changed_.notify_all();
  }

  std::shared_ptr<const SessionPicture> picture() const {
    const std::scoped_lock lock(mutex_);
    return picture_;
  }

  std::shared_ptr<const SessionPicture> wait_for(Wait what, const Progress& progress) const {
    std::unique_lock lock(mutex_);
    while (true) {
      if (!error_.empty()) throw InvalidInput(error_);
      const auto& found = what == Wait::final ? final_ : picture_;
      if (found && found->change == change_) return found;
      if (is_cancelled_ || is_ended_) return nullptr;
      changed_.wait_for(lock, std::chrono::milliseconds(50));
      if (progress) {
        lock.unlock();
        if (!progress(0.0)) return nullptr;
        lock.lock();
      }
    }
  }

  Status status() const {
    const std::scoped_lock lock(mutex_);
    return {.change = change_,
            .is_working = is_working_ || has_work_,
            .error = error_,
            .warnings = warnings_};
  }

  std::vector<FileState> files() const {
    const std::scoped_lock lock(mutex_);
    return files_;
  }

  int made(KeptPart part) const {
    const std::scoped_lock lock(kept_in_work_);
    return kept_.made(part);
  }

 private:
  /// With the mutex held.
  std::uint64_t begin_change() {
    ++stamp_;
    is_cancelled_ = false;
    error_.clear();
    changed_at_ = Clock::now();
    has_work_ = true;
    ++change_;
    changed_.notify_all();
    return change_;
  }

  void run() {
    while (true) {
      std::uint64_t change = 0, stamp = 0;
      {
        std::unique_lock lock(mutex_);
        is_working_ = false;
        changed_.notify_all();
        changed_.wait(lock, [&] { return is_ended_ || has_work_; });
        if (is_ended_) return;
        has_work_ = false;
        is_working_ = true;
        if (next_scene_) scene_ = std::move(*next_scene_);
        next_scene_.reset();
        scene_.film = film_;
        if (region_) scene_.film.region = region_;
        change = change_;
        stamp = stamp_;
      }
      try {
        render_all(change, stamp);
      } catch (const Interrupted&) {
        continue;  // by a change, or by progress
      } catch (const std::exception& error) {
        {
          const std::scoped_lock lock(mutex_);
          if (stamp == stamp_) error_ = error.what();
        }
        changed_.notify_all();
        if (options_.on_error) options_.on_error(error.what());
      }
    }
  }

  void render_all(std::uint64_t change, std::uint64_t stamp) {
    const Film film = scene_.film;
    const RenderSettings settings = scene_.render;
    const RenderSettings chosen = choose_settings(scene_, {}).settings;
    const AspectHashes aspects = aspect_hashes(scene_, chosen, {});
    const auto render_one = [&](int fraction, bool is_first_look, int samples) {
      AspectHashes own = aspects;
      scene_.film = smaller(film, fraction);
      scene_.render = settings;
      if (fraction > 1 || is_first_look) {
        scene_.render.samples_per_pixel = std::min(samples, settings.samples_per_pixel);
        scene_.render.noise = 0.0f;
      }
      Hash of_film;
      for (const int number : {scene_.film.width, scene_.film.height}) of_film.add(number);
      own[static_cast<std::size_t>(SceneAspect::film)] = of_film.value();
      render_picture(own, film, fraction, is_first_look, change, stamp);
    };
    // Where only the camera has moved, light of the film's size stands in at once.
    const bool has_only_moved = chosen.method->keeps_light && [&] {
      AspectHashes before = finished_;
      before[static_cast<std::size_t>(SceneAspect::camera)] =
          aspects[static_cast<std::size_t>(SceneAspect::camera)];
      return before == aspects;
    }();
    if (options_.has_small_pictures) {
      const int side = std::min(rendered_area(film).width, rendered_area(film).height);
      for (const int fraction : {8, 4, 2})
        if (side / fraction >= least_side && (fraction == 8 || !has_only_moved))
          render_one(fraction, true, samples_of(fraction));
      if (has_only_moved && side / 8 >= least_side) render_one(1, true, 1);
    }
    render_one(1, false, settings.samples_per_pixel);
    finished_ = aspects;
  }

  void render_picture(const AspectHashes& aspects, const Film& film, int fraction,
                      bool is_first_look, std::uint64_t change, std::uint64_t stamp) {
    const auto is_current = [&] { return stamp_.load(std::memory_order_relaxed) == stamp; };
    const std::function<void()> ask = [&] {
      if (!is_current()) throw Interrupted();
    };
    const std::scoped_lock lock(kept_in_work_);
    kept_.begin_picture(aspects, fraction, is_first_look);
    const int wanted = scene_.render.samples_per_pixel;
    const bool is_whole = fraction == 1 && !is_first_look;
    const auto show = [&](const Image& image, bool is_complete) {
      if (!is_current()) return;
      SessionPicture shown{.image = image,
                           .film = film,
                           .change = change,
                           .fraction = fraction,
                           .is_first_look = kept_.has_stand_ins(),
                           .is_final = false,
                           .samples_per_pixel = mean_samples(image),
                           .seconds = seconds_since_change()};
      shown.is_final = is_whole && (is_complete || shown.samples_per_pixel >= wanted);
      publish(std::make_shared<const SessionPicture>(std::move(shown)));
    };
    RenderOptions how{.memory = options_.memory,
                      .kept = &kept_,
                      .on_notice = fraction == 1 ? options_.on_notice : nullptr,
                      .on_image = [&](const Image& image) { show(image, false); },
                      .seconds_between_images = options_.seconds_between_pictures};
    if (is_whole && options_.goes_on && !(scene_.render.noise > 0.0f))
      how.goes_on_to = endless_samples;
    const StoppableLoops stoppable(ask);
    const Progress told = options_.progress ? options_.progress() : Progress();
    const Progress progress = [&](double finished) {
      return report_progress(told, finished) && is_current();
    };
    RenderResult result =
        options_.render ? options_.render(scene_, how, progress) : render(scene_, how, progress);
    if (!is_current()) throw Interrupted();
    const bool is_complete = result.statistics.is_complete;
    if (is_complete && how.goes_on_to == 0) show(result.image, true);
    if (is_whole && options_.on_result) options_.on_result(scene_, std::move(result));
    if (!is_complete) throw Interrupted();
  }

  double seconds_since_change() const {
    const std::scoped_lock lock(mutex_);
    return std::chrono::duration<double>(Clock::now() - changed_at_).count();
  }

  void publish(const std::shared_ptr<const SessionPicture>& shown) {
    {
      const std::scoped_lock lock(mutex_);
      if (shown->change != change_) return;
      picture_ = shown;
      if (shown->is_final) final_ = shown;
    }
    changed_.notify_all();
    if (options_.on_picture) options_.on_picture(*shown);
  }

  const JsonFile file_;
  const Options options_;

  std::mutex loading_;  ///< before mutex_
  std::vector<std::string> settings_;
  KeptReadings readings_;

  mutable std::mutex kept_in_work_;  ///< before mutex_
  KeptParts kept_;
  Scene scene_;            ///< of the thread that renders
  AspectHashes finished_{};  ///< of the last scene whose picture was made in full

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::atomic<std::uint64_t> stamp_ = 0;  ///< another one where work is out of date
  std::uint64_t change_ = 0;
  bool has_work_ = false, is_working_ = false, is_cancelled_ = false, is_ended_ = false;
  std::optional<Scene> next_scene_;
  Film film_;
  std::optional<PixelRectangle> region_;
  std::vector<FileState> files_;
  std::vector<std::string> warnings_;
  std::string error_;
  Clock::time_point changed_at_;
  std::shared_ptr<const SessionPicture> picture_, final_;
  std::thread thread_;
};

RenderSession::RenderSession(JsonFile scene, const std::vector<std::string>& settings,
                             Options options)
    : work_(std::make_unique<Work>(std::move(scene), settings, std::move(options))) {}
RenderSession::~RenderSession() = default;
std::uint64_t RenderSession::set(const std::vector<std::string>& settings) {
  return work_->set(settings);
}
std::uint64_t RenderSession::set_region(std::optional<PixelRectangle> region) {
  return work_->set_region(region);
}
void RenderSession::cancel() { work_->cancel(); }
std::shared_ptr<const SessionPicture> RenderSession::picture() const { return work_->picture(); }
std::shared_ptr<const SessionPicture> RenderSession::wait_for(Wait what,
                                                              const Progress& progress) const {
  return work_->wait_for(what, progress);
}
RenderSession::Status RenderSession::status() const { return work_->status(); }
std::vector<FileState> RenderSession::files() const { return work_->files(); }
int RenderSession::made(KeptPart part) const { return work_->made(part); }

}  // namespace lamina
