// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "picture_look.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/nearest_name.h"

namespace lamina::cli {
namespace {

/// The config that a view or a display is looked up in; "": none is asked for.
std::string config_of(const LookOptions& options) {
  if (!options.ocio.empty()) return options.ocio;
  const bool is_own = options.view.empty() || find_enum_value<View>(options.view);
  if (is_own && options.display.empty()) return "";
  const char* config = std::getenv("OCIO");
  if (config && *config) return config;
  const auto names = names_of<View>();
  throw InvalidInput(
      is_own
          ? "--display: goes with a config of OpenColorIO, by --ocio or the environment "
            "variable OCIO, but there is none"
          : fmt::format("--view: must be one of {}, or a view of the config of OpenColorIO "
                        "that --ocio or the environment variable OCIO names, but is {}{}",
                        fmt::join(names, ", "), options.view, did_you_mean(options.view, names)));
}

}  // namespace

void add_look_options(const Command& command, LookOptions& options) {
  options.exposure_given =
      command.add_option("--exposure", options.exposure, "stops, for the PNG only")
          .type_name("EV")
          .range(-50.0, 50.0)
          .group("Look");
  command
      .add_option("--view", options.view,
                  "how the PNG is seen: filmic, which rolls highlights off; agx, softer, bright "
                  "colors lose saturation; standard, cut off; or a view of an OpenColorIO config")
      .type_name(fmt::format("VIEW:{{{}}}", fmt::join(names_of<View>(), ",")))
      .group("Look");
  command
      .add_option("--ocio", options.ocio,
                  "config of OpenColorIO whose view the PNG shows, by default that of the "
                  "environment variable OCIO for views that lamina does not have")
      .type_name("FILE")
      .group("Look");
  command
      .add_option("--display", options.display, "of that config; by default the one it names first")
      .type_name("NAME")
      .group("Look");
  command
      .add_choice("--color-space", options.space,
                  "of the colors of the EXR, linear: rec709, or acescg, the primaries AP1 of ACES; "
                  "the file says which")
      .group("Look");
}

PictureLook::PictureLook(const LookOptions& options) : space_(options.space) {
  if (options.exposure_given.is_given()) exposure_ = static_cast<double>(options.exposure);
  const std::string config = config_of(options);
  if (config.empty())
    view_ = find_enum_value<View>(options.view);
  else
    ocio_.emplace(OcioChoice{.config = config, .display = options.display, .view = options.view});
}

std::string PictureLook::write(const Image& image, const PictureFiles& files,
                               const std::vector<ImageNote>& notes, const OfScene& scene,
                               const std::vector<std::string>& channels) const {
  std::string written;
  const double exposure = exposure_.value_or(scene.exposure);
  const View view = view_.value_or(scene.view);
  if (!files.exr.empty()) {
    std::vector<ImageNote> said = notes;
    for (ImageNote& note : said) {
      if (note.name == "lamina/view")
        note.text = ocio_ ? ocio_->display() + ", " + ocio_->view() : std::string(name_of(view));
      if (note.name == "lamina/exposure_stops") note.text = number_text(exposure);
    }
    save_exr(channels.empty() ? image : select_channels(image, channels), files.exr,
             ExrPrecision::half, said, space_, scene.frame);
    written += files.exr;
  }
  if (!files.png.empty()) {
    const Image colors = unpremultiplied(image);
    save_png(ocio_ ? ocio_->see(colors, exposure) : view_image(colors, view, exposure), files.png);
    written += (written.empty() ? "" : ", ") + files.png;
  }
  return written;
}

}  // namespace lamina::cli
