// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/skin_surface/surface_skin_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "lamina/base/core/hash.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/smooth_step.h"
#include "lamina/scene/skin_surface/internal/surface_canvas.h"
#include "lamina/scene/surface/noise.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {
namespace {

/// Between the pixels of an image over texture coordinates.
Vec3f color_at(const Image& image, Vec2f uv) {
  const auto pixel = [&](float fx, float fy) {
    const int x = std::clamp(static_cast<int>(fx), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(fy), 0, image.height - 1);
    const float* p = image.at(x, y);
    return Vec3f{p[0], p[1], p[2]};
  };
  const float x = uv.x * static_cast<float>(image.width) - 0.5f;
  const float y = (1.0f - uv.y) * static_cast<float>(image.height) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
  return (1.0f - fy) * ((1.0f - fx) * pixel(x0, y0) + fx * pixel(x0 + 1.0f, y0)) +
         fy * ((1.0f - fx) * pixel(x0, y0 + 1.0f) + fx * pixel(x0 + 1.0f, y0 + 1.0f));
}

/// Of the ellipse that a unit circle of the texture becomes on the surface: of a texel that is
/// stretched, the way along which least detail fits.
float longest_side(const Vec3f& du, const Vec3f& dv) {
  const float mean = 0.5f * (dot(du, du) + dot(dv, dv));
  const float difference = 0.5f * (dot(du, du) - dot(dv, dv));
  return std::sqrt(mean + std::hypot(difference, dot(du, dv)));
}

/// The texels whose middles lie on faces.
std::vector<SurfaceTexel> texels_of(const SurfaceMapRecipe& recipe) {
  const Mesh& mesh = recipe.meshes.front();
  std::vector<SurfaceTexel> texels;
  std::vector<char> is_taken(static_cast<std::size_t>(recipe.width) *
                             static_cast<std::size_t>(recipe.height));
  const auto w = static_cast<float>(recipe.width), h = static_cast<float>(recipe.height);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec2f origin = mesh.uvs[a], d1 = mesh.uvs[b] - origin, d2 = mesh.uvs[c] - origin;
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    if (determinant == 0.0f) continue;
    const auto [u_low, u_high] = std::minmax({mesh.uvs[a].x, mesh.uvs[b].x, mesh.uvs[c].x});
    const auto [v_low, v_high] = std::minmax({mesh.uvs[a].y, mesh.uvs[b].y, mesh.uvs[c].y});
    const int x_from = std::max(0, static_cast<int>(u_low * w - 0.5f));
    const int x_to = std::min(recipe.width - 1, static_cast<int>(std::lround(u_high * w)));
    const int y_from = std::max(0, static_cast<int>((1.0f - v_high) * h - 0.5f));
    const int y_to = std::min(recipe.height - 1, static_cast<int>(std::lround((1.0f - v_low) * h)));
    for (int y = y_from; y <= y_to; ++y)
      for (int x = x_from; x <= x_to; ++x) {
        const Vec2f uv{(static_cast<float>(x) + 0.5f) / w,
                       1.0f - (static_cast<float>(y) + 0.5f) / h};
        const Vec2f d = uv - origin;
        const float u = (d.x * d2.y - d.y * d2.x) / determinant;
        const float v = (d1.x * d.y - d1.y * d.x) / determinant;
        if (std::min({u, v, 1.0f - u - v}) < -1e-5f) continue;
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(recipe.width) +
            static_cast<std::size_t>(x);
        if (is_taken[pixel]) continue;
        is_taken[pixel] = 1;
        const SurfacePoint point = make_surface_point(
            recipe.meshes, {.distance = 0.0f, .u = u, .v = v, .mesh = 0, .triangle = t}, 0.0f);
        texels.push_back({pixel, point.position, point.smooth_normal, uv,
                          longest_side(point.du / w, point.dv / h)});
      }
  }
  return texels;
}

