// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/methods/make_methods.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/render/subsurface/correction/corrected_transport.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"
#include "lamina/render/subsurface/probe/probe_transport.h"
#include "lamina/render/subsurface/profiles/colored_transport.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/render/subsurface/shadow_map/shadow_map_transport.h"
#include "lamina/render/subsurface/single_scattering/single_scattering.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"

namespace lamina {
namespace {

/// Of methods that take a profile.
template <template <int> class Transport>
constexpr auto make_by_profile = []<int N>(const MethodContext<N>& c) {
  return make_for_each_material(c, [&](std::uint32_t material) {
    return std::make_unique<Transport<N>>(c.scene, c.conversion, material, c.make_profile,
                                          c.is_printed_exit);
  });
};

template <int N>
SubsurfaceMethods<N> make_random_walks(const MethodContext<N>& c, bool are_quiet = false) {
  std::shared_ptr<WalkMedia<N>> media;  // of all walks
  return make_for_each_material(c, [&](std::uint32_t material) {
    if (!media) media = make_walk_media<N>(c.scene, c.conversion, are_quiet);
    std::unique_ptr<SubsurfaceMethod<N>> walk = std::make_unique<RandomWalk<N>>(media, material);
    const auto& surface = std::get<SubsurfaceSurface>(c.scene.scene->materials[material].surface);
    if (surface.color_use == SubsurfaceSurface::ColorUse::none) return walk;
    return std::unique_ptr<SubsurfaceMethod<N>>(
        std::make_unique<ColoredTransport<N>>(c.scene, c.conversion, material, std::move(walk)));
  });
}

/// @throws InvalidInput if light scattered once would count twice.
void require_light_once(const RenderSettings& settings) {
  if (settings.is_corrected && settings.single_scattering != RenderSettings::SingleScattering::none)
    throw InvalidInput(
        "render: corrected light holds what is scattered once, so single_scattering must be "
        "\"none\", but is \"" +
        std::string(name_of(settings.single_scattering)) + "\"");
  if (settings.method->uses_profile &&
      profile_of(settings) == RenderSettings::Profile::radiative_transfer &&
      settings.single_scattering != RenderSettings::SingleScattering::none)
    throw InvalidInput(
        "render: profile \"radiative_transfer\" holds the light scattered once, so "
        "single_scattering must be \"none\", but is \"" +
        std::string(name_of(settings.single_scattering)) + "\"");
}

/// Puts methods with corrected light in the place of planar ones.
/// @throws InvalidInput for what random walks do not take
template <int N>
void correct(SubsurfaceMethods<N>& planar, const MethodContext<N>& c) try {
  SubsurfaceMethods<N> walks = make_random_walks(c, true);  // CorrectedTransport wants no others
  for (std::uint32_t m = 0; m < planar.size(); ++m)
    if (planar[m])
      planar[m] = std::make_unique<CorrectedTransport<N>>(c.scene, m, std::move(planar[m]),
                                                          std::move(walks[m]));
} catch (const InvalidInput& error) {
  throw InvalidInput("render.correct: random walks cannot follow this light: " +
                     std::string(error.what()));
}

/// Progress of unknown length that says once why it takes time.
Progress announced(const Progress& progress,
                   const std::function<void(const std::string&)>& on_notice) {
  const auto is_said = std::make_shared<std::atomic<bool>>(false);
  return [is_said, on_notice, reported = of_unknown_length(progress)](double finished) {
    if (!is_said->exchange(true) && on_notice)
      on_notice(
          "solving profiles by radiative transfer, once: they are kept on disk; for a quick "
          "preview "
          "--profile diffusion");
    return report_progress(reported, finished);
  };
}

const SubsurfaceMethodMaker* find_maker(SceneMethod method, const RenderOptions& options) {
  for (const SubsurfaceMethodMaker& maker : subsurface_method_makers())
    if (maker.method == method) return &maker;
  for (const SubsurfaceMethodMaker* maker : options.more_methods)
    if (maker->method == method) return maker;
  throw InvalidInput("render: nobody knows how to make the method \"" + std::string(method.name()) +
                     "\"");
}

}  // namespace

std::span<const SubsurfaceMethodMaker> subsurface_method_makers() {
  static const std::vector<SubsurfaceMethodMaker> makers = {
      {SceneMethod::probe, make_by_profile<ProbeTransport>},
      {SceneMethod::layered_bsdf,
       []<int N>(const MethodContext<N>& c) {
         return SubsurfaceMethods<N>(c.scene.scene->materials.size());
       }},
      {SceneMethod::hierarchy, make_by_profile<HierarchyTransport>},
      {SceneMethod::shadow_map, make_by_profile<ShadowMapTransport>},
      {SceneMethod::texture_space,
       []<int N>(const MethodContext<N>& c) {
         return make_for_each_material(c, [&](std::uint32_t material) {
           return std::make_unique<TextureSpaceTransport<N>>(c.scene, material, c.is_printed_exit);
         });
       }},
      {SceneMethod::random_walk,
       []<int N>(const MethodContext<N>& c) { return make_random_walks(c); }}};
  return makers;
}

template <int N>
SubsurfaceMethods<N> make_subsurface_methods(const RenderScene& scene,
                                             const BandConversion<N>& conversion,
                                             const RenderOptions& options,
                                             const Progress& progress) {
  const RenderSettings& settings = scene.settings;
  require_light_once(settings);
  const ProfileMaker make_profile(settings, announced(progress, options.on_notice));
  const bool is_printed = settings.exit_angle == RenderSettings::ExitAngle::printed;
  const SubsurfaceMethodMaker& maker = *find_maker(settings.method, options);
  using Make = SubsurfaceMethodMaker::Make<N>;
  SubsurfaceMethods<N> methods =
      std::get<Make>(maker.make)({scene, conversion, make_profile, is_printed});
  if (settings.is_corrected) correct(methods, {scene, conversion, make_profile, is_printed});
  using Single = RenderSettings::SingleScattering;
  if (settings.single_scattering != Single::none)
    for (std::uint32_t m = 0; m < methods.size(); ++m)
      if (methods[m])
        methods[m] = std::make_unique<SingleScattering<N>>(
            scene, conversion, m, settings.single_scattering == Single::refracted, make_profile,
            std::move(methods[m]));
  return methods;
}

#define LAMINA_INSTANTIATE(N)                               \
  template SubsurfaceMethods<N> make_subsurface_methods<N>( \
      const RenderScene&, const BandConversion<N>&, const RenderOptions&, const Progress&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
