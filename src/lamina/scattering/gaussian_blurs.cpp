// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/gaussian_blurs.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "lamina/scattering/gaussian_blur_kernels.h"

namespace lamina {
namespace {

using detail::frame;

/// Variances on the finest grid, and further ones on a coarser grid in its own texel². The step to
/// a coarser grid and the way back add 3/4 of a finer texel² each.
constexpr std::array<double, finest_rungs> finest = {0.0, 0.25, 0.5, 1.0, 2.0, 4.0};
constexpr std::array<double, 2> coarser = {2.0, 4.0};
constexpr double step_variance = 0.75;

/// How far each coarser rung is blurred from the one before, in its grid's texel². The same on all
/// coarser grids.
constexpr std::array<double, 2> coarser_steps = {
    coarser[0] - (finest.back() + 2 * step_variance) / 4.0, coarser[1] - coarser[0]};

/// Taps e^-t I_n(t) of the discrete Gaussian, to where they fall below 1e-6, with a sum of 1.
std::vector<float> gaussian_taps(double t) {
  std::vector<double> taps;
  double sum = 0.0;
  for (std::size_t n = 0; n <= frame; ++n) {
    const double tap = std::exp(-t) * std::cyl_bessel_i(static_cast<double>(n), t);
    if (tap < 1e-6) break;
    taps.push_back(tap);
    sum += n == 0 ? tap : 2.0 * tap;
  }
  std::vector<float> result;
  for (const double tap : taps) result.push_back(static_cast<float>(tap / sum));
  return result;
}

/// The place that a mirror at both ends shows at i.
int reflected(int i, int size) {
  const int period = 2 * size;
  i = ((i % period) + period) % period;
  return i < size ? i : period - 1 - i;
}

float* row_of(Plane& plane, int y) {
  return plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.width;
}
const float* row_of(const Plane& plane, int y) {
  return plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.width;
}

/// A row with a frame to either side, in which it is mirrored.
class FramedRow {
 public:
  explicit FramedRow(int size) : size_(size), values_(static_cast<std::size_t>(size) + 4 * frame) {}
  [[nodiscard]] float* data() { return values_.data() + 2 * frame; }
  void mirror() {
    for (int i = 1; i <= static_cast<int>(frame); ++i) {
      data()[-i] = data()[reflected(-i, size_)];
      data()[size_ + i - 1] = data()[reflected(size_ + i - 1, size_)];
    }
  }

