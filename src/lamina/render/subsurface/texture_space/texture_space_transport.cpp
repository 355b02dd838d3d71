// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel_chunks.h"
#include "lamina/render/subsurface/irradiance_fireflies.h"
#include "lamina/render/subsurface/leaving_fraction.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "lamina/render/subsurface/texture_space/internal/texel_maps.h"
#include "lamina/render/subsurface/texture_space/internal/texel_samples.h"
#include "lamina/skin/patch/material_texels.h"

namespace lamina {
namespace {

/// Texels that do not show get so many times fewer samples: their light comes in from afar only.
constexpr int fewer_where_hidden = 8;

/// Place of a texel along a curve that visits all of a square of 2^k by 2^k texels before it leaves
/// it: Morton's, the bits of x and y in turn.
std::uint32_t morton(std::int32_t x, std::int32_t y) {
  const auto bits_apart = [](std::int32_t value) {
    std::uint32_t bits = static_cast<std::uint32_t>(value) & 0xffffu;
    bits = (bits | (bits << 8)) & 0x00ff00ffu;
    bits = (bits | (bits << 4)) & 0x0f0f0f0fu;
    bits = (bits | (bits << 2)) & 0x33333333u;
    return (bits | (bits << 1)) & 0x55555555u;
  };
  return bits_apart(x) | (bits_apart(y) << 1);
}

}  // namespace

template <int N>
TextureSpaceTransport<N>::TextureSpaceTransport(const RenderScene& scene, std::uint32_t material,
                                                bool is_printed_exit)
    : scene_(scene),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      material_(material),
      is_printed_exit_(is_printed_exit) {
  const auto refuse = [&](const std::string& rule) {
    throw InvalidInput("material \"" + scene.scene->materials[material].name +
                       "\": method texture_space needs " + rule);
  };
  const Material& layers = surface_.material;
  const bool lets_through = lets_light_through(layers);
  if (layers.ground.top.roughness > 0.0 && !lets_through) refuse("a smooth boundary to the ground");
  for (const Mesh& mesh : scene.scene->meshes)
    is_sheet_.push_back(lets_through && !is_closed(mesh, material) &&
                        std::ranges::find(mesh.material, material) != mesh.material.end());
  sides_.resize(std::ranges::find(is_sheet_, true) != is_sheet_.end() ? 2 : 1);
  const BandSet& bands = surface_.material.bands;
  for (const MaterialMap& map : surface_.material_maps) {
    const std::size_t channels = map.values.channel_count();
    const bool is_of_layers = surface_.material.skin == std::nullopt && !surface_.material.leaf;
    if (channels > 1 && channels != bands.size())
      refuse("maps by band for the bands of the scene, but that of " + map.number.name + " has " +
             std::to_string(channels) + " for " + std::to_string(bands.size()));
    if (!is_of_layers && bands.is_rgb())
      refuse("wavelengths for a map of " + map.number.name + ", but the scene is in RGB");
  }
}

template <int N>
float TextureSpaceTransport<N>::spacing_for(float pixel_size) const {
  const TextureSpaceSettings& settings = scene_.settings.texture_space;
  const auto area = static_cast<float>(surface_area(scene_.scene->meshes, material_));
  // Finer than the narrowest profiles matter there is nothing to see.
  constexpr float finest = 0.02f;
  const float wanted = settings.texel > 0.0f ? settings.texel : std::max(pixel_size, finest);
  return std::max(wanted, std::sqrt(area / static_cast<float>(settings.max_texels)));
}

template <int N>
void TextureSpaceTransport<N>::make_texels(float spacing) {
  spacing_ = spacing;
  atlas_ = std::make_shared<const TextureAtlas>(scene_.scene->meshes, material_, spacing_);
  if (atlas_->texels().empty())
    throw InvalidInput("material \"" + scene_.scene->materials[material_].name +
                       "\": no texel of method texture_space lies on it: its faces have no area in "
                       "texture coordinates, or are all smaller than a texel");
}

template <int N>
std::optional<IrradianceCloud> TextureSpaceTransport<N>::sample_light(
    const LightGatherer<N>& light, const std::vector<bool>& is_seen, std::uint64_t seed,
    const Progress& progress) const {
  const auto texels = atlas_->texels();
  const auto& meshes = scene_.scene->meshes;
  const CellGraph& graph = texel_layers_->graph;
  const std::size_t points = side_count() * texels.size();
  IrradianceCloud cloud{.material = material_,
                        .bands = surface_.material.bands.size(),
                        .spacing = spacing_,
                        .points = std::vector<CloudPoint>(points),
                        .irradiance = std::vector<float>(points * surface_.material.bands.size())};
  const SurfaceMaterial& material = scene_.scene->materials[material_];
  const int full = scene_.settings.texture_space.irradiance_samples;
  std::optional<SkyIrradiance> sky;
  if (has_uneven_sky(scene_.lights)) {
    const AtlasTexel& first = texels.front();
    sky.emplace(scene_.lights, boundary_at(scene_, make_surface_point(meshes,
                                                                      {.distance = 0.0f,
                                                                       .u = first.u,
                                                                       .v = first.v,
                                                                       .mesh = first.mesh,
                                                                       .triangle = first.triangle},
                                                                      spacing_)));
  }
  const auto point_at = [&](std::size_t i, Vec2f moved) {
    const bool is_below = i >= texels.size();
    const AtlasTexel& texel = texels[i % texels.size()];
    // Moved within the plane of its face, as far as that goes.
    const Vec2f d = barycentric_step(meshes, texel, moved);
    float u = texel.u + d.x, v = texel.v + d.y;
    if (u < 0.0f || v < 0.0f || u + v > 1.0f) u = texel.u, v = texel.v;
    SurfacePoint point = make_surface_point(
        meshes, {.distance = 0.0f, .u = u, .v = v, .mesh = texel.mesh, .triangle = texel.triangle},
        spacing_);
    if (material.bump || material.normal_map)
      point.normal = bent_normal(scene_.textures, material, point);
    return is_below ? turned_over(point, true) : point;
  };
  std::vector<TexelSamples<N>> found(points);
  const auto sample = [&](std::size_t i, PixelSamples samples) {
    const Vec2f place = samples.next_2d();
    const SurfacePoint point = point_at(i, {place.x - 0.5f, place.y - 0.5f});
    found[i].add(sky ? light.entering_light(point, samples, *sky)
                     : EnteringLight<N>{light.entering_irradiance(point, samples)});
  };
  constexpr std::size_t chunk = 256;
  const int first_count = full > 2 ? (full + 1) / 2 : full;
  const auto sample_evenly = [&](std::size_t i) {
    const bool is_below = i >= texels.size();
    const std::size_t t = i % texels.size();
    const AtlasTexel& texel = texels[t];
    const SurfacePoint middle = point_at(i, {0.0f, 0.0f});
    cloud.points[i] = {.position = texel.position,
                       .normal = middle.normal,
                       .uv = middle.uv,
                       .area = texel.area,
                       .albedo = {1, 1, 1},
                       .thickness = 0.0f};
    found[i].may_have_more = is_seen.empty() || is_seen[t];
    if (is_below && !is_sheet_[texel.mesh]) found[i].may_have_more = false;
    if (is_below && !is_sheet_[texel.mesh]) return;
    const bool is_full = found[i].may_have_more;
    const auto count =
        static_cast<std::uint32_t>(is_full ? first_count : std::max(1, full / fewer_where_hidden));
    const std::uint32_t along = morton(texel.x, texel.y);
    for (std::uint32_t s = 0; s < count; ++s)
      sample(i, PixelSamples(seed + (is_below ? 0x3c6ef372u : 0x9d2c5680u),
                             2 * texel.chart + (is_full ? 0 : 1), along * count + s));
  };
  if (!parallel_chunks(points, chunk, sample_evenly, progress)) return std::nullopt;

  std::vector<float> shares;  // [texel], of the sky
  const auto of_side = [&](std::size_t side) {
    return std::span<const TexelSamples<N>>(found).subspan(side * texels.size(), texels.size());
  };
  const auto find_shares = [&] {
    shares.clear();
    for (std::size_t side = 0; side < side_count(); ++side)
      std::ranges::copy(sky_shares<N>(graph.levels.front(), of_side(side)),
                        std::back_inserter(shares));
  };
  find_shares();
  for (std::size_t side = 0; full > first_count && side < side_count(); ++side) {
    const std::size_t first = side * texels.size();
    const std::vector<int> more = more_samples<N>(
        graph, of_side(side), std::span<const float>(shares).subspan(first, texels.size()),
        static_cast<float>(full - first_count));
    const auto sample_more = [&](std::size_t t) {
      for (int s = 0; s < more[t]; ++s)
        sample(first + t, PixelSamples(seed + 0x1b873593u, static_cast<std::uint32_t>(first + t),
                                       static_cast<std::uint32_t>(s)));
    };
    if (!parallel_chunks(texels.size(), chunk, sample_more, progress)) return std::nullopt;
  }
  find_shares();
  CellField<N> means(points);
  for (std::size_t i = 0; i < points; ++i)
    if (found[i].count > 0)
      means[i] = (1.0f / static_cast<float>(found[i].count)) *
                 (found[i].irradiance + shares[i] * found[i].missed);
  for (std::size_t side = 0; side < side_count(); ++side)
    spread_rare_light<N>(
        graph, of_side(side),
        std::span<const float>(shares).subspan(side * texels.size(), texels.size()),
        std::span(means).subspan(side * texels.size(), texels.size()));
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t b = 0; b < cloud.bands; ++b)
      cloud.irradiance[i * cloud.bands + b] = means[i][static_cast<int>(b)];
  return cloud;
}

