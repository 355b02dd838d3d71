// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/leaf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// Reflectance (specular included) and transmittance, lit from the upper and from the lower side.
std::array<double, 4> both_sides(const LeafParameters& leaf, double wavelength) {
  const LayerStack stack = leaf_layer_stack(leaf, wavelength);
  const SlabTotals upper = adding_doubling(stack, {}, {.accuracy = 3e-4}).totals;
  const SlabTotals lower = adding_doubling(flipped(stack), {}, {.accuracy = 3e-4}).totals;
  return {upper.specular_reflectance + upper.diffuse_reflectance, upper.transmittance,
          lower.specular_reflectance + lower.diffuse_reflectance, lower.transmittance};
}

struct FittedLeaf {
  const char* name;
  double chlorophyll, carotenoids, anthocyanins, brown_pigments, dry_matter, structure,
      palisade_share;
  double rms;  ///< found by the fit, over 400-800 nm every 20 and the four quantities
};

// Fitted by least squares to the ten leaves of [Noda2013]; water 0.012 cm.
constexpr FittedLeaf leaves[] = {
    {"Quercus_leaf_sun_2010_0802_1", 40.4, 5.71, 4.81, 0.0884, 0.0033, 1.634, 0.728, 0.0109},
    {"Quercus_leaf_sun_2012_0823_1", 37.6, 4.24, 4.99, 0.0537, 0.0022, 1.673, 0.743, 0.0111},
    {"Quercus_leaf_shade_2010_0802_1", 45.6, 5.99, 5.52, 0.0073, 0.0014, 1.433, 0.688, 0.0102},
    {"Quercus_leaf_yellow_2010_1007_1", 1.45, 3.88, 0.47, 0.0242, 0.0060, 1.430, 0.399, 0.0184},
    {"Betula_leaf_first_2010_0802_1", 41.2, 6.94, 5.09, 0.0095, 0.0022, 1.909, 0.684, 0.0097},
    {"Betula_leaf_second_2010_0802_1", 37.1, 6.25, 4.56, 0.0134, 0.0016, 1.661, 0.706, 0.0107},
    {"Betula_leaf_yellow_2010_1006_1", 1.15, 5.83, 0.69, 0.1591, 0.0052, 1.854, 0.379, 0.0158},
    {"Solidago_leaf_upper_2010_0728_1", 17.2, 3.40, 1.96, 0.0326, 0.0004, 1.600, 0.522, 0.0141},
    {"Solidago_leaf_upper_2010_0913_1", 29.4, 3.20, 4.03, 0.0509, 0.0024, 2.121, 0.474, 0.0134},
    {"Solidago_leaf_lower_2010_1103_1", 16.0, 3.58, 1.60, 0.1560, 0.0051, 2.099, 0.562, 0.0096}};

/// The rows of a table of numbers under a line of names; empty if the file is absent.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
};
Table load_table(const std::filesystem::path& file) {
  Table table;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream fields(line);
    const bool is_head = table.names.empty();
    if (!is_head) table.rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');)
      if (is_head)
        table.names.push_back(field);
      else
        table.rows.back().push_back(field.empty() ? std::nan("") : std::stod(field));
  }
  return table;
}

/// The value in the row of a wavelength, both in whole nm.
double value_at(const Table& table, const std::string& name, double wavelength) {
  const auto column = std::ranges::find(table.names, name) - table.names.begin();
  for (const std::vector<double>& row : table.rows)
    if (row[0] == wavelength) return row[static_cast<std::size_t>(column)];
  return std::nan("");
}

TEST(Leaf, ModelMeetsTenMeasuredLeavesFromBothSides) {
  const Table measured =
      load_table(std::filesystem::path(LAMINA_SHARED_DATA) / "leaves/jalter_leaf_rt.csv");
  if (measured.rows.empty()) GTEST_SKIP() << "reference data are absent: measured leaves";
  for (const FittedLeaf& fit : leaves) {
    const LeafParameters leaf{.chlorophyll = fit.chlorophyll,
                              .carotenoids = fit.carotenoids,
                              .anthocyanins = fit.anthocyanins,
                              .brown_pigments = fit.brown_pigments,
                              .dry_matter = fit.dry_matter,
                              .structure = fit.structure,
                              .palisade_share = fit.palisade_share};
    // In this one the two columns of the lower side are exchanged: at 350 nm, where no light
    // passes a leaf, it would transmit 8 % and reflect 1 %.
    const bool is_exchanged = std::string(fit.name) == "Quercus_leaf_sun_2012_0823_1";
    const std::array<const char*, 4> columns = {":R_ad", ":T_ad", is_exchanged ? ":T_ab" : ":R_ab",
                                                is_exchanged ? ":R_ab" : ":T_ab"};
    double sum = 0.0;
    int count = 0;
    for (double nm = 400.0; nm <= 800.0; nm += 20.0) {
      const std::array<double, 4> modeled = both_sides(leaf, nm);
      for (std::size_t i = 0; i < 4; ++i, ++count)
        sum += std::pow(modeled[i] - value_at(measured, std::string(fit.name) + columns[i], nm), 2);
    }
    EXPECT_NEAR(std::sqrt(sum / count), fit.rms, 0.001) << fit.name;  // its digits are rounded
  }
}

