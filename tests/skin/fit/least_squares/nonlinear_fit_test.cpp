// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/symmetric_eigen.h"
#include "skin/fit/normal_number.h"

namespace lamina {
namespace {

using Values = std::span<const double>;

std::string refusal(const std::vector<FitParameter>& parameters, const FitData& data,
                    const FitModel& model, const FitOptions& options = {}) {
  try {
    (void)fit_parameters(parameters, data, model, options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

/// The sentences that hold a text.
int notes_with(const FitResult& result, const std::string& text) {
  int count = 0;
  for (const std::string& note : result.notes) count += note.find(text) != std::string::npos;
  return count;
}

const FitModel line = {.predict = [](Values p) {
  return std::vector{p[0], p[0] + p[1], p[0] + 2.0 * p[1]};
}};

// NIST StRD, Misra1a: y = b1 (1 - exp(-b2 x)), certified to eleven digits, from its first start.
TEST(NonlinearFit, GivesTheCertifiedValuesOfMisra1a) {
  const std::vector<double> x = {77.6,  114.9, 141.1, 190.8, 239.9, 289.0, 332.8,
                                 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0};
  const FitData data{.measured = {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76,
                                  55.05, 61.01, 66.40, 75.47, 81.78},
                     .standard_deviation = std::vector(14, 1.0),
                     .has_known_errors = false};
  const FitModel model{.predict = [&](Values b) {
    std::vector<double> y;
    for (const double at : x) y.push_back(b[0] * (1.0 - std::exp(-b[1] * at)));
    return y;
  }};
  const FitModel with_derivatives{.predict = model.predict, .derivatives = [&](Values b) {
                                    DenseMatrix derivatives(x.size(), 2);
                                    for (std::size_t i = 0; i < x.size(); ++i) {
                                      derivatives(i, 0) = 1.0 - std::exp(-b[1] * x[i]);
                                      derivatives(i, 1) = b[0] * x[i] * std::exp(-b[1] * x[i]);
                                    }
                                    return derivatives;
                                  }};
  for (const FitModel& one : {model, with_derivatives}) {
    const FitResult result =
        fit_parameters({{.name = "b1", .start = 500.0}, {.name = "b2", .start = 1e-4}}, data, one);
    EXPECT_TRUE(result.has_converged);
    EXPECT_NEAR(result.parameters[0].value, 2.3894212918e2, 2e-6);
    EXPECT_NEAR(result.parameters[1].value, 5.5015643181e-4, 5e-12);
    EXPECT_NEAR(result.parameters[0].standard_deviation, 2.7070075241, 1e-4);
    EXPECT_NEAR(result.parameters[1].standard_deviation, 7.2668688436e-6, 3e-10);
    EXPECT_NEAR(result.chi_squared, 1.2455138894e-1, 1e-9);
    EXPECT_EQ(notes_with(result, "b1 and b2: hardly told apart"), 1);
  }
}

// A straight line through three points, by the normal equations on paper.
TEST(NonlinearFit, GivesTheClosedFormOfALine) {
  const FitResult result =
      fit_parameters({{.name = "a", .start = 0.0}, {.name = "b", .start = 0.0}},
                     {.measured = {1.0, 2.0, 4.0}, .standard_deviation = {0.1, 0.1, 0.1}}, line);
  EXPECT_NEAR(result.parameters[0].value, 5.0 / 6.0, 1e-9);
  EXPECT_NEAR(result.parameters[1].value, 1.5, 1e-9);
  EXPECT_NEAR(result.parameters[0].standard_deviation, 0.1 * std::sqrt(5.0 / 6.0), 1e-7);
  EXPECT_NEAR(result.parameters[1].standard_deviation, 0.1 * std::sqrt(0.5), 1e-7);
  EXPECT_NEAR(result.correlation(0, 1), -std::sqrt(0.6), 1e-6);
  EXPECT_NEAR(result.chi_squared, 100.0 / 6.0, 1e-6);
  EXPECT_EQ(result.degrees_of_freedom, 1);
  EXPECT_TRUE(result.notes.empty());
}

// Errors that go together: two readings with a common offset of sd 3 and own noise of 1, of which
// the mean has variance 9 + 1/2.
TEST(NonlinearFit, KnowsErrorsThatGoTogether) {
  FitData data{.measured = {4.0, 6.0}, .covariance = DenseMatrix(2, 2)};
  data.covariance.values = {10.0, 9.0, 9.0, 10.0};
  const FitModel both{.predict = [](Values p) { return std::vector{p[0], p[0]}; }};
  const FitResult result = fit_parameters({{.name = "a", .start = 1.0}}, data, both);
  EXPECT_NEAR(result.parameters[0].value, 5.0, 1e-8);
  EXPECT_NEAR(result.parameters[0].standard_deviation, std::sqrt(9.5), 1e-6);
  EXPECT_NEAR(result.chi_squared, 2.0, 1e-8);
}

TEST(NonlinearFit, SaysThatItStoppedShortOfASolution) {
  const FitModel curve{.predict = [](Values p) {
    return std::vector{std::exp(p[0]), std::exp(2.0 * p[0])};
  }};
  const FitData data{.measured = {20.0, 400.0}, .standard_deviation = {1.0, 1.0}};
  const std::vector<FitParameter> power = {{.name = "p", .start = 0.0}};
  const FitResult cut = fit_parameters(power, data, curve, {.max_iterations = 2});
  EXPECT_FALSE(cut.has_converged);
  EXPECT_EQ(notes_with(cut, "stopped after 2 steps, short of a solution"), 1);
  const FitResult whole = fit_parameters(power, data, curve);
  EXPECT_TRUE(whole.has_converged);
  EXPECT_NEAR(whole.parameters[0].value, std::log(20.0), 1e-9);
  EXPECT_TRUE(whole.notes.empty());
}

// Held, a would leave b the error of a measurement that knows it, sqrt(1 / 5); free, as on paper.
TEST(NonlinearFit, HoldsParametersAtTheirBoundsWhichAreUnknown) {
  const FitResult result = fit_parameters(
      {{.name = "a", .start = 2.0, .low = 1.0, .high = 5.0}, {.name = "b", .start = 0.0}},
      {.measured = {0.0, 1.0, 2.0}, .standard_deviation = {1.0, 1.0, 1.0}}, line);
  EXPECT_TRUE(result.parameters[0].is_at_bound);
  EXPECT_EQ(result.parameters[0].value, 1.0);
  EXPECT_NEAR(result.parameters[1].value, 0.4, 1e-8);  // of 0, 2 b = 0 1: (0 + 2) / 5
  for (const double error : {result.parameters[0].standard_deviation,
                             result.parameters[0].low_error, result.parameters[0].high_error})
    EXPECT_TRUE(std::isinf(error));
  EXPECT_NEAR(result.parameters[1].standard_deviation, std::sqrt(0.5), 1e-6);
  EXPECT_EQ(notes_with(result, "a: unknown, since it ended at its range, 1;"), 1);
}

TEST(NonlinearFit, TakesPriorsForWhatTheDataDoNotTell) {
  const FitModel sees_one{.predict = [](Values p) { return std::vector{p[0]}; }};
  const FitResult result =
      fit_parameters({{.name = "seen",
                       .start = 1.0,
                       .low = 0.1,
                       .high = 10.0,
                       .scale = FitScale::logarithmic,
                       .prior = FitPrior{2.0, 0.5}},
                      {.name = "unseen",
                       .start = 0.2,
                       .low = 0.0,
                       .high = 1.0,
                       .scale = FitScale::logit,
                       .prior = FitPrior{0.6, 0.4}}},
                     {.measured = {3.0}, .standard_deviation = {1e-4}}, sees_one);
  EXPECT_NEAR(result.parameters[0].value, 3.0, 1e-3);
  EXPECT_LT(result.parameters[0].prior_share, 1e-3);
  EXPECT_NEAR(result.parameters[1].value, 0.6, 1e-8);
  EXPECT_NEAR(result.parameters[1].prior_share, 1.0, 1e-9);
  EXPECT_EQ(notes_with(result, "unseen: from the prior"), 1);
  EXPECT_EQ(notes_with(result, "seen: from the prior"), 1);
}

// Of two Gaussians with a correlation, the second given the first has the mean and the standard
// deviation of the closed form.
TEST(NonlinearFit, LearnsFromPriorsThatGoTogether) {
  const FitModel sees_one{.predict = [](Values p) { return std::vector{p[0]}; }};
  const std::vector<FitParameter> parameters = {
      {.name = "seen", .start = 1.0, .prior = FitPrior{1.0, 0.5}},
      {.name = "unseen", .start = 3.0, .prior = FitPrior{4.0, 2.0}}};
  FitOptions options;
  options.prior_correlation = DenseMatrix(2, 2);
  options.prior_correlation.values = {1.0, 0.8, 0.8, 1.0};
  const FitData data{.measured = {2.0}, .standard_deviation = {1e-5}};
  const FitResult result = fit_parameters(parameters, data, sees_one, options);
  EXPECT_NEAR(result.parameters[0].value, 2.0, 1e-8);
  EXPECT_NEAR(result.parameters[1].value, 4.0 + 2.0 * 0.8 * (2.0 - 1.0) / 0.5, 1e-6);
  EXPECT_NEAR(result.parameters[1].standard_deviation, 2.0 * 0.6, 1e-6);
  EXPECT_NEAR(result.parameters[1].prior_share, 0.6, 1e-6);
  EXPECT_NEAR(result.prior_squares, 4.0, 1e-6);
  options.prior_correlation(0, 0) = 2.0;
  EXPECT_EQ(refusal(parameters, data, sees_one, options),
            "prior_correlation: must be 1 on the diagonal, but is 2 in row 0");
}

TEST(NonlinearFit, SaysWhatCannotBeTold) {
  const auto positive = [](const std::string& name) {
    return FitParameter{
        .name = name, .start = 1.3, .low = 1e-3, .high = 1e3, .scale = FitScale::logarithmic};
  };
  const FitModel scales{.predict = [](Values p) {
    return std::vector{p[0] * p[2], std::sqrt(p[1] * p[2]), p[0] / p[1]};
  }};
  const FitResult result =
      fit_parameters({positive("sigma_a"), positive("sigma_s"), positive("thickness")},
                     {.measured = {2.0, 1.5, 0.9}, .standard_deviation = {0.1, 0.1, 0.1}}, scales);
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_EQ(result.notes[0],
            "sigma_a and sigma_s divided and thickness multiplied by any one factor give the same "
            "prediction: the data cannot tell the scale");
  for (const FittedParameter& parameter : result.parameters)
    EXPECT_TRUE(std::isinf(parameter.standard_deviation));
  const FitModel sum{.predict = [](Values p) { return std::vector{p[0] + 2.0 * p[1]}; }};
  EXPECT_EQ(notes_with(fit_parameters({{.name = "a", .start = 1.0}, {.name = "b", .start = 1.0}},
                                      {.measured = {2.0}, .standard_deviation = {0.1}}, sum),
                       "a and b: the data tell a combination of them only"),
            1);
  const FitModel first{.predict = [](Values p) { return std::vector{p[0]}; }};
  EXPECT_EQ(notes_with(fit_parameters({{.name = "a", .start = 1.0}, {.name = "b", .start = 1.0}},
                                      {.measured = {2.0}, .standard_deviation = {0.1}}, first),
                       "b: the data do not depend on it"),
            1);
}

// The mean of many equal readings and one that is far off: Huber's estimate is the mean of the rest
// moved by limit / count.
TEST(NonlinearFit, RobustLossBoundsThePullOfOutliers) {
  const FitModel ten{.predict = [](Values p) { return std::vector(10, p[0]); }};
  FitData data{.measured = std::vector(10, 1.0), .standard_deviation = std::vector(10, 0.1)};
  data.measured[9] = 100.0;
  const std::vector<FitParameter> mean = {{.name = "mean", .start = 5.0}};
  EXPECT_NEAR(fit_parameters(mean, data, ten).parameters[0].value, 10.9, 1e-6);
  EXPECT_NEAR(fit_parameters(mean, data, ten, {.robust_limit = 1.5}).parameters[0].value,
              1.0 + 0.15 / 9.0, 1e-6);
}

TEST(NonlinearFit, SeveralStartsFindTheDeepestOfManyValleys) {
  const FitModel wave{.predict = [](Values p) {
    std::vector<double> y;
    for (int i = 0; i < 20; ++i) y.push_back(std::sin(p[0] * 0.5 * i));
    return y;
  }};
  const std::vector<double> truth = {3.1};
  const FitData data{.measured = wave.predict(truth), .standard_deviation = std::vector(20, 0.01)};
  const std::vector<FitParameter> frequency = {
      {.name = "f", .start = 1.0, .low = 0.5, .high = 5.0}};
  EXPECT_GT(fit_parameters(frequency, data, wave).chi_squared, 1.0);
  const FitResult found = fit_parameters(frequency, data, wave, {.starts = 40});
  EXPECT_NEAR(found.parameters[0].value, 3.1, 1e-6);
  EXPECT_GE(found.agreeing_starts, 2);
  EXPECT_LT(found.agreeing_starts, 40);
}

// 500 measurements with noise, truths drawn from the prior: the error bars hold what they say.
TEST(NonlinearFit, ErrorBarsCoverTheTruthAsOftenAsTheySay) {
  const FitModel decay{.predict = [](Values p) {
    std::vector<double> y;
    for (int i = 0; i < 12; ++i) y.push_back(p[0] * std::exp(-0.25 * i * p[1]) + 0.2 * p[2]);
    return y;
  }};
  const std::vector<FitParameter> parameters = {{.name = "a",
                                                 .start = 1.0,
                                                 .low = 1e-3,
                                                 .high = 1e3,
                                                 .scale = FitScale::logarithmic,
                                                 .prior = FitPrior{1.0, 0.3}},
                                                {.name = "b",
                                                 .start = 1.0,
                                                 .low = 1e-3,
                                                 .high = 1e3,
                                                 .scale = FitScale::logarithmic,
                                                 .prior = FitPrior{1.0, 0.4}},
                                                {.name = "c",
                                                 .start = 0.5,
                                                 .low = 0.0,
                                                 .high = 1.0,
                                                 .scale = FitScale::logit,
                                                 .prior = FitPrior{0.4, 0.6}}};
  constexpr int measurements = 500;
  std::vector<int> within_one(3, 0), within_two(3, 0);
  for (int k = 0; k < measurements; ++k) {
    Random random = make_random(7, static_cast<std::uint64_t>(k));
    std::vector<double> truth, coordinates;
    for (const FitParameter& p : parameters) {
      coordinates.push_back(fit_coordinate(p, p.prior->mean) +
                            p.prior->standard_deviation * normal_number(random));
      truth.push_back(fit_value(p, coordinates.back()));
    }
    FitData data{.measured = decay.predict(truth), .standard_deviation = std::vector(12, 0.03)};
    for (double& value : data.measured) value += 0.03 * normal_number(random);
    const FitResult result = fit_parameters(parameters, data, decay);
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      const double off =
          std::abs(fit_coordinate(parameters[j], result.parameters[j].value) - coordinates[j]) /
          result.parameters[j].standard_deviation;
      within_one[j] += off < 1.0;
      within_two[j] += off < 2.0;
    }
  }
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    EXPECT_GE(within_one[j], 0.60 * measurements) << parameters[j].name;
    EXPECT_LE(within_one[j], 0.75 * measurements) << parameters[j].name;
    EXPECT_GE(within_two[j], 0.93 * measurements) << parameters[j].name;
    EXPECT_LE(within_two[j], 0.975 * measurements) << parameters[j].name;
  }
}

TEST(NonlinearFit, RefusesWhatItCannotUse) {
  const FitModel one{.predict = [](Values p) { return std::vector{p[0]}; }};
  const FitData data{.measured = {1.0}, .standard_deviation = {0.1}};
  EXPECT_EQ(refusal({}, data, one), "fit: at least one parameter must be free");
  EXPECT_EQ(refusal({{.name = "x", .start = 3.0, .low = 0.0, .high = 1.0}}, data, one),
            "x: start must lie in [0, 1], but is 3");
  EXPECT_EQ(
      refusal({{.name = "x", .start = 1.0, .low = 0.0, .scale = FitScale::logarithmic}}, data, one),
      "x: low must be > 0 on a logarithmic scale, but is 0");
  EXPECT_EQ(refusal({{.name = "x", .start = 1.0, .prior = FitPrior{1.0, 0.0}}}, data, one),
            "x: standard deviation of the prior must be > 0, but is 0");
  const std::vector<FitParameter> x = {{.name = "x", .start = 1.0}};
  EXPECT_EQ(refusal(x, {.measured = {1.0}, .standard_deviation = {-0.1}}, one),
            "data: standard deviations must be > 0, but one is -0.1");
  EXPECT_EQ(refusal(x, {.measured = {1.0, 2.0}, .standard_deviation = {0.1}}, one),
            "data: standard_deviation must hold 2 numbers, one for each that was measured, but "
            "holds 1");
  EXPECT_EQ(
      refusal(x, {.measured = {1.0}, .standard_deviation = {1.0}, .has_known_errors = false}, one),
      "fit: 1 numbers cannot tell their errors and 1 parameters; give standard deviations");
  const FitModel none{.predict = [](Values) { return std::vector{std::nan("")}; }};
  EXPECT_EQ(refusal(x, data, none), "fit: the model predicts nothing at the start");
}

TEST(SymmetricEigen, PutsTheMatrixTogetherAgain) {
  DenseMatrix a(3, 3);
  a.values = {2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 2.0};
  const SymmetricEigen eigen = symmetric_eigen(a);
  EXPECT_NEAR(eigen.values[0], 2.0 - std::numbers::sqrt2, 1e-14);
  EXPECT_NEAR(eigen.values[2], 2.0 + std::numbers::sqrt2, 1e-14);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (std::size_t e = 0; e < 3; ++e)
        sum += eigen.values[e] * eigen.vectors(i, e) * eigen.vectors(j, e);
      EXPECT_NEAR(sum, a(i, j), 1e-14);
    }
}

}  // namespace
}  // namespace lamina
