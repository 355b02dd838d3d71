// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/steps/band_blocks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/small_matrix.h"
#include "lamina/skin/acquire/inversion/texels/local_model.h"
#include "lamina/skin/acquire/inversion/texels/skin_at_texel.h"

namespace lamina::detail {
namespace {

constexpr int least_side = 6;  // of the coarsest grid

/// A triangle as it is stored.
struct StoredTriangle {
  const float* values;
  struct Row {
    const float* values;
    double operator[](std::size_t column) const { return static_cast<double>(values[column]); }
  };
  Row operator[](std::size_t row) const { return {values + row * (row + 1) / 2}; }
};

/// Calls body(begin, end) for parts of the texels, on all threads.
template <class Body>
void for_chunks(std::size_t texels, const Body& body) {
  constexpr std::size_t chunk = 2048;
  parallel_for((texels + chunk - 1) / chunk,
               [&](std::size_t c) { body(c * chunk, std::min(texels, (c + 1) * chunk)); });
}

/// Maps on the half grid.
TexelMaps halves(const GridSize& size, const TexelMaps& maps) {
  TexelMaps result(maps.size());
  parallel_for(maps.size(), [&](std::size_t m) { result[m] = on_half(size, maps[m]); });
  return result;
}

/// What a map gives to texels up to half a millimeter around each.
std::vector<float> spread(GridSize size, std::vector<float> map, double mm_per_texel) {
  constexpr double reach = 1.6;  // [mm]
  if (mm_per_texel >= reach || std::min(size.width, size.height) < 4) return map;
  return on_fine(size, spread(size.half(), on_half(size, map), 2.0 * mm_per_texel));
}

}  // namespace

BandBlocks::BandBlocks(const PatchObjective& objective, const TexelMaps& coordinates,
                       const TexelMaps& level)
    : numbers_(coordinates.size()), images_(objective.weights().size()) {
  const InversionTables& tables = objective.tables();
  const std::size_t texels = coordinates[0].size();
  Octave octave{.size = {objective.capture().width, objective.capture().height}};
  octave.slopes.assign(images_ * numbers_, std::vector<float>(texels));
  // Texels that nothing is known of change what those around them show.
  TexelMaps reached = objective.weights();
  parallel_for(images_, [&](std::size_t i) {
    const PatchCapture& capture = objective.capture();
    for (std::size_t t = 0; t < texels; ++t) {
      const float weight = reached[i][t] * level[i][t];
      reached[i][t] = weight * weight * objective.shares()[i][t];
    }
    const std::vector<float> around = spread(octave.size, reached[i], capture.mm_per_texel);
    for (std::size_t t = 0; t < texels; ++t)
      reached[i][t] = std::sqrt(std::max(reached[i][t], around[t]));
  });
  for_chunks(texels, [&](std::size_t begin, std::size_t end) {
    LocalModel model(objective.capture(), tables);
    TexelNumbers at = {};
    for (std::size_t t = begin; t < end; ++t) {
      for (std::size_t n = 0; n < numbers_; ++n) at[n] = static_cast<double>(coordinates[n][t]);
      model.predict(std::span(at).first(numbers_));
      for (std::size_t i = 0; i < images_; ++i) {
        const auto scale = static_cast<double>(reached[i][t]);
        for (std::size_t n = 0; n < numbers_; ++n)
          octave.slopes[i * numbers_ + n][t] = static_cast<float>(scale * model.by_number[i][n]);
      }
    }
  });
  // The same change of all texels.
  const auto all = static_cast<double>(texels);
  for (std::size_t n = 0; n < numbers_; ++n)
    for (std::size_t m = 0; m <= n; ++m) {
      double sum = all * objective.prior_precision()(n, m);
      for (std::size_t i = 0; i < images_; ++i)
        sum += dot({octave.slopes[i * numbers_ + n]}, {octave.slopes[i * numbers_ + m]});
      whole_[n][m] = sum;
    }
  whole_ = cholesky(whole_, numbers_);
  find_level_shifts(objective, octave.slopes);
  // Noise that moves the images by about as much in each number.
  TexelMaps noise(numbers_, std::vector<float>(texels));
  for (std::size_t n = 0; n < numbers_; ++n) {
    double squares = 0.0;
    for (std::size_t i = 0; i < images_; ++i)
      for (const float slope : octave.slopes[i * numbers_ + n])
        squares += static_cast<double>(slope) * static_cast<double>(slope);
    const double size = std::sqrt(static_cast<double>(texels * images_) / std::max(squares, 1e-30));
    Random random = make_random(1, n);
    for (float& value : noise[n]) value = static_cast<float>(random.uniform() < 0.5 ? -size : size);
  }
  TexelMaps changes = objective.light().change(noise);
  for (std::size_t i = 0; i < images_; ++i)
    for (std::size_t t = 0; t < texels; ++t)
      changes[i][t] *= objective.weights()[i][t] * std::sqrt(objective.shares()[i][t]);
  // What each number does to each image without light that travels, for comparison.
  TexelMaps expected(images_ * numbers_);
  for (std::size_t e = 0; e < expected.size(); ++e) {
    expected[e] = octave.slopes[e];
    for (std::size_t t = 0; t < texels; ++t) expected[e][t] *= noise[e % numbers_][t];
  }
  std::vector<float> known(texels, 0.0f);  // whether it changes any image
  for (const std::vector<float>& weights : reached)
    for (std::size_t t = 0; t < texels; ++t)
      if (weights[t] > 0.0f) known[t] = 1.0f;
  std::vector<MapSmoothness> smoothness = objective.smoothness();
  while (true) {
    const bool is_last = std::min(octave.size.width, octave.size.height) < 2 * least_side;
    const GridSize size = octave.size;
    decompose(octave, octaves_.size(), measured_shares(octave, changes, expected), objective,
              smoothness);
    for (std::vector<float>& slopes : octave.slopes)
      for (std::size_t t = 0; t < slopes.size(); ++t) slopes[t] *= std::sqrt(known[t]);
    TexelMaps coarser = is_last ? TexelMaps() : halves(size, octave.slopes);
    octave.slopes.clear();
    octaves_.push_back(std::move(octave));
    if (is_last) break;
    for (MapSmoothness& each : smoothness)
      for (std::vector<float>* share : {&each.first.share, &each.third.share})
        if (!share->empty()) *share = on_half(size, *share);
    octave = {.size = size.half(), .slopes = std::move(coarser), .lower = {}};
    // A texel of which a part is known counts by that part, its slopes by the root of it.
    known = on_half(size, known);
    for (std::vector<float>& slopes : octave.slopes)
      for (std::size_t t = 0; t < slopes.size(); ++t)
        if (known[t] > 0.0f) slopes[t] /= std::sqrt(known[t]);
    changes = halves(size, changes);
    expected = halves(size, expected);
  }
}

std::vector<double> BandBlocks::measured_shares(const Octave& octave, const TexelMaps& changes,
                                                const TexelMaps& expected) const {
  constexpr double least = 0.02, most = 1.2;
  constexpr std::size_t least_texels = 100;
  std::vector<double> shares(images_ * numbers_, 1.0);
  parallel_for(images_, [&](std::size_t i) {
    // Least squares of the change by what each number is expected to do, held near 1.
    const std::vector<float> change = details(octave.size, changes[i]);
    std::vector<std::vector<float>> by_number;
    for (std::size_t n = 0; n < numbers_; ++n)
      by_number.push_back(details(octave.size, expected[i * numbers_ + n]));
    const auto product = [](const std::vector<float>& a, const std::vector<float>& b) {
      double sum = 0.0;
      for (std::size_t t = 0; t < a.size(); ++t)
        sum += static_cast<double>(a[t]) * static_cast<double>(b[t]);
      return sum;
    };
    const double held =
        product(change, change) * (change.size() < least_texels ? 10.0 : 1e-3) + 1e-30;
    TexelMatrix matrix = {};
    TexelNumbers right = {};
    for (std::size_t n = 0; n < numbers_; ++n) {
      for (std::size_t m = 0; m <= n; ++m) matrix[n][m] = product(by_number[n], by_number[m]);
      matrix[n][n] += held;
      right[n] = product(by_number[n], change) + held;
    }
    const TexelNumbers found = solve_cholesky(cholesky(matrix, numbers_), numbers_, right);
    for (std::size_t n = 0; n < numbers_; ++n)
      shares[i * numbers_ + n] = std::clamp(found[n], least, most);
  });
  return shares;
}

void BandBlocks::find_level_shifts(const PatchObjective& objective, const TexelMaps& slopes) {
  const TexelMaps& weights = objective.weights();
  level_shifts_.assign(numbers_, std::vector<double>(images_, 0.0));
  TexelMatrix matrix = {};
  std::vector<TexelNumbers> by_image(images_, TexelNumbers{});
  double known = 0.0;
  for (std::size_t i = 0; i < images_; ++i)
    for (std::size_t t = 0; t < weights[i].size(); ++t) {
      if (weights[i][t] == 0.0f) continue;
      known += 1.0 / static_cast<double>(images_);
      const double share = std::sqrt(static_cast<double>(objective.shares()[i][t]));
      const double level = share * static_cast<double>(weights[i][t] * objective.measured()[i][t]);
      for (std::size_t n = 0; n < numbers_; ++n) {
        const auto slope = static_cast<double>(slopes[i * numbers_ + n][t]);
        by_image[i][n] += slope * level;
        for (std::size_t m = 0; m <= n; ++m)
          matrix[n][m] += slope * static_cast<double>(slopes[i * numbers_ + m][t]);
      }
    }
  for (std::size_t n = 0; n < numbers_; ++n)
    for (std::size_t m = 0; m <= n; ++m) matrix[n][m] += known * objective.prior_precision()(n, m);
  const TexelMatrix lower = cholesky(matrix, numbers_);
  for (std::size_t i = 0; i < images_; ++i) {
    const TexelNumbers shift = solve_cholesky(lower, numbers_, by_image[i]);
    for (std::size_t n = 0; n < numbers_; ++n) level_shifts_[n][i] = shift[n];
  }
}

void BandBlocks::decompose(Octave& octave, std::size_t number, const std::vector<double>& shares,
                           const PatchObjective& objective,
                           const std::vector<MapSmoothness>& smoothness) const {
  const std::size_t entries = numbers_ * (numbers_ + 1) / 2;
  // Square of the wave number, of differences of texels of the finest grid.
  const double wave_square = 4.0 * std::pow(0.25, static_cast<double>(number));
  constexpr double third_power = 4.0;  // by trial: 3 and 4 take fewer steps than .2 to 1
  octave.lower.resize(octave.size.texels() * entries);
  for_chunks(octave.size.texels(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      TexelMatrix block = {};
      for (std::size_t n = 0; n < numbers_; ++n)
        for (std::size_t m = 0; m <= n; ++m) {
          block[n][m] = objective.prior_precision()(n, m);
          if (m == n)
            block[n][m] += wave_square * smoothness[n].first.at(t) +
                           third_power * std::pow(wave_square, 3) * smoothness[n].third.at(t);
          for (std::size_t i = 0; i < images_; ++i) {
            const std::size_t a = i * numbers_ + n, b = i * numbers_ + m;
            block[n][m] += shares[a] * shares[b] * static_cast<double>(octave.slopes[a][t]) *
                           static_cast<double>(octave.slopes[b][t]);
          }
        }
      const TexelMatrix lower = cholesky(block, numbers_);
      float* to = &octave.lower[t * entries];
      for (std::size_t n = 0; n < numbers_; ++n)
        for (std::size_t m = 0; m <= n; ++m) *to++ = static_cast<float>(lower[n][m]);
    }
  });
}

