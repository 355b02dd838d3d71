// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/texture_space_preparation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/core/number_text.h"
#include "lamina/core/parallel.h"
#include "lamina/render/geometry/nearest_pixel.h"
#include "lamina/render/subsurface/light_cache.h"

namespace lamina {
namespace {

/// Texels that face the camera's place with nothing but clear surfaces or other materials of the
/// kind between: what may show, directly.
std::vector<bool> seen_texels(const RenderScene& scene, std::span<const AtlasTexel> texels) {
  const Vec3& at = scene.scene->camera.position;
  const Vec3f eye{static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
  std::vector<char> is_seen(texels.size(), 0);
  constexpr std::size_t chunk = 1024;
  parallel_for((texels.size() + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(texels.size(), (c + 1) * chunk); ++i) {
      const AtlasTexel& texel = texels[i];
      const Vec3f offset = eye - texel.position;
      const float distance = length(offset), width = std::sqrt(texel.area);
      if (!(distance > width) || dot(offset, texel.normal) < -0.1f * distance) continue;
      const Ray ray{texel.position + width * texel.normal, offset / distance};
      is_seen[i] = scene.geometry.is_blocked(ray, 0.0f, distance) ? 0 : 1;
    }
  });
  return {is_seen.begin(), is_seen.end()};
}

}  // namespace

template <int N>
bool prepare_texture_spaces(const std::vector<TextureSpaceTransport<N>*>& transports,
                            const RenderScene& scene, const CameraRays& camera,
                            const LightGatherer<N>& light, const RenderOptions& options,
                            const Progress& progress) {
  if (transports.empty()) return true;
  const bool is_kept = !options.cache.empty();
  const auto pixel_of = [&](const TextureSpaceTransport<N>& transport) {
    return nearest_pixel(*scene.scene, camera, transport.material());
  };
  const auto misfit = [&](const std::vector<IrradianceCloud>& clouds) -> std::string {
    for (const TextureSpaceTransport<N>* transport : transports) {
      const IrradianceCloud* cloud = cloud_of(clouds, transport->material());
      if (!cloud || cloud->bands > N || cloud->exitance.empty())
        return "lacks a material of the scene";
      const float wanted = transport->spacing_for(pixel_of(*transport));
      if (cloud->spacing > 2.001f * wanted)
        return "its texels are " + number_text(cloud->spacing) +
               " mm wide, but this camera sees light as fine as " + number_text(wanted) + " mm";
    }
    return {};
  };
  if (const auto kept = find_kept_light(*scene.scene, options, misfit)) {
    for (TextureSpaceTransport<N>* transport : transports) {
      const IrradianceCloud& found = *cloud_of(*kept, transport->material());
      transport->make_texels(found.spacing);
      transport->use(found);
    }
    return true;
  }
  const std::optional<DiskCache> tables = user_cache();
  for (TextureSpaceTransport<N>* transport : transports) {
    transport->make_texels(transport->spacing_for(pixel_of(*transport)));
    transport->make_layers(tables);
  }
  std::vector<IrradianceCloud> clouds;
  for (TextureSpaceTransport<N>* transport : transports) {
    const auto is_seen = is_kept ? std::vector<bool>{} : seen_texels(scene, transport->texels());
    auto cloud = transport->sample_light(light, is_seen, scene.scene->render.seed, progress);
    if (!cloud) return false;
    clouds.push_back(*std::move(cloud));
  }
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    transports[i]->spread(clouds[i]);
    transports[i]->use(clouds[i]);
  }
  keep_light(*scene.scene, options, clouds);
  return true;
}

template bool prepare_texture_spaces<4>(const std::vector<TextureSpaceTransport<4>*>&,
                                        const RenderScene&, const CameraRays&,
                                        const LightGatherer<4>&, const RenderOptions&,
                                        const Progress&);
template bool prepare_texture_spaces<8>(const std::vector<TextureSpaceTransport<8>*>&,
                                        const RenderScene&, const CameraRays&,
                                        const LightGatherer<8>&, const RenderOptions&,
                                        const Progress&);
template bool prepare_texture_spaces<16>(const std::vector<TextureSpaceTransport<16>*>&,
                                         const RenderScene&, const CameraRays&,
                                         const LightGatherer<16>&, const RenderOptions&,
                                         const Progress&);

}  // namespace lamina
