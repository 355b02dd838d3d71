// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/hierarchy/internal/inner_blockers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/fresnel.h"

namespace lamina {
namespace {

/// Share of the fluence at the surface of an object that it absorbs per area: D over the distance
/// behind the surface at which the fluence would be 0 if it went on straight. Over the mean free
/// path that is .71 at a flat black surface (Milne's problem), 4/3 at a small black ball, and
/// between them as [FuchsSutugin1971] have it; what the surface reflects adds to it.
///
/// @param knudsen  mean free path over the radius of a ball as large
float absorbed_fraction(float reflectance, float knudsen) {
  const float r = std::clamp(reflectance, 0.0f, 0.9999f);
  const float of_black = (0.71f + 1.33f * knudsen) / (1.0f + knudsen);
  return 1.0f / (3.0f * of_black + 4.0f * r / (1.0f - r));
}

constexpr float most_fraction = 2.0f;  ///< that is left, above a bright object near the surface

}  // namespace

template <int N>
DiffusionMedium<N> make_diffusion_medium(const Material& material) {
  DiffusionMedium<N> medium{.sigma_tr = {},
                            .diffusion = BandValues<N>::filled(1.0f),
                            .mfp = BandValues<N>::filled(1.0f),
                            .height_of_image = {},
                            .mirrored = {}};
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
    medium.mirrored[b] = static_cast<float>(f_dr);
    medium.height_of_image[b] = static_cast<float>(4.0 / 3.0 * mfp * (1.0 + f_dr) / (1.0 - f_dr));
  }
  return medium;
}