template <int N>
void TextureSpaceTransport<N>::scatter(IrradianceCloud& cloud) {
  const std::size_t texels = atlas_->texels().size(), sides = side_count();
  std::vector<CellField<N>> leaving(sides, CellField<N>(texels));
  for (std::size_t side = 0; side < sides; ++side) {
    CellField<N> entering(texels);
    for (std::size_t i = 0; i < texels; ++i)
      for (std::size_t b = 0; b < cloud.bands; ++b)
        entering[i][static_cast<int>(b)] = cloud.irradiance[(side * texels + i) * cloud.bands + b];
    clamp_fireflies(texel_layers_->graph.levels.front(), entering);
    auto [reflected, transmitted] =
        transport(texel_layers_->from(side), entering,
                  scene_.settings.texture_space.interlayer_bounces);
    for (std::size_t i = 0; i < texels; ++i) leaving[side][i] += reflected[i];
    if (!transmitted.empty()) add_transmitted(side, std::move(transmitted), leaving);
  }
  texel_layers_.reset();
  const auto keep = [&](const CellField<N>& field, std::vector<float>& values) {
    for (std::size_t i = 0; i < texels; ++i)
      for (std::size_t b = 0; b < cloud.bands; ++b)
        values.push_back(std::max(field[i][static_cast<int>(b)], 0.0f));  // where weights overshoot
  };
  for (std::size_t side = 0; side < sides; ++side) {
    keep(leaving[side], cloud.exitance);
    keep(sides_[side].reflectance, cloud.reflectance);
    if (sides == 2) keep(sides_[side].transmittance, cloud.transmittance);
  }
  cloud.irradiance = {};
}

