// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/errors/posterior.h"

#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/small_matrix.h"
#include "lamina/skin/acquire/inversion/steps/gauss_newton.h"
#include "lamina/skin/acquire/inversion/texels/skin_at_texel.h"

namespace lamina::detail {
namespace {

float sign(Random& random) { return random.bits() >> 63 ? 1.0f : -1.0f; }

/// Noise whose covariance is the part of the matrix that smoothness and prior have.
TexelMaps prior_noise(const PatchObjective& objective, std::uint64_t seed) {
  const PatchCapture& capture = objective.capture();
  const DenseMatrix& precision = objective.prior_precision();
  const std::size_t numbers = precision.rows;
  const GridSize size{capture.width, capture.height};
  TexelMatrix matrix = {};
  for (std::size_t n = 0; n < numbers; ++n)
    for (std::size_t m = 0; m <= n; ++m) matrix[n][m] = precision(n, m);
  const TexelMatrix root = cholesky(matrix, numbers);
  TexelMaps white(numbers), noise(numbers, std::vector<float>(size.texels(), 0.0f));
  parallel_for(numbers, [&](std::size_t n) {
    Random random = make_random(seed, n);
    for (std::size_t t = 0; t < size.texels(); ++t) white[n].push_back(sign(random));
    noise[n] = roughness_noise(size, objective.smoothness()[n], [&] { return sign(random); });
  });
  parallel_for(numbers, [&](std::size_t n) {
    for (std::size_t m = 0; m <= n; ++m)
      for (std::size_t t = 0; t < size.texels(); ++t)
        noise[n][t] += static_cast<float>(root[n][m]) * white[m][t];
  });
  return noise;
}

/// Means of a map over about 8 x 8 texels.
std::vector<float> neighborhood_mean(GridSize size, std::vector<float> map, int halvings = 3) {
  if (halvings == 0 || std::min(size.width, size.height) < 8) return map;
  return on_fine(size, neighborhood_mean(size.half(), on_half(size, map), halvings - 1));
}

/// The same of texels that are known, and of those that are not.
std::vector<float> mean_of_alike(GridSize size, const std::vector<float>& map,
                                 const std::vector<float>& is_known) {
  std::vector<float> result(map.size());
  for (const float kind : {0.0f, 1.0f}) {
    std::vector<float> part(map.size()), weight(map.size());
    for (std::size_t t = 0; t < map.size(); ++t) {
      weight[t] = is_known[t] == kind ? 1.0f : 0.0f;
      part[t] = weight[t] * map[t];
    }
    part = neighborhood_mean(size, std::move(part));
    weight = neighborhood_mean(size, std::move(weight));
    for (std::size_t t = 0; t < map.size(); ++t)
      if (is_known[t] == kind) result[t] = part[t] / weight[t];
  }
  return result;
}

}  // namespace

PosteriorSample draw_posterior(const PatchObjective& objective, const BandBlocks& blocks,
                               std::uint64_t seed, std::uint64_t index,
                               const std::function<bool()>& must_end) {
  constexpr int most_steps = 10;
  constexpr double tolerance = 0.05;
  const std::size_t images = objective.weights().size();
  std::uint64_t state = seed + 0x5851f42d4c957f2du * (index + 1);
  const std::uint64_t own_seed = Random::splitmix(state);
  TexelMaps data = objective.weights();
  parallel_for(images, [&](std::size_t i) {
    Random random = make_random(own_seed, 1000 + i);
    for (std::size_t t = 0; t < data[i].size(); ++t)
      data[i][t] *= sign(random) * std::sqrt(objective.shares()[i][t]);
  });
  PosteriorSample sample{.off = {}, .pushed = objective.light().gradient(data)};
  TexelMaps right = prior_noise(objective, own_seed);
  add_times(right, 1.0, sample.pushed);
  sample.off = solve_by_conjugate_gradients(objective, blocks, std::move(right), most_steps,
                                            tolerance, must_end);
  return sample;
}

PosteriorErrors posterior_errors(const PatchObjective& objective, const BandBlocks& blocks,
                                 const std::vector<TexelMaps>& draws, double level_error) {
  const GridSize size{objective.capture().width, objective.capture().height};
  const std::size_t numbers = draws[0].size();
  PosteriorErrors result{.deviations = blocks.inverse_diagonal(),
                         .correlation = DenseMatrix(numbers, numbers)};
  std::vector<float> is_known(size.texels(), 0.0f);
  for (const std::vector<float>& weights : objective.weights())
    for (std::size_t t = 0; t < size.texels(); ++t)
      if (weights[t] > 0.0f) is_known[t] = 1.0f;
  parallel_for(numbers, [&](std::size_t n) {
    std::vector<float>& variance = result.deviations[n];
    std::vector<float> relative(size.texels(), 0.0f);
    for (const TexelMaps& draw : draws)
      for (std::size_t t = 0; t < size.texels(); ++t)
        relative[t] += draw[n][t] * draw[n][t] / (variance[t] * static_cast<float>(draws.size()));
    relative = mean_of_alike(size, relative, is_known);
    double of_level = 0.0;
    for (const double shift : blocks.level_shifts()[n])
      of_level += std::pow(level_error * shift, 2);
    for (std::size_t t = 0; t < size.texels(); ++t)
      variance[t] = std::sqrt(variance[t] * relative[t] + static_cast<float>(of_level));
  });
  // Of texels that some image knows.
  DenseMatrix products(numbers, numbers);
  for (const TexelMaps& draw : draws)
    for (std::size_t n = 0; n < numbers; ++n)
      for (std::size_t m = 0; m <= n; ++m)
        for (std::size_t t = 0; t < size.texels(); ++t)
          if (objective.weights()[0][t] > 0.0f)
            products(n, m) += static_cast<double>(draw[n][t] / result.deviations[n][t]) *
                              static_cast<double>(draw[m][t] / result.deviations[m][t]);
  for (std::size_t n = 0; n < numbers; ++n)
    for (std::size_t m = 0; m <= n; ++m)
      result.correlation(n, m) = result.correlation(m, n) =
          products(n, m) / std::sqrt(products(n, n) * products(m, m));
  return result;
}

}  // namespace lamina::detail