NoiseMap smooth_noise(double size, int octaves, std::uint64_t seed) {
  return {.kind = NoiseMap::Kind::smooth,
          .size = static_cast<float>(size),
          .octaves = octaves,
          .seed = static_cast<std::uint32_t>(seed)};
}

void apply_feature(const Unevenness& uneven, const SurfacePlaces& where, std::uint64_t seed,
                   SurfaceCanvas& canvas) {
  const NoiseMap melanin = smooth_noise(uneven.melanin_size, 3, seed);
  const NoiseMap blood = smooth_noise(uneven.hemoglobin_size, 3, seed + 1);
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    const auto weight = static_cast<double>(where.weight(texel.position));
    const auto noise = [&](const NoiseMap& map, double amount) {
      return std::exp(weight * amount *
                      static_cast<double>(evaluate_noise(map, texel.position, texel.width)));
    };
    SkinParameters& skin = canvas.skin[i];
    skin.melanin *= noise(melanin, uneven.melanin);
    const double more = noise(blood, uneven.hemoglobin);
    skin.hemoglobin_dermis *= more;
    skin.hemoglobin_epidermis *= more;
  });
}

void apply_feature(const Flush& flush, const SurfacePlaces& where, std::uint64_t,
                   SurfaceCanvas& canvas) {
  for_texels(canvas, [&](std::size_t i) {
    const auto weight = static_cast<double>(where.weight(canvas.texels[i].position));
    SkinParameters& skin = canvas.skin[i];
    skin.melanin += weight * flush.melanin;
    skin.hemoglobin_epidermis += weight * flush.hemoglobin_epidermis;
    skin.hemoglobin_dermis += weight * flush.hemoglobin_dermis;
  });
}

void apply_feature(const VesselNet& net, const SurfacePlaces& where, std::uint64_t seed,
                   SurfaceCanvas& canvas) {
  const NoiseMap noise = smooth_noise(net.size, 2, seed);
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    const float weight = where.weight(texel.position);
    if (!(weight > 0.0f)) return;
    // Distance to where the noise is 0: its value over its slope.
    const float value = evaluate_noise(noise, texel.position, texel.width);
    const auto step = static_cast<float>(0.05 * net.size);
    Vec3f slope;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3f moved = texel.position;
      moved[axis] += step;
      slope[axis] = (evaluate_noise(noise, moved, texel.width) - value) / step;
    }
    const double distance = static_cast<double>(std::abs(value) / std::max(length(slope), 1e-6f));
    const double across = distance / (0.5 * net.width);
    SkinParameters& skin = canvas.skin[i];
    mix_in(skin.hemoglobin_dermis, skin.saturation_dermis,
           static_cast<double>(weight) * net.hemoglobin * std::exp(-0.5 * across * across),
           net.saturation);
  });
}

