// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/texels/inversion_tables.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/skin/acquire/inversion/texels/local_model.h"
#include "lamina/skin/patch/skin_patch.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/heterogeneous/oblique_light.h"

namespace lamina {
namespace {

using detail::LocalModel;
using detail::TexelData;
using detail::TexelNumbers;

std::vector<SkinFitNumber> numbers_of(const InversionModel& model) {
  if (model.numbers.empty()) throw InvalidInput("numbers: at least one of skin must vary");
  const std::vector<SkinFitNumber> all = skin_fit_numbers(model.skin);
  std::vector<SkinFitNumber> chosen;
  for (const std::string& name : model.numbers) {
    const auto is_it = [&](const SkinFitNumber& number) { return number.parameter.name == name; };
    const auto found = std::ranges::find_if(all, is_it);
    if (found == all.end()) throw InvalidInput(name + ": is no number of skin that can be found");
    if (name == "scattering_scale")
      throw InvalidInput(name + ": cannot vary over a patch, as only numbers of absorption can");
    if (std::ranges::any_of(chosen, is_it)) throw InvalidInput(name + ": is named twice");
    chosen.push_back(*found);
  }
  return chosen;
}

/// Mean, inverse covariance and what the model misses, from a population.
void use_population(const SkinPopulation& population, InversionTables& tables) {
  const std::size_t n = tables.numbers.size();
  std::vector<std::size_t> known;
  for (const SkinFitNumber& number : tables.numbers) {
    const std::string& name = number.parameter.name;
    const auto found = std::ranges::find(population.names, name);
    if (found == population.names.end())
      throw InvalidInput(name + ": the population knows nothing of it");
    known.push_back(static_cast<std::size_t>(found - population.names.begin()));
  }
  DenseMatrix covariance(n, n), one(n, n);
  for (std::size_t a = 0; a < n; ++a) {
    const FitPrior& prior = population.priors[known[a]];
    tables.prior_mean[a] = fit_coordinate(tables.numbers[a].parameter, prior.mean);
    one(a, a) = 1.0;
    for (std::size_t b = 0; b < n; ++b)
      covariance(a, b) = population.correlation(known[a], known[b]) * prior.standard_deviation *
                         population.priors[known[b]].standard_deviation;
  }
  tables.prior_precision = solve_linear(covariance, one);
  tables.reference = tables.prior_mean;
  for (std::size_t w = 0; w < tables.wavelengths.size(); ++w) {
    const double nm = tables.wavelengths[w];
    tables.missed[w] = at_wavelength(population, population.missed, nm);
    double square = 0.0;
    for (std::size_t c = 0; c < population.missed_components.rows; ++c)
      square += std::pow(at_wavelength(population, population.missed_components.row(c), nm), 2);
    tables.missed_deviation[w] = std::sqrt(square);
  }
}

/// Fits of some of the texels that are lit well, as if light did not travel sideways; [number].
std::vector<std::vector<double>> sample_fits(const PatchCapture& capture,
                                             const InversionTables& tables) {
  constexpr std::size_t most_samples = 400;
  const std::size_t count = capture.images.size();
  const auto light_at = [&](std::size_t i, std::size_t t) {
    const PatchImage& image = capture.images[i];
    return std::isinf(image.deviation.values[t]) ? 0.0f : capture.lights[image.light].values[t];
  };
  std::vector<float> least_light(count, 0.0f);
  const std::size_t all = capture.images[0].reflected.values.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t t = 0; t < all; ++t)
      least_light[i] = std::max(least_light[i], 0.5f * light_at(i, t));
  const auto is_lit = [&](std::size_t i, std::size_t t) { return light_at(i, t) > least_light[i]; };
  std::vector<std::size_t> texels;
  for (std::size_t t = 0; t < all; ++t)
    for (std::size_t i = 0; i < count; ++i)
      if (is_lit(i, t)) {
        texels.push_back(t);
        break;
      }
  const auto data_of = [&](std::size_t t) {
    TexelData data{std::vector<double>(count), std::vector<double>(count),
                   std::vector<double>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_lit(i, t)) continue;
      const PatchImage& image = capture.images[i];
      data.measured[i] = static_cast<double>(image.reflected.values[t]);
      data.weight[i] =
          1.0 / std::max(static_cast<double>(image.deviation.values[t]),
                         least_relative_deviation * static_cast<double>(light_at(i, t)));
      data.level[i] = static_cast<double>(light_at(i, t));
    }
    return data;
  };
  std::vector<std::vector<double>> fits(tables.numbers.size());
  LocalModel model(capture, tables);
  const std::size_t samples = std::min(most_samples, texels.size());
  for (std::size_t s = 0; s < samples; ++s) {
    const std::size_t t = texels[s * texels.size() / samples];
    const TexelNumbers fit = fit_texel(model, data_of(t), tables, tables.reference, 0.0);
    for (std::size_t n = 0; n < fits.size(); ++n) fits[n].push_back(fit[n]);
  }
  return fits;
}

