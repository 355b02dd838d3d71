// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// The images of a scene together with coarser copies, for lookups that do not alias.
class TextureStore {
 public:
  /// `images` must outlive the store.
  explicit TextureStore(const std::vector<Image>& images);

  /// Adds an image, which must outlive the store. Returns the index for maps.
  std::size_t add(const Image& image);

  [[nodiscard]] const Image& image(std::size_t index) const { return *pyramids_[index].image; }

  /// Linear Rec.709 colour of an image: bilinear, repeated beyond the unit square, averaged over
  /// the point's footprint. An image of one channel is grey.
  [[nodiscard]] Vec3f color(const ImageMap& map, const SurfacePoint& point) const;

  /// The mean colour of an image, or of all its tiles.
  [[nodiscard]] Vec3f mean_color(const ImageMap& map) const;

  /// offset + scale * value, kept in the range of the map; of a colour, its luminance.
  [[nodiscard]] float scalar(const TextureMap& map, const SurfacePoint& point) const;
  [[nodiscard]] Vec3f color(const TextureMap& map, const SurfacePoint& point) const;

  /// The parameter's value times its map.
  [[nodiscard]] float scalar(const ScalarParameter& parameter, const SurfacePoint& point) const;
  [[nodiscard]] Vec3f color(const ColorParameter& parameter, const SurfacePoint& point) const;

 private:
  struct Level {
    int width, height;
    std::vector<Vec3f> texels;  ///< [y][x]; level 0 reads the image itself
  };
  struct Pyramid {
    const Image* image;
    std::array<std::size_t, 3> channels;  ///< that hold red, green and blue
    std::vector<Level> levels;            ///< each half the size of the last, down to 1 x 1
  };

  /// Color of a map that is no noise.
  [[nodiscard]] Vec3f source_color(const TextureMap& map, const SurfacePoint& point) const;
  [[nodiscard]] Vec3f texel(const Pyramid& pyramid, std::size_t level, int x, int y) const;
  [[nodiscard]] Vec3f bilinear(const Pyramid& pyramid, std::size_t level, Vec2f uv) const;
  [[nodiscard]] Vec3f filtered(const Pyramid& pyramid, Vec2f uv, Vec2f stretch,
                               const SurfacePoint& point, bool is_tile) const;

  std::vector<Pyramid> pyramids_;
};

/// The point's smooth normal, bent as the height of a bump map and a normal map have it.
///
/// Heights are differentiated on the surface in space, so noise needs no texture coordinates; the
/// step is the footprint, so that what is finer than a pixel does not alias.
[[nodiscard]] Vec3f bent_normal(const TextureStore& textures, const SurfaceMaterial& material,
                                const SurfacePoint& point);

/// A map's value kept in its range.
[[nodiscard]] inline float clamp_to_range(const TextureMap& map, float value) {
  return std::clamp(value, map.low, map.high);
}

}  // namespace lamina
