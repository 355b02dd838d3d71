// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/csv_table.h"

#include <gtest/gtest.h>

#include <string>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

CsvTable parse(const std::string& text) {
  MemoryBudget memory;
  return parse_csv(text, "t.csv", memory);
}

std::string refusal(const std::string& text) {
  try {
    const CsvTable table = parse(text);
    for (std::size_t row = 0; row < table.rows(); ++row)
      (void)table.number(row, table.column("R"), closed_interval(0.0, 1.2));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(CsvTable, TakesCommasSemicolonsTabsQuotesAndComments) {
  for (const char* text : {"# note\nnm,R\n400,.5\n", "nm;R\r\n400;.5\r\n\r\n", "nm\tR\n400\t.5",
                           "\xef\xbb\xbfnm, R\n 400 , \"+.5\"\n", "\"nm\",\"R\"\n400,5e-1"}) {
    const CsvTable table = parse(text);
    ASSERT_EQ(table.rows(), 1U) << text;
    EXPECT_EQ(table.number(0, table.column("nm")), 400.0) << text;
    EXPECT_EQ(table.number(0, table.column("R")), 0.5) << text;
  }
  const CsvTable names = parse("name,\"size, \"\"mm\"\"\"\n\"a, b\",3\n");
  EXPECT_EQ(names.columns()[1], "size, \"mm\"");
  EXPECT_EQ(names.text(0, 0), "a, b");
  EXPECT_FALSE(names.find_column("R"));
}

// As spectrometers write them: what they say of themselves first, blanks, tabs, decimal commas, a
// separator at the end of each line, line ends of old Macs.
TEST(CsvTable, TakesFilesOfInstruments) {
  for (const char* text :
       {"Sample 1,\r\nWavelength nm,R\r\n400,.5\r\n390,.6\r\n",
        "Scan 7\n\nSpeed,600\nnm,R\n400,.5\n390,.6\n", "nm R\n400 .5\n390  .6\n",
        "# x\nnm \t R\n 400 .5\n\t390\t.6\n", "nm;R\n400;0,5\n390;0,6\n",
        "Gerät: A, B\nnm\tR\n400\t0,5\n390\t0,6\n", "nm R\n400,0 0,5\n390,0 0,6\n",
        "nm,R,\n400,.5,\n390,.6,\n", "nm,R\r400,.5\r390,.6\r"}) {
    const CsvTable table = parse(text);
    ASSERT_EQ(table.rows(), 2U) << text;
    ASSERT_EQ(table.columns().size(), 2U) << text;
    EXPECT_EQ(table.columns()[1], "R") << text;
    EXPECT_EQ(table.number(0, 0), 400.0) << text;
    EXPECT_EQ(table.number(1, 1), 0.6) << text;
  }
  CsvTable falling = parse("nm,R\n400,.5\n390,.6\n380,.7\n");
  falling.reverse_rows();
  EXPECT_EQ(falling.number(0, 0), 380.0);
  EXPECT_EQ(falling.number(2, 1), 0.5);
  EXPECT_EQ(falling.number(1, 0), 390.0);
}

TEST(CsvTable, CellsOfTextAreReadBackAndAreNoFormulas) {
  EXPECT_EQ(csv_cell("plain name.csv"), "plain name.csv");
  EXPECT_EQ(csv_cell("-0.5"), "-0.5");
  EXPECT_EQ(csv_cell("x\ny"), "x y");
  for (const char* text : {"a,b", "say \"a\"", "=1+1", "@SUM(A1)", "+1+1", "-a", "a;b"}) {
    const CsvTable table = parse("name,R\n" + csv_cell(text) + ",1\n");
    const bool is_formula = std::string("=@+-").find(text[0]) != std::string::npos;
    EXPECT_EQ(table.text(0, 0), (is_formula ? "'" : "") + std::string(text));
  }
}

TEST(CsvTable, RefusesInOneLineThatNamesThePlaceAndTheValue) {
  EXPECT_EQ(refusal("nm,R\n400,37.2\n"), "t.csv:2: R must lie in [0, 1.2], but is 37.2");
  EXPECT_EQ(refusal("# a\n\nnm,R\n400,-1\n"), "t.csv:4: R must lie in [0, 1.2], but is -1");
  EXPECT_EQ(refusal("nm;R\n400;0,5\n401;0.5\n"),
            "t.csv:2: R must lie in [0, 1.2], but is \"0,5\"; write a decimal point");
  EXPECT_EQ(refusal("nm,R\n400,0,5\n"),
            "t.csv:2: must hold 2 cells, one for each column, but holds 3; numbers are written "
            "with a decimal point");
  for (const char* bad : {"1e999", "0.5x", "0x1", "1 2"})
    EXPECT_EQ(refusal("nm,R\n400," + std::string(bad) + "\n"),
              "t.csv:2: R must lie in [0, 1.2], but is \"" + std::string(bad) + "\"");
  for (const char* bad : {"nan", "inf", "-NaN"})
    EXPECT_EQ(refusal("nm,R\n400," + std::string(bad) + "\n"),
              "t.csv:2: R must lie in [0, 1.2], but is " + std::string(bad));
  EXPECT_EQ(refusal("nm,R\n400,\n"), "t.csv:2: R must lie in [0, 1.2], but is empty");
  EXPECT_EQ(refusal("nm,R\n400\n"), "t.csv:2: must hold 2 cells, one for each column, but holds 1");
  EXPECT_EQ(refusal("nm,r\n400,1\n"),
            "t.csv: there is no column \"R\" among \"nm\", \"r\"; did you mean \"r\"?");
  EXPECT_EQ(refusal("nm,nm\n1,1\n"), "t.csv:1: there are two columns \"nm\"");
  EXPECT_EQ(refusal("nm,\n1,1\n"), "t.csv:1: column 2 has no name");
  EXPECT_EQ(refusal("400,.5\n410,.6\n"),
            "t.csv:1: the first line must name the columns, as in wavelength_nm,sigma_a");
  EXPECT_EQ(refusal("# only\n"), "t.csv: is empty");
  EXPECT_EQ(refusal("nm,R\n"), "t.csv: has no line of values");
  EXPECT_EQ(refusal("nm,R\n400,\xff\n"), "t.csv:2: must be UTF-8");
}

TEST(CsvTable, KeepsToTheMemoryBudget) {
  MemoryBudget memory{.left = 100};
  EXPECT_THROW((void)parse_csv("a,b\n1,2\n3,4\n5,6\n", "t.csv", memory), FileError);
}

}  // namespace
}  // namespace lamina