void apply_feature(const MelaninSpots& spots, const SurfacePlaces& where, std::uint64_t seed,
                   SurfaceCanvas& canvas) {
  // Each cube of space as wide as the largest spot may hold the middle of one. A spot is a ball, so
  // where the surface cuts it beside its middle it is smaller; as many are cut as the density says.
  const auto cube = static_cast<float>(spots.diameter[1]);
  const double expected = spots.density / 100.0 * static_cast<double>(cube * cube);
  const NoiseMap ragged = smooth_noise(0.6 * spots.diameter[1], 2, seed + 1);
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    const float weight = where.weight(texel.position);
    if (!(weight > 0.0f)) return;
    const auto index = [&](float x) { return static_cast<std::int64_t>(std::floor(x / cube)); };
    const auto texel_width = static_cast<double>(texel.width);
    double darkest = 0.0;
    const float unevenness = evaluate_noise(ragged, texel.position, texel.width);
    for (std::int64_t z = -1; z <= 1; ++z)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t x = -1; x <= 1; ++x) {
          const std::int64_t kx = index(texel.position.x) + x, ky = index(texel.position.y) + y,
                             kz = index(texel.position.z) + z;
          Random random = make_random(seed, cell_key(kx, ky, kz));
          if (random.uniform() > expected) continue;
          const Vec3f middle = cube * Vec3f{static_cast<float>(kx) + random.uniform_float(),
                                            static_cast<float>(ky) + random.uniform_float(),
                                            static_cast<float>(kz) + random.uniform_float()};
          const double ratio = spots.diameter[1] / spots.diameter[0];
          const double radius = 0.5 * spots.diameter[0] * std::pow(ratio, random.uniform());
          const double melanin =
              spots.melanin[0] + random.uniform() * (spots.melanin[1] - spots.melanin[0]);
          if (random.uniform_float() > where.weight(middle)) continue;
          // No sharper than a texel, so that where texels are stretched spots stay round; and no
          // wider than the cubes that are looked at.
          const double rim =
              std::min(std::hypot(std::min(spots.rim, 2.0 / 3.0 * radius), 0.5 * texel_width),
                       static_cast<double>(cube) - radius);
          const double inside = radius * (1.0 + 0.15 * static_cast<double>(unevenness)) -
                                static_cast<double>(length(texel.position - middle));
          darkest = std::max(darkest, melanin * static_cast<double>(smooth_step(
                                                    static_cast<float>(0.5 + 0.5 * inside / rim))));
        }
    mix_in(canvas.skin[i].melanin, canvas.skin[i].melanin_blend, darkest, spots.melanin_blend);
  });
}

/// Colors of the texture that the surface shows, evenly over it.
std::vector<std::array<float, 3>> shown_colors(const Mesh& mesh, const Image& image) {
  constexpr std::size_t most = 500;
  std::vector<std::array<float, 3>> colors;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += mesh.triangles.size() / most + 1) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3f color = color_at(image, (1.0f / 3.0f) * (mesh.uvs[a] + mesh.uvs[b] + mesh.uvs[c]));
    colors.push_back({color.x, color.y, color.z});
  }
  return colors;
}

/// Pixels of the texture, evenly over it, for the growth of its errors.
std::vector<std::array<float, 3>> sampled_colors(const Image& image, float exposure) {
  const std::size_t pixels = image.pixels.size() / 3, samples = std::min(pixels, misfit_colors);
  std::vector<std::array<float, 3>> colors(samples);
  for (std::size_t s = 0; s < samples; ++s)
    for (std::size_t c = 0; c < 3; ++c)
      colors[s][c] = exposure * image.pixels[3 * (s * pixels / samples) + c];
  return colors;
}

void apply_feature(const ColorOfSkin& color, const SurfacePlaces& where, std::uint64_t,
                   SurfaceCanvas& canvas) {
  SkinParameters base = canvas.recipe.base.skin;
  base.dermis_thickness = std::numeric_limits<double>::infinity();
  const TextureSkin texture(base);
  std::optional<SkinLookup> lookup;
  auto exposure = static_cast<float>(color.exposure.value_or(1.0));
  if (!color.exposure) {
    lookup = texture.lookup();
    canvas.matches.push_back(
        match_exposure(*lookup, shown_colors(canvas.recipe.meshes.front(), color.image)));
    exposure = static_cast<float>(canvas.matches.back().exposure);
  }
  const std::vector<double> growth = texture.error_growth(sampled_colors(color.image, exposure));
  const bool has_grown = std::ranges::any_of(growth, [](double each) { return each > 1.0; });
  if (!lookup || has_grown) lookup = texture.lookup(growth);
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    const Vec3f seen = exposure * color_at(color.image, texel.uv);
    const ColorFit found = lookup->at({seen.x, seen.y, seen.z});
    const auto weight = static_cast<double>(where.weight(texel.position));
    SkinParameters& skin = canvas.skin[i];
    for (std::size_t n = 0; n < texture.numbers.size(); ++n)
      for (double SkinParameters::*const value : texture.numbers[n].values)
        skin.*value += weight * (static_cast<double>(found.values[n]) - skin.*value);
  });
}

