// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/hierarchy_preparation.h"

#include <algorithm>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/render/irradiance_cloud_file.h"
#include "lamina/render/nearest_pixel.h"
#include "lamina/render/scene_fingerprint.h"

namespace lamina {
template <int N>
bool prepare_hierarchies(const std::vector<HierarchyTransport<N>*>& hierarchies,
                         const RenderScene& scene, const CameraRays& camera,
                         const LightGatherer<N>& light, const std::filesystem::path& cache,
                         const Progress& progress) {
  if (hierarchies.empty()) return true;
  const SceneFingerprint made_for = cache.empty() ? SceneFingerprint{} : fingerprint(*scene.scene);
  if (!cache.empty() && std::filesystem::exists(cache)) {
    const std::vector<IrradianceCloud> clouds = load_irradiance_clouds(cache, made_for);
    for (HierarchyTransport<N>* hierarchy : hierarchies) {
      const auto found =
          std::ranges::find(clouds, hierarchy->material(), &IrradianceCloud::material);
      if (found == clouds.end() || found->bands > N || found->irradiance.empty())
        throw FileError(cache.string() + ": lacks a material of the scene");
      hierarchy->use(*found);
    }
    return true;
  }
  std::vector<IrradianceCloud> clouds;
  for (HierarchyTransport<N>* hierarchy : hierarchies) {
    // What is kept serves cameras that come closer, too.
    const float pixel =
        (cache.empty() ? 1.0f : 0.5f) * nearest_pixel(*scene.scene, camera, hierarchy->material());
    auto cloud = hierarchy->sample_light(light, pixel, scene.scene->render.seed, progress);
    if (!cloud) return false;
    hierarchy->use(*cloud);
    clouds.push_back(*std::move(cloud));
  }
  if (!cache.empty()) save_irradiance_clouds(clouds, made_for, cache);
  return true;
}

template bool prepare_hierarchies<4>(const std::vector<HierarchyTransport<4>*>&, const RenderScene&,
                                     const CameraRays&, const LightGatherer<4>&,
                                     const std::filesystem::path&, const Progress&);
template bool prepare_hierarchies<8>(const std::vector<HierarchyTransport<8>*>&, const RenderScene&,
                                     const CameraRays&, const LightGatherer<8>&,
                                     const std::filesystem::path&, const Progress&);
template bool prepare_hierarchies<16>(const std::vector<HierarchyTransport<16>*>&,
                                      const RenderScene&, const CameraRays&,
                                      const LightGatherer<16>&, const std::filesystem::path&,
                                      const Progress&);

}  // namespace lamina
