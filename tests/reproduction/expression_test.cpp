// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/expression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

ExpressionSources sources() {
  return {.value = [](std::string_view path) -> ExpressionValue {
            if (path == "mc.r[:][1]") return {1.0, 2.0, 4.0};
            if (path == "two") return {2.0};
            throw InvalidInput("there is no " + std::string(path));
          },
          .runs = [](const std::string& prefix, const std::string& path) -> ExpressionValue {
            EXPECT_EQ(prefix, "a_");
            EXPECT_EQ(path, "R[0]");
            return {3.0, 4.0};
          },
          .pixels = [](const std::string& file, const std::string& channel, double left, double,
                       double, double bottom) -> ExpressionValue {
            EXPECT_EQ(file, "a.exr");
            EXPECT_EQ(channel, "R");
            return {left, bottom};
          }};
}

ExpressionValue value(std::string_view text) { return evaluate_expression(text, sources()); }
double number(std::string_view text) { return evaluate_number(text, sources()); }

TEST(Expression, BindsAsArithmeticDoes) {
  EXPECT_EQ(number("1 + 2 * 3 ^ 2"), 19.0);
  EXPECT_EQ(number("-2 ^ 2"), -4.0);
  EXPECT_EQ(number("2 ^ -1"), 0.5);
  EXPECT_EQ(number("2 ^ 3 ^ 0"), 2.0);
  EXPECT_EQ(number("10 - 4 - 3"), 3.0);
  EXPECT_EQ(number("12 / 3 / 2"), 2.0);
  EXPECT_EQ(number("(1 + 2) * 1.5e1"), 45.0);
  EXPECT_EQ(number("2e-3 * 1000"), 2.0);
  EXPECT_EQ(number("1 < 2 & 3 >= 4 | 1 == 1"), 1.0);
  EXPECT_EQ(number("two - 1 + two"), 3.0);
}

TEST(Expression, WorksElementByElement) {
  EXPECT_EQ(value("mc.r[:][1] * two"), (ExpressionValue{2.0, 4.0, 8.0}));
  EXPECT_EQ(value("two + two * [1]"), (ExpressionValue{4.0}));
  EXPECT_EQ(value("[1, mc.r[:][1]] < 2"), (ExpressionValue{1.0, 1.0, 0.0, 0.0}));
  EXPECT_EQ(value("if([1, 0], [5, 6], -[7, 8])"), (ExpressionValue{5.0, -8.0}));
  EXPECT_EQ(value("max([1, 5], [3, 2])"), (ExpressionValue{3.0, 5.0}));
  EXPECT_EQ(value("slice([1, 2, 3, 4], 1, -1)"), (ExpressionValue{2.0, 3.0}));
  EXPECT_EQ(value("reverse([1, 2, 3])"), (ExpressionValue{3.0, 2.0, 1.0}));
  EXPECT_EQ(value("2 * runs('a_', 'R[0]')"), (ExpressionValue{6.0, 8.0}));
  EXPECT_EQ(value("range(0, 1, 5)"), (ExpressionValue{0.0, 0.25, 0.5, 0.75, 1.0}));
  EXPECT_EQ(value("pixels('a.exr', 'R', 0.25, 0, 1, 0.5)"), (ExpressionValue{0.25, 0.5}));
}

TEST(Expression, Reduces) {
  EXPECT_EQ(number("min(mc.r[:][1])"), 1.0);
  EXPECT_EQ(number("mean([1, 2, 6])"), 3.0);
  EXPECT_EQ(number("sum([1, 2, 6]) + count([1, 2])"), 11.0);
  EXPECT_DOUBLE_EQ(number("rms([3, 4])"), std::sqrt(12.5));
  EXPECT_EQ(number("first([7, 8]) - last([7, 8])"), -1.0);
  EXPECT_EQ(number("all([1, 2]) + all([1, 0]) + any([0, 3])"), 2.0);
  EXPECT_EQ(number("at([1, 2, 4], [10, 20, 40], 3)"), 30.0);
  EXPECT_EQ(number("at([1, 2], [10, 20], 9)"), 20.0);
  EXPECT_EQ(number("integral([0, 1, 3], [0, 1, 1])"), 2.5);
  EXPECT_EQ(number("peak([5, 6, 7], [1, 9, 2])"), 6.0);
  EXPECT_DOUBLE_EQ(number("log10(100) + log(exp(1)) + sqrt(4) + abs(-1) + cos(0) + sin(0)"), 7.0);
}

TEST(Expression, SaysWhereItCannotBeUnderstood) {
  for (const char* const text :
       {"", "1 +", "(1", "[1, 2", "1 2", "foo(1)", "abs(1, 2)", "[1, 2] + [1, 2, 3]", "mean([1, 2]",
        "at([2, 1], [1, 1], 1)", "1e", "1.2.3", "pixels(a, 'R', 0, 0, 1, 1)", "range(0, 1, 1e99)",
        "no.such[0]", "mc.r[", "peak([1], [1, 2])"})
    EXPECT_THROW((void)value(text), InvalidInput) << text;
  EXPECT_THROW((void)number("[1, 2]"), InvalidInput);
  EXPECT_THROW((void)value(std::string(100'000, '(')), InvalidInput);
  EXPECT_THROW((void)value(std::string(100'000, '-')), InvalidInput);
  try {
    (void)value("1 + foo(2)");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "expression \"1 + foo(2)\": there is no function foo at character 11");
  }
}

}  // namespace
}  // namespace lamina