 private:
  int size_;
  std::vector<float> values_;
};

/// Blurs a plane and hands over each row as it is done.
template <class Use>
Plane blurred(const Plane& plane, const std::vector<float>& taps, const Use& use) {
  Plane result = make_plane(plane.width, plane.height);
  FramedRow sum(plane.width);
  const int reach = static_cast<int>(taps.size()) - 1;
  std::vector<const float*> rows(static_cast<std::size_t>(2 * reach + 1));
  const auto size = static_cast<std::size_t>(plane.width);
  for (int y = 0; y < plane.height; ++y) {
    for (int n = -reach; n <= reach; ++n)
      rows[static_cast<std::size_t>(n + reach)] = row_of(plane, reflected(y + n, plane.height));
    detail::combine_rows(rows, taps, sum.data(), size);
    sum.mirror();
    detail::convolve_row(sum.data(), taps, row_of(result, y), size);
    use(y, row_of(result, y));
  }
  return result;
}

Plane blurred(const Plane& plane, const std::vector<float>& taps) {
  return blurred(plane, taps, [](int, const float*) {});
}

Plane halved(const Plane& plane) {
  Plane result = make_plane(plane.width / 2, plane.height / 2);
  FramedRow sum(plane.width);
  // (1 3 3 1) / 8 of four rows is (1 1) of (r0 + r3) / 8 and 3 / 8 (r1 + r2): two pairs of rows
  // that stand symmetrically, with a centre of weight 0 in between.
  const std::array<float, 3> taps = {0.0f, 0.375f, 0.125f};
  for (int y = 0; y < result.height; ++y) {
    std::array<const float*, 5> rows;
    rows[0] = row_of(plane, reflected(2 * y - 1, plane.height));
    rows[1] = row_of(plane, 2 * y);
    rows[2] = rows[1];
    rows[3] = row_of(plane, 2 * y + 1);
    rows[4] = row_of(plane, reflected(2 * y + 2, plane.height));
    detail::combine_rows(rows, taps, sum.data(), static_cast<std::size_t>(plane.width));
    sum.mirror();
    detail::halve_row(sum.data(), row_of(result, y), static_cast<std::size_t>(result.width));
  }
  return result;
}

/// Between the two coarse rows next to row y of the finer grid.
void row_between(const Plane& coarse, int y, FramedRow& row) {
  const float* near = row_of(coarse, y / 2);
  const float* far = row_of(coarse, reflected(y % 2 == 0 ? y / 2 - 1 : y / 2 + 1, coarse.height));
  const std::array<const float*, 3> rows = {far, near, far};
  const std::array<float, 2> taps = {0.75f, 0.125f};
  detail::combine_rows(rows, taps, row.data(), static_cast<std::size_t>(coarse.width));
  row.mirror();
}

/// The rungs of the coarser grids, [level - 1], two each.
std::vector<std::array<Plane, 2>> coarse_rungs(const BlurLadder& ladder, const Plane& last) {
  std::vector<std::array<Plane, 2>> rungs;
  const std::array<std::vector<float>, 2> taps = {gaussian_taps(coarser_steps[0]),
                                                  gaussian_taps(coarser_steps[1])};
  for (int level = 1; level <= ladder.levels; ++level) {
    Plane first = blurred(halved(rungs.empty() ? last : rungs.back()[1]), taps[0]);
    Plane second = blurred(first, taps[1]);
    rungs.push_back({std::move(first), std::move(second)});
  }
  return rungs;
}

/// What one power's weights make of the coarser rungs and the mean, on the grid of level 1.
Plane sum_of_rungs(const std::vector<std::array<Plane, 2>>& rungs, const float* weights,
                   float mean) {
  Plane sum = rungs.back()[0];
  const std::size_t last = rungs.size() - 1;
  for (std::size_t i = 0; i < sum.values.size(); ++i)
    sum.values[i] = weights[2 * last] * sum.values[i] +
                    weights[2 * last + 1] * rungs[last][1].values[i] + weights[2 * last + 2] * mean;
  for (std::size_t level = last; level-- > 0;) {
    const auto& [first, second] = rungs[level];
    Plane finer = make_plane(first.width, first.height);
    FramedRow between(sum.width);
    for (int y = 0; y < finer.height; ++y) {
      row_between(sum, y, between);
      detail::add_doubled_row(between.data(), row_of(first, y), weights[2 * level],
                              row_of(second, y), weights[2 * level + 1], row_of(finer, y),
                              static_cast<std::size_t>(finer.width));
    }
    sum = std::move(finer);
  }
  return sum;
}

/// Transfer of each rung at a spatial frequency [1/texel], what folds back left out.
std::vector<double> rung_transfers(const BlurLadder& ladder, double k) {
  std::vector<double> transfers;
  for (const double v : finest) transfers.push_back(std::exp(-v * (1.0 - std::cos(k))));
  double down = transfers.back(), up = 1.0;
  for (int level = 1; level <= ladder.levels; ++level) {
    const double at = k * std::ldexp(1.0, level);  // per texel of this grid
    const double step = at < 2.0 * std::numbers::pi ? std::pow(std::cos(at / 4.0), 3) : 0.0;
    down *= step;
    up *= step;
    for (const double t : coarser_steps) {
      down *= std::exp(-t * (1.0 - std::cos(at)));
      transfers.push_back(at < std::numbers::pi ? down * up : 0.0);
    }
  }
  transfers.push_back(k == 0.0 ? 1.0 : 0.0);
  return transfers;
}

}  // namespace

BlurLadder make_blur_ladder(int width, int height, double largest_variance) {
  assert(width > 0 && height > 0);
  constexpr int smallest_side = 4;
  int levels = 1;
  while (coarser[1] * std::pow(4.0, levels) < largest_variance &&
         (std::min(width, height) >> (levels + 1)) >= smallest_side)
    ++levels;
  const int multiple = 1 << levels;
  const auto rounded = [&](int size) { return (size + multiple - 1) / multiple * multiple; };
  BlurLadder ladder{.width = rounded(width),
                    .height = rounded(height),
                    .levels = levels,
                    .variances = {finest.begin(), finest.end()}};
  for (int level = 1; level <= levels; ++level)
    for (const double v : coarser) ladder.variances.push_back(v * std::pow(4.0, level));
  ladder.variances.push_back(std::numeric_limits<double>::infinity());
  return ladder;
}

std::vector<double> detail::fit_rungs(std::span<const double> variances, double lowest,
                                      std::size_t rung_count, const RungTransfers& transfers_at) {
  constexpr int count = 400;
  constexpr double ridge = 1e-4, weight_of_total = 100.0;
  const auto rungs = static_cast<Eigen::Index>(rung_count);
  const auto gaussians = static_cast<Eigen::Index>(variances.size());
  Eigen::MatrixXd a(count + 1, rungs), wanted(count + 1, gaussians);
  for (Eigen::Index j = 0; j <= count; ++j) {
    const double k =
        j == 0 ? 0.0 : std::numbers::pi * std::pow(lowest, 1.0 - static_cast<double>(j) / count);
    const double weight = j == 0 ? weight_of_total : 1.0;
    // k²/2 as far as blurs on the grid can have it: the mean over directions of its fourth order
    // in k is right.
    const double rise = 1.0 - std::cos(k), half_square = rise + rise * rise / 8.0;
    const std::vector<double> transfers = transfers_at(k);
    for (Eigen::Index i = 0; i < rungs; ++i)
      a(j, i) = weight * transfers[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 0; i < gaussians; ++i)
      wanted(j, i) = weight * std::exp(-variances[static_cast<std::size_t>(i)] * half_square);
  }
  Eigen::MatrixXd all(count + 1 + rungs, rungs), of(count + 1 + rungs, gaussians);
  all << a, ridge * std::sqrt(count + 1.0) * Eigen::MatrixXd::Identity(rungs, rungs);
  of << wanted, Eigen::MatrixXd::Zero(rungs, gaussians);
  Eigen::MatrixXd weights = all.householderQr().solve(of);
  for (Eigen::Index i = 0; i < gaussians; ++i) weights.col(i) /= weights.col(i).sum();
  return {weights.data(), weights.data() + weights.size()};
}

std::vector<double> rungs_of_gaussians(const BlurLadder& ladder,
                                       std::span<const double> variances) {
  return detail::fit_rungs(variances, 1.0 / std::max(ladder.width, ladder.height),
                           ladder.variances.size(),
                           [&](double k) { return rung_transfers(ladder, k); });
}

std::vector<Plane> apply(const BlurLadder& ladder, const Plane& input, const Plane& coordinate,
                         std::span<const MappedOperator* const> operators) {
  assert(input.width == ladder.width && input.height == ladder.height);
  assert(coordinate.width == ladder.width && coordinate.height == ladder.height);
  const std::size_t rungs = ladder.variances.size();
  const auto width = static_cast<std::size_t>(ladder.width);
  std::vector<Plane> results;
  for (std::size_t o = 0; o < operators.size(); ++o)
    results.push_back(make_plane(ladder.width, ladder.height));
  std::vector<float> coefficients;
  const auto add = [&](std::size_t rung, int y, const float* row) {
    for (std::size_t o = 0; o < operators.size(); ++o) {
      coefficients.clear();
      for (std::size_t p = 0; p < operators[o]->powers; ++p)
        coefficients.push_back(operators[o]->weights[p * rungs + rung]);
      detail::add_times_polynomial(row, row_of(coordinate, y), coefficients, row_of(results[o], y),
                                   width);
    }
  };
  for (int y = 0; y < input.height; ++y) add(0, y, row_of(input, y));
  Plane last;
  for (std::size_t rung = 1; rung < finest_rungs; ++rung)
    last = blurred(rung == 1 ? input : last, gaussian_taps(finest[rung] - finest[rung - 1]),
                   [&](int y, const float* row) { add(rung, y, row); });

  const auto coarse = coarse_rungs(ladder, last);
  const double sum = std::accumulate(input.values.begin(), input.values.end(), 0.0);
  const auto mean = static_cast<float>(sum / static_cast<double>(input.values.size()));
  for (std::size_t o = 0; o < operators.size(); ++o) {
    std::vector<Plane> sums;
    std::vector<FramedRow> between;
    std::vector<const float*> rows;
    for (std::size_t p = 0; p < operators[o]->powers; ++p) {
      sums.push_back(sum_of_rungs(coarse, &operators[o]->weights[p * rungs + finest_rungs], mean));
      between.emplace_back(sums.back().width);
    }
    for (FramedRow& row : between) rows.push_back(row.data());
    for (int y = 0; y < ladder.height; ++y) {
      for (std::size_t p = 0; p < sums.size(); ++p) row_between(sums[p], y, between[p]);
      detail::add_doubled_polynomial(rows, row_of(coordinate, y), row_of(results[o], y), width);
    }
  }
  return results;
}

std::vector<Plane> apply_reciprocally(const BlurLadder& ladder, const Plane& input,
                                      const Plane& coordinate,
                                      std::span<const MappedOperator* const> operators) {
  const std::size_t rungs = ladder.variances.size();
  std::size_t most_powers = 1;
  for (const MappedOperator* each : operators) most_powers = std::max(most_powers, each->powers);
  std::vector<Plane> sums;
  Plane light = input;  // times coordinate^q where it enters
  for (std::size_t q = 0; q < most_powers; ++q) {
    // What is left of each power's binomial for where light comes out.
    std::vector<MappedOperator> rest(operators.size());
    std::vector<const MappedOperator*> used;
    std::vector<std::size_t> index;
    for (std::size_t o = 0; o < operators.size(); ++o) {
      const MappedOperator& whole = *operators[o];
      if (whole.powers <= q) continue;
      rest[o].powers = whole.powers - q;
      double choose = 1.0;  // of p = q + m powers those q that belong to where light enters
      for (std::size_t m = 0; m < rest[o].powers; ++m) {
        const double p = static_cast<double>(q + m);
        if (m > 0) choose *= p / static_cast<double>(m);
        const auto share = static_cast<float>(choose * std::exp2(-p));
        for (std::size_t j = 0; j < rungs; ++j)
          rest[o].weights.push_back(share * whole.weights[(q + m) * rungs + j]);
      }
      used.push_back(&rest[o]);
      index.push_back(o);
    }
    std::vector<Plane> parts = apply(ladder, light, coordinate, used);
    if (q == 0) {
      sums = std::move(parts);
    } else {
      for (std::size_t u = 0; u < used.size(); ++u)
        for (std::size_t i = 0; i < light.values.size(); ++i)
          sums[index[u]].values[i] += parts[u].values[i];
    }
    for (std::size_t i = 0; i < light.values.size(); ++i) light.values[i] *= coordinate.values[i];
  }
  return sums;
}

Plane mirrored(const BlurLadder& ladder, Plane plane) {
  if (plane.width == ladder.width && plane.height == ladder.height) return plane;
  Plane result = make_plane(ladder.width, ladder.height);
  for (int y = 0; y < ladder.height; ++y) {
    const float* from = row_of(plane, reflected(y, plane.height));
    for (int x = 0; x < ladder.width; ++x) row_of(result, y)[x] = from[reflected(x, plane.width)];
  }
  return result;
}

Plane cropped(Plane plane, int width, int height) {
  if (plane.width == width && plane.height == height) return plane;
  Plane result = make_plane(width, height);
  for (int y = 0; y < height; ++y) std::copy_n(row_of(plane, y), width, row_of(result, y));
  return result;
}

}  // namespace lamina
