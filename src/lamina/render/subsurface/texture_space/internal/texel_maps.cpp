// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/internal/texel_maps.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/parallel_chunks.h"
#include "lamina/base/image/bilinear.h"

namespace lamina {
namespace {

constexpr std::size_t texels_at_once = 4096;

float bilinear(const Image& image, std::size_t channel, Vec2f uv) {
  const float x = uv.x * static_cast<float>(image.width);
  const float y = (1.0f - uv.y) * static_cast<float>(image.height);
  return bilinear_repeated(x, y, image.width, image.height).interpolate([&](int i, int j) {
    return image.at(i, j)[channel];
  });
}

}  // namespace

std::vector<NumberTexels> sample_maps(std::span<const MaterialMap> maps,
                                      const std::vector<Mesh>& meshes, const TextureAtlas& atlas) {
  const auto texels = atlas.texels();
  std::vector<NumberTexels> result;
  for (const MaterialMap& map : maps) {
    const std::size_t channels = map.values.channel_count();
    NumberTexels& to = result.emplace_back(
        NumberTexels{map.number, channels, std::vector<float>(texels.size() * channels)});
    parallel_chunks(texels.size(), texels_at_once, [&](std::size_t i) {
      const AtlasTexel& texel = texels[i];
      const Mesh& mesh = meshes[texel.mesh];
      const auto& corners = mesh.triangles[texel.triangle];
      const Vec2f uv = (1.0f - texel.u - texel.v) * mesh.uvs[corners[0]] +
                       texel.u * mesh.uvs[corners[1]] + texel.v * mesh.uvs[corners[2]];
      const float width = 1.0f / atlas.density(texel.chart);
      // A tap for each texel of the map below this one, each way.
      const float covered =
          width * static_cast<float>(std::max(map.values.width, map.values.height));
      const int taps = std::clamp(static_cast<int>(std::ceil(covered)), 1, 16);
      for (std::size_t channel = 0; channel < channels; ++channel) {
        float sum = 0.0f;
        for (int y = 0; y < taps; ++y)
          for (int x = 0; x < taps; ++x) {
            const auto place = [&](int k) {
              return width * ((static_cast<float>(k) + 0.5f) / static_cast<float>(taps) - 0.5f);
            };
            sum += bilinear(map.values, channel, uv + Vec2f{place(x), place(y)});
          }
        to.values[i * channels + channel] = sum / static_cast<float>(taps * taps);
      }
    });
  }
  return result;
}

Vec2f barycentric_step(const std::vector<Mesh>& meshes, const AtlasTexel& texel, Vec2f step) {
  const Mesh& mesh = meshes[texel.mesh];
  const auto& corners = mesh.triangles[texel.triangle];
  // In space, where the chart's grid need not be known: the step along the two edges.
  const Vec3f e1 = mesh.positions[corners[1]] - mesh.positions[corners[0]];
  const Vec3f e2 = mesh.positions[corners[2]] - mesh.positions[corners[0]];
  const Vec3f d = step.x * texel.across + step.y * texel.up;
  const float a = dot(e1, e1), b = dot(e1, e2), c = dot(e2, e2);
  const float determinant = a * c - b * b;
  if (!(determinant > 0.0f)) return {};
  const float p = dot(d, e1), q = dot(d, e2);
  return {(c * p - b * q) / determinant, (a * q - b * p) / determinant};
}

}  // namespace lamina
