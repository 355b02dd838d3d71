// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/image/image.h"

namespace lamina {

/// A render with what is known about its noise.
struct RenderEstimate {
  Image mean;
  Image variance;  ///< of the mean, not of single samples; same size and channels
};

struct ImageComparison {
  bool agrees = false;            ///< neither test below fails
  double smallest_p_value = 1.0;  ///< of any pixel and channel, by its own z-test
  double threshold = 0.0;      ///< below it some pixel differs: significance / 2 / number of tests
  std::size_t differing = 0;   ///< pixels and channels below the threshold
  double bias_z = 0.0;         ///< difference of the image means over its standard error
  double mean_square_z = 0.0;  ///< 1 if the variances are right and nothing differs
  double rmse = 0.0;
  Image p_values;  ///< channel "Y": the smallest p-value of a pixel's channels

  /// One line: what agrees or differs, and by how much.
  [[nodiscard]] std::string report() const;
};

/// Whether two renders show the same scene, within their noise.
///
/// Each pixel and channel has a two-sided z-test, corrected for their number (Bonferroni), and the
/// mean of the image has one, which finds a bias too small for single pixels. Images of one scene
/// are taken to differ with a probability of at most `significance`, as long as means of pixels are
/// about normal: with heavy-tailed noise or fewer than about 50 samples per pixel it is more.
/// @throws InvalidInput if sizes or channels differ, or a variance is negative or a value not
/// finite.
[[nodiscard]] ImageComparison compare_renders(const RenderEstimate& a, const RenderEstimate& b,
                                              double significance = 1e-3);

/// Root of the mean squared difference over all pixels and channels.
/// @throws InvalidInput if sizes or channels differ.
[[nodiscard]] double root_mean_square_difference(const Image& a, const Image& b);

/// How noisy a render looks: the median over lit pixels of |pixel - mean of its 4 neighbours| over
/// that mean, in luminance (channels 0 to 2; of fewer channels in the first). Lit are those whose
/// mean is at least a quarter of the average. Absent if there is no such pixel.
///
/// Independent Gaussian noise of relative standard deviation s gives 0.754 s; detail of the picture
/// adds to it.
///
/// @param is_measured  [y][x], whether a pixel counts; it must do with its four neighbours
/// @throws             InvalidInput if the sizes differ.
[[nodiscard]] std::optional<double> relative_noise(const Image& image,
                                                   const std::vector<bool>& is_measured);

/// The noise of a render with its outliers, which the median of relative_noise does not see: root
/// of the mean over the same pixels of (pixel - mean of its 4 neighbours)² over 5/4 of that mean
/// squared. A difference counts up to three of its standard errors, by channel "variance": what is
/// further apart is detail of the picture. Absent if there is no such pixel, no such channel, or no
/// variance in it, as after one sample per pixel.
///
/// Independent noise of relative standard deviation s gives s, rare samples of much light included.
///
/// @param is_measured  as of relative_noise
/// @throws             InvalidInput if the sizes differ.
[[nodiscard]] std::optional<double> relative_noise_rms(const Image& image,
                                                       const std::vector<bool>& is_measured);

}  // namespace lamina
