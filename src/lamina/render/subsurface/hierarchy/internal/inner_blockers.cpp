// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/hierarchy/internal/inner_blockers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/core/dense_matrix.h"
#include "lamina/core/float_pi.h"
#include "lamina/core/parallel.h"
#include "lamina/optics/fresnel.h"

namespace lamina {
namespace {

/// Share of the fluence at a surface that it absorbs per area: of light that is diffuse, the flux
/// towards the surface is a quarter of the fluence and half of the net flux.
float absorbed_fraction(float reflectance) {
  const float r = std::clamp(reflectance, 0.0f, 1.0f);
  return 0.5f * (1.0f - r) / (1.0f + r);
}

}  // namespace

template <int N>
DiffusionMedium<N> make_diffusion_medium(const Material& material) {
  DiffusionMedium<N> medium{.sigma_tr = {},
                            .diffusion = BandValues<N>::filled(1.0f),
                            .mfp = BandValues<N>::filled(1.0f),
                            .height_of_image = {}};
  for (std::size_t band = 0; band < material.bands.size(); ++band) {
    const LayerStack stack = layer_stack(material, band);
    const Medium& inside = stack.layers().back().medium;
    const double outside = stack.ior_above(), f_dr = fresnel_diffuse(outside / inside.ior);
    // A medium that does nothing to light is as good as one of a metre's mean free path.
    const double mfp = std::min(mfp_prime(inside), 1000.0);
    const int b = static_cast<int>(band);
    medium.sigma_tr[b] = static_cast<float>(sigma_tr(inside));
    medium.mfp[b] = static_cast<float>(mfp);
    medium.diffusion[b] = static_cast<float>(mfp / 3.0);
    medium.height_of_image[b] = static_cast<float>(4.0 / 3.0 * mfp * (1.0 + f_dr) / (1.0 - f_dr));
  }
  return medium;
}

template <int N>
InnerBlockers<N>::InnerBlockers(std::span<const Patch> patches, const DiffusionMedium<N>& medium,
                                const IrradianceTree<N>& light, float error)
    : medium_(medium), error_(error) {
  float least = largest(medium.sigma_tr);
  for (int b = 0; b < N; ++b)
    if (medium.sigma_tr[b] > 0.0f) least = std::min(least, medium.sigma_tr[b]);
  support_radius_ = least > 0.0f ? 20.0f / least : 1e6f;
  if (patches.empty()) return;
  const std::vector<Bands> fluences = solve(patches, light);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& patch = patches[i];
    const float radius = std::sqrt(patch.area / float_pi), apart = 0.25f * radius;
    Source source{.inner = patch.position - apart * patch.normal,
                  .outer = patch.position + apart * patch.normal,
                  .power_inner = {},
                  .power_outer = {},
                  .least2 = 0.25f * radius * radius};
    for (int b = 0; b < N; ++b) {
      const float power = fluences[i][b] * patch.area;
      const float dipole = power * medium.diffusion[b] / (2.0f * apart);
      const float absorbed = power * absorbed_fraction(patch.reflectance[b]);
      source.power_inner[b] = -dipole - 0.5f * absorbed;
      source.power_outer[b] = dipole - 0.5f * absorbed;
    }
    const Vec3f& p = patch.position;
    if (sources_.empty()) box_low_ = box_high_ = p;
    for (int k = 0; k < 3; ++k) {
      box_low_[k] = std::min(box_low_[k], p[k]);
      box_high_[k] = std::max(box_high_[k], p[k]);
    }
    sources_.push_back(source);
  }
}

/// Of all light that enters, by dipoles of sources below the surface and images above it.
template <int N>
BandValues<N> InnerBlockers<N>::fluence(const Vec3f& position,
                                        const IrradianceTree<N>& light) const {
  const Bands above = medium_.mfp + medium_.height_of_image;
  Bands total;
  light.gather(position, support_radius_, error_, medium_.mfp[0],
               [&](const auto& node, const Bands&, const Vec3f& offset, float d2) {
                 const float along = dot(offset, node.normal);
                 const auto green = [&](const Bands& height) {
                   // Squared distance to a point at a height above the node.
                   const Bands r2 =
                       Bands::filled(d2) + height * (2.0f * along * Bands::filled(1.0f) + height);
                   const Bands least = 0.25f * medium_.mfp * medium_.mfp;
                   const Bands inverse = reciprocal_root(max(r2, least));
                   return inverse * exp_minus(medium_.sigma_tr * max(r2, least) * inverse);
                 };
                 total += node.power * (green(-1.0f * medium_.mfp) - green(above));
               });
  return max(total, Bands{}) / (4.0f * float_pi * medium_.diffusion);
}

