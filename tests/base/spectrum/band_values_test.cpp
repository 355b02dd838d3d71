// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/band_values.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/spectrum/brief_bands.h"

namespace lamina {
namespace {

using Bands = BandValues<8>;

/// Largest relative difference of a function of bands from a function of a double.
template <class F, class Exact>
double worst_error(const F& f, const Exact& exact, double low, double high) {
  double worst = 0.0;
  constexpr int count = 20'000;
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(low * std::pow(high / low, i / (count - 1.0)));
    const double expected = exact(static_cast<double>(x));
    const double value = static_cast<double>(f(Bands::filled(x))[i % 8]);
    worst = std::max(worst, std::abs(value / expected - 1.0));
  }
  return worst;
}

TEST(BandValues, FunctionsKeepTheirStatedErrors) {
  EXPECT_LT(worst_error([](const Bands& x) { return reciprocal(x); },
                        [](double x) { return 1.0 / x; }, 1e-36, 1e36),
            3e-7);
  EXPECT_LT(worst_error([](const Bands& x) { return reciprocal_root(x); },
                        [](double x) { return 1.0 / std::sqrt(x); }, 1e-36, 1e36),
            3e-7);
  EXPECT_LT(worst_error([](const Bands& x) { return exp_minus(x); },
                        [](double x) { return std::exp(-x); }, 1e-6, 86.0),
            2e-7);
  EXPECT_EQ(exp_minus(Bands::filled(0.0f))[0], 1.0f);
  EXPECT_EQ(exp_minus(Bands::filled(1e12f))[7], 0.0f);
}

// Eight bits with the leading one, rounded to nearest.
TEST(BandValues, InHalfTheMemoryKeepTheirStatedError) {
  const auto kept = [](double x) {
    Bands bands;
    bands[5] = static_cast<float>(-x);
    return static_cast<double>(-in_full(brief(bands))[5]);
  };
  double worst = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const double x = std::exp(-80.0 + 0.016 * i);
    worst = std::max(worst, std::abs(kept(x) / x - 1.0));
  }
  EXPECT_LT(worst, 0x1.01p-8);
  EXPECT_GT(worst, 0x1.8p-9);  // or it would be in full
  EXPECT_EQ(kept(0.0), 0.0);
  EXPECT_EQ(in_full(brief(Bands::filled(1.0f)))[0], 1.0f);
}

}  // namespace
}  // namespace lamina