TexelMaps BandBlocks::solve(const TexelMaps& b) const {
  const std::size_t entries = numbers_ * (numbers_ + 1) / 2;
  std::vector<TexelMaps> parts;  // [octave]
  TexelMaps left = b;
  for (std::size_t o = 0; o < octaves_.size(); ++o) {
    const GridSize size = octaves_[o].size;
    const bool is_last = o + 1 == octaves_.size();
    TexelMaps &part = parts.emplace_back(numbers_), half(numbers_);
    parallel_for(numbers_, [&](std::size_t n) {
      if (!is_last) half[n] = on_half(size, left[n]);
      part[n] = is_last ? left[n] : details(size, left[n]);
    });
    left = std::move(half);
    for_chunks(size.texels(), [&](std::size_t begin, std::size_t end) {
      TexelNumbers at = {};
      for (std::size_t t = begin; t < end; ++t) {
        for (std::size_t n = 0; n < numbers_; ++n) at[n] = static_cast<double>(part[n][t]);
        const StoredTriangle lower{&octaves_[o].lower[t * entries]};
        const TexelNumbers x = solve_cholesky(lower, numbers_, at);
        for (std::size_t n = 0; n < numbers_; ++n) part[n][t] = static_cast<float>(x[n]);
      }
    });
  }
  // The transpose of taking apart. On a grid of half the size a texel counts for four, which makes
  // the transpose of on_half the same as on_fine.
  TexelMaps sum = std::move(parts.back());
  for (std::size_t o = octaves_.size() - 1; o-- > 0;)
    parallel_for(numbers_, [&](std::size_t n) {
      const GridSize size = octaves_[o].size;
      std::vector<float> fine = details(size, parts[o][n]);
      const std::vector<float> coarse = on_fine(size, sum[n]);
      for (std::size_t t = 0; t < fine.size(); ++t) fine[t] += coarse[t];
      sum[n] = std::move(fine);
    });
  TexelNumbers mean = {};
  for (std::size_t n = 0; n < numbers_; ++n)
    for (const float value : b[n]) mean[n] += static_cast<double>(value);
  mean = solve_cholesky(whole_, numbers_, mean);
  for (std::size_t n = 0; n < numbers_; ++n)
    for (float& value : sum[n]) value += static_cast<float>(mean[n]);
  return sum;
}

TexelMaps BandBlocks::inverse_diagonal() const {
  const std::size_t entries = numbers_ * (numbers_ + 1) / 2;
  TexelMaps sum;
  for (std::size_t o = octaves_.size(); o-- > 0;) {
    const GridSize size = octaves_[o].size;
    // Of the waves of a grid one in four is left for the next one.
    const double part =
        std::pow(0.25, static_cast<double>(o)) * (o + 1 == octaves_.size() ? 1.0 : 0.75);
    if (sum.empty())
      sum.assign(numbers_, std::vector<float>(size.texels(), 0.0f));
    else
      for (std::vector<float>& map : sum) map = on_fine(size, map);
    for_chunks(size.texels(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const StoredTriangle lower{&octaves_[o].lower[t * entries]};
        for (std::size_t n = 0; n < numbers_; ++n) {
          TexelNumbers unit = {};
          unit[n] = part;
          sum[n][t] += static_cast<float>(solve_cholesky(lower, numbers_, unit)[n]);
        }
      }
    });
  }
  return sum;
}

}  // namespace lamina::detail
