// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <tuple>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/render/subsurface/texture_space/internal/texel_neighborhood.h"

namespace lamina {
namespace {

/// Sets that are joined until they are the connected ones.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Barycentric weights of a point in the plane; false if the triangle is but a line.
bool barycentric(const std::array<Vec2f, 3>& corner, Vec2f p, float& u, float& v) {
  const Vec2f d1 = corner[1] - corner[0], d2 = corner[2] - corner[0], d = p - corner[0];
  const float determinant = d1.x * d2.y - d1.y * d2.x;
  if (determinant == 0.0f) return false;
  u = (d.x * d2.y - d.y * d2.x) / determinant;
  v = (d1.x * d.y - d1.y * d.x) / determinant;
  return true;
}

std::array<Vec2f, 3> uvs_of(const Mesh& mesh, std::uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]};
}

float area_of(const std::array<Vec2f, 3>& t) {
  const Vec2f a = t[1] - t[0], b = t[2] - t[0];
  return 0.5f * std::abs(a.x * b.y - a.y * b.x);
}

float area_of(const Mesh& mesh, std::uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3f& p = mesh.positions[t[0]];
  return 0.5f * length(cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p));
}

}  // namespace

TextureAtlas::TextureAtlas(const std::vector<Mesh>& meshes, std::uint32_t material, float spacing) {
  find_charts(meshes, material);
  for (std::uint32_t chart = 0; chart < faces_.size(); ++chart) fill_chart(meshes, chart, spacing);
  add_borders();
}

void TextureAtlas::find_charts(const std::vector<Mesh>& meshes, std::uint32_t material) {
  chart_of_.resize(meshes.size());
  for (std::uint32_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    chart_of_[m].assign(mesh.triangles.size(), no_texel);
    if (std::ranges::find(mesh.material, material) == mesh.material.end()) continue;
    if (mesh.uvs.empty())
      throw InvalidInput("mesh \"" + mesh.name +
                         "\": method texture_space needs texture coordinates, but it has none");
    // Vertices that differ by their normals alone are one.
    using Key = std::tuple<float, float, float, float, float>;
    std::vector<std::uint32_t> order(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t i) {
      const Vec3f& p = mesh.positions[i];
      return Key(p.x, p.y, p.z, mesh.uvs[i].x, mesh.uvs[i].y);
    };
    std::ranges::sort(order, [&](auto a, auto b) { return key(a) < key(b); });
    DisjointSets sets(mesh.positions.size());
    for (std::size_t i = 1; i < order.size(); ++i)
      if (key(order[i]) == key(order[i - 1])) sets.join(order[i], order[i - 1]);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material[t] != material) continue;
      sets.join(mesh.triangles[t][0], mesh.triangles[t][1]);
      sets.join(mesh.triangles[t][0], mesh.triangles[t][2]);
    }
    std::map<std::uint32_t, std::uint32_t> number;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material[t] != material) continue;
      const auto [found, is_new] = number.try_emplace(sets.find(mesh.triangles[t][0]),
                                                      static_cast<std::uint32_t>(faces_.size()));
      if (is_new) faces_.emplace_back();
      chart_of_[m][t] = found->second;
      faces_[found->second].push_back({m, t});
    }
  }
}