template <int N>
InnerBlockers<N>::InnerBlockers(std::span<const Patch> patches, std::span<const Patch> outer,
                                const DiffusionMedium<N>& medium, const IrradianceTree<N>& light,
                                float error)
    : medium_(medium), error_(error) {
  float least = largest(medium.sigma_tr);
  for (int b = 0; b < N; ++b)
    if (medium.sigma_tr[b] > 0.0f) least = std::min(least, medium.sigma_tr[b]);
  support_radius_ = least > 0.0f ? 20.0f / least : 1e6f;
  if (patches.empty()) return;
  std::vector<Wall> walls;
  for (const Patch& patch : patches) {
    Wall& wall = walls.emplace_back(Wall{patch.position, patch.normal, patch.area, {}});
    for (int b = 0; b < N; ++b)
      wall.loss[b] = absorbed_fraction(patch.reflectance[b], medium.mfp[b] / patch.radius);
  }
  if (!outer.empty()) solve_with_surface(walls, outer, light);
  std::vector<Bands> arriving(patches.size());
  parallel_for(patches.size(),
               [&](std::size_t i) { arriving[i] = fluence(patches[i].position, light, true); });
  const std::vector<Bands> fluences =
      left_.empty() ? solve(walls, std::move(arriving)) : std::move(arriving);
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
      const float absorbed = power * walls[i].loss[b];
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
BandValues<N> InnerBlockers<N>::fluence(const Vec3f& position, const IrradianceTree<N>& light,
                                        bool has_images) const {
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
                 const Bands own = green(-1.0f * medium_.mfp);
                 total += node.power * (has_images ? own - green(above) : own);
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

/// The fluence at each patch, from half of it = what comes without the patches + what all of them
/// send there: D dG/dn, less what they absorb times G.
///
/// @param fluences  that come without them
template <int N>
std::vector<BandValues<N>> InnerBlockers<N>::solve(std::span<const Wall> patches,
                                                   std::vector<Bands> fluences) const {
  const std::size_t count = patches.size();
  parallel_for(static_cast<std::size_t>(N), [&](std::size_t lane) {
    const int b = static_cast<int>(lane);
    std::vector<float> arriving(count);
    for (std::size_t i = 0; i < count; ++i) arriving[i] = fluences[i][b];
    if (std::ranges::none_of(arriving, [](float value) { return value > 0.0f; })) return;
    const float kappa = medium_.sigma_tr[b], D = medium_.diffusion[b];
    BasicDenseMatrix<float> matrix(count, count);
    for (std::size_t j = 0; j < count; ++j) {
      const Wall& from = patches[j];
      const float beta = from.loss[b];
      const float radius = std::sqrt(from.area / float_pi);
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f d = patches[i].position - from.position;
        const float r = length(d);
        if (!(r > 0.1f * radius)) {
          // Within a disc: the integral of G is (1 - exp(-kappa radius)) / (2 D kappa).
          const float own = kappa * radius > 1e-4f ? -std::expm1(-kappa * radius) / kappa : radius;
          matrix(i, j) = (i == j ? 0.5f - from.own_dipole : 0.0f) + beta * own / (2.0f * D);
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

/// Finds what curved patches send to themselves: what is missing to the dipoles of a closed surface
/// on itself, which add up to 1/2 without absorption.
///
/// @param sum  -1/2 where normals point out of it, 1/2 where they point inward
template <int N>
void InnerBlockers<N>::find_own_dipoles(std::span<Wall> surface, float sum) {
  parallel_for(surface.size(), [&](std::size_t i) {
    float others = 0.0f;
    for (const Wall& from : surface) {
      const Vec3f d = surface[i].position - from.position;
      const float r2 = dot(d, d);
      if (r2 > 0.01f * from.area)
        others += from.area * dot(d, from.normal) / (4.0f * float_pi * r2 * std::sqrt(r2));
    }
    constexpr float most = 0.2f;  // of a surface that is not closed more may be missing
    surface[i].own_dipole = std::clamp(sum - others, -most, most);
  });
}

/// Both surfaces in one equation, and the outer one alone: it absorbs what it does not mirror.
template <int N>
void InnerBlockers<N>::solve_with_surface(std::span<const Wall> inner, std::span<const Patch> outer,
                                          const IrradianceTree<N>& light) {
  const Bands one = Bands::filled(1.0f);
  const Bands lost = 0.5f * (one - medium_.mirrored) / (one + medium_.mirrored);
  std::vector<Wall> walls;
  for (const Patch& patch : outer)
    walls.push_back({patch.position, -patch.normal, patch.area, lost});
  walls.insert(walls.end(), inner.begin(), inner.end());
  const std::span alone = std::span(walls).first(outer.size());
  find_own_dipoles(alone, 0.5f);
  find_own_dipoles(std::span(walls).subspan(outer.size()), -0.5f);
  std::vector<Bands> arriving(walls.size());
  parallel_for(walls.size(),
               [&](std::size_t i) { arriving[i] = fluence(walls[i].position, light, false); });
  const auto count = static_cast<std::ptrdiff_t>(outer.size());
  const std::vector<Bands> without = solve(alone, {arriving.begin(), arriving.begin() + count});
  const std::vector<Bands> with = solve(walls, std::move(arriving));
  float area = 0.0f;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    Bands fraction = one;
    for (int b = 0; b < N; ++b)
      if (without[i][b] > 0.0f) fraction[b] = std::min(with[i][b] / without[i][b], most_fraction);
    left_.push_back({outer[i].position, outer[i].normal, fraction});
    area += outer[i].area;
  }
  left_spacing_ = std::sqrt(area / static_cast<float>(outer.size()));
}

template <int N>
BandValues<N> InnerBlockers<N>::unblocked_fraction(const Vec3f& position, const Vec3f& normal,
                                                   const IrradianceTree<N>& light) const {
  if (!left_.empty()) {
    Bands total;
    float weights = 0.0f;
    for (const Left& left : left_) {
      const Vec3f d = left.position - position;
      const float facing = dot(left.normal, normal);
      if (!(facing > 0.0f)) continue;
      const float weight = facing * std::exp(-dot(d, d) / (left_spacing_ * left_spacing_)) + 1e-20f;
      total += weight * left.fraction;
      weights += weight;
    }
    return weights > 0.0f ? (1.0f / weights) * total : Bands::filled(1.0f);
  }
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
  Bands result = Bands::filled(1.0f);
  for (int b = 0; b < N; ++b)
    if (without[b] > 0.0f)
      result[b] = std::clamp(1.0f + change[b] / without[b], 0.0f, most_fraction);
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
