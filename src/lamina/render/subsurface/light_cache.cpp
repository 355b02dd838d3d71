// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/light_cache.h"

#include <algorithm>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"

namespace lamina {

bool LightCache::is_there() const { return is_wanted() && std::filesystem::exists(options_.cache); }

/// @throws InvalidInput if the options need what the file does not have
void LightCache::say_anew(const std::string& why) const {
  const std::string line = options_.cache.string() + ": " + why;
  if (options_.needs_cache || options_.takes_foreign_light) throw InvalidInput(line);
  if (is_there() && options_.on_notice) options_.on_notice(line + "; it is made anew");
}

void LightCache::load() {
  is_loaded_ = true;
  KeptClouds kept{.clouds = {}, .ratios = {}, .why_unusable = "there is no such file"};
  if (is_there())
    kept =
        load_irradiance_clouds(options_.cache, fingerprint(), options_.memory,
                               options_.takes_foreign_light ? CloudOrigin::any : CloudOrigin::own);
  is_usable_ = kept.why_unusable.empty();
  if (is_usable_) {
    clouds_ = std::move(kept.clouds);
    ratios_ = std::move(kept.ratios);
  } else {
    say_anew(kept.why_unusable);
  }
}

const IrradianceCloud* LightCache::find(
    std::uint32_t material, const std::function<CloudMisfit(const IrradianceCloud&)>& misfit) {
  if (!is_wanted()) return nullptr;
  if (!is_loaded_) load();
  if (!is_usable_) return nullptr;
  const auto found = std::ranges::find(clouds_, material, &IrradianceCloud::material);
  const CloudMisfit why =
      found == clouds_.end()
          ? CloudMisfit{.lacks = "lacks a material of the scene", .too_coarse = {}}
          : misfit(*found);
  const bool is_coarse = !why.too_coarse.empty();
  if (why.lacks.empty() && is_coarse && options_.takes_foreign_light && options_.on_notice)
    options_.on_notice("warning: " + options_.cache.string() + ": " + why.too_coarse);
  if (why.lacks.empty() && (!is_coarse || options_.takes_foreign_light)) return &*found;
  say_anew(why.lacks.empty() ? why.too_coarse : why.lacks);
  return nullptr;
}

const LightRatioCloud* LightCache::find_ratios(std::uint32_t material) {
  if (!is_wanted()) return nullptr;
  if (!is_loaded_) load();
  if (!is_usable_) return nullptr;
  const auto found = std::ranges::find(ratios_, material, &LightRatioCloud::material);
  if (found != ratios_.end()) return &*found;
  say_anew("lacks the correction of a material");
  return nullptr;
}

template <class Cloud>
void LightCache::put(Cloud cloud, std::vector<Cloud>& clouds) {
  if (!is_wanted()) return;
  is_changed_ = true;
  const auto old = std::ranges::find(clouds, cloud.material, &Cloud::material);
  if (old != clouds.end())
    *old = std::move(cloud);
  else
    clouds.push_back(std::move(cloud));
}

void LightCache::add(IrradianceCloud cloud) { put(std::move(cloud), clouds_); }
void LightCache::add(LightRatioCloud ratios) { put(std::move(ratios), ratios_); }

void LightCache::save() const {
  if (is_changed_ && !options_.takes_foreign_light)
    save_irradiance_clouds(clouds_, ratios_, fingerprint(), options_.cache);
}

}  // namespace lamina
