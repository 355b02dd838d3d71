// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel_chunks.h"
#include "lamina/render/geometry/nearest_pixel.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"

namespace lamina {
namespace {

// Measured on one core of a Zen 4 [CPU s], for what cannot be timed before it is prepared.
constexpr double seconds_per_texel = 12e-6;  // cutting one, its neighbours, its skin
constexpr double seconds_per_bounce = 1e-6;  // between the layers, for each texel and band
constexpr double seconds_per_texel_lookup = 0.5e-6;

/// Layers of so many texels are kept for other pictures, 2 kB each.
constexpr std::size_t most_kept_texels = 250'000;

/// Texels that face the camera's place with nothing but clear surfaces or other materials of the
/// kind between: what may show, directly. Sheets face it on either side.
std::vector<char> seen_texels(const RenderScene& scene, std::span<const AtlasTexel> texels,
                              const std::vector<bool>& is_sheet) {
  const Vec3& at = scene.scene->camera.position;
  const Vec3f eye{static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
  std::vector<char> is_seen(texels.size(), 0);
  constexpr std::size_t chunk = 1024;
  parallel_chunks(texels.size(), chunk, [&](std::size_t i) {
    const AtlasTexel& texel = texels[i];
    const Vec3f offset = eye - texel.position;
    const float distance = length(offset), width = std::sqrt(texel.area);
    const bool is_from_below = is_sheet[texel.mesh] && dot(offset, texel.normal) < 0.0f;
    const Vec3f normal = is_from_below ? -texel.normal : texel.normal;
    if (!(distance > width) || dot(offset, normal) < -0.1f * distance) return;
    const Ray ray{texel.position + width * normal, offset / distance};
    is_seen[i] = scene.geometry.is_blocked(ray, 0.0f, distance) ? 0 : 1;
  });
  return is_seen;
}

/// Texels whose light shows: what enters opposite a texel that is seen comes through to it.
std::vector<bool> showing_texels(std::vector<char> is_seen, std::span<const FarSide> far_sides) {
  const std::vector<char> directly = is_seen;
  for (std::size_t i = 0; i < far_sides.size(); ++i) {
    const TextureAtlas::Weights& place = far_sides[i].place;
    if (!directly[i]) continue;
    for (std::size_t k = 0; k < static_cast<std::size_t>(place.count); ++k)
      if (place.texel[k] < is_seen.size()) is_seen[place.texel[k]] = 1;
  }
  return {is_seen.begin(), is_seen.end()};
}

}  // namespace

template <int N>
CloudMisfit TextureSpaceTransport<N>::misfit(const IrradianceCloud& cloud,
                                             const CameraRays& camera) const {
  if (cloud.bands != surface_.material.bands.size() || cloud.exitance.empty())
    return {.lacks = "lacks a material of the scene", .too_coarse = {}};
  const float wanted = spacing_for(nearest_pixel(*scene_.scene, camera, material_));
  if (cloud.spacing > 2.001f * wanted)
    return {.lacks = {},
            .too_coarse = "its texels are " + number_text(cloud.spacing) +
                          " mm wide, but this camera sees light as fine as " + number_text(wanted) +
                          " mm"};
  return {};
}

template <int N>
void TextureSpaceTransport<N>::prepare_reflectance(const Preparation<N>& with) {
  const IrradianceCloud* kept = with.cache.find(
      material_, [&](const IrradianceCloud& cloud) { return misfit(cloud, with.camera); });
  is_kept_ = kept != nullptr;
  if (kept) {
    make_texels(kept->spacing);
    use(*kept);
  } else {
    take_or_make_layers(with);
  }
  std::ranges::copy(atlas_->warnings(), std::back_inserter(with.report.warnings));
}

template <int N>
void TextureSpaceTransport<N>::take_or_make_layers(const Preparation<N>& with) {
  const float wanted = spacing_for(nearest_pixel(*scene_.scene, with.camera, material_));
  KeptParts* kept = with.cache.is_wanted() ? nullptr : scene_.kept;
  if (kept) {
    Hash hash;
    hash.add(wanted);
    struct Texels {
      float spacing;
      std::shared_ptr<const TextureAtlas> atlas;
    };
    const auto texels = kept->get<Texels>(
        KeptPart::texels, material_, hash.value(),
        [&] {
          make_texels(wanted);
          return std::make_shared<const Texels>(Texels{spacing_, atlas_});
        },
        [&](const Texels& others) {
          return others.spacing < 2.0f * wanted && wanted < 2.0f * others.spacing;
        });
    spacing_ = texels.part->spacing;
    atlas_ = texels.part->atlas;
    texels_key_ = texels.key;
    const auto leaving = kept->find<TexelLight>(
        KeptPart::leaving_light, material_, texels_key_,
        [&](const TexelLight& light) { return light.texels == texels_key_; });
    if (leaving) {
      use(leaving->cloud);
      is_kept_ = true;
      return;
    }
  } else {
    make_texels(wanted);
  }
  const auto make = [&] { return make_layers(user_cache()); };
  texel_layers_ = atlas_->texels().size() > most_kept_texels
                      ? make()
                      : kept_or_made<TexelLayers>(kept, KeptPart::texel_layers, material_,
                                                  texels_key_, make)
                            .part;
  for (std::size_t side = 0; side < side_count(); ++side) {
    sides_[side].reflectance = texel_layers_->reflectance[side];
    if (side_count() > 1) sides_[side].transmittance = texel_layers_->transmittance[side];
  }
  if (!texel_layers_->warning.empty()) with.report.warnings.push_back(texel_layers_->warning);
}

template <int N>
bool TextureSpaceTransport<N>::prepare(const Preparation<N>& with) {
  if (is_kept_) return true;
  KeptParts* kept = with.cache.is_wanted() ? nullptr : scene_.kept;
  const auto sample = [&] {
    const auto is_seen = with.cache.is_wanted()
                             ? std::vector<bool>{}
                             : showing_texels(seen_texels(scene_, atlas_->texels(), is_sheet_),
                                              texel_layers_->far_sides);
    auto cloud = sample_light(with.light, is_seen, scene_.settings.seed, with.progress);
    if (!cloud) throw Interrupted();
    return std::make_shared<const TexelLight>(TexelLight{texels_key_, *std::move(cloud)});
  };
  try {
    const auto entering = kept_or_made<TexelLight>(
        kept, KeptPart::entering_light, material_, texels_key_, sample,
        [&](const TexelLight& light) { return light.texels == texels_key_; });
    IrradianceCloud cloud = entering.part->cloud;
    scatter(cloud);
    use(cloud);
    if (kept)
      kept->keep<TexelLight>(KeptPart::leaving_light, material_, texels_key_,
                             std::make_shared<const TexelLight>(TexelLight{texels_key_, cloud}));
    with.cache.add(std::move(cloud));
  } catch (const Interrupted&) {
    return false;
  }
  return true;
}

template <int N>
SubsurfaceCost TextureSpaceTransport<N>::expected_cost(const Preparation<N>& with) const {
  const Scene& scene = *scene_.scene;
  const TextureSpaceSettings& settings = scene_.settings.texture_space;
  const auto spacing =
      static_cast<double>(spacing_for(nearest_pixel(scene, with.camera, material_)));
  const double area = surface_area(scene.meshes, material_), texels = area / (spacing * spacing);
  const auto sides = static_cast<double>(side_count());
  if (with.cache.is_there())
    return {.preparation = texels * seconds_per_texel, .lookup = seconds_per_texel_lookup};
  const double seen =
      with.cache.is_wanted() ? 1.0 : std::min(1.0, with.seen.area(material_) / area);
  const int full = settings.irradiance_samples;
  const double estimates = seen * full + (1.0 - seen) * std::max(1, full / 8);
  const auto bands = static_cast<double>(surface_.material.bands.size());
  const double per_side = estimates * with.seen.seconds_per_estimate +
                          seconds_per_bounce * bands * (1 + settings.interlayer_bounces);
  return {.preparation = texels * (seconds_per_texel + sides * per_side),
          .lookup = seconds_per_texel_lookup};
}

#define LAMINA_INSTANTIATE(N)                                                                      \
  template CloudMisfit TextureSpaceTransport<N>::misfit(const IrradianceCloud&, const CameraRays&) \
      const;                                                                                       \
  template void TextureSpaceTransport<N>::prepare_reflectance(const Preparation<N>&);              \
  template void TextureSpaceTransport<N>::take_or_make_layers(const Preparation<N>&);              \
  template bool TextureSpaceTransport<N>::prepare(const Preparation<N>&);                          \
  template SubsurfaceCost TextureSpaceTransport<N>::expected_cost(const Preparation<N>&) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
