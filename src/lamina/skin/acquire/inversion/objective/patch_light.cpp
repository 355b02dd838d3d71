// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/objective/patch_light.h"

#include <algorithm>

#include "lamina/base/core/parallel.h"

namespace lamina::detail {
namespace {

constexpr std::size_t light_chunk = 4096;  // texels that one thread takes at a time

/// Whether absorption of a layer depends on a number.
bool depends(const SkinFitNumber& number, const SkinParameters& skin, std::size_t layer) {
  const SkinSpectrum any{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  const auto absorption = [&](double value) {
    SkinParameters moved = skin;
    moved.melanin = 0.01;
    moved.hemoglobin_epidermis = moved.hemoglobin_dermis = moved.carotene = 0.02;
    for (double SkinParameters::*const member : number.values) moved.*member = value;
    return layer == 0 ? epidermis_absorption(moved, any) : dermis_absorption(moved, any);
  };
  return absorption(0.1) != absorption(0.2);
}

/// A range that holds the absorptions of a map, and what a few steps may make of them.
AbsorptionRange range_about(const Plane& sigma_a) {
  constexpr double margin = 1.5;
  const GaussianTableGrid grid;
  const auto [low, high] = std::ranges::minmax(sigma_a.values);
  return {std::max(grid.lowest, static_cast<double>(low) / margin),
          std::min(grid.highest, static_cast<double>(high) * margin)};
}

bool holds(const AbsorptionRange& range, const Plane& sigma_a) {
  const GaussianTableGrid grid;
  const auto [low, high] = std::ranges::minmax(sigma_a.values);
  return (range.lowest <= static_cast<double>(low) || range.lowest <= grid.lowest) &&
         (static_cast<double>(high) <= range.highest || range.highest >= grid.highest);
}

}  // namespace

PatchLight::PatchLight(const PatchCapture& capture, const InversionTables& tables, double cost,
                       double spent)
    : capture_(capture),
      tables_(tables),
      texels_(static_cast<std::size_t>(capture.width) * static_cast<std::size_t>(capture.height)),
      layers_(tables.wavelengths.size()),
      cost_(cost),
      forwards_(spent) {
  for (std::size_t w = 0; w < layers_.size(); ++w)
    for (std::size_t l = 0; l < capture.lights.size(); ++l)
      if (std::ranges::any_of(capture.images, [&](const PatchImage& image) {
            return image.light == l && image.sensor[w] != 0.0;
          }))
        fields_.push_back({w, l});
  for (auto& of_wavelength : layers_)
    for (std::size_t l = 0; l < skin_layer_count; ++l) {
      LayerMaps& layer = of_wavelength[l];
      layer.sigma_a = make_plane(capture.width, capture.height);
      for (const SkinFitNumber& number : tables.numbers)
        layer.by_number.emplace_back(depends(number, tables.model.skin, l) ? texels_ : 0);
    }
}

void PatchLight::set_absorption(const TexelMaps& coordinates) {
  parallel_for((texels_ + light_chunk - 1) / light_chunk, [&](std::size_t c) {
    SkinAtTexel skin(tables_.numbers, tables_.model.skin);
    TexelNumbers at = {};
    for (std::size_t t = c * light_chunk; t < std::min(texels_, (c + 1) * light_chunk); ++t) {
      for (std::size_t n = 0; n < coordinates.size(); ++n)
        at[n] = static_cast<double>(coordinates[n][t]);
      skin.set(std::span(at).first(coordinates.size()));
      for (std::size_t w = 0; w < layers_.size(); ++w) {
        const LayerAbsorption absorption = skin.absorption(tables_.spectra[w]);
        for (std::size_t l = 0; l < skin_layer_count; ++l) {
          LayerMaps& layer = layers_[w][l];
          layer.sigma_a.values[t] =
              static_cast<float>(std::max(absorption.sigma_a[l], least_coefficient));
          for (std::size_t n = 0; n < coordinates.size(); ++n)
            if (!layer.by_number[n].empty())
              layer.by_number[n][t] = static_cast<float>(absorption.by_number[l][n]);
        }
      }
    }
  });
}

void PatchLight::make_transport(Field& field) const {
  const auto& layers = layers_[field.wavelength];
  for (std::size_t l = 0; l < skin_layer_count; ++l) {
    const AbsorptionRange wanted = range_about(layers[l].sigma_a);
    AbsorptionRange& range = field.ranges[l];
    if (field.transport)
      range = {std::min(range.lowest, wanted.lowest), std::max(range.highest, wanted.highest)};
    else
      range = wanted;
  }
  field.transport = std::make_unique<DifferentiableTransport<float>>(
      tables_.stacks[field.wavelength], capture_.width, capture_.height, field.ranges,
      capture_.mm_per_texel,
      DifferentiableOptions{.transport = tables_.model.transport,
                            .profile = tables_.model.profile});
}

TexelMaps PatchLight::images(const TexelMaps& coordinates) {
  forwards_ += cost_;
  set_absorption(coordinates);
  parallel_for(fields_.size(), [&](std::size_t f) {
    Field& field = fields_[f];
    const auto& layers = layers_[field.wavelength];
    bool fits = field.transport != nullptr;
    for (std::size_t l = 0; l < skin_layer_count && fits; ++l)
      fits = holds(field.ranges[l], layers[l].sigma_a);
    if (!fits) make_transport(field);
    const auto entering = static_cast<float>(tables_.entering[field.wavelength]);
    TransportMaps<float> maps{
        .sigma_a = {layers[0].sigma_a, layers[1].sigma_a},
        .absorbance = {make_plane(capture_.width, capture_.height,
                                  static_cast<float>(tables_.sheet[field.wavelength]))},
        .irradiance = capture_.lights[field.light]};
    for (float& value : maps.irradiance.values) value *= entering;
    field.reflected = field.transport->light(maps).reflected;
  });
  TexelMaps sums = sums_over_sensors();
  for (std::size_t i = 0; i < sums.size(); ++i) {
    double missed = 0.0;
    for (std::size_t w = 0; w < layers_.size(); ++w)
      missed += capture_.images[i].sensor[w] * tables_.missed[w];
    const std::vector<float>& light = capture_.lights[capture_.images[i].light].values;
    for (std::size_t t = 0; t < texels_; ++t) sums[i][t] += static_cast<float>(missed) * light[t];
  }
  return sums;
}

TexelMaps PatchLight::change(const TexelMaps& coordinate_change) {
  forwards_ += cost_;
  parallel_for(fields_.size(), [&](std::size_t f) {
    Field& field = fields_[f];
    TransportMaps<float> change;
    for (const LayerMaps& layer : layers_[field.wavelength]) {
      Plane& sum = change.sigma_a.emplace_back(make_plane(capture_.width, capture_.height));
      for (std::size_t n = 0; n < layer.by_number.size(); ++n)
        for (std::size_t t = 0; t < layer.by_number[n].size(); ++t)
          sum.values[t] += layer.by_number[n][t] * coordinate_change[n][t];
    }
    field.reflected = field.transport->tangent(change).reflected;
  });
  return sums_over_sensors();
}

TexelMaps PatchLight::sums_over_sensors() const {
  TexelMaps sums(capture_.images.size(), std::vector<float>(texels_, 0.0f));
  parallel_for(sums.size(), [&](std::size_t i) {
    const PatchImage& image = capture_.images[i];
    for (const Field& field : fields_) {
      const auto weight = static_cast<float>(image.sensor[field.wavelength]);
      if (field.light != image.light || weight == 0.0f) continue;
      for (std::size_t t = 0; t < texels_; ++t) sums[i][t] += weight * field.reflected.values[t];
    }
  });
  return sums;
}

TexelMaps PatchLight::gradient(const TexelMaps& by_images) {
  forwards_ += cost_;
  std::vector<std::vector<Plane>> by_sigma_a(fields_.size());
  parallel_for(fields_.size(), [&](std::size_t f) {
    const Field& field = fields_[f];
    Plane by_reflected = make_plane(capture_.width, capture_.height);
    for (std::size_t i = 0; i < by_images.size(); ++i) {
      const PatchImage& image = capture_.images[i];
      const auto weight = static_cast<float>(image.sensor[field.wavelength]);
      if (field.light != image.light || weight == 0.0f) continue;
      for (std::size_t t = 0; t < texels_; ++t) by_reflected.values[t] += weight * by_images[i][t];
    }
    by_sigma_a[f] = field.transport->gradient({std::move(by_reflected), {}}).sigma_a;
  });
  TexelMaps result(tables_.numbers.size(), std::vector<float>(texels_, 0.0f));
  parallel_for(result.size(), [&](std::size_t n) {
    for (std::size_t f = 0; f < fields_.size(); ++f)
      for (std::size_t l = 0; l < skin_layer_count; ++l) {
        const std::vector<float>& slope = layers_[fields_[f].wavelength][l].by_number[n];
        for (std::size_t t = 0; t < slope.size(); ++t)
          result[n][t] += slope[t] * by_sigma_a[f][l].values[t];
      }
  });
  return result;
}

}  // namespace lamina::detail
