// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/colored_transport.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "lamina/base/core/float_pi.h"
#include "lamina/render/subsurface/nearby_point.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"

namespace lamina {
namespace {

using ColorUse = SubsurfaceSurface::ColorUse;

const SubsurfaceSurface& surface_of(const RenderScene& scene, std::uint32_t material) {
  return std::get<SubsurfaceSurface>(scene.scene->materials[material].surface);
}

bool scatters(const LayerStack& stack) {
  return std::ranges::all_of(stack.layers(),
                             [](const Layer& layer) { return layer.medium.sigma_s > 0.0; });
}

}  // namespace

Vec3f mean_of_map(const TextureStore& textures, const ColorParameter& color) {
  Vec3f mean{1, 1, 1};
  if (!color.map) return mean;
  Vec3f of_source;
  if (const auto* image = std::get_if<ImageMap>(&color.map->source))
    of_source = textures.mean_color(*image);
  else if (const auto* colors = std::get_if<VertexColorMap>(&color.map->source))
    of_source = colors->mean;
  else
    return mean;
  for (int c = 0; c < 3 && color.map->vertex_colors; ++c)
    of_source[c] *= color.map->vertex_colors->mean[c];  // as if they varied apart from the image
  for (int c = 0; c < 3; ++c)
    mean[c] = std::max(color.map->offset + color.map->scale * of_source[c], 1e-4f);
  return mean;
}

template <int N>
Material colored_medium(const RenderScene& scene, const BandConversion<N>& conversion,
                        std::uint32_t material) {
  const SubsurfaceSurface& surface = surface_of(scene, material);
  Material medium = surface.material;
  medium.layers.back().thickness = std::numeric_limits<double>::infinity();
  medium.ior_below = medium.layers.back().ior;
  medium.ground = {};
  if (surface.color_use != ColorUse::invert) return medium;
  const Vec3f mean = mean_of_map(scene.textures, surface.color);
  const BandValues<N> wanted =
      conversion.from_rgb({mean.x * surface.color.value.x, mean.y * surface.color.value.y,
                           mean.z * surface.color.value.z});
  std::vector<double> reflectance;
  for (std::size_t b = 0; b < medium.bands.size(); ++b)
    reflectance.push_back(std::clamp(static_cast<double>(wanted[static_cast<int>(b)]), 0.0, 1.0));
  return with_reflectance(medium, reflectance);
}

template <int N>
ColoredTransport<N>::ColoredTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material,
                                      std::unique_ptr<SubsurfaceMethod<N>> inside)
    : scene_(scene),
      conversion_(conversion),
      surface_(surface_of(scene, material)),
      material_(material),
      inside_(std::move(inside)),
      mean_color_(mean_of_map(scene.textures, surface_.color)) {
  const std::vector<LayerStack> layers =
      layer_stacks(colored_medium<N>(scene, conversion, material));
  const std::vector<EnteredTotals> totals = material_totals(layers);
  for (std::size_t b = 0; b < totals.size(); ++b)
    reflected_[static_cast<int>(b)] = static_cast<float>(std::max(totals[b].reflectance, 1e-6));
  if (surface_.color_use != ColorUse::scale || !std::ranges::all_of(layers, scatters)) return;
  const Profile profile = make_diffusion_profile(layers).profile;
  profile_.emplace(profile, make_radius_grid({profile}), Bands::filled(1.0f));
}

template <int N>
SurfacePoint ColoredTransport<N>::colored_at(const SurfacePoint& point,
                                             PixelSamples& samples) const {
  if (!profile_) return point;
  const Vec2f u = samples.next_2d();
  const float r = profile_->sample_radius(u.x), phi = 2.0f * float_pi * u.y;
  return nearby_point(scene_, material_, point, {r * std::cos(phi), r * std::sin(phi)},
                      profile_->support_radius());
}

template <int N>
BandValues<N> ColoredTransport<N>::scale(const SurfacePoint& point) const {
  Vec3f color = scene_.textures.color(surface_.color, point);
  if (surface_.color_use == ColorUse::scale)
    for (int c = 0; c < 3; ++c) color[c] /= mean_color_[c];
  const Bands by = max(conversion_.from_rgb(color), Bands{});
  const Bands most = Bands::filled(1.0f) / reflected_;
  return surface_.color_use == ColorUse::invert ? by * most : min(by, most);
}

template <int N>
BandValues<N> ColoredTransport<N>::local_reflectance(const SurfacePoint& point) const {
  Bands result = scale(point) * inside_->local_reflectance(point);
  for (int b = 0; b < N; ++b) result[b] = std::clamp(result[b], 0.0f, 1.0f);
  return result;
}

#define LAMINA_INSTANTIATE(N)                                                       \
  template Material colored_medium<N>(const RenderScene&, const BandConversion<N>&, \
                                      std::uint32_t);                               \
  template class ColoredTransport<N>
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