struct InfraredLeaf {
  FittedLeaf leaf;
  double water;               ///< [cm]
  double rms_of_r, rms_of_t;  ///< of the upper side, found by the fit
};

// By tools/fit/leaf_spectra: eight numbers from the upper side, 400-1000 nm every 10.
const InfraredLeaf infrared_leaves[] = {
    {{"Quercus_leaf_sun_2010_0802_1", 40.58, 7.156, 4.662, 0.07265, 0.00485, 1.612, 0.6441, 0.0},
     0.006802,
     0.0068,
     0.0090},
    {{"Quercus_leaf_sun_2012_0823_1", 37.57, 5.565, 4.538, 0.03979, 0.002962, 1.606, 0.5337, 0.0},
     0.005617,
     0.0079,
     0.0084},
    {{"Quercus_leaf_shade_2010_0802_1", 45.75, 6.712, 5.35, 0, 0.002393, 1.425, 0.6288, 0.0},
     0.003605,
     0.0063,
     0.0093},
    {{"Quercus_leaf_yellow_2010_1007_1", 1.43, 4.301, 0.1962, 0.07744, 0.004239, 1.39, 0.2263, 0.0},
     0,
     0.0157,
     0.0156},
    {{"Betula_leaf_first_2010_0802_1", 41.78, 6.857, 5.489, 0, 0.00244, 1.983, 0.7331, 0.0},
     0.005821,
     0.0066,
     0.0076},
    {{"Betula_leaf_second_2010_0802_1", 38.12, 6.631, 4.848, 0, 0.002425, 1.722, 0.7291, 0.0},
     0.006942,
     0.0061,
     0.0088},
    {{"Betula_leaf_yellow_2010_1006_1", 1.172, 6.501, 0.6591, 0.1752, 0.003995, 1.881, 0.347, 0.0},
     0.003523,
     0.0131,
     0.0125},
    {{"Solidago_leaf_upper_2010_0728_1", 17.49, 3.424, 2.086, 0.006988, 0.00104, 1.744, 0.6745,
      0.0},
     0.01282,
     0.0086,
     0.0105},
    {{"Solidago_leaf_upper_2010_0913_1", 29.56, 4.108, 3.616, 0.06002, 0.00208, 2.226, 0.5022, 0.0},
     0.01051,
     0.0086,
     0.0095},
    {{"Solidago_leaf_lower_2010_1103_1", 17, 3.896, 1.845, 0.09101, 0.007901, 2.1, 0.4917, 0.0},
     0.006687,
     0.0079,
     0.0056}};

TEST(Leaf, ModelMeetsMeasuredLeavesIntoTheNearInfrared) {
  const Table measured =
      load_table(std::filesystem::path(LAMINA_SHARED_DATA) / "leaves/jalter_leaf_rt.csv");
  if (measured.rows.empty()) GTEST_SKIP() << "reference data are absent: measured leaves";
  for (const auto& [fit, water, rms_of_r, rms_of_t] : infrared_leaves) {
    const LeafParameters leaf{.chlorophyll = fit.chlorophyll,
                              .carotenoids = fit.carotenoids,
                              .anthocyanins = fit.anthocyanins,
                              .brown_pigments = fit.brown_pigments,
                              .water = water,
                              .dry_matter = fit.dry_matter,
                              .structure = fit.structure,
                              .palisade_share = fit.palisade_share};
    double of_r = 0.0, of_t = 0.0;
    int count = 0;
    for (double nm = 400.0; nm <= 1000.0; nm += 20.0, ++count) {
      const SlabTotals upper =
          adding_doubling(leaf_layer_stack(leaf, nm), {}, {.accuracy = 3e-4}).totals;
      const std::string name(fit.name);
      of_r += std::pow(upper.specular_reflectance + upper.diffuse_reflectance -
                           value_at(measured, name + ":R_ad", nm),
                       2);
      of_t += std::pow(upper.transmittance - value_at(measured, name + ":T_ad", nm), 2);
    }
    EXPECT_NEAR(std::sqrt(of_r / count), rms_of_r, 0.0015) << fit.name;  // every 10 nm in the fit
    EXPECT_NEAR(std::sqrt(of_t / count), rms_of_t, 0.0015) << fit.name;
  }
}

