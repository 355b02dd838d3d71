// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lamina/render/paths/internal/direct_light.h"
#include "lamina/render/paths/internal/path_step.h"
#include "lamina/render/shading/dielectric_scattering.h"

namespace lamina {

template <int N>
bool scatter_at_dielectric(const PathWorld<N>& world, const SurfacePoint& point,
                           const DielectricSurface& glass, PathState<N>& path,
                           PixelSamples& samples) {
  const Vec3f to_eye = -path.ray.direction;
  const bool is_inside = dot(to_eye, point.geometric_normal) < 0.0f;
  const Vec3f n = make_visible(is_inside ? -point.normal : point.normal, to_eye);
  const Framef frame = make_frame(n);
  const Vec3f wo = frame.to_local(to_eye);
  const DielectricScattering boundary =
      dielectric_at(world.scene.textures, glass, point, is_inside);
  const auto index_towards = [&](const Vec3f& direction) {
    return dot(direction, point.geometric_normal) < 0.0f ? glass.ior : 1.0f;
  };
  // Radiance over n^2 is what paths carry: glass passes it unchanged.
  if (!is_specular(boundary.interface)) {
    const auto pdf = [&](const LightSample& light) {
      const Vec3f wi = frame.to_local(light.direction);
      const float side = dot(light.direction, point.geometric_normal) * (is_inside ? -1.0f : 1.0f);
      return wi.z * side > 0.0f ? pdf_dielectric(boundary, wo, wi) : 0.0f;
    };
    // Lights behind another glass are found by paths that are refracted there.
    const ResampledLight<N> drawn = resample_light(
        world, point, samples,
        [&](const LightSample& light) {
          const float density = pdf(light);
          return density * mis_weight_of_light_sample(world.options.direct_light, light, density);
        },
        Dielectrics::block);
    if (drawn.weight > 0.0f) {
      const LightSample& light = drawn.light;
      const float index = index_towards(light.direction);
      const float value =
          evaluate_dielectric(boundary, wo, frame.to_local(light.direction), samples) *
          mis_weight_of_light_sample(world.options.direct_light, light, pdf(light)) /
          (index * index);
      path.radiance += value * drawn.weight * path.throughput * drawn.transmittance *
                       world.conversion.from_rgb(light.radiance);
    }
  }
  const DielectricSample sample = sample_dielectric(boundary, wo, samples);
  if (!(sample.weight > 0.0f)) return false;
  path.throughput *= sample.weight;
  path.ray.direction = normalize(frame.to_world(sample.wi));
  path.ray.origin = leave_surface(point, path.ray.direction);
  path.pdf = sample.pdf;
  path.index = index_towards(path.ray.direction);
  if (sample.pdf > 0.0f)
    path.spread = std::max(
        path.spread, 0.3f * std::min(static_cast<float>(boundary.interface.facets.alpha), 1.0f));
  path.t_near = 0.0f;
  path.is_camera_ray = false;
  return true;
}

#define LAMINA_INSTANTIATE(N)                                                   \
  template bool scatter_at_dielectric(const PathWorld<N>&, const SurfacePoint&, \
                                      const DielectricSurface&, PathState<N>&, PixelSamples&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
