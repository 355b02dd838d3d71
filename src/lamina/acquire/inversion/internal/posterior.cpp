// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/acquire/inversion/internal/posterior.h"

#include <cmath>
#include <utility>

#include "lamina/acquire/inversion/internal/gauss_newton.h"
#include "lamina/acquire/inversion/internal/skin_at_texel.h"
#include "lamina/core/parallel.h"
#include "lamina/core/random.h"
#include "lamina/core/small_matrix.h"

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
    const auto weight = static_cast<float>(std::sqrt(objective.smoothness()[n]));
    for_neighbors(capture.width, capture.height, [&](std::size_t a, std::size_t b) {
      const float flow = weight * sign(random);
      noise[n][a] += flow;
      noise[n][b] -= flow;
    });
  });
  parallel_for(numbers, [&](std::size_t n) {
    for (std::size_t m = 0; m <= n; ++m)
      for (std::size_t t = 0; t < size.texels(); ++t)
        noise[n][t] += static_cast<float>(root[n][m]) * white[m][t];
  });
  return noise;
}

/// Means of a map over about 16 x 16 texels.
std::vector<float> neighborhood_mean(GridSize size, std::vector<float> map, int halvings = 4) {
  if (halvings == 0 || std::min(size.width, size.height) < 8) return map;
  return on_fine(size, neighborhood_mean(size.half(), on_half(size, map), halvings - 1));
}

}  // namespace

PosteriorSample draw_posterior(const PatchObjective& objective, const BandBlocks& blocks,
                               std::uint64_t seed, std::uint64_t index,
                               const std::function<bool()>& must_end) {
  constexpr int most_steps = 14;
  constexpr double tolerance = 0.03;
  const std::size_t images = objective.weights().size();
  std::uint64_t state = seed + 0x5851f42d4c957f2du * (index + 1);
  const std::uint64_t own_seed = Random::splitmix(state);
  TexelMaps data = objective.weights();
  parallel_for(images, [&](std::size_t i) {
    Random random = make_random(own_seed, 1000 + i);
    for (std::size_t t = 0; t < data[i].size(); ++t)
      data[i][t] *= sign(random) * std::sqrt(objective.shares()[i][t]);
  });
  const TexelMaps by_data = objective.light().gradient(data);
  TexelMaps right = prior_noise(objective, own_seed);
  add_times(right, 1.0, by_data);
  PosteriorSample sample;
  sample.off = solve_by_conjugate_gradients(objective, blocks, std::move(right), most_steps,
                                            tolerance, must_end);
  for (std::size_t n = 0; n < sample.off.size(); ++n)
    sample.told.push_back(dot({by_data[n]}, {sample.off[n]}));
  return sample;
}

PosteriorErrors posterior_errors(const PatchObjective& objective, const BandBlocks& blocks,
                                 const std::vector<TexelMaps>& draws) {
  const GridSize size{objective.capture().width, objective.capture().height};
  const std::size_t numbers = draws[0].size();
  PosteriorErrors result{.deviations = blocks.inverse_diagonal(),
                         .correlation = DenseMatrix(numbers, numbers)};
  parallel_for(numbers, [&](std::size_t n) {
    std::vector<float>& variance = result.deviations[n];
    std::vector<float> relative(size.texels(), 0.0f);
    for (const TexelMaps& draw : draws)
      for (std::size_t t = 0; t < size.texels(); ++t)
        relative[t] += draw[n][t] * draw[n][t] / (variance[t] * static_cast<float>(draws.size()));
    relative = neighborhood_mean(size, std::move(relative));
    for (std::size_t t = 0; t < size.texels(); ++t)
      variance[t] = std::sqrt(variance[t] * relative[t]);
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
