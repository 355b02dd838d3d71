// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/core/parallel_chunks.h"
#include "lamina/render/subsurface/irradiance_fireflies.h"
#include "lamina/render/subsurface/leaving_fraction.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "lamina/render/subsurface/texture_space/internal/texel_maps.h"
#include "lamina/scene/skin_totals.h"
#include "lamina/skin_patch/material_texels.h"

namespace lamina {
namespace {

/// Levels of cells go on up to at least this size: Gaussians of skin are no wider [mm²]. Where
/// light goes further, up to so many times the variance of what it spreads.
constexpr double smallest_largest_cell = 25.0, cell_per_spread = 1.9;

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
  if (surface_.material.ground.top.roughness > 0.0) refuse("a smooth boundary to the ground");
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
  const TextureSpaceSettings& settings = scene_.scene->render.texture_space;
  const auto area = static_cast<float>(surface_area(scene_.scene->meshes, material_));
  // Finer than the narrowest profiles matter there is nothing to see.
  constexpr float finest = 0.02f;
  const float wanted = settings.texel > 0.0f ? settings.texel : std::max(pixel_size, finest);
  return std::max(wanted, std::sqrt(area / static_cast<float>(settings.max_texels)));
}

template <int N>
void TextureSpaceTransport<N>::make_texels(float spacing) {
  spacing_ = spacing;
  atlas_.emplace(scene_.scene->meshes, material_, spacing_);
  if (atlas_->texels().empty())
    throw InvalidInput("material \"" + scene_.scene->materials[material_].name +
                       "\": no texel of method texture_space lies on it: its faces have no area in "
                       "texture coordinates, or are all smaller than a texel");
}

template <int N>
void TextureSpaceTransport<N>::make_layers(const std::optional<DiskCache>& cache) {
  const TextureAtlas::Cells cells = atlas_->cells();
  const std::vector<NumberTexels> maps =
      sample_maps(surface_.material_maps, scene_.scene->meshes, *atlas_);
  const std::size_t bands = surface_.material.bands.size();
  const OperatorTotals totals = texture_space_totals();
  std::vector<StackTables> tables(bands);
  std::vector<BandTexels> texels(bands);
  std::vector<MappedStack> stacks(bands);
  Material material = surface_.material;
  material.layers.front().top = {};  // the surface's roughness is the coat's business
  parallel_for(bands, [&](std::size_t b) {
    texels[b] = band_texels(material, maps, atlas_->texels().size(), b);
    stacks[b] = mapped_stack(material, b, texels[b]);
    tables[b] = cached_stack_tables(cache, stacks[b], totals, reference_absorptions(texels[b]));
  });
  double widest = smallest_largest_cell;
  for (const StackTables& table : tables)
    widest = std::max(widest, cell_per_spread * widest_spread(table.lattices));
  graph_ = make_cell_graph(cells.cells, cells.links, widest);
  layers_ = make_surface_layers<N>(graph_);
  for (std::size_t b = 0; b < bands; ++b)
    layers_->add_band(static_cast<int>(b), tables[b], texels[b].layers, texels[b].absorbance);
  if (std::isinf(material.layers.back().thickness)) {
    std::vector<std::vector<float>> last(bands);  // absorption of the last layer
    std::vector<ThinBand> thin;
    for (std::size_t b = 0; b < bands; ++b) {
      last[b] = texels[b].layers.back().sigma_a;
      last[b].resize(atlas_->texels().size(), last[b].front());
      thin.push_back({.stack = &stacks[b],
                      .tables = &tables[b],
                      .reference = reference_absorptions(texels[b]),
                      .sigma_a = last[b],
                      .has_transfer_totals = totals != OperatorTotals::diffusion});
    }
    std::vector<Vec3f> positions, normals;
    for (const AtlasTexel& texel : atlas_->texels()) {
      positions.push_back(texel.position);
      normals.push_back(texel.normal);
    }
    layers_->thin = make_thin_parts<N>(graph_, positions, normals, thin);
  }
  reflectance_ = uniform_reflectance(*layers_);
  extend(reflectance_);
}

template <int N>
OperatorTotals TextureSpaceTransport<N>::texture_space_totals() const {
  const Material& material = surface_.material;
  const bool is_transfer = !material.skin || takes_material_totals(material, scene_.scene->render);
  return is_transfer ? OperatorTotals::radiative_transfer_diffuse : OperatorTotals::diffusion;
}

template <int N>
std::optional<IrradianceCloud> TextureSpaceTransport<N>::sample_light(
    const LightGatherer<N>& light, const std::vector<bool>& is_seen, std::uint64_t seed,
    const Progress& progress) const {
  const auto texels = atlas_->texels();
  const auto& meshes = scene_.scene->meshes;
  IrradianceCloud cloud{
      .material = material_,
      .bands = surface_.material.bands.size(),
      .spacing = spacing_,
      .points = std::vector<CloudPoint>(texels.size()),
      .irradiance = std::vector<float>(texels.size() * surface_.material.bands.size())};
  const SurfaceMaterial& material = scene_.scene->materials[material_];
  const int full = scene_.scene->render.texture_space.irradiance_samples;
  constexpr std::size_t chunk = 256;
  const auto sample = [&](std::size_t i) {
    const AtlasTexel& texel = texels[i];
    const auto point_at = [&](Vec2f moved) {
      // Moved within the plane of its face, as far as that goes.
      const Vec2f d = barycentric_step(meshes, texel, moved);
      float u = texel.u + d.x, v = texel.v + d.y;
      if (u < 0.0f || v < 0.0f || u + v > 1.0f) u = texel.u, v = texel.v;
      SurfacePoint point = make_surface_point(
          meshes,
          {.distance = 0.0f, .u = u, .v = v, .mesh = texel.mesh, .triangle = texel.triangle},
          spacing_);
      if (material.bump || material.normal_map)
        point.normal = bent_normal(scene_.textures, material, point);
      return point;
    };
    const bool is_full = is_seen.empty() || is_seen[i];
    const int count = is_full ? full : std::max(1, full / fewer_where_hidden);
    const std::uint32_t along = morton(texel.x, texel.y);
    Bands irradiance;
    for (int s = 0; s < count; ++s) {
      PixelSamples samples(
          seed + 0x9d2c5680u, 2 * texel.chart + (is_full ? 0 : 1),
          along * static_cast<std::uint32_t>(count) + static_cast<std::uint32_t>(s));
      const Vec2f place = samples.next_2d();
      irradiance += light.entering_irradiance(point_at({place.x - 0.5f, place.y - 0.5f}), samples);
    }
    for (std::size_t b = 0; b < cloud.bands; ++b)
      cloud.irradiance[i * cloud.bands + b] =
          irradiance[static_cast<int>(b)] / static_cast<float>(count);
    const SurfacePoint middle = point_at({0.0f, 0.0f});
    cloud.points[i] = {.position = texel.position,
                       .normal = middle.normal,
                       .uv = middle.uv,
                       .area = texel.area,
                       .albedo = {1, 1, 1},
                       .thickness = 0.0f};
  };
  if (!parallel_chunks(texels.size(), chunk, sample, progress)) return std::nullopt;
  return cloud;
}

template <int N>
void TextureSpaceTransport<N>::scatter(IrradianceCloud& cloud) {
  const std::size_t texels = cloud.points.size();
  CellField<N> entering(texels);
  for (std::size_t i = 0; i < texels; ++i)
    for (std::size_t b = 0; b < cloud.bands; ++b)
      entering[i][static_cast<int>(b)] = cloud.irradiance[i * cloud.bands + b];
  clamp_fireflies(graph_.levels.front(), entering);
  const CellField<N> leaving =
      transport(*layers_, entering, scene_.scene->render.texture_space.interlayer_bounces);
  layers_.reset();
  graph_ = {};
  const auto kept = [&](const CellField<N>& field) {
    std::vector<float> values(texels * cloud.bands);
    for (std::size_t i = 0; i < texels; ++i)
      for (std::size_t b = 0; b < cloud.bands; ++b)
        values[i * cloud.bands + b] =
            std::max(field[i][static_cast<int>(b)], 0.0f);  // where weights overshoot
    return values;
  };
  cloud.exitance = kept(leaving);
  cloud.reflectance = kept(reflectance_);
  cloud.irradiance = {};
}

template <int N>
void TextureSpaceTransport<N>::use(const IrradianceCloud& cloud) {
  const std::size_t texels = atlas_->texels().size();
  if (cloud.points.size() != texels || cloud.exitance.empty())
    throw InvalidInput("texture_space: " + std::to_string(cloud.points.size()) +
                       " samples of light do not fit " + std::to_string(texels) + " texels");
  for (std::size_t i = 0; i < texels; ++i) {
    const Vec3f offset = cloud.points[i].position - atlas_->texels()[i].position;
    if (!(length(offset) < 0.01f * spacing_))
      throw InvalidInput("texture_space: sample of light " + std::to_string(i) +
                         " must lie on its texel, but is " + number_text(length(offset)) +
                         " mm away: another version of lamina made the cache; remove it");
  }
  const auto field_of = [&](const std::vector<float>& values) {
    CellField<N> field;
    field.reserve(texels + atlas_->borders().size());
    field.resize(texels);
    for (std::size_t i = 0; i < texels; ++i)
      for (std::size_t b = 0; b < cloud.bands; ++b)
        field[i][static_cast<int>(b)] = values[i * cloud.bands + b];
    extend(field);
    return field;
  };
  exitance_ = field_of(cloud.exitance);
  reflectance_ = field_of(cloud.reflectance);
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
                                                  const SurfacePoint& point) const {
  const TextureAtlas::Weights weights = atlas_->weights_at(point);
  Bands value;
  for (int k = 0; k < weights.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    value += weights.weight[i] * field[weights.texel[i]];
  }
  return value;
}

template <int N>
BandValues<N> TextureSpaceTransport<N>::local_reflectance(const SurfacePoint& point) const {
  return looked_up(reflectance_, point);
}

template <int N>
BandValues<N> TextureSpaceTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                         const LightGatherer<N>& /*light*/,
                                                         PixelSamples& /*samples*/) const {
  return leaving_fraction(exit, is_printed_exit_) * looked_up(exitance_, exit.point);
}

template class TextureSpaceTransport<4>;
template class TextureSpaceTransport<8>;
template class TextureSpaceTransport<16>;

}  // namespace lamina
