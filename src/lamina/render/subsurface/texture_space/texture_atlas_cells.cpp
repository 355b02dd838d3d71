// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <tuple>

#include "lamina/render/subsurface/texture_space/internal/texel_neighborhood.h"
#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"

namespace lamina {
namespace {

/// Light goes over edges whose normals have at least this scalar product: 115° between them. What
/// lies beyond sharper ones is another side, as that of a sheet which is thinner than a texel.
constexpr float sharpest_edge = -0.42f;

struct Offset {
  int x = 0, y = 0;
};

/// A symmetric tensor as a sum of conductances along three steps on the grid.
struct Steps {
  std::array<Offset, 3> step;
  std::array<float, 3> conductance{};  ///< >= 0
};

/// The tensor sqrt(g) g^-1 of the first fundamental form: what flows for a gradient on the grid.
///
/// Source: Selling's decomposition [FehrenbachMirebeau2014] over an obtuse superbase, so no
/// conductance is negative however the texture is stretched or sheared.
Steps steps_of(const Vec3f& across, const Vec3f& up) {
  const float e = dot(across, across), f = dot(across, up), g = dot(up, up);
  const float root = std::sqrt(std::max(e * g - f * f, 1e-12f * e * g));
  const float xx = g / root, xy = -f / root, yy = e / root;
  const auto product = [&](Offset a, Offset b) {
    const auto ax = static_cast<float>(a.x), ay = static_cast<float>(a.y);
    const auto bx = static_cast<float>(b.x), by = static_cast<float>(b.y);
    return xx * ax * bx + xy * (ax * by + ay * bx) + yy * ay * by;
  };
  std::array<Offset, 3> base = {{{1, 0}, {0, 1}, {-1, -1}}};
  constexpr int most = 16;
  for (int turn = 0; turn < most; ++turn) {
    bool is_obtuse = true;
    for (std::size_t k = 0; k < 3 && is_obtuse; ++k) {
      const Offset a = base[(k + 1) % 3], b = base[(k + 2) % 3];
      if (product(a, b) <= 1e-6f * (xx + yy)) continue;
      base = {{{-a.x, -a.y}, b, {a.x - b.x, a.y - b.y}}};
      is_obtuse = false;
    }
    if (is_obtuse) break;
  }
  Steps steps;
  for (std::size_t k = 0; k < 3; ++k) {
    steps.step[k] = {-base[k].y, base[k].x};
    steps.conductance[k] = std::max(-product(base[(k + 1) % 3], base[(k + 2) % 3]), 0.0f);
  }
  return steps;
}

/// The normal of a texel's face, which smoothing does not round, on the side of the smooth one.
Vec3f face_normal(const AtlasTexel& texel) {
  const Vec3f normal = cross(texel.across, texel.up);
  return (dot(normal, texel.normal) < 0.0f ? -1.0f : 1.0f) / length(normal) * normal;
}

/// The way from a texel to another one, along the surface: over an edge between two plane faces as
/// if it were unfolded, elsewhere straight.
Vec3f unfolded_way(const AtlasTexel& from, const AtlasTexel& to) {
  const Vec3f way = to.position - from.position;
  const Vec3f n = face_normal(from), m = face_normal(to), edge = cross(n, m);
  const float sine = length(edge);
  constexpr float sharp = 0.5f;  // 30°; flatter ones are about as long as they are straight
  if (sine < sharp) return way;
  const Vec3f along = edge / sine, over = cross(along, n);
  const float before = dot(way, m) / sine, behind = -dot(way, n) / sine;
  return dot(way, along) * along + (before + behind) * over;
}

}  // namespace

TextureAtlas::Cells TextureAtlas::cells() const {
  Cells result;
  for (const AtlasTexel& texel : texels_)
    result.cells.push_back({texel.position, texel.area, texel.chart, texel.x, texel.y});
  const TexelNeighborhood neighborhood(texels_);
  /// Where the surface goes on beyond a chart's border, if it does.
  const auto beyond = [&](std::uint32_t from, const Vec3f& step) {
    const AtlasTexel& texel = texels_[from];
    const Vec3f place = texel.position + step;
    const float width = length(step);
    std::uint32_t best = no_texel;
    float nearest = 0.8f * width * width;  // not as far from the place as the texel itself
    // Texels on the other face of an edge lie this far from the place before it is unfolded.
    neighborhood.for_near(place, 1.5f * width, [&](std::uint32_t k, float /*straight*/) {
      if (k == from || dot(texels_[k].normal, texel.normal) < sharpest_edge) return;
      const Vec3f beside = unfolded_way(texel, texels_[k]) - step;
      const float distance2 = dot(beside, beside);
      if (distance2 < nearest || (distance2 == nearest && k < best)) {
        nearest = distance2;
        best = k;
      }
    });
    return best;
  };
  const auto texel_count = static_cast<std::uint32_t>(texels_.size());
  std::vector<CellLink> links;
  for (std::uint32_t i = 0; i < texel_count; ++i) {
    const AtlasTexel& texel = texels_[i];
    const Steps steps = steps_of(texel.across, texel.up);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(steps.conductance[k] > 1e-3f)) continue;
      for (const int sign : {1, -1}) {
        const int dx = sign * steps.step[k].x, dy = sign * steps.step[k].y;
        const Vec3f step =
            static_cast<float>(dx) * texel.across + static_cast<float>(dy) * texel.up;
        std::uint32_t to = texel_at(charts_[texel.chart], texel.x + dx, texel.y + dy);
        // Next to each other on the chart, but torn apart in space: a slit.
        if (to < texel_count && length(texels_[to].position - texel.position) > 3.0f * length(step))
          to = no_texel;
        float conductance = 0.5f * steps.conductance[k];
        if (to >= texel_count) {
          to = beyond(i, step);
          if (to == no_texel) continue;
          // Nearer than a step light flows more easily.
          const float along = dot(unfolded_way(texel, texels_[to]), step);
          conductance *= std::clamp(dot(step, step) / std::max(along, 1e-12f), 0.5f, 2.0f);
        }
        links.push_back({std::min(i, to), std::max(i, to), conductance});
      }
    }
  }
  std::ranges::sort(links, [](const CellLink& a, const CellLink& b) {
    return std::tuple(a.from, a.to, a.conductance) < std::tuple(b.from, b.to, b.conductance);
  });
  for (const CellLink& link : links)
    if (!result.links.empty() && result.links.back().from == link.from &&
        result.links.back().to == link.to)
      result.links.back().conductance += link.conductance;
    else
      result.links.push_back(link);
  return result;
}

}  // namespace lamina
