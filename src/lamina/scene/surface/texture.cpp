// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/surface/texture.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/image/bilinear.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/scene/surface/noise.h"

namespace lamina {
namespace {

std::array<std::size_t, 3> color_channels(const Image& image) {
  const auto find = [&](const char* name, std::size_t otherwise) {
    const auto at = std::find(image.channels.begin(), image.channels.end(), name);
    return at != image.channels.end() ? static_cast<std::size_t>(at - image.channels.begin())
                                      : otherwise;
  };
  if (image.channel_count() < 3) return {0, 0, 0};
  return {find("R", 0), find("G", 1), find("B", 2)};
}

/// Height in mm of a bump map moved by a step on the surface.
float height_at(const TextureStore& textures, const TextureMap& bump, SurfacePoint point,
                const Vec3f& step, Vec2f uv_step) {
  point.position += step;
  point.uv = point.uv + uv_step;
  return textures.scalar(bump, point);
}

Vec3f bend_by_bump(const TextureStore& textures, const TextureMap& bump,
                   const SurfacePoint& point) {
  const Vec3f& n = point.smooth_normal;
  Vec3f slope;  // gradient of the height along the surface
  if (const auto* noise = std::get_if<NoiseMap>(&bump.source)) {
    const Framef frame = make_frame(n);
    const float step = std::max(0.5f * point.footprint, 0.02f * noise->size);
    const float here = textures.scalar(bump, point);
    const auto rise = [&](const Vec3f& along) {
      return (height_at(textures, bump, point, step * along, {}) - here) / step;
    };
    slope = rise(frame.x) * frame.x + rise(frame.y) * frame.y;
  } else {
    const Vec3f normal_area = cross(point.du, point.dv);
    const float area = length(normal_area);
    if (!(area > 0.0f)) return n;
    const float step = std::max(point.uv_footprint, 1.0f / 4096.0f);
    const auto rise = [&](Vec2f along) {
      return (height_at(textures, bump, point, {}, 0.5f * step * along) -
              height_at(textures, bump, point, {}, -0.5f * step * along)) /
             step;
    };
    // gradient = h_u (dv x n) + h_v (n x du), over the area of du x dv
    const Vec3f unit = normal_area / area;
    slope = (rise({1, 0}) * cross(point.dv, unit) + rise({0, 1}) * cross(unit, point.du)) / area;
    slope = slope - dot(slope, n) * n;
  }
  return normalize(n - slope);
}

Vec3f bend_by_normal_map(const TextureStore& textures, const ImageMap& map,
                         const SurfacePoint& point, const Vec3f& n) {
  if (dot(point.du, point.du) == 0.0f || dot(point.dv, point.dv) == 0.0f) return n;
  // Along the axes of the image, which its placement turns and mirrors.
  const auto& [u_axis, v_axis, shift] = map.placement;
  const float area = u_axis.x * v_axis.y - u_axis.y * v_axis.x;
  if (area == 0.0f) return n;
  const Vec3f along_u = (v_axis.y * point.du - u_axis.y * point.dv) / area;
  const Vec3f along_v = (u_axis.x * point.dv - v_axis.x * point.du) / area;
  const Vec3f m = 2.0f * textures.color(map, point) - Vec3f{1, 1, 1};
  Vec3f t = along_u - dot(along_u, n) * n;
  if (!(dot(t, t) > 0.0f)) return n;
  t = normalize(t);
  Vec3f b = cross(n, t);
  if (dot(b, along_v) < 0.0f) b = -b;
  const Vec3f bent = m.x * t + m.y * b + std::max(m.z, 0.05f) * n;
  return normalize(bent);
}

}  // namespace

TextureStore::TextureStore(const std::vector<Image>& images) {
  for (const Image& image : images) (void)add(image);
}

std::size_t TextureStore::add(const Image& image) {
  Pyramid pyramid{&image, color_channels(image), {}};
  pyramid.levels.push_back({image.width, image.height, {}});
  while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1) {
    const std::size_t above = pyramid.levels.size() - 1;
    const int w = pyramid.levels[above].width, h = pyramid.levels[above].height;
    Level level{std::max(w / 2, 1), std::max(h / 2, 1), {}};
    level.texels.reserve(static_cast<std::size_t>(level.width) *
                         static_cast<std::size_t>(level.height));
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x) {
        // The box of texels that this one stands for; three wide where the size is odd.
        const int x0 = x * w / level.width, x1 = std::max((x + 1) * w / level.width, x0 + 1);
        const int y0 = y * h / level.height, y1 = std::max((y + 1) * h / level.height, y0 + 1);
        Vec3f total;
        for (int j = y0; j < y1; ++j)
          for (int i = x0; i < x1; ++i) total += texel(pyramid, above, i, j);
        level.texels.push_back(total / static_cast<float>((x1 - x0) * (y1 - y0)));
      }
    pyramid.levels.push_back(std::move(level));
  }
  pyramids_.push_back(std::move(pyramid));
  return pyramids_.size() - 1;
}

Vec3f TextureStore::texel(const Pyramid& pyramid, std::size_t level, int x, int y) const {
  if (level > 0) {
    const Level& l = pyramid.levels[level];
    return l.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) +
                    static_cast<std::size_t>(x)];
  }
  const float* pixel = pyramid.image->at(x, y);
  const auto& [r, g, b] = pyramid.channels;
  return {pixel[r], pixel[g], pixel[b]};
}

