// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/core/bracketed_root.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/shared_gaussians.h"
#include "lamina/exchange/misfit_json.h"
#include "lamina/solve/scattering/profile/gaussian_fit.h"

namespace lamina::detail {
namespace {

/// A blur along a line, which leaves of a straight edge of light what the sum of Gaussians leaves.
struct LineKernel {
  std::vector<double> offsets;               ///< [tap] [mm], from 0 outward to both sides in turn
  std::vector<std::vector<double>> weights;  ///< [tap][channel]
};

/// The part of a Gaussian of unit flux left of x.
double part_below(double x, double variance) {
  if (variance == 0.0) return x >= 0.0 ? 1.0 : 0.0;
  return 0.5 * std::erfc(-x / std::sqrt(2.0 * variance));
}

/// Taps crowd toward the middle, as the square of their number. Each has the flux of the line's
/// profile up to halfway to its neighbours; the outermost have all beyond.
/// Source: the arrangement is that of [Jimenez2015] §4; the weights are integrals, not samples.
LineKernel line_kernel(const SharedGaussians& sums, int taps_per_side) {
  constexpr double flux_beyond = 0.005;
  double range = 0.0;
  for (std::size_t c = 0; c < sums.weights.size(); ++c) {
    double total = 0.0;
    for (const double weight : sums.weights[c]) total += weight;
    const auto beyond = [&](double x) {
      double sum = 0.0;
      for (std::size_t i = 0; i < sums.variances.size(); ++i)
        sum += sums.weights[c][i] * 2.0 * part_below(-x, sums.variances[i]);
      return sum;
    };
    const double widest = 10.0 * std::sqrt(sums.variances.back());
    const auto excess = [&](double x) { return beyond(x) - flux_beyond * total; };
    range = std::max(range, falling_root(excess, 0.0, widest, 1e-9 * total).place);
  }
  LineKernel kernel;
  for (int i = -taps_per_side; i <= taps_per_side; ++i) {
    const double place = static_cast<double>(i) / taps_per_side;
    kernel.offsets.push_back(range * place * std::abs(place));
  }
  const std::size_t taps = kernel.offsets.size();
  for (std::size_t t = 0; t < taps; ++t) {
    kernel.weights.emplace_back();
    for (const std::vector<double>& weights : sums.weights) {
      double flux = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) {
        const double below = t == 0 ? 0.0
                                    : part_below(0.5 * (kernel.offsets[t - 1] + kernel.offsets[t]),
                                                 sums.variances[i]);
        const double above =
            t + 1 == taps
                ? 1.0
                : part_below(0.5 * (kernel.offsets[t] + kernel.offsets[t + 1]), sums.variances[i]);
        flux += weights[i] * (above - below);
      }
      kernel.weights.back().push_back(flux);
    }
  }
  return kernel;
}

JsonOutput sums_json(const SharedGaussians& sums, double mm_per_unit) {
  std::vector<double> widths, scene_widths;
  for (const double variance : sums.variances) {
    widths.push_back(std::sqrt(variance));
    scene_widths.push_back(std::sqrt(variance) / mm_per_unit);
  }
  JsonOutput weights = JsonOutput::array();
  for (std::size_t i = 0; i < sums.variances.size(); ++i) {
    JsonOutput row = JsonOutput::array();
    for (const std::vector<double>& of_channel : sums.weights) row.push_back(of_channel[i]);
    weights.push_back(row);
  }
  return {{"variance_mm2", sums.variances},
          {"width_mm", widths},
          {"width_scene_units", scene_widths},
          {"weights", weights},
          {"largest_flux_error", sums.largest_error}};
}

JsonOutput kernel_json(const LineKernel& kernel, double mm_per_unit) {
  std::vector<double> scene_offsets;
  for (const double offset : kernel.offsets) scene_offsets.push_back(offset / mm_per_unit);
  return {
      {"offset_mm", kernel.offsets},
      {"offset_scene_units", scene_offsets},
      {"weights", kernel.weights},
      {"note",
       "blurs along x, then along y, weights over their sum the second time; right for straight "
       "edges of light along x or y, else an approximation"}};
}

/// A sum of Gaussians as a profile at the radii of another.
void put_profile(const SharedGaussians& sums, std::vector<double>& profile,
                 std::vector<double>& totals, const Profile& like) {
  profile.clear();
  totals.clear();
  std::vector<GaussianSum> of_channels;
  for (const std::vector<double>& weights : sums.weights) {
    of_channels.push_back({sums.variances, weights});
    totals.push_back(0.0);
    for (const double weight : weights) totals.back() += weight;
  }
  for (const double r : like.r)
    for (const GaussianSum& sum : of_channels) profile.push_back(evaluate(sum, r));
}

}  // namespace

ExportedMaterial write_gaussians(const ExportInput& input) {
  const ChannelLight& light = *input.light;
  const double mm_per_unit = input.options.mm_per_unit;
  constexpr int taps_per_side = 12;
  ExportedMaterial result;
  Profile obtained = light.profile;
  const SharedGaussians reflected =
      fit_shared_gaussians(light.profile, true, input.options.gaussians);
  put_profile(reflected, obtained.reflectance_profile, obtained.total_reflectance, light.profile);
  JsonOutput json = head_json(input, "gaussians");
  json["meaning"] =
      "R(r) = sum of weights[i][channel] exp(-r^2 / (2 variance[i])) / (2 pi variance[i]), of "
      "diffuse light per arriving flux; the first reflection is left out. Weights sum to the "
      "diffuse color.";
  json["reflectance"] = sums_json(reflected, mm_per_unit);
  json["reflectance"]["separable_kernel"] =
      kernel_json(line_kernel(reflected, taps_per_side), mm_per_unit);
  if (light.transmits) {
    const SharedGaussians transmitted =
        fit_shared_gaussians(light.profile, false, input.options.gaussians);
    put_profile(transmitted, obtained.transmittance_profile, obtained.total_transmittance,
                light.profile);
    json["transmittance"] = sums_json(transmitted, mm_per_unit);
  }
  result.misfits = channel_misfits(light, obtained);
  json["misfit"] = misfit_json(result.misfits);
  result.files.push_back({input.stem + "_gaussians.json", json.text(1) + "\n"});
  return result;
}

}  // namespace lamina::detail