void TextureAtlas::fill_chart(const std::vector<Mesh>& meshes, std::uint32_t chart_number,
                              float spacing) {
  AtlasChart& chart = charts_.emplace_back();
  double area = 0.0, flat_area = 0.0;
  float low_x = 1e30f, low_y = 1e30f, high_x = -1e30f, high_y = -1e30f;
  for (const auto& [m, t] : faces_[chart_number]) {
    const auto uv = uvs_of(meshes[m], t);
    area += static_cast<double>(area_of(meshes[m], t));
    flat_area += static_cast<double>(area_of(uv));
    for (const Vec2f& corner : uv) {
      low_x = std::min(low_x, corner.x), high_x = std::max(high_x, corner.x);
      low_y = std::min(low_y, corner.y), high_y = std::max(high_y, corner.y);
    }
  }
  if (!(flat_area > 0.0) || !(area > 0.0)) return;
  chart.density = static_cast<float>(std::sqrt(area / flat_area)) / spacing;
  const auto first = [&](float low) {
    return static_cast<std::int32_t>(std::floor(low * chart.density)) - 2;
  };
  const auto count = [&](float low, float high) {
    return static_cast<std::int32_t>(std::ceil((high - low) * chart.density)) + 5;
  };
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput("mesh \"" + meshes[faces_[chart_number].front().mesh].name +
                       "\": its texture coordinates " + why + " to be filled with texels");
  };
  constexpr double most = 2.5e8;  // 1 GiB of them
  grid_size_ += (static_cast<double>(high_x - low_x) * static_cast<double>(chart.density) + 5.0) *
                (static_cast<double>(high_y - low_y) * static_cast<double>(chart.density) + 5.0);
  if (!(grid_size_ <= most)) refuse("are spread too far");
  // Beyond, numbers of single precision have no halves of a texel.
  constexpr float farthest = 1 << 22;
  for (const float end : {low_x, low_y, high_x, high_y})
    if (!(std::abs(end * chart.density) < farthest)) refuse("lie too far from 0");
  chart.x0 = first(low_x), chart.y0 = first(low_y);
  chart.width = count(low_x, high_x), chart.height = count(low_y, high_y);
  chart.index.assign(static_cast<std::size_t>(chart.width) * static_cast<std::size_t>(chart.height),
                     no_texel);

  const std::size_t texels_before = texels_.size();
  std::vector<bool> is_shared;  // [texel of the chart], lies on several faces
  std::size_t overlaps = 0;
  Vec2f overlap_at;
  for (const auto& [m, t] : faces_[chart_number]) {
    const auto uv = uvs_of(meshes[m], t);
    const auto range = [&](float a, float b, float c) {
      const auto [low, high] = std::minmax({a, b, c});
      return std::pair(static_cast<std::int32_t>(std::floor(low * chart.density - 0.5f)),
                       static_cast<std::int32_t>(std::ceil(high * chart.density - 0.5f)));
    };
    const auto [x_from, x_to] = range(uv[0].x, uv[1].x, uv[2].x);
    const auto [y_from, y_to] = range(uv[0].y, uv[1].y, uv[2].y);
    for (std::int32_t y = y_from; y <= y_to; ++y)
      for (std::int32_t x = x_from; x <= x_to; ++x) {
        const Vec2f middle{(static_cast<float>(x) + 0.5f) / chart.density,
                           (static_cast<float>(y) + 0.5f) / chart.density};
        float u = 0.0f, v = 0.0f;
        if (!barycentric(uv, middle, u, v)) continue;
        const float least = std::min({u, v, 1.0f - u - v});
        if (least < -1e-5f) continue;
        std::uint32_t& index = chart.index[static_cast<std::size_t>(y - chart.y0) *
                                               static_cast<std::size_t>(chart.width) +
                                           static_cast<std::size_t>(x - chart.x0)];
        if (index != no_texel) {
          is_shared.resize(texels_.size() - texels_before);
          if (least < 0.01f || is_shared[index - texels_before]) continue;
          is_shared[index - texels_before] = true;
          if (++overlaps == 1) overlap_at = middle;
          continue;
        }
        const SurfacePoint point = make_surface_point(
            meshes, {.distance = 0.0f, .u = u, .v = v, .mesh = m, .triangle = t}, 0.0f);
        AtlasTexel texel{.mesh = m,
                         .triangle = t,
                         .u = u,
                         .v = v,
                         .chart = chart_number,
                         .x = x,
                         .y = y,
                         .position = point.position,
                         .normal = point.smooth_normal,
                         .across = point.du / chart.density,
                         .up = point.dv / chart.density};
        texel.area = length(cross(texel.across, texel.up));
        if (!(texel.area > 0.0f) || !std::isfinite(texel.area)) continue;
        index = static_cast<std::uint32_t>(texels_.size());
        texels_.push_back(texel);
      }
  }
  const std::size_t filled = texels_.size() - texels_before;
  if (overlaps <= 8 || overlaps * 200 <= filled) return;  // rounding along edges
  const std::string text = "mesh \"" + meshes[faces_[chart_number].front().mesh].name +
                           "\": texture coordinates overlap: " + std::to_string(overlaps) + " of " +
                           std::to_string(filled) +
                           " texels of a chart lie on several faces, as at u " +
                           number_text(overlap_at.x) + ", v " + number_text(overlap_at.y);
  if (2 * overlaps > filled) throw InvalidInput(text);
  warnings_.push_back(text + "; one of the faces has the light of each");
}

