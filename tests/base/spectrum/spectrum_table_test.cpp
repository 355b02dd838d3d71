// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/spectrum_table.h"

#include <gtest/gtest.h>

#include <string>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

SpectrumTable read(const std::string& text, const std::string& column = "") {
  MemoryBudget memory;
  return read_spectrum(parse_csv(text, "t.csv", memory), column, at_least(0.0, "1/mm"));
}

std::string refusal(const std::string& text, const std::string& column = "") {
  try {
    (void)read(text, column);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(SpectrumTable, IsLinearBetweenItsEntries) {
  const SpectrumTable table = read("wavelength_nm,a,b\n400,1,0\n500,3,0\n520,2,0\n", "a");
  EXPECT_EQ(interpolate(table, 400.0), 1.0);
  EXPECT_DOUBLE_EQ(interpolate(table, 425.0), 1.5);
  EXPECT_EQ(interpolate(table, 500.0), 3.0);
  EXPECT_DOUBLE_EQ(interpolate(table, 515.0), 2.25);
  EXPECT_EQ(interpolate(table, 520.0), 2.0);
  EXPECT_TRUE(table.covers(400.0));
  EXPECT_FALSE(table.covers(520.1));
}

TEST(SpectrumTable, ReadsTheUnitOfWavelengthsFromTheNameOfTheirColumn) {
  for (const char* name : {"nm", "wavelength_nm", "Wavelength (nm)", "lambda [nm]"})
    EXPECT_EQ(read(std::string(name) + ",R\n400,1\n").wavelengths[0], 400.0) << name;
  for (const char* name : {"um", "wavelength_um", "lambda [µm]"})
    EXPECT_DOUBLE_EQ(read(std::string(name) + ",R\n0.4,1\n").wavelengths[0], 400.0) << name;
}

TEST(SpectrumTable, RefusesInOneLineThatNamesThePlaceAndTheValue) {
  EXPECT_EQ(refusal("wavelength,R\n400,1\n"),
            "t.csv: the first column must be wavelengths, with their unit in its name, as "
            "wavelength_nm, but is \"wavelength\"");
  EXPECT_EQ(refusal("nm,R\n400,1\n410,1\n405,1\n"),
            "t.csv:4: nm must be longer than the wavelength before it, but is 405");
  EXPECT_EQ(refusal("nm,R\n400,1\n400,1\n"),
            "t.csv:3: nm must be longer than the wavelength before it, but is the same, 400");
  EXPECT_EQ(refusal("nm,R\n0.4,1\n"), "t.csv:2: nm must lie in [200, 3000] nm, but is 0.4");
  EXPECT_EQ(refusal("um,R\n400,1\n"), "t.csv:2: um must lie in [0.2, 3] um, but is 400");
  EXPECT_EQ(refusal("nm,R\n400,-1\n"), "t.csv:2: R must be >= 0 [1/mm], but is -1");
  EXPECT_EQ(refusal("nm,R,S\n400,1,1\n"),
            "t.csv: has 2 columns besides the wavelengths; \"column\" must say which");
}

}  // namespace
}  // namespace lamina