Vec3f TextureStore::bilinear(const Pyramid& pyramid, std::size_t level, Vec2f uv) const {
  const int w = pyramid.levels[level].width, h = pyramid.levels[level].height;
  return bilinear_repeated(uv.x * static_cast<float>(w), (1.0f - uv.y) * static_cast<float>(h), w,
                           h)
      .interpolate([&](int x, int y) { return texel(pyramid, level, x, y); });
}

Vec3f TextureStore::color(const ImageMap& map, const SurfacePoint& point) const {
  if (map.tiles.empty()) {
    Vec2f uv = place_uv(map.placement, point.uv);
    uv = {uv.x - std::floor(uv.x), uv.y - std::floor(uv.y)};
    if (!(uv.x >= 0.0f && uv.y >= 0.0f)) uv = {};  // coordinates that are not numbers
    const auto& [u_axis, v_axis, shift] = map.placement;
    const Vec2f stretch{std::max(std::abs(u_axis.x), std::abs(v_axis.x)),
                        std::max(std::abs(u_axis.y), std::abs(v_axis.y))};
    return filtered(pyramids_[map.image], uv, stretch, point, false);
  }
  // The tile of the triangle, so that its far edges do not belong to the next one.
  const std::optional<std::uint32_t> tile = tile_at(map, point.uv_middle);
  if (!tile) return {};
  const Vec2f corner{std::floor(point.uv_middle.x), std::floor(point.uv_middle.y)};
  const Vec2f uv{std::clamp(point.uv.x - corner.x, 0.0f, 1.0f),
                 std::clamp(point.uv.y - corner.y, 0.0f, 1.0f)};
  return filtered(pyramids_[*tile], uv, {1, 1}, point, true);
}

Vec3f TextureStore::filtered(const Pyramid& pyramid, Vec2f at, Vec2f stretch,
                             const SurfacePoint& point, bool is_tile) const {
  const float texels =
      point.uv_footprint * std::max(stretch.x * static_cast<float>(pyramid.levels[0].width),
                                    stretch.y * static_cast<float>(pyramid.levels[0].height));
  // Tiles end at their edges, where others come round to the other side.
  const auto bilinear = [&](std::size_t level) {
    if (!is_tile) return this->bilinear(pyramid, level, at);
    const Vec2f half{0.5f / static_cast<float>(pyramid.levels[level].width),
                     0.5f / static_cast<float>(pyramid.levels[level].height)};
    return this->bilinear(
        pyramid, level,
        {std::clamp(at.x, half.x, 1.0f - half.x), std::clamp(at.y, half.y, 1.0f - half.y)});
  };
  if (!(texels > 1.0f)) return bilinear(0);
  const float level = std::min(std::log2(texels), static_cast<float>(pyramid.levels.size() - 1));
  const auto fine = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(fine);
  const Vec3f value = bilinear(fine);
  if (blend == 0.0f || fine + 1 == pyramid.levels.size()) return value;
  return (1.0f - blend) * value + blend * bilinear(fine + 1);
}

Vec3f TextureStore::mean_color(const ImageMap& map) const {
  const auto mean = [&](std::size_t image) {
    const Pyramid& pyramid = pyramids_[image];
    return texel(pyramid, pyramid.levels.size() - 1, 0, 0);
  };
  if (map.tiles.empty()) return mean(map.image);
  const std::vector<std::size_t> images = images_of(map);
  Vec3f sum;
  for (const std::size_t image : images) sum += mean(image);
  return sum / static_cast<float>(images.size());
}

Vec3f TextureStore::source_color(const TextureMap& map, const SurfacePoint& point) const {
  if (std::holds_alternative<VertexColorMap>(map.source)) return point.color;
  Vec3f value = color(std::get<ImageMap>(map.source), point);
  for (int c = 0; c < 3 && map.vertex_colors; ++c) value[c] *= point.color[c];
  return value;
}

float TextureStore::scalar(const TextureMap& map, const SurfacePoint& point) const {
  const auto* noise = std::get_if<NoiseMap>(&map.source);
  const float value = noise ? evaluate_noise(*noise, point.position, point.footprint)
                            : luminance(source_color(map, point));
  return clamp_to_range(map, map.offset + map.scale * value);
}

Vec3f TextureStore::color(const TextureMap& map, const SurfacePoint& point) const {
  if (std::holds_alternative<NoiseMap>(map.source)) {
    const float value = scalar(map, point);
    return {value, value, value};
  }
  Vec3f value = source_color(map, point);
  for (int c = 0; c < 3; ++c) value[c] = clamp_to_range(map, map.offset + map.scale * value[c]);
  return value;
}

float TextureStore::scalar(const ScalarParameter& parameter, const SurfacePoint& point) const {
  return parameter.map ? parameter.value * scalar(*parameter.map, point) : parameter.value;
}

Vec3f TextureStore::color(const ColorParameter& parameter, const SurfacePoint& point) const {
  if (!parameter.map) return parameter.value;
  const Vec3f value = color(*parameter.map, point);
  return {parameter.value.x * value.x, parameter.value.y * value.y, parameter.value.z * value.z};
}

Vec3f bent_normal(const TextureStore& textures, const SurfaceMaterial& material,
                  const SurfacePoint& point) {
  Vec3f n = point.smooth_normal;
  if (material.bump) n = bend_by_bump(textures, *material.bump, point);
  if (material.normal_map) n = bend_by_normal_map(textures, *material.normal_map, point, n);
  return n;
}

}  // namespace lamina