/// Skin of each of the fits, as absorption of its layers.
std::vector<std::vector<float>> absorptions_of(const std::vector<std::vector<double>>& fits,
                                               const InversionTables& tables, std::size_t band) {
  std::vector<std::vector<float>> sigma_a(detail::skin_layer_count);
  detail::SkinAtTexel skin(tables.numbers, tables.model.skin);
  for (std::size_t s = 0; s < fits[0].size(); ++s) {
    std::vector<double> coordinates;
    for (const std::vector<double>& fit : fits) coordinates.push_back(fit[s]);
    skin.set(coordinates);
    const detail::LayerAbsorption absorption = skin.absorption(tables.spectra[band]);
    for (std::size_t l = 0; l < sigma_a.size(); ++l)
      sigma_a[l].push_back(static_cast<float>(std::max(absorption.sigma_a[l], least_coefficient)));
  }
  return sigma_a;
}

void make_stacks(const PatchCapture& capture, const std::vector<std::vector<double>>& fits,
                 const std::optional<DiskCache>& cache, InversionTables& tables) {
  SkinPatch patch;
  patch.bands = BandSet(capture.wavelengths);
  patch.skin.skin = tables.model.skin;
  const Material material = material_of(patch).material;
  const std::size_t bands = tables.wavelengths.size();
  tables.stacks.resize(bands);
  tables.entering.resize(bands);
  tables.sheet.resize(bands);
  parallel_for(bands, [&](std::size_t b) {
    BandTexels texels = band_texels(material, {}, 1, b);
    const MappedStack stack = mapped_stack(material, b, texels);
    std::vector<double> typical;
    for (const std::vector<float>& layer : absorptions_of(fits, tables, b)) {
      texels.layers[typical.size()].sigma_a = {static_cast<float>(typical_absorption(layer))};
      typical.push_back(typical_absorption(layer));
    }
    tables.stacks[b] = cached_stack_tables(cache, stack, tables.model.totals, typical);
    const ObliqueLight oblique(stack, texels.layers, typical_absorbances(texels), capture.theta);
    tables.entering[b] =
        entry_transmittance(layer_stack(material, b), {.theta = capture.theta}) * oblique.gain(0);
    tables.sheet[b] = static_cast<double>(texels.absorbance[0][0]);
  });
}

}  // namespace

InversionTables make_inversion_tables(const PatchCapture& capture, const InversionModel& model,
                                      const std::optional<DiskCache>& cache) {
  check_capture(capture);
  std::vector<SkinFitNumber> numbers = numbers_of(model);
  if (!model.population && capture.images.size() < numbers.size())
    throw InvalidInput(std::to_string(numbers.size()) + " numbers of skin cannot be told from " +
                       std::to_string(capture.images.size()) +
                       " images where nothing is known of a population");
  const auto table = model.reflectance ? model.reflectance
                                       : std::make_shared<const SkinReflectanceTable>(
                                             capture.wavelengths, Incidence{.theta = capture.theta},
                                             skin_fit_range(model.skin));
  if (table->wavelengths() != capture.wavelengths)
    throw InvalidInput("reflectance: must have the wavelengths of the capture");
  InversionTables tables{
      .model = model,
      .numbers = std::move(numbers),
      .wavelengths = capture.wavelengths,
      .spectra = {},
      .reflectance = std::make_shared<const LocalReflectance>(*table, model.skin)};
  for (const double nm : tables.wavelengths) tables.spectra.push_back(skin_spectrum(nm));
  tables.missed.resize(tables.wavelengths.size());
  tables.missed_deviation.resize(tables.wavelengths.size());
  const std::size_t n = tables.numbers.size();
  tables.prior_precision = DenseMatrix(n, n);
  for (std::size_t i = 0; i < n; ++i) {
    const FitParameter& parameter = tables.numbers[i].parameter;
    tables.prior_mean.push_back(fit_coordinate(parameter, parameter.start));
    tables.prior_precision(i, i) = 1.0 / (wide_deviation * wide_deviation);
  }
  tables.reference = tables.prior_mean;
  if (model.population) use_population(*model.population, tables);
  std::vector<std::vector<double>> fits = sample_fits(capture, tables);
  if (model.has_transport) make_stacks(capture, fits, cache, tables);
  for (std::size_t i = 0; i < n; ++i) {
    const auto middle = fits[i].begin() + static_cast<std::ptrdiff_t>(fits[i].size() / 2);
    std::ranges::nth_element(fits[i], middle);
    tables.reference[i] = *middle;
  }
  if (!model.population) tables.prior_mean = tables.reference;
  return tables;
}

}  // namespace lamina
