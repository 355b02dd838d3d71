// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/planning/method_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"
#include "lamina/scene/method_settings.h"
#include "lamina/scene/subsurface_methods.h"

namespace lamina {
namespace {

using Method = SceneMethod;

/// Work of `hierarchy` per sample of the light beside its paths, in paths: cutting the surface, and
/// where a sample is seen the sum over all others.
constexpr double work_of_cell = 1.0, work_of_sum = 8.0;
/// Work of `probe` per sample of a pixel, in paths: the one, and the probes for where it enters.
constexpr double work_of_probe = 0.4;
/// Light without noise is worth so many times the work.
constexpr double worth_of_no_noise = 2.5;

std::vector<std::uint32_t> translucent_materials(const Scene& scene) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m)
    if (std::holds_alternative<SubsurfaceSurface>(scene.materials[m].surface)) found.push_back(m);
  return found;
}

/// What the scene asks for by what only one method reads.
std::optional<MethodChoice> choice_by_needs(const Scene& scene, const RenderOptions& options) {
  const RenderSettings& settings = scene.render;
  for (const std::uint32_t m : translucent_materials(scene)) {
    const auto& surface = std::get<SubsurfaceSurface>(scene.materials[m].surface);
    const std::string of = "\"" + scene.materials[m].name + "\"";
    if (!surface.maps.empty())
      return MethodChoice{Method::layered_bsdf, of + " has maps of layers"};
    if (!surface.material_maps.empty())
      return MethodChoice{Method::texture_space, of + " has maps of what it is made of"};
  }
  const std::string of_settings = "the scene has settings of it";
  if (settings.orders != LayeredOrders::all || settings.factors.any())
    return MethodChoice{Method::layered_bsdf, of_settings};
  for (const Method method : subsurface_methods())
    if (has_numbers_of(settings, method) && (options.cache.empty() || method->keeps_light) &&
        !refusal(scene, method))
      return MethodChoice{method, of_settings};
  if (!options.cache.empty()) return MethodChoice{Method::hierarchy, "its light can be kept"};
  return std::nullopt;
}

bool has_diffusion_profile(const Material& material, const RenderSettings& settings) {
  try {
    (void)ProfileMaker(settings)(material, layer_stacks(material));
  } catch (const InvalidInput&) {
    return false;
  }
  return true;
}

using Profile = RenderSettings::Profile;

bool has_profile(const Material& material, const RenderSettings& settings) {
  const Profile source = ProfileMaker(settings).source(material);
  return source == Profile::radiative_transfer ? !transfer_refusal(material)
                                               : has_diffusion_profile(material, settings);
}

/// Profiles to plan with: at once by diffusion, where it takes the material.
ProfileMaker quick_profiles(const Material& material, const RenderSettings& settings,
                            const Progress& progress) {
  RenderSettings quick = settings;
  if (profile_of(settings) == Profile::radiative_transfer) quick.profile = Profile::diffusion;
  return ProfileMaker(has_diffusion_profile(material, quick) ? quick : settings, progress);
}

}  // namespace

template <int N>
MethodChoice choose_method(const RenderScene& scene, const BandConversion<N>& conversion,
                           const CameraRays& camera, const SeenSurface& seen,
                           const RenderOptions& options, const Progress& progress) {
  const Scene& s = *scene.scene;
  if (auto choice = choice_by_needs(s, options)) return *choice;
  const auto materials = translucent_materials(s);
  if (seen.count() == 0) return {Method::probe, "nothing translucent is seen"};
  for (const std::uint32_t m : materials) {
    const Material& material = std::get<SubsurfaceSurface>(s.materials[m].surface).material;
    if (!has_profile(material, s.render))
      return {Method::layered_bsdf, "\"" + s.materials[m].name + "\" has no profile"};
  }
  double of_hierarchy = 0.0;
  for (const std::uint32_t m : materials) {
    const Material& material = std::get<SubsurfaceSurface>(s.materials[m].surface).material;
    const HierarchyTransport<N> hierarchy(scene, conversion, m,
                                          quick_profiles(material, s.render, progress), false);
    // What shows outside as well, as eyes do, hardly changes the light.
    if (std::ranges::any_of(hierarchy.objects_inside(),
                            [](const auto& object) { return object.fraction > 0.9; }))
      return {Method::hierarchy, "something opaque is inside \"" + s.materials[m].name + "\""};
    const LightSampling sampling = hierarchy.plan_sampling(camera, seen, !options.cache.empty());
    of_hierarchy +=
        sampling.cells * (sampling.estimates + work_of_cell) + sampling.close_cells * work_of_sum;
  }
  // Without noise below surfaces few samples of a pixel do.
  const double pixels = static_cast<double>(s.film.width) * static_cast<double>(s.film.height);
  const double fraction = static_cast<double>(seen.count()) / static_cast<double>(seen.rays);
  const double of_probe = fraction * pixels * s.render.samples_per_pixel * (1.0 + work_of_probe);
  const double ratio = of_hierarchy / of_probe;
  if (ratio <= worth_of_no_noise)
    return {Method::hierarchy,
            printf_text("no noise below surfaces for %.1f times the work of probe", ratio)};
  return {Method::probe, printf_text("hierarchy would take %.1f times its work", ratio)};
}

#define LAMINA_INSTANTIATE(N)                                                          \
  template MethodChoice choose_method<N>(const RenderScene&, const BandConversion<N>&, \
                                         const CameraRays&, const SeenSurface&,        \
                                         const RenderOptions&, const Progress&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
