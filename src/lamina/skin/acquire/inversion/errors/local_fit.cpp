// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/errors/local_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/skin/acquire/inversion/texels/local_model.h"

namespace lamina::detail {
namespace {

constexpr std::size_t fit_chunk = 256;  // texels that one thread takes at a time

/// Calls body(model, texel) for all texels.
template <class Body>
void for_texels(const PatchObjective& objective, const Body& body) {
  const std::size_t texels = objective.weights()[0].size();
  parallel_for((texels + fit_chunk - 1) / fit_chunk, [&](std::size_t c) {
    LocalModel model(objective.capture(), objective.tables());
    for (std::size_t t = c * fit_chunk; t < std::min(texels, (c + 1) * fit_chunk); ++t)
      body(model, t);
  });
}

TexelData data_of(const PatchObjective& objective, const TexelMaps& level, std::size_t t) {
  const std::size_t images = level.size();
  TexelData data{std::vector<double>(images), std::vector<double>(images),
                 std::vector<double>(images)};
  for (std::size_t i = 0; i < images; ++i) {
    data.weight[i] = static_cast<double>(objective.weights()[i][t]);
    data.measured[i] = static_cast<double>(objective.measured()[i][t]);
    data.level[i] = static_cast<double>(level[i][t]);
  }
  return data;
}

/// A map with weights, on a grid.
struct WeightedMap {
  std::size_t width, height;
  std::vector<float> values, weights;
};

/// Fills texels of weight 0 from coarser grids, on which values are means of those with weight.
void fill_unknown(WeightedMap& map) {
  if (std::ranges::all_of(map.weights, [](float weight) { return weight > 0.0f; })) return;
  if (std::ranges::none_of(map.weights, [](float weight) { return weight > 0.0f; })) return;
  WeightedMap coarse{(map.width + 1) / 2, (map.height + 1) / 2, {}, {}};
  coarse.values.resize(coarse.width * coarse.height);
  coarse.weights.resize(coarse.values.size());
  const auto for_all = [&](const auto& body) {
    for (std::size_t y = 0; y < map.height; ++y)
      for (std::size_t x = 0; x < map.width; ++x)
        body(y * map.width + x, y / 2 * coarse.width + x / 2);
  };
  for_all([&](std::size_t fine, std::size_t at) {
    coarse.values[at] += map.weights[fine] * map.values[fine];
    coarse.weights[at] += map.weights[fine];
  });
  for (std::size_t at = 0; at < coarse.values.size(); ++at)
    if (coarse.weights[at] > 0.0f) {
      coarse.values[at] /= coarse.weights[at];
      coarse.weights[at] = 1.0f;
    }
  fill_unknown(coarse);
  for_all([&](std::size_t fine, std::size_t at) {
    if (map.weights[fine] == 0.0f) map.values[fine] = coarse.values[at];
  });
}

}  // namespace

TexelMaps light_levels(const PatchObjective& objective) {
  const PatchCapture& capture = objective.capture();
  const InversionTables& tables = objective.tables();
  TexelMaps level;
  if (tables.stacks.empty()) {
    for (const PatchImage& image : capture.images)
      level.push_back(capture.lights[image.light].values);
    return level;
  }
  TexelMaps uniform;
  for (const double coordinate : tables.reference)
    uniform.emplace_back(objective.weights()[0].size(), static_cast<float>(coordinate));
  level = objective.light().images(uniform);
  LocalModel model(capture, tables);
  model.predict(tables.reference);
  for (std::size_t i = 0; i < level.size(); ++i)
    for (float& value : level[i]) value /= static_cast<float>(model.reflectance[i]);
  return level;
}

TexelMaps fit_texels(const PatchObjective& objective, const TexelMaps& level, double robust_limit) {
  const PatchCapture& capture = objective.capture();
  const InversionTables& tables = objective.tables();
  const TexelMaps& weights = objective.weights();
  const std::size_t numbers = tables.numbers.size();
  TexelMaps result(numbers, std::vector<float>(weights[0].size()));
  std::vector<float> known(weights[0].size(), 0.0f);
  for_texels(objective, [&](LocalModel& model, std::size_t t) {
    const TexelData data = data_of(objective, level, t);
    for (const double weight : data.weight)
      if (weight > 0.0) known[t] = 1.0f;
    if (known[t] == 0.0f) return;
    const TexelNumbers fit = fit_texel(model, data, tables, tables.reference, robust_limit);
    for (std::size_t n = 0; n < numbers; ++n) result[n][t] = static_cast<float>(fit[n]);
  });
  for (std::vector<float>& map : result) {
    WeightedMap weighted{static_cast<std::size_t>(capture.width),
                         static_cast<std::size_t>(capture.height), std::move(map), known};
    fill_unknown(weighted);
    map = std::move(weighted.values);
  }
  return result;
}

std::vector<BandMisfit> texel_misfit(const PatchObjective& objective, const TexelMaps& level,
                                     double robust_limit) {
  constexpr std::size_t most_samples = 1024, chunk = 32;
  const InversionTables& tables = objective.tables();
  const std::size_t images = level.size(), numbers = tables.numbers.size();
  std::vector<std::size_t> known;
  for (std::size_t t = 0; t < level[0].size(); ++t)
    if (std::ranges::any_of(objective.weights(), [&](const auto& map) { return map[t] > 0.0f; }))
      known.push_back(t);
  const std::size_t samples = std::min(known.size(), most_samples);
  std::vector<std::vector<BandMisfit>> parts((samples + chunk - 1) / chunk);
  parallel_for(parts.size(), [&](std::size_t c) {
    parts[c].resize(images);
    LocalModel model(objective.capture(), tables);
    for (std::size_t s = c * chunk; s < std::min(samples, (c + 1) * chunk); ++s) {
      const TexelData data = data_of(objective, level, known[s * known.size() / samples]);
      const TexelNumbers fit = fit_texel(model, data, tables, tables.reference, robust_limit);
      const TexelMatrix covariance =
          texel_covariance(model, data, tables, std::span(fit).first(numbers), robust_limit);
      for (std::size_t i = 0; i < images; ++i) {
        if (data.weight[i] == 0.0) continue;
        const double scale = data.level[i] * data.weight[i];
        const double miss = scale * model.reflectance[i] - data.measured[i] * data.weight[i];
        const double size = std::abs(miss);
        const double share = robust_limit > 0.0 && size > robust_limit ? robust_limit / size : 1.0;
        double leverage = 0.0;
        for (std::size_t n = 0; n < numbers; ++n)
          for (std::size_t m = 0; m < numbers; ++m)
            leverage += model.by_number[i][n] * covariance[n][m] * model.by_number[i][m];
        const double growth = objective.error_growth()[i];
        parts[c][i].squares += share * miss * miss * growth * growth;
        parts[c][i].left += 1.0 - share * scale * scale * leverage;
        parts[c][i].count += 1.0;
      }
    }
  });
  std::vector<BandMisfit> result(images);
  for (const std::vector<BandMisfit>& part : parts) add_misfit(result, part);
  return result;
}

PosteriorErrors texel_errors(const PatchObjective& objective, const TexelMaps& level,
                             const TexelMaps& coordinates, double robust_limit) {
  const std::size_t numbers = coordinates.size(), texels = coordinates[0].size();
  PosteriorErrors errors{.deviations = coordinates, .correlation = DenseMatrix(numbers, numbers)};
  std::vector<TexelMaps> products(numbers, TexelMaps(numbers, std::vector<float>(texels)));
  for_texels(objective, [&](LocalModel& model, std::size_t t) {
    TexelNumbers at = {};
    for (std::size_t n = 0; n < numbers; ++n) at[n] = static_cast<double>(coordinates[n][t]);
    const TexelMatrix covariance =
        texel_covariance(model, data_of(objective, level, t), objective.tables(),
                         std::span(at).first(numbers), robust_limit);
    for (std::size_t n = 0; n < numbers; ++n) {
      errors.deviations[n][t] = static_cast<float>(std::sqrt(covariance[n][n]));
      for (std::size_t m = 0; m <= n; ++m)
        products[n][m][t] =
            static_cast<float>(covariance[n][m] / std::sqrt(covariance[n][n] * covariance[m][m]));
    }
  });
  for (std::size_t n = 0; n < numbers; ++n)
    for (std::size_t m = 0; m <= n; ++m) {
      double sum = 0.0;
      for (const float value : products[n][m]) sum += static_cast<double>(value);
      errors.correlation(n, m) = errors.correlation(m, n) = sum / static_cast<double>(texels);
    }
  return errors;
}

TexelMaps local_images(const PatchObjective& objective, const TexelMaps& level,
                       const TexelMaps& coordinates) {
  TexelMaps images = level;
  for_texels(objective, [&](LocalModel& model, std::size_t t) {
    TexelNumbers at = {};
    for (std::size_t n = 0; n < coordinates.size(); ++n)
      at[n] = static_cast<double>(coordinates[n][t]);
    model.predict(std::span(at).first(coordinates.size()));
    for (std::size_t i = 0; i < images.size(); ++i)
      images[i][t] *= static_cast<float>(model.reflectance[i]);
  });
  return images;
}

}  // namespace lamina::detail
