// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_layer.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <numbers>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"
#include "solve/scattering/only_target.h"

namespace lamina::detail {
namespace {

const DirectionGrid matched_grid = make_direction_grid(std::vector<double>{1.0}, 12);

Layer scattering_layer(double g, double thickness) {
  return {.medium = {.sigma_a = 0.2, .sigma_s = 3.0, .g = g}, .thickness = thickness};
}

// The peak that is cut off scatters, but nowhere new: the mean cosine stays what it was.
TEST(TruncatedPhase, KeepsTheMeanCosine) {
  for (const double g : {-0.95, -0.3, 0.0, 0.5, 0.9, 0.99}) {
    const TruncatedPhase phase = truncate(HenyeyGreenstein{g}, 16);
    const double rest = 1.0 - phase.forward_peak - phase.backward_peak;
    const double mean = phase.moments.size() > 1 ? rest * phase.moments[1] : 0.0;
    EXPECT_NEAR(mean + phase.forward_peak - phase.backward_peak, g, 1e-14) << "g " << g;
    EXPECT_DOUBLE_EQ(phase.moments[0], 1.0);
  }
}

TEST(TruncatedPhase, LeavesAShortSeriesAlone) {
  const TruncatedPhase phase = truncate(Rayleigh{}, 16);
  EXPECT_EQ(phase.forward_peak, 0.0);
  ASSERT_EQ(phase.moments.size(), 3U);
  EXPECT_NEAR(phase.moments[2], 0.1, 1e-15);  // 3/4 (1 + x^2) has the moment 1/10
}

// Witness: the closed form of Henyey and Greenstein, summed over azimuth.
TEST(PhaseMode, ModesAddUpToThePhaseFunction) {
  const double g = 0.6;
  std::vector<double> moments;
  for (int l = 0; l < 80; ++l) moments.push_back(std::pow(g, l));
  const std::vector<double> cos = {0.1, 0.55, 1.0, 0.9};
  for (const double phi : {0.0, 0.7, 2.0, std::numbers::pi}) {
    Matrix forward(4, 4), backward(4, 4);
    for (int m = 0; m < 80; ++m) {
      const PhaseMode mode = phase_mode(moments, cos, m);
      const double factor = (m == 0 ? 1.0 : 2.0) * std::cos(m * phi);
      for (std::size_t k = 0; k < 16; ++k) {
        forward.values[k] += factor * mode.forward.values[k];
        backward.values[k] += factor * mode.backward.values[k];
      }
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        const double sin2 = std::sqrt((1.0 - cos[i] * cos[i]) * (1.0 - cos[j] * cos[j]));
        const auto expected = [&](double side) {
          return 4.0 * std::numbers::pi *
                 evaluate(HenyeyGreenstein{g}, side * cos[i] * cos[j] + sin2 * std::cos(phi));
        };
        EXPECT_NEAR(forward(i, j), expected(1.0), 1e-9) << i << " " << j << " phi " << phi;
        EXPECT_NEAR(backward(i, j), expected(-1.0), 1e-9) << i << " " << j << " phi " << phi;
      }
  }
}

TEST(LayerOperators, TwoHalvesMakeTheWhole) {
  for (const double g : {-0.5, 0.0, 0.9}) {
    const GridLayer whole = make_grid_layer(scattering_layer(g, 0.7), 1.0, 1.0, matched_grid);
    const GridLayer half = make_grid_layer(scattering_layer(g, 0.35), 1.0, 1.0, matched_grid);
    for (const int m : {0, 1, 4}) {
      const LayerOperators a = layer_operators(whole, m), b = layer_operators(half, m);
      const Matrix pass = product(between(b.reflection, b.reflection), b.transmission);
      const Matrix up = product(b.transmission, product(b.reflection, pass));
      for (std::size_t k = 0; k < up.values.size(); ++k)
        EXPECT_NEAR(b.reflection.values[k] + up.values[k], a.reflection.values[k], 1e-12);
    }
  }
}

TEST(LayerOperators, LightRetracesItsPath) {
  const GridLayer layer = make_grid_layer(scattering_layer(0.8, 2.0), 1.0, 1.0, matched_grid);
  for (const int m : {0, 3}) {
    const LayerOperators operators = layer_operators(layer, m);
    for (const Matrix* matrix : {&operators.reflection, &operators.transmission})
      for (std::size_t i = 0; i < matrix->rows; ++i)
        for (std::size_t j = 0; j < i; ++j)
          EXPECT_NEAR((*matrix)(i, j), (*matrix)(j, i), 1e-14) << i << " " << j;
  }
}

// A layer so thin that light scatters at most once: R = sigma_s d P / (4 mu_i mu_j), in flux.
TEST(LayerOperators, ThinLayerScattersOnce) {
  const double d = 1e-9;
  const GridLayer layer = make_grid_layer(scattering_layer(0.5, d), 1.0, 1.0, matched_grid);
  const LayerOperators operators = layer_operators(layer, 0);
  const PhaseMode mode = phase_mode(layer.moments, layer.cos, 0);
  for (std::size_t i = 0; i < layer.cos.size(); ++i)
    for (std::size_t j = 0; j < layer.cos.size(); ++j) {
      const double scattering = 0.25 * layer.sigma_s * d * layer.weight[i] * layer.weight[j];
      EXPECT_NEAR(operators.reflection(i, j), scattering * mode.backward(i, j),
                  1e-5 * scattering);  // the next order is d sigma_t / mu, up to 1e-6
    }
}

// One slab per lane of a vector, or a few too few for all lanes: the same as one by one, however
// many doublings its neighbours need.
TEST(SlabDoubling, SlabsAreTheSameTogetherAndAlone) {
  constexpr std::size_t n = 17, even = 10, count = 11;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    for (const double opaque : {0.0, 1e-9}) {
      const OnlyTarget only(target);
      std::vector<Matrix> a, b;
      for (std::size_t l = 0; l < count; ++l) {
        Matrix& forward = a.emplace_back(n, n);
        Matrix& backward = b.emplace_back(n, n);
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t j = 0; j < n; ++j) {
            const bool differ = (i < even) != (j < even);
            const double sign = differ && i < j ? -1.0 : 1.0;
            forward(i, j) = 0.02 * sign * std::cos(static_cast<double>(i * j + l));
            backward(i, j) = differ ? 0.0 : 0.01 * std::sin(static_cast<double>(i + j + l));
            if (i == j) forward(i, j) -= 1.0 + 0.1 * static_cast<double>(l);
          }
      }
      std::vector<SlabProblem> problems;
      std::vector<Matrix> r(count, Matrix(n, n)), t = r;
      std::vector<double*> r_of, t_of;
      for (std::size_t l = 0; l < count; ++l) {
        const int doublings = opaque > 0.0 ? 40 : 3 + static_cast<int>(l % 3);
        problems.push_back({.size = n,
                            .even = even,
                            .forward = a[l].values.data(),
                            .backward = b[l].values.data(),
                            .step = opaque > 0.0 ? 0.3 : std::ldexp(2.0, -doublings),
                            .doublings = doublings,
                            .opaque = opaque});
        r_of.push_back(r[l].values.data());
        t_of.push_back(t[l].values.data());
      }
      double_slabs(problems, r_of.data(), t_of.data());
      for (std::size_t l = 0; l < count; ++l) {
        Matrix alone_r(n, n), alone_t(n, n);
        double_slab(problems[l], alone_r.values.data(), alone_t.values.data());
        for (std::size_t k = 0; k < n * n; ++k) {
          EXPECT_NEAR(r[l].values[k], alone_r.values[k], 1e-14) << hwy::TargetName(target);
          EXPECT_NEAR(t[l].values[k], alone_t.values[k], opaque + 1e-14) << hwy::TargetName(target);
        }
      }
    }
}

// Rungs of a ladder are slabs that are doubled less often; opaque slabs stay as they are.
TEST(SlabDoubling, LadderPassesByThinnerSlabs) {
  constexpr std::size_t n = 6, even = 4, count = 5, rungs = 4;
  for (const double opaque : {0.0, 1e-6}) {
    Matrix forward(n, n), backward(n, n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const bool differ = (i < even) != (j < even);
        forward(i, j) = 0.02 * (differ && i < j ? -1.0 : 1.0) * std::cos(double(i * j)) -
                        (i == j ? 1.0 : 0.0);
        backward(i, j) = differ ? 0.0 : 0.01 * std::sin(double(i + j));
      }
    std::vector<SlabProblem> problems;
    for (std::size_t l = 0; l < count; ++l)
      problems.push_back({.size = n,
                          .even = even,
                          .forward = forward.values.data(),
                          .backward = backward.values.data(),
                          .step = std::ldexp(1.0 + double(l), -5),
                          .doublings = 8,
                          .opaque = opaque});
    std::vector<Matrix> r(rungs * count, Matrix(n, n)), t = r;
    std::vector<double*> r_of, t_of;
    for (std::size_t q = 0; q < rungs * count; ++q) {
      r_of.push_back(r[q].values.data());
      t_of.push_back(t[q].values.data());
    }
    double_slab_ladder(problems, rungs, r_of.data(), t_of.data());
    for (std::size_t rung = 0; rung < rungs; ++rung)
      for (std::size_t l = 0; l < count; ++l) {
        SlabProblem thinner = problems[l];
        thinner.doublings -= int(rungs - 1 - rung);
        Matrix alone_r(n, n), alone_t(n, n);
        double_slab(thinner, alone_r.values.data(), alone_t.values.data());
        for (std::size_t k = 0; k < n * n; ++k) {
          EXPECT_NEAR(r[rung * count + l].values[k], alone_r.values[k], 1e-14);
          EXPECT_NEAR(t[rung * count + l].values[k], alone_t.values[k], opaque + 1e-14);
        }
      }
  }
}

// The states of odd azimuthal modes change sign under reciprocity. Witness: the same slab by small
// steps of its differential equations, R' = B + A R + R A + R B R and T' = (A + R B) T.
TEST(SlabDoubling, SlabSolvesTheRiccatiEquationWithOddStates) {
  constexpr int n = 4, even = 2;
  const double A[n][n] = {{-1.0, 0.2, 0.3, 0.1},
                          {0.2, -1.4, 0.05, 0.2},
                          {-0.3, -0.05, -1.1, 0.1},
                          {-0.1, -0.2, 0.1, -1.6}};
  const double B[n][n] = {
      {0.2, 0.1, 0.0, 0.0}, {0.1, 0.3, 0.0, 0.0}, {0.0, 0.0, 0.1, 0.05}, {0.0, 0.0, 0.05, 0.2}};
  Matrix a(n, n), b(n, n), reflection(n, n), transmission(n, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      a(i, j) = A[i][j];
      b(i, j) = B[i][j];
    }
  double_slab({.size = n,
               .even = even,
               .forward = a.values.data(),
               .backward = b.values.data(),
               .step = 0.25,
               .doublings = 3},
              reflection.values.data(), transmission.values.data());
  const auto times = [](const Matrix& x, const Matrix& y) {
    Matrix z(n, n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < n; ++k) z(i, j) += x(i, k) * y(k, j);
    return z;
  };
  const auto plus = [](Matrix x, const Matrix& y, double factor) {
    for (std::size_t k = 0; k < x.values.size(); ++k) x.values[k] += factor * y.values[k];
    return x;
  };
  Matrix r(n, n), t(n, n);
  for (std::size_t i = 0; i < n; ++i) t(i, i) = 1.0;
  const auto slope_r = [&](const Matrix& x) {
    return plus(plus(plus(b, times(a, x), 1.0), times(x, a), 1.0), times(x, times(b, x)), 1.0);
  };
  const auto slope_t = [&](const Matrix& x, const Matrix& y) {
    return times(y, plus(a, times(b, x), 1.0));  // a new sheet on top: T' = T (A + B R)
  };
  constexpr int steps = 400;
  const double h = 2.0 / steps;
  for (int step = 0; step < steps; ++step) {  // Runge-Kutta of fourth order
    const Matrix r1 = slope_r(r), t1 = slope_t(r, t);
    const Matrix ra = plus(r, r1, h / 2), ta = plus(t, t1, h / 2);
    const Matrix r2 = slope_r(ra), t2 = slope_t(ra, ta);
    const Matrix rb = plus(r, r2, h / 2), tb = plus(t, t2, h / 2);
    const Matrix r3 = slope_r(rb), t3 = slope_t(rb, tb);
    const Matrix rc = plus(r, r3, h), tc = plus(t, t3, h);
    const Matrix r4 = slope_r(rc), t4 = slope_t(rc, tc);
    r = plus(plus(plus(plus(r, r1, h / 6), r2, h / 3), r3, h / 3), r4, h / 6);
    t = plus(plus(plus(plus(t, t1, h / 6), t2, h / 3), t3, h / 3), t4, h / 6);
  }
  for (std::size_t k = 0; k < n * n; ++k) {
    EXPECT_NEAR(reflection.values[k], r.values[k], 1e-9);
    EXPECT_NEAR(transmission.values[k], t.values[k], 1e-9);
  }
}

}  // namespace
}  // namespace lamina::detail
