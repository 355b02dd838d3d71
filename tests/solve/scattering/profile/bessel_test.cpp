// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/bessel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lamina::detail {
namespace {

TEST(Bessel, TableAgreesWithTheStandardLibrary) {
  for (const std::size_t orders : {1, 5, 47, 48, 60})
    for (double x = 0.0; x < 130.0; x += 0.731) {
      std::vector<double> found(orders);
      tabulated_bessel_functions(x, found);
      for (std::size_t m = 0; m < orders; ++m)
        EXPECT_NEAR(found[m], std::cyl_bessel_j(static_cast<double>(m), x), 1e-7) << m << ' ' << x;
    }
}

}  // namespace
}  // namespace lamina::detail
