// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lamina/render/film/render_options.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/irradiance_cloud.h"

namespace lamina {

/// Why a cloud cannot serve a picture; empty: it can.
struct CloudMisfit {
  std::string lacks;       ///< what must be there
  std::string too_coarse;  ///< for what the camera sees
};

/// The light that the cache file of the options keeps, a cloud of samples for each material. It is
/// read when it is first asked for.
class LightCache {
 public:
  /// Both must outlive it.
  LightCache(const RenderScene& scene, const RenderOptions& options)
      : scene_(scene), options_(options) {}

  /// Whether light is kept for other cameras.
  [[nodiscard]] bool is_wanted() const { return !options_.cache.empty(); }
  [[nodiscard]] bool is_there() const;

  /// The light of a material, valid until some is added; null if there is none of use, of which
  /// on_notice is told.
  ///
  /// @param misfit  says why a cloud cannot serve this picture
  /// @throws InvalidInput if the options need the cache and it is of no use or not there
  /// @throws as load_irradiance_clouds
  [[nodiscard]] const IrradianceCloud* find(
      std::uint32_t material, const std::function<CloudMisfit(const IrradianceCloud&)>& misfit);

  /// The ratios to planar light of a material, valid until some are added; null if there are none.
  ///
  /// @throws as find
  [[nodiscard]] const LightRatioCloud* find_ratios(std::uint32_t material);

  /// Adds light that was sampled anew, for save().
  void add(IrradianceCloud cloud);
  void add(LightRatioCloud ratios);

  /// Writes the file, if one is wanted and light was added. @throws WriteError
  void save() const;

 private:
  void load();
  template <class Cloud>
  void put(Cloud cloud, std::vector<Cloud>& clouds);
  void say_anew(const std::string& why) const;

  [[nodiscard]] LightFingerprint fingerprint() const {
    return light_fingerprint(*scene_.scene, scene_.settings, options_);
  }

  const RenderScene& scene_;
  const RenderOptions& options_;
  bool is_loaded_ = false, is_changed_ = false, is_usable_ = false;
  std::vector<IrradianceCloud> clouds_;
  std::vector<LightRatioCloud> ratios_;
};

}  // namespace lamina
