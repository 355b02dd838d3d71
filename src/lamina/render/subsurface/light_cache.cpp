// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/light_cache.h"

#include <algorithm>

#include "lamina/core/error.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"

namespace lamina {

std::optional<std::vector<IrradianceCloud>> find_kept_light(
    const Scene& scene, const RenderOptions& options,
    const std::function<std::string(const std::vector<IrradianceCloud>&)>& misfit) {
  if (options.cache.empty()) return std::nullopt;
  KeptClouds kept{.clouds = {}, .why_unusable = "there is no such file"};
  const bool is_there = std::filesystem::exists(options.cache);
  if (is_there)
    kept = load_irradiance_clouds(options.cache, light_fingerprint(scene, options), options.memory);
  if (kept.why_unusable.empty()) kept.why_unusable = misfit(kept.clouds);
  if (kept.why_unusable.empty()) return std::move(kept.clouds);
  const std::string why = options.cache.string() + ": " + kept.why_unusable;
  if (options.needs_cache) throw InvalidInput(why);
  if (is_there && options.on_notice) options.on_notice(why + "; it is made anew");
  return std::nullopt;
}

void keep_light(const Scene& scene, const RenderOptions& options,
                const std::vector<IrradianceCloud>& clouds) {
  if (!options.cache.empty())
    save_irradiance_clouds(clouds, light_fingerprint(scene, options), options.cache);
}

const IrradianceCloud* cloud_of(const std::vector<IrradianceCloud>& clouds,
                                std::uint32_t material) {
  const auto found = std::ranges::find(clouds, material, &IrradianceCloud::material);
  return found == clouds.end() ? nullptr : &*found;
}

}  // namespace lamina