TEST(Leaf, TablesEqualTheirSourceWhereItIsAtHand) {
  const Table source =
      load_table(std::filesystem::path(LAMINA_SHARED_DATA) / "leaves/prospect_pro_sac.csv");
  if (source.rows.empty()) GTEST_SKIP() << "reference data are absent: PROSPECT coefficients";
  const LeafParameters none{0, 0, 0, 0, 0, 0};
  const std::pair<const char*, double LeafParameters::*> columns[] = {
      {"chl", &LeafParameters::chlorophyll},  {"car", &LeafParameters::carotenoids},
      {"ant", &LeafParameters::anthocyanins}, {"brown", &LeafParameters::brown_pigments},
      {"ewt", &LeafParameters::water},        {"lma", &LeafParameters::dry_matter}};
  for (const auto& [name, constituent] : columns)
    for (double nm = 400.0; nm <= 1000.0; nm += 5.0) {
      LeafParameters leaf = none;
      leaf.*constituent = 1.0;
      const double expected = value_at(source, name, nm);
      EXPECT_NEAR(leaf_absorption(leaf, nm), expected, 1e-5 * expected) << name << " " << nm;
    }
}

// [Feret2017]: chlorophyll absorbs most near 436 and 675 nm and is clear beyond 750.
TEST(Leaf, ChlorophyllMakesItGreen) {
  const LeafParameters green;
  const auto [red, red_through, red_below, red_up] = both_sides(green, 675.0);
  const auto [mid, mid_through, mid_below, mid_up] = both_sides(green, 550.0);
  const auto [far, far_through, far_below, far_up] = both_sides(green, 800.0);
  EXPECT_LT(red, 0.08);
  EXPECT_GT(mid, 1.5 * red);
  EXPECT_GT(far, 0.4);
  EXPECT_GT(far + far_through, 0.9);
  EXPECT_GT(mid_below, 1.2 * mid);  // the pale side is below
  EXPECT_NEAR(mid_up, mid_through, 0.01);
  EXPECT_LT(red_through, 0.05);
  EXPECT_GT(red_below, red);
  EXPECT_NEAR(red_up, red_through, 0.01);
  EXPECT_NEAR(far_up, far_through, 0.01);
  EXPECT_GT(far_below, 0.4);
}

// [HaleQuerry1973]: .45 per cm at 975 nm, ten times what it is at 900 nm.
TEST(Leaf, WaterIsSeenBeyond900Nanometres) {
  const LeafParameters dry{.water = 0.0}, wet{.water = 0.02};
  const auto lost = [](const LeafParameters& leaf, double nm) {
    const auto [reflected, transmitted, ignored, up] = both_sides(leaf, nm);
    return 1.0 - reflected - transmitted;
  };
  EXPECT_NEAR(leaf_spectrum(975.0).water, 0.45, 0.05);
  EXPECT_LT(lost(wet, 820.0) - lost(dry, 820.0), 0.005);
  EXPECT_GT(lost(wet, 970.0) - lost(dry, 970.0), 0.03);
}

TEST(Leaf, ThicknessLeavesTheTotals) {
  const std::array<double, 4> thin = both_sides({.thickness = 0.1}, 550.0);
  const std::array<double, 4> thick = both_sides({.thickness = 0.4}, 550.0);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(thin[i], thick[i], 1e-9);
}

TEST(Leaf, RefusesWhatNoLeafHolds) {
  try {
    (void)leaf_layer_stack({.chlorophyll = 500.0}, 550.0);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "leaf: chlorophyll must lie in [0, 200], but is 500");
  }
}

TEST(Leaf, FileIsTheStackOfItsParameters) {
  const Material leaf = find_material("green_leaf");
  EXPECT_EQ(leaf.bands, default_spectral_bands());
  ASSERT_EQ(leaf.layers.size(), 2U);
  const LayerStack expected = leaf_layer_stack({}, 540.0), stack = layer_stack(leaf, 4);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(stack.layers()[i].medium.sigma_a, expected.layers()[i].medium.sigma_a);
    EXPECT_EQ(stack.layers()[i].medium.sigma_s, expected.layers()[i].medium.sigma_s);
  }
}

}  // namespace
}  // namespace lamina