std::uint32_t TextureAtlas::texel_at(const AtlasChart& chart, std::int32_t x,
                                     std::int32_t y) const {
  x -= chart.x0;
  y -= chart.y0;
  if (x < 0 || y < 0 || x >= chart.width || y >= chart.height) return no_texel;
  return chart.index[static_cast<std::size_t>(y) * static_cast<std::size_t>(chart.width) +
                     static_cast<std::size_t>(x)];
}

void TextureAtlas::add_borders() {
  const TexelNeighborhood neighborhood(texels_);
  const std::size_t count = texels_.size();
  for (std::uint32_t i = 0; i < count; ++i) {
    const AtlasTexel& texel = texels_[i];
    AtlasChart& chart = charts_[texel.chart];
    for (std::int32_t dy = -1; dy <= 1; ++dy)
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        if (texel_at(chart, texel.x + dx, texel.y + dy) != no_texel) continue;
        const Vec3f place = texel.position + static_cast<float>(dx) * texel.across +
                            static_cast<float>(dy) * texel.up;
        Border border;
        float total = 0.0f;
        const float width = std::sqrt(texel.area);
        neighborhood.for_near(place, 1.6f * width, [&](std::uint32_t k, float distance2) {
          if (dot(texels_[k].normal, texel.normal) < 0.2f) return;
          const float weight = std::exp(-2.0f * distance2 / (width * width));
          border.from.emplace_back(k, weight);
          total += weight;
        });
        if (border.from.empty()) {
          border.from.emplace_back(i, 1.0f);
          total = 1.0f;
        }
        for (auto& each : border.from) each.second /= total;
        chart.index[static_cast<std::size_t>(texel.y + dy - chart.y0) *
                        static_cast<std::size_t>(chart.width) +
                    static_cast<std::size_t>(texel.x + dx - chart.x0)] =
            static_cast<std::uint32_t>(count + borders_.size());
        borders_.push_back(std::move(border));
      }
  }
}

TextureAtlas::Weights TextureAtlas::weights_at(const SurfacePoint& point) const {
  Weights weights;
  const std::uint32_t number = chart_of_[point.mesh][point.triangle];
  if (number == no_texel || texels_.empty()) return weights;
  const AtlasChart& chart = charts_[number];
  const float x = point.uv.x * chart.density - 0.5f, y = point.uv.y * chart.density - 0.5f;
  const float x_low = std::floor(x), y_low = std::floor(y), fx = x - x_low, fy = y - y_low;
  const auto ix = static_cast<std::int32_t>(x_low), iy = static_cast<std::int32_t>(y_low);
  float total = 0.0f;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const std::uint32_t texel = texel_at(chart, ix + dx, iy + dy);
    const float weight = (dx != 0 ? fx : 1.0f - fx) * (dy != 0 ? fy : 1.0f - fy);
    if (texel == no_texel || !(weight > 0.0f)) continue;
    const auto k = static_cast<std::size_t>(weights.count++);
    weights.texel[k] = texel;
    weights.weight[k] = weight;
    total += weight;
  }
  if (total > 0.0f) {
    for (float& weight : weights.weight) weight /= total;
    return weights;
  }
  // A face smaller than a texel, away from all others: the nearest texel of its chart.
  for (std::int32_t ring = 1; ring <= 8; ++ring)
    for (std::int32_t dy = -ring; dy <= ring; ++dy)
      for (std::int32_t dx = -ring; dx <= ring; ++dx) {
        const std::uint32_t texel = texel_at(chart, ix + dx, iy + dy);
        if (texel == no_texel) continue;
        weights.count = 1;
        weights.texel[0] = texel;
        weights.weight[0] = 1.0f;
        return weights;
      }
  return weights;
}

}  // namespace lamina
