// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/skin/fit/predicted/measurement_tables.h"
#include "lamina/skin/fit/predicted/recipe_totals.h"
#include "lamina/skin/fit/predicted/timed_prediction.h"

namespace lamina::fit_detail {

/// A number that a fit finds: one that is free, in one band if it is per band.
struct Unknown {
  std::size_t free = 0;
  std::size_t band = 0;  ///< 0 if it is not per band
};

/// Some bands of a measurement as a function of what is unknown in them.
///
/// What comes through over decades, unscattered light and profiles over radius, counts by its
/// logarithm where it is known to better than a third.
class MeasurementModel {
 public:
  /// @param bands   of the points that count; what is free per band is unknown in these.
  /// @param tables  that series use in place of solvers
  MeasurementModel(const Measurement& measurement, std::vector<std::size_t> bands,
                   const MeasurementTables& tables, Progress progress);

  [[nodiscard]] const std::vector<Unknown>& unknowns() const { return unknowns_; }
  [[nodiscard]] std::vector<FitParameter> parameters() const;
  [[nodiscard]] FitData data() const;
  /// How priors go together, as in FitOptions.
  [[nodiscard]] DenseMatrix prior_correlation() const;

  /// By quick solutions times the correction; not finite where the material cannot be so.
  [[nodiscard]] std::vector<double> predict(std::span<const double> values) const;

  /// Derivatives, [point][unknown]: of what layers are made of exactly by the solver, times central
  /// differences of that by the unknowns; central differences of all where indices or boundaries
  /// change, and of profiles.
  [[nodiscard]] DenseMatrix derivatives(std::span<const double> values) const;

  /// Whether all derivatives of a series are exact there.
  [[nodiscard]] bool is_exact(std::size_t series, std::span<const double> values) const;

  /// Factors of measured curves that nobody knows, which take as many numbers.
  [[nodiscard]] std::size_t unknown_factors() const;

  /// Noise of photons, which adds to the errors of data, [point][independent part of it]; no
  /// columns if there is none.
  [[nodiscard]] DenseMatrix photon_noise(std::span<const double> values) const;
  [[nodiscard]] double photons() const;  ///< most that a curve was corrected by

  /// Whether there are solutions that can be corrected, and not only tables.
  [[nodiscard]] bool has_solutions() const { return !parts_.empty(); }

  /// From now on predictions are times what makes them right at these values; with derivatives,
  /// those that corrects_derivatives() names also times what makes their derivatives right there,
  /// by differences of accurate solutions.
  void correct(std::span<const double> values, bool with_derivatives);

  /// Where the points of the model lie in the measurement, and what they are without logarithms.
  struct Place {
    std::size_t series, point;
  };
  [[nodiscard]] std::vector<Place> places() const;
  [[nodiscard]] double plain(std::size_t i, double number) const;

 private:
  struct Part {  ///< the points of a series in a band
    std::size_t series, band, first;
    std::vector<std::size_t> indices;  ///< in the series
    std::vector<MeasuredPoint> points;
    std::shared_ptr<TimedPrediction> timed;  ///< over time or frequency; else null
  };
  [[nodiscard]] std::vector<double> predict_model(std::span<const double> values) const;
  /// Errors of the model of a population, which go together.
  void add_missed_scatter(FitData& data) const;
  /// A curve of what that model misses, where reflectance is measured. [row]
  [[nodiscard]] std::vector<double> over_rows(std::span<const double> missed) const;
  [[nodiscard]] std::vector<LayerStack> stacks(std::span<const double> values) const;
  struct Sides {                                   ///< of a free number, in all its bands
    std::vector<double> value_below, value_above;  ///< [unknown]
    std::vector<LayerStack> below, above;          ///< [band]
  };
  /// [free number] A little less and a little more of each.
  [[nodiscard]] std::vector<Sides> both_sides(std::span<const double> values,
                                              const std::vector<LayerStack>& at) const;
  /// Puts what a table says of a part in its rows; of derivatives if they are given.
  void look_up(const Part& part, std::span<const double> values, std::span<double> predicted,
               DenseMatrix* derivatives) const;
  [[nodiscard]] std::size_t place_of(std::size_t band) const;  ///< in bands_
  [[nodiscard]] bool depends(const Part& part, std::size_t unknown) const;
  [[nodiscard]] std::vector<double> coordinates(std::span<const double> values) const;
  /// How far an unknown is from where predictions were corrected: along its coordinate, or along
  /// its value where light is lost, which stays as it is where absorption goes to 0.
  struct CorrectionStep {
    double length;
    double value_derivative;  ///< of the unknown by the length
  };
  /// [unknown], or empty where derivatives are not corrected
  [[nodiscard]] std::vector<CorrectionStep> correction_steps(const Part& part,
                                                             std::span<const double> values) const;
  [[nodiscard]] double correction_at(std::size_t row, std::span<const CorrectionStep> steps) const;
  void correct_derivatives(std::span<const double> values);

  const Measurement& measurement_;
  std::vector<std::size_t> bands_;
  Progress progress_;
  std::vector<Unknown> unknowns_;
  std::vector<std::shared_ptr<const RecipeTotals>> tables_;  ///< [series] null: it is solved
  std::vector<Part> parts_, looked_up_;                      ///< solved, and by tables
  std::vector<bool> is_logarithmic_;                         ///< [point]
  std::vector<double> missed_;      ///< [point] by the model of a population; empty without one
  std::vector<double> correction_;  ///< [point] factor
  DenseMatrix
      derivative_correction_;  ///< [point][unknown] of its logarithm by coordinates, or empty
  std::vector<double> corrected_at_;  ///< [unknown] coordinates
};

}  // namespace lamina::fit_detail
