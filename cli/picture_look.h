// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "console.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/files/image_frame.h"
#include "lamina/base/image/files/ocio_view.h"
#include "lamina/base/image/tone.h"
#include "picture_files.h"

namespace lamina::cli {

/// Options of how pictures are written.
struct LookOptions {
  std::string view, ocio, display;
  float exposure = 0.0f;
  RgbSpace space = RgbSpace::rec709;
  Option exposure_given;
};

/// --exposure, --view, --ocio, --display and --color-space.
void add_look_options(const Command& command, LookOptions& options);

/// Names of those options.
inline constexpr std::array<std::string_view, 5> look_option_names = {
    "--exposure", "--view", "--ocio", "--display", "--color-space"};

/// How a picture is written: its PNG as it is seen, its EXR in a color space.
class PictureLook {
 public:
  /// @throws InvalidInput for a view that neither lamina nor the config of --ocio or of the
  ///         environment variable OCIO has; Error as OcioView
  explicit PictureLook(const LookOptions& options);

  /// Where the command line says nothing, the view and the exposure [stops] are those of a scene.
  struct OfScene {
    View view = View::filmic;
    double exposure = 0.0;
    ImageFrame frame;  ///< of the EXR, where the picture is a region of a larger one
  };

  /// Writes a picture, linear Rec.709, to those files that are wanted.
  /// @param channels  of the EXR; none: all
  /// @return          the names of the files
  std::string write(const Image& image, const PictureFiles& files,
                    const std::vector<ImageNote>& notes, const OfScene& scene,
                    const std::vector<std::string>& channels = {}) const;

 private:
  std::optional<View> view_;
  std::optional<double> exposure_;
  std::optional<OcioView> ocio_;
  RgbSpace space_;
};

}  // namespace lamina::cli
