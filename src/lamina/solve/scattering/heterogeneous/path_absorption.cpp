// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/path_absorption.h"

#include <cassert>
#include <cmath>

#include "lamina/layers/optics/medium.h"

namespace lamina {
namespace {

struct PathGaussian {
  double share, width;  ///< in decay lengths
};
constexpr std::array<PathGaussian, 2> path_gaussians = {{{0.7, 0.5}, {0.3, 0.05}}};

double decay(double sigma_a, double reduced_scattering) {
  return sigma_tr(Medium{.sigma_a = sigma_a, .sigma_s = reduced_scattering, .g = 0.0});
}

}  // namespace

template <class T>
void PathAbsorption<T>::add_neighbors(std::size_t one, std::size_t other) {
  const auto a = static_cast<double>(sigma_a_[one]), b = static_cast<double>(sigma_a_[other]);
  if (a == b) return;
  decays_ +=
      std::abs(a - b) * 0.5 * (decay(a, reduced_scattering_) + decay(b, reduced_scattering_));
  differences_ += std::abs(a - b);
}

template <class T>
double PathAbsorption<T>::decay_length() const {
  return decays_ > 0.0 ? differences_ / decays_ : 0.0;
}

template <class T>
void PathAbsorption<T>::add_derivatives(std::size_t one, std::size_t other, double by_log_length,
                                        std::span<T> by_sigma_a) const {
  const auto a = static_cast<double>(sigma_a_[one]), b = static_cast<double>(sigma_a_[other]);
  if (a == b) return;
  const double mean = 0.5 * (decay(a, reduced_scattering_) + decay(b, reduced_scattering_));
  // d|a - b| / d sigma_a, and d sigma_tr / d sigma_a of sigma_tr² = 3 sigma_a (sigma_a + sigma_s')
  const double by_difference = by_log_length * (1.0 / differences_ - mean / decays_);
  const double sign = a > b ? 1.0 : -1.0;
  const auto by_end = [&](double sigma_a) {
    const double slope =
        1.5 * (2.0 * sigma_a + reduced_scattering_) / decay(sigma_a, reduced_scattering_);
    return by_log_length * 0.5 * std::abs(a - b) * slope / decays_;
  };
  by_sigma_a[one] += static_cast<T>(sign * by_difference - by_end(a));
  by_sigma_a[other] += static_cast<T>(-sign * by_difference - by_end(b));
}

template class PathAbsorption<float>;
template class PathAbsorption<double>;

std::array<double, 2> path_variances(double decay_length) {
  return {std::pow(path_gaussians[0].width * decay_length, 2),
          std::pow(path_gaussians[1].width * decay_length, 2)};
}

std::vector<double> sum_by_shares(const std::array<std::vector<double>, 2>& scales) {
  std::vector<double> sum(scales[0].size());
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] = path_gaussians[0].share * scales[0][i] + path_gaussians[1].share * scales[1][i];
  return sum;
}

bool follows_absorption(const LayerTexels& texels) {
  return varies_in_absorption_only(texels) && texels.sigma_a.size() > 1;
}

double reduced_scattering(const LayerTexels& texels) {
  assert(varies_in_absorption_only(texels));
  return static_cast<double>(texels.sigma_s[0]) * (1.0 - static_cast<double>(texels.g[0]));
}

}  // namespace lamina
