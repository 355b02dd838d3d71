// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "lamina/base/image/image.h"

namespace lamina {

/// Transform of an ICC profile to linear Rec.709, by the relative colorimetric intent, under
/// D65. Source: [ICC2010]; LittleCMS evaluates it, in floating point and without bounds.
class IccTransform {
 public:
  /// @param is_grey  of the pixels: one number in place of red, green and blue
  /// @throws InvalidInput in a few words: "is damaged", "is of CMYK, but ..."; also where lamina is
  ///         built without LittleCMS
  IccTransform(std::span<const std::byte> profile, bool is_grey);
  ~IccTransform();
  IccTransform(const IccTransform&) = delete;
  IccTransform& operator=(const IccTransform&) = delete;

  /// Whether the numbers that it takes are light.
  [[nodiscard]] bool takes_light() const { return takes_light_; }

  /// Turns the first channels of all pixels.
  void apply(Image& image) const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
  bool is_grey_ = false, has_grey_profile_ = false, takes_light_ = false;
};

}  // namespace lamina