/// Fills what lies next to the charts with the mean of what is known around it, ring by ring.
void grow(Image& image, std::vector<char> is_known) {
  constexpr int rings = 6;
  const int w = image.width, h = image.height;
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<char> before = is_known;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const auto at = [&](int i, int j) {
          return static_cast<std::size_t>(j) * static_cast<std::size_t>(w) +
                 static_cast<std::size_t>(i);
        };
        if (before[at(x, y)]) continue;
        float sum = 0.0f;
        int count = 0;
        for (int j = std::max(0, y - 1); j <= std::min(h - 1, y + 1); ++j)
          for (int i = std::max(0, x - 1); i <= std::min(w - 1, x + 1); ++i)
            if (before[at(i, j)]) {
              sum += image.pixels[at(i, j)];
              ++count;
            }
        if (count == 0) continue;
        image.pixels[at(x, y)] = sum / static_cast<float>(count);
        is_known[at(x, y)] = 1;
      }
  }
}

}  // namespace

float SurfacePlaces::weight(const Vec3f& position) const {
  if (places.empty()) return 1.0f;
  float most = 0.0f;
  for (const Place& place : places)
    most = std::max(most, smooth_step(1.0f - length(position - place.at) / place.radius));
  return most;
}

ColorMatch match_exposure(const SkinLookup& lookup, std::span<const std::array<float, 3>> colors) {
  const auto match = [&](double exposure) {
    const auto factor = static_cast<float>(exposure);
    std::vector<float> distances;
    for (const auto& [r, g, b] : colors)
      distances.push_back(lookup.at({factor * r, factor * g, factor * b}).distance);
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    return ColorMatch{.exposure = exposure, .distance = static_cast<double>(*middle)};
  };
  ColorMatch best = match(1.0);
  for (double stops = -3.0; stops < 1.01; stops += 0.125) {
    const ColorMatch other = match(std::exp2(stops));
    if (other.distance < best.distance) best = other;
  }
  return best;
}

std::vector<SkinMap> make_surface_maps(const SurfaceMapRecipe& recipe, const Progress& progress,
                                       std::vector<ColorMatch>* matches) {
  SurfaceCanvas canvas{recipe, texels_of(recipe), {}, {}};
  canvas.skin.assign(canvas.texels.size(), recipe.base.skin);
  std::uint64_t seed = recipe.seed * 1'000'003u + 1;
  double done = 0.0;
  for (const SurfaceFeature& feature : recipe.features) {
    std::visit([&](const auto& kind) { apply_feature(kind, feature.where, seed, canvas); },
               feature.kind);
    seed += 10'007;
    report_or_throw(progress, ++done / static_cast<double>(recipe.features.size()));
  }
  if (matches) *matches = canvas.matches;
  std::vector<char> is_known(static_cast<std::size_t>(recipe.width) *
                             static_cast<std::size_t>(recipe.height));
  for (const SurfaceTexel& texel : canvas.texels) is_known[texel.pixel] = 1;
  SkinParameters base = recipe.base.skin;
  canvas.skin.push_back(base);  // what differs from it is a map, too
  std::vector<SkinMap> maps = varying_numbers(canvas.skin);
  canvas.skin.pop_back();
  for (SkinMap& map : maps) {
    map.values = make_image(recipe.width, recipe.height, {"Y"});
    std::ranges::fill(map.values.pixels, static_cast<float>(mapped_number(base, map)));
    for (std::size_t i = 0; i < canvas.skin.size(); ++i)
      map.values.pixels[canvas.texels[i].pixel] = clamped_number(canvas.skin[i], map);
    grow(map.values, is_known);
  }
  return maps;
}

}  // namespace lamina
