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
#include "lamina/render/subsurface/papers/shadow_map/shadow_map_transport.h"
#include "lamina/render/subsurface/papers/single_scattering/single_scattering.h"
#include "lamina/render/subsurface/probe/probe_transport.h"
#include "lamina/render/subsurface/profiles/colored_transport.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"
#include "lamina/scene/description/materials_in_use.h"

namespace lamina {
namespace {

/// The parts that the methods of a picture are made of; all must outlive them.
template <int N>
struct MethodContext {
  const RenderScene& scene;
  const BandConversion<N>& conversion;
  const ProfileMaker& make_profile;
  bool is_printed_exit;  ///< RenderSettings::ExitAngle
};

/// Makes a method for the translucent materials of a scene that are in use, `make(material)` each.
template <int N, class Make>
SubsurfaceMethods<N> make_for_each_material(const MethodContext<N>& context, const Make& make) {
  const Scene& scene = *context.scene.scene;
  SubsurfaceMethods<N> methods(scene.materials.size());
  for (const std::uint32_t m : translucent_materials_in_use(scene)) methods[m] = make(m);
  return methods;
}

template <template <int> class Transport, int N>
SubsurfaceMethods<N> make_by_profile(const MethodContext<N>& c) {
  return make_for_each_material(c, [&](std::uint32_t material) {
    return std::make_unique<Transport<N>>(c.scene, c.conversion, material, c.make_profile,
                                          c.is_printed_exit);
  });
}

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

template <int N>
SubsurfaceMethods<N> make_of_table(SceneMethod method, const MethodContext<N>& c) {
  if (method == SceneMethod::probe) return make_by_profile<ProbeTransport>(c);
  if (method == SceneMethod::hierarchy) return make_by_profile<HierarchyTransport>(c);
  if (method == SceneMethod::shadow_map) return make_by_profile<ShadowMapTransport>(c);
  if (method == SceneMethod::texture_space)
    return make_for_each_material(c, [&](std::uint32_t material) {
      return std::make_unique<TextureSpaceTransport<N>>(c.scene, material, c.is_printed_exit);
    });
  if (method == SceneMethod::random_walk) return make_random_walks(c);
  if (method->is_bsdf) return SubsurfaceMethods<N>(c.scene.scene->materials.size());
  throw InvalidInput("render: unknown method \"" + std::string(method.name()) + "\"");
}

}  // namespace

template <int N>
SubsurfaceMethods<N> make_subsurface_methods(const RenderScene& scene,
                                             const BandConversion<N>& conversion,
                                             const RenderOptions& options,
                                             const Progress& progress) {
  const RenderSettings& settings = scene.settings;
  require_light_once(settings);
  const ProfileMaker make_profile(settings, announced(progress, options.on_notice));
  const bool is_printed = settings.exit_angle == RenderSettings::ExitAngle::printed;
  const MethodContext<N> context{scene, conversion, make_profile, is_printed};
  SubsurfaceMethods<N> methods = make_of_table(settings.method, context);
  if (settings.is_corrected) correct(methods, context);
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
