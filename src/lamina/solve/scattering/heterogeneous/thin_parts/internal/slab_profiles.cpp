// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/thin_parts/internal/slab_profiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/heterogeneous/tables/operator_totals.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/layer_response.h"

namespace lamina::detail {
namespace {

constexpr float thinnest = 0.1f;  // [mm]
constexpr float slabs_per_octave = 4.0f;
constexpr float nearest = 0.05f;  // [mm] along the slab
constexpr float distances_per_octave = 16.0f;
constexpr std::size_t distance_count = 146;  // up to 27 mm

/// Rows of tables: slabs between parallel faces, the half-space, slabs between faces of an edge.
constexpr std::size_t half_space_row = slab_count, row_count = 2 * slab_count + 1;

/// Tables of slabs between faces are made for an edge of 90°; sharper ones lie between these and
/// parallel faces, blunter ones stay at these.
constexpr float widest_opening = 0.5f;

/// Place of a ratio >= 1 among values at equal ratios.
float place(float ratio, float per_octave, std::size_t count) {
  return std::min(per_octave * std::log2(ratio), static_cast<float>(count) - 1.001f);
}

float place_of_distance(float distance2) {
  return place(std::max(distance2 / (nearest * nearest), 1.0f), 0.5f * distances_per_octave,
               distance_count);
}

/// Reduced mean free path in the last layer [mm].
double mean_free_path(const ThinBand& band) {
  const MappedLayer& layer = band.stack->layers.back();
  return mfp_prime(Medium{band.reference.back(), layer.sigma_s, layer.g, layer.ior});
}

Multipole slab_of(const SlabLayer& slab, double sigma_a, double thickness) {
  const MappedLayer& layer = slab.layer;
  return make_multipole({sigma_a, layer.sigma_s, layer.g, layer.ior}, thickness, slab.inside,
                        slab.inside);
}

/// The slab in place of one of a thickness between the faces of an edge of 90° [mm].
double between_faces(double thickness, double mean_free_path) {
  constexpr double least = 1.75;  // mean free paths
  const double squared = thickness * thickness;
  const double least2 = least * least * mean_free_path * mean_free_path;
  return std::pow(squared * squared + least2 * least2, 0.25);
}

/// The layers above the last one by their tables' totals, at their reference absorption.
LayerResponse coat_of(const ThinBand& band) {
  LayerResponse coat;
  for (std::size_t i = 0; i + 1 < band.stack->layers.size(); ++i) {
    std::array<double, 4> totals{};
    const auto tables = operator_tables(band.tables->layers[i]);
    const LatticePlace place = place_in(band.tables->lattices[i],
                                        reference_state(band.stack->layers[i], band.reference[i]));
    for (std::size_t which = 0; which < 4; ++which)
      for (const double weight : weights_at(band.tables->lattices[i], *tables[which], place))
        totals[which] += weight;
    coat = stacked(coat, {totals[0], totals[1], totals[2], totals[3]});
  }
  return coat;
}

/// Reflectance below the coat with which `returned` comes back of what has entered it.
double below_coat(const LayerResponse& coat, double returned) {
  const double through = returned - coat.reflection_above;
  return through /
         (coat.transmission_down * coat.transmission_up + through * coat.reflection_below);
}

struct TransferSlab {
  SlabResponse response;
  double scattered;  ///< share of what is transmitted
};

/// The slab by radiative transfer: with light alike on both sides of the whole it returns what it
/// reflects and transmits, with light of opposite sign their difference. Either is a half-space of
/// that reflectance below one coat.
TransferSlab transfer_slab(const ThinBand& band, const LayerResponse& coat, double thickness) {
  std::vector<Layer> layers;
  const auto add = [&](std::size_t i, double thick) {
    const MappedLayer& layer = band.stack->layers[i];
    layers.push_back({.medium = {.sigma_a = band.reference[i],
                                 .sigma_s = layer.sigma_s,
                                 .g = layer.g,
                                 .ior = layer.ior},
                      .thickness = thick});
  };
  const std::size_t last = band.stack->layers.size() - 1;
  for (std::size_t i = 0; i < last; ++i) add(i, band.stack->layers[i].thickness);
  add(last, thickness);
  if (std::isfinite(thickness))
    for (std::size_t i = last; i-- > 0;) add(i, band.stack->layers[i].thickness);
  // Even light would get through 3.5 % less, a lamp straight behind 3.5 % more.
  constexpr double theta = std::numbers::pi / 6.0;
  const AddingDoublingTotals found = adding_doubling(
      LayerStack(layers, band.stack->ior_above, band.stack->ior_above), {.theta = theta});
  const SlabTotals& totals = found.totals;
  const double entered = 1.0 - totals.specular_reflectance;
  const double reflected = totals.diffuse_reflectance / entered;
  const double transmitted = totals.transmittance / entered;
  const double even = below_coat(coat, reflected + transmitted);
  const double odd = below_coat(coat, reflected - transmitted);
  const double scattered =
      totals.transmittance > 0.0
          ? std::max(1.0 - found.unscattered_transmittance / totals.transmittance, 0.0)
          : 1.0;
  return {{0.5 * (even - odd), 0.5 * (even + odd)}, scattered};
}

}  // namespace

double slab_thickness(std::size_t index) {
  return static_cast<double>(thinnest) *
         std::exp2(static_cast<double>(index) / static_cast<double>(slabs_per_octave));
}

SlabLayer last_layer(const MappedStack& stack) {
  return {stack.layers.back(), boundary_reflectances(stack, stack.layers.size() - 1).first};
}

SlabResponse multipole_slab(const SlabLayer& layer, double sigma_a, double thickness) {
  const LayerResponse slab = response(slab_of(layer, sigma_a, thickness), 0.0);
  const LayerResponse thick =
      response(slab_of(layer, sigma_a, std::numeric_limits<double>::infinity()), 0.0);
  return {slab.transmission_down, slab.reflection_above / thick.reflection_above};
}

SlabResponse between_slabs(std::span<const SlabResponse> slabs, double thickness) {
  const double place = std::clamp(
      static_cast<double>(slabs_per_octave) * std::log2(thickness / static_cast<double>(thinnest)),
      0.0, static_cast<double>(slabs.size()) - 1.001);
  const auto i = static_cast<std::size_t>(place);
  const double f = place - static_cast<double>(i);
  return {std::lerp(slabs[i].transmittance, slabs[i + 1].transmittance, f),
          std::lerp(slabs[i].reflectance, slabs[i + 1].reflectance, f)};
}

SlabFactors transfer_factors(const ThinBand& band) {
  SlabFactors factors{.slabs = std::vector<SlabResponse>(slab_count, {1.0, 1.0}),
                      .scattered = std::vector<double>(slab_count, 1.0)};
  const LayerResponse coat = coat_of(band);
  // Next to nothing gets through: no way to tell, and no need.
  if (!band.has_transfer_totals || coat.transmission_down * coat.transmission_up < 1e-3)
    return factors;
  const double sigma_a = band.reference.back();
  const SlabLayer layer = last_layer(*band.stack);
  const double half_space =
      transfer_slab(band, coat, std::numeric_limits<double>::infinity()).response.reflectance;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  factors.half_space =
      half_space / response(slab_of(layer, sigma_a, infinity), 0.0).reflection_above;
  const auto factor_at = [&](std::size_t i) {
    const SlabResponse multipole = multipole_slab(layer, sigma_a, slab_thickness(i));
    const auto [transfer, scattered] = transfer_slab(band, coat, slab_thickness(i));
    constexpr double least = 1e-3;  // of the light, a hundred times the error of adding-doubling
    return TransferSlab{
        {multipole.transmittance > least ? transfer.transmittance / multipole.transmittance : 0.0,
         transfer.reflectance / half_space / multipole.reflectance},
        scattered};
  };
  constexpr auto step = static_cast<std::size_t>(slabs_per_octave);
  TransferSlab low = factor_at(0);
  for (std::size_t i = 0; i < slab_count; i += step) {
    TransferSlab high = i + step < slab_count ? factor_at(i + step) : low;
    if (!(high.response.transmittance > 0.0))
      high.response.transmittance = low.response.transmittance;
    for (std::size_t k = 0; k < step; ++k) {
      const double f = static_cast<double>(k) / static_cast<double>(step);
      factors.slabs[i + k] = {std::lerp(low.response.transmittance, high.response.transmittance, f),
                              std::lerp(low.response.reflectance, high.response.reflectance, f)};
      factors.scattered[i + k] = std::lerp(low.scattered, high.scattered, f);
    }
    low = high;
  }
  return factors;
}

template <int N>
SlabProfiles<N>::SlabProfiles(std::span<const ThinBand> bands,
                              const std::vector<SlabFactors>& factors, double blur, SlabLight light)
    : values_(row_count * distance_count) {
  const HankelPlan plan = make_hankel_plan(
      {.first = static_cast<double>(nearest),
       .last = static_cast<double>(nearest) *
               std::exp2((distance_count - 1.0) / static_cast<double>(distances_per_octave)),
       .size = distance_count});
  for (const ThinBand& band : bands)
    longest_ = std::max(longest_, static_cast<float>(mean_free_path(band)));
  parallel_for(bands.size(), [&](std::size_t b) {
    const SlabLayer layer = last_layer(*bands[b].stack);
    const double sigma_a = bands[b].reference.back();
    std::vector<double> spectra(plan.k.size() * row_count);
    for (std::size_t row = 0; row < row_count; ++row) {
      double thickness = std::numeric_limits<double>::infinity(), factor = factors[b].half_space;
      if (row < half_space_row) {
        thickness = slab_thickness(row);
        factor = factors[b].slabs[row].transmittance;
        if (light == SlabLight::scattered) factor *= factors[b].scattered[row];
      } else if (row > half_space_row) {
        thickness =
            between_faces(slab_thickness(row - half_space_row - 1), mean_free_path(bands[b]));
        factor = between_slabs(factors[b].slabs, thickness).transmittance;
      }
      const Multipole slab = slab_of(layer, sigma_a, thickness);
      for (std::size_t j = 0; j < plan.k.size(); ++j) {
        const double k = plan.k[j];
        const LayerResponse r = response(slab, k);
        spectra[j * row_count + row] =
            factor * (row == half_space_row ? r.reflection_above : r.transmission_down) *
            std::exp(-0.5 * k * k * blur * blur);
      }
    }
    const std::vector<double> profiles = inverse_hankel(plan, spectra, row_count);
    for (std::size_t row = 0; row < row_count; ++row)
      for (std::size_t r = 0; r < distance_count; ++r)
        values_[row * distance_count + r][static_cast<int>(b)] =
            static_cast<float>(std::max(profiles[r * row_count + row], 0.0));
  });
}

template <int N>
BandValues<N> SlabProfiles<N>::looked_up(std::size_t first_row, float slab, float distance) const {
  const auto i = static_cast<std::size_t>(slab), j = static_cast<std::size_t>(distance);
  const float of_slab = slab - static_cast<float>(i), of_r = distance - static_cast<float>(j);
  const BandValues<N>* low = &values_[(first_row + i) * distance_count + j];
  const BandValues<N>* high = low + distance_count;
  const BandValues<N> thin = low[0] + of_r * (low[1] - low[0]);
  return thin + of_slab * (high[0] + of_r * (high[1] - high[0]) - thin);
}

template <int N>
BandValues<N> SlabProfiles<N>::transmittance(float thickness, float lateral2, float opening) const {
  const float slab = place(std::max(thickness / thinnest, 1.0f), slabs_per_octave, slab_count);
  const float distance = place_of_distance(lateral2);
  const BandValues<N> parallel = looked_up(0, slab, distance);
  // Nearly parallel, or so far apart that it makes no difference.
  if (opening < 0.01f || thickness > 12.0f * longest_) return parallel;
  const float share = std::min(opening / widest_opening, 1.0f);
  return parallel + share * (looked_up(half_space_row + 1, slab, distance) - parallel);
}

template <int N>
BandValues<N> SlabProfiles<N>::reflectance(float distance2) const {
  const float r = place_of_distance(distance2);
  const auto j = static_cast<std::size_t>(r);
  const BandValues<N>* at = &values_[half_space_row * distance_count + j];
  return at[0] + (r - static_cast<float>(j)) * (at[1] - at[0]);
}

template class SlabProfiles<4>;
template class SlabProfiles<8>;
template class SlabProfiles<16>;

}  // namespace lamina::detail
