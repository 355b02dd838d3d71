// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/band_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

TEST(BandSet, IsRgbOrAscendingWavelengths) {
  EXPECT_EQ(BandSet::rgb().size(), 3u);
  EXPECT_EQ(band_name(BandSet::rgb(), 1), "G");
  EXPECT_EQ(default_spectral_bands().size(), 8u);
  EXPECT_EQ(band_name(default_spectral_bands(), 4), "540");
  EXPECT_EQ(band_name(BandSet({542.5}), 0), "542.5");
}

TEST(BandSet, RefusesWhatIsNoWavelength) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& wavelengths : {std::vector<double>{},
                                                 {540.0, 540.0},
                                                 {600.0, 500.0},
                                                 {0.0},
                                                 {3001.0},
                                                 {inf},
                                                 {std::nan("")}})
    EXPECT_THROW(BandSet{wavelengths}, InvalidInput);
}

}  // namespace
}  // namespace lamina
