// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "lamina/base/image/image.h"

namespace lamina {

/// View of an OpenColorIO config; names left empty are chosen by the config.
struct OcioChoice {
  std::string config;  ///< path of the file
  std::string display, view;
};

/// A view of an OpenColorIO config: how a studio looks at linear light.
///
/// Linear Rec.709 enters as the config's space of that name (`lin_rec709`, "Linear Rec.709 (sRGB)",
/// and what other configs call it), or as ACES2065-1 where the config has the role
/// `aces_interchange`.
class OcioView {
 public:
  /// @throws FileError if the config cannot be read, or is not valid; InvalidInput if it has no
  ///         such display or view, naming those that it has, or no space for linear Rec.709, or if
  ///         lamina was built without OpenColorIO
  explicit OcioView(const OcioChoice& choice);
  ~OcioView();
  OcioView(OcioView&&) noexcept;
  OcioView& operator=(OcioView&&) noexcept;

  [[nodiscard]] const std::string& display() const;
  [[nodiscard]] const std::string& view() const;

  /// An image for display: the channels R, G, B (or Y) in linear Rec.709 times 2^exposure, seen
  /// through the view. As view_image (base/image/tone.h) ready for save_png, which then holds the
  /// code values that OpenColorIO gives, cut off at 0 and 1. NaN is 0, light beyond 65504 is that.
  /// A stays as it is, other channels are left out.
  /// @param exposure  [stops]
  /// @throws InvalidInput if there are no such channels
  [[nodiscard]] Image see(const Image& image, double exposure = 0.0) const;

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
};

}  // namespace lamina