template <int N>
void TextureSpaceTransport<N>::add_transmitted(std::size_t side, CellField<N> through,
                                               std::vector<CellField<N>>& leaving) const {
  const auto texels = atlas_->texels();
  const std::vector<FarSide>& far_sides = texel_layers_->far_sides;
  extend(through);
  for (std::size_t i = 0; i < texels.size(); ++i)
    if (is_sheet_[texels[i].mesh])
      leaving[1 - side][i] += through[i];
    else if (side == 0 && far_sides[i].facing > 0.0f)
      leaving[0][i] += far_sides[i].facing * looked_up(through, far_sides[i].place);
}

template <int N>
void TextureSpaceTransport<N>::use(const IrradianceCloud& cloud) {
  const std::size_t texels = atlas_->texels().size(), points = side_count() * texels;
  if (cloud.points.size() != points || cloud.exitance.empty())
    throw InvalidInput("texture_space: " + std::to_string(cloud.points.size()) +
                       " samples of light do not fit " + std::to_string(points) + " texels");
  for (std::size_t i = 0; i < points; ++i) {
    const Vec3f offset = cloud.points[i].position - atlas_->texels()[i % texels].position;
    if (!(length(offset) < 0.01f * spacing_))
      throw InvalidInput("texture_space: sample of light " + std::to_string(i) +
                         " must lie on its texel, but is " + number_text(length(offset)) +
                         " mm away: another version of lamina made the cache; remove it");
  }
  for (std::size_t side = 0; side < side_count(); ++side) {
    const auto field_of = [&](const std::vector<float>& values) {
      CellField<N> field;
      field.reserve(texels + atlas_->borders().size());
      field.resize(texels);
      for (std::size_t i = 0; i < texels; ++i)
        for (std::size_t b = 0; b < cloud.bands; ++b)
          field[i][static_cast<int>(b)] = values[(side * texels + i) * cloud.bands + b];
      extend(field);
      return field;
    };
    sides_[side] = {field_of(cloud.exitance), field_of(cloud.reflectance), {}};
    if (!cloud.transmittance.empty()) sides_[side].transmittance = field_of(cloud.transmittance);
  }
}

template <int N>
void TextureSpaceTransport<N>::extend(CellField<N>& field) const {
  for (const TextureAtlas::Border& border : atlas_->borders()) {
    Bands value;
    for (const auto& [texel, weight] : border.from) value += weight * field[texel];
    field.push_back(value);
  }
}

template <int N>
BandValues<N> TextureSpaceTransport<N>::looked_up(const CellField<N>& field,
                                                  const TextureAtlas::Weights& weights) {
  Bands value;
  for (int k = 0; k < weights.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    value += weights.weight[i] * field[weights.texel[i]];
  }
  return value;
}

template <int N>
BandValues<N> TextureSpaceTransport<N>::local_reflectance(const SurfacePoint& point) const {
  return looked_up(side_of(point).reflectance, atlas_->weights_at(point));
}

template <int N>
BandValues<N> TextureSpaceTransport<N>::local_transmittance(const SurfacePoint& point) const {
  return looked_up(side_of(point).transmittance, atlas_->weights_at(point));
}

template <int N>
BandValues<N> TextureSpaceTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                         const LightGatherer<N>& /*light*/,
                                                         PixelSamples& /*samples*/) const {
  return leaving_fraction(exit, is_printed_exit_) *
         looked_up(side_of(exit.point).exitance, atlas_->weights_at(exit.point));
}

template class TextureSpaceTransport<4>;
template class TextureSpaceTransport<8>;
template class TextureSpaceTransport<16>;

}  // namespace lamina
