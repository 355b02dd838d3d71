// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/base/image/cryptomatte.h"
#include "lamina/render/film/camera_sample.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Counts what the samples of each pixel meet first. Different pixels may be added to from
/// different threads.
class MatteFilm {
 public:
  MatteFilm(int width, int height)
      : width_(static_cast<std::size_t>(width)),
        pixels_(width_ * static_cast<std::size_t>(height)) {}

  void add(int x, int y, const CameraSample& sample);

  /// Adds layers CryptoObject, by the names of meshes, and CryptoMaterial to an image of that size.
  /// @return  the attributes of the file
  std::vector<ImageNote> add_to(Image& image, const Scene& scene) const;

 private:
  struct Count {
    std::uint32_t mesh = 0, material = 0, samples = 0;
  };
  struct Pixel {
    std::uint32_t samples = 0;
    std::vector<Count> met;
  };
  std::size_t width_;
  std::vector<Pixel> pixels_;
};

}  // namespace lamina
