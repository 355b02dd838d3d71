// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/image/image.h"
#include "lamina/base/image/pixel_rectangle.h"
#include "lamina/base/io/files_read.h"
#include "lamina/base/io/json_file.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

enum class KeptPart;

/// A picture of a session, as far as it is.
struct SessionPicture {
  Image image;               ///< as RenderResult has it; of a region alone where one is asked for
  Film film;                 ///< of the scene; the picture's own size is a fraction of it
  std::uint64_t change = 0;  ///< of the scene, counted from 1
  int fraction = 1;          ///< the film is so many times as wide as the picture: 8, 4, 2 or 1
  bool is_first_look = false;  ///< light of the scene as it was stands in for some of it
  bool is_final = false;  ///< the picture that render() makes of the scene, or with more samples
  double samples_per_pixel = 0.0;
  double seconds = 0.0;  ///< since the change
};

/// A scene that is rendered again and again as it changes, keeping what a change leaves valid
/// (render/kept/kept_parts.h has the table): first small, then ever finer, then with ever more
/// samples. A change ends the work on a picture that it makes out of date.
///
/// All members may be called from any thread.
class RenderSession {
 public:
  struct Options {
    MemoryBudget memory;  ///< for reading files
    bool has_small_pictures = true;  ///< begins with an eighth of the film's width
    bool goes_on = true;  ///< adds samples to a final picture until the scene changes
    double seconds_between_pictures = 0.5;  ///< at least, of one fraction
    /// Changes the scene each time that it is loaded, as options of a command do. May be empty.
    std::function<void(Scene&)> prepare;
    /// Told of each picture and each line that a user should know, by the thread that renders: what
    /// it does must not wait for that thread. May be empty.
    std::function<void(const SessionPicture&)> on_picture;
    std::function<void(const std::string&)> on_notice;
    /// Told why a change has no picture. May be empty.
    std::function<void(const std::string&)> on_error;
    /// Renders in place of render(), with more options. May be empty.
    std::function<RenderResult(Scene&, const RenderOptions&, const Progress&)> render;
    /// Gives the progress of a picture that begins, which may ask to stop it. May be empty.
    std::function<Progress()> progress;
    /// Told all of the final picture where the work does not go on, and of one that progress asked
    /// to stop, as far as it is. May be empty.
    std::function<void(const Scene&, RenderResult)> on_result;
  };

  /// Loads the scene and begins to render it.
  /// @throws as load_scene
  RenderSession(JsonFile scene, const std::vector<std::string>& settings, Options options);
  ~RenderSession();
  RenderSession(const RenderSession&) = delete;
  RenderSession& operator=(const RenderSession&) = delete;

  /// Changes values as `--set` of a command does, `path=value` each, all at once, and reads files
  /// that are not as they were. A value replaces an earlier one of the same path.
  /// @return  the number of the change
  /// @throws  as load_scene; the scene is then as before
  std::uint64_t set(const std::vector<std::string>& settings);

  /// Reads files that are not as they were.
  std::uint64_t reload() { return set({}); }

  /// Renders a rectangle of the film alone, or all of it again.
  /// @throws InvalidInput if it does not lie on the film
  std::uint64_t set_region(std::optional<PixelRectangle> region);

  /// Stops the work until the next change.
  void cancel();

  /// The last picture; null if there is none yet.
  [[nodiscard]] std::shared_ptr<const SessionPicture> picture() const;

  enum class Wait { any, final };
  /// The first picture of the scene as it is now, or its final one. Null if `progress` asked to
  /// stop, after cancel(), or where there is none.
  /// @throws InvalidInput why there is no such picture
  [[nodiscard]] std::shared_ptr<const SessionPicture> wait_for(Wait what,
                                                               const Progress& progress = {}) const;

  struct Status {
    std::uint64_t change = 0;
    bool is_working = false;
    std::string error;  ///< why the scene as it is has no picture; else empty
    std::vector<std::string> warnings;  ///< of loading the scene as it is
  };
  [[nodiscard]] Status status() const;

  /// Files that the scene was made of, each as it was read.
  [[nodiscard]] std::vector<FileState> files() const;

  /// How often parts of a kind were made.
  [[nodiscard]] int made(KeptPart part) const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lamina