/// Flux per area that leaves at a flat surface, of a source below it and its image above:
/// [Jensen2001] Eq. 4 without the albedo, for a source at any depth.
template <int N>
BandValues<N> InnerBlockers<N>::leaving(const Vec3f& to_source, const Vec3f& normal,
                                        const Bands& depth, float least2) const {
  const float along = dot(to_source, normal);
  const float lateral2 = std::max(dot(to_source, to_source) - along * along, 0.0f);
  const auto flux_from = [&](const Bands& z) {
    const Bands d2 = max(Bands::filled(lateral2) + z * z, Bands::filled(std::max(least2, 1e-12f)));
    const Bands inverse = reciprocal_root(d2), x = medium_.sigma_tr * d2 * inverse;
    return z * (Bands::filled(1.0f) + x) * exp_minus(x) * inverse * inverse * inverse;
  };
  return (1.0f / (4.0f * float_pi)) *
         (flux_from(depth) + flux_from(depth + medium_.height_of_image));
}

/// The fluence at each patch, from half of it = what comes without the objects + what all patches
/// send there: D dG/dn, less what they absorb times G.
template <int N>
std::vector<BandValues<N>> InnerBlockers<N>::solve(std::span<const Patch> patches,
                                                   const IrradianceTree<N>& light) const {
  std::vector<Bands> fluences(patches.size());
  parallel_for(patches.size(),
               [&](std::size_t i) { fluences[i] = fluence(patches[i].position, light); });
  const std::size_t count = patches.size();
  parallel_for(static_cast<std::size_t>(N), [&](std::size_t lane) {
    const int b = static_cast<int>(lane);
    std::vector<float> arriving(count);
    for (std::size_t i = 0; i < count; ++i) arriving[i] = fluences[i][b];
    if (std::ranges::none_of(arriving, [](float value) { return value > 0.0f; })) return;
    const float kappa = medium_.sigma_tr[b], D = medium_.diffusion[b];
    BasicDenseMatrix<float> matrix(count, count);
    for (std::size_t j = 0; j < count; ++j) {
      const Patch& from = patches[j];
      const float beta = absorbed_fraction(from.reflectance[b]);
      const float radius = std::sqrt(from.area / float_pi);
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f d = patches[i].position - from.position;
        const float r = length(d);
        if (!(r > 0.1f * radius)) {
          // Within a disc: the integral of G is (1 - exp(-kappa radius)) / (2 D kappa).
          const float own = kappa * radius > 1e-4f ? -std::expm1(-kappa * radius) / kappa : radius;
          matrix(i, j) = (i == j ? 0.5f : 0.0f) + beta * own / (2.0f * D);
          continue;
        }
        const float green = from.area * std::exp(-kappa * r) / (4.0f * float_pi * r);
        const float dipole = green * (1.0f + kappa * r) / (r * r) * dot(d, from.normal);
        matrix(i, j) = beta / D * green - dipole;
      }
    }
    const std::vector<float> solved = solve_linear(matrix, arriving);
    for (std::size_t i = 0; i < count; ++i)
      fluences[i][b] = std::isfinite(solved[i]) ? std::max(solved[i], 0.0f) : 0.0f;
  });
  return fluences;
}

template <int N>
BandValues<N> InnerBlockers<N>::unblocked_fraction(const Vec3f& position, const Vec3f& normal,
                                                   const IrradianceTree<N>& light) const {
  Bands without;
  light.gather(position, support_radius_, error_, medium_.mfp[0],
               [&](const auto& node, const Bands&, const Vec3f& offset, float) {
                 // Below the place where it enters; never above the surface where it leaves.
                 const Bands depth = max(-dot(offset, normal) * Bands::filled(1.0f) +
                                             dot(node.normal, normal) * medium_.mfp,
                                         0.25f * medium_.mfp);
                 without += node.power * leaving(offset, normal, depth, 0.0f);
               });
  Bands change;
  for (const Source& source : sources_) {
    const auto from = [&](const Vec3f& at, const Bands& power) {
      const Vec3f offset = at - position;
      const Bands depth = max(Bands::filled(-dot(offset, normal)), 0.25f * medium_.mfp);
      change += power * leaving(offset, normal, depth, source.least2);
    };
    from(source.inner, source.power_inner);
    from(source.outer, source.power_outer);
  }
  constexpr float most = 2.0f;  // above a bright object near the surface
  Bands result = Bands::filled(1.0f);
  for (int b = 0; b < N; ++b)
    if (without[b] > 0.0f) result[b] = std::clamp(1.0f + change[b] / without[b], 0.0f, most);
  return result;
}

#define LAMINA_INSTANTIATE(N)                                                     \
  template DiffusionMedium<N> make_diffusion_medium<N>(const Material& material); \
  template class InnerBlockers<N>
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
