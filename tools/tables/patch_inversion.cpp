// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The table of docs/acquire.md, "With lateral transport": what each method makes of a synthetic
// patch, in how many forward equivalents and seconds.
//
//     patch_inversion [SIZE [METHOD...]]
#include "lamina/acquire/inversion/patch_inversion.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "acquire/inversion/synthetic_patch.h"
#include "lamina/core/parallel.h"

namespace {

using namespace lamina;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void print_course(const InversionResult& result) {
  std::printf("  forwards to");
  for (const double share : {0.04, 0.02, 0.01, 0.0055}) {
    const auto found = std::ranges::find_if(
        result.history, [&](const InversionStep& step) { return step.residual < share; });
    std::printf("  %.3g %%: ", 100.0 * share);
    if (found == result.history.end())
      std::printf("never");
    else
      std::printf("%.0f", found->forwards);
  }
  const InversionStep& last = result.history.back();
  std::printf("; %.3f %% (%.3f deviations) after %.0f, %s\n   ", 100.0 * last.residual,
              last.in_deviations, last.forwards, std::string(name_of(result.stop)).c_str());
  for (std::size_t i = 0; i < result.history.size() && i < 12; ++i)
    std::printf(" %.0f:%.3f%%/%.4g", result.history[i].forwards,
                100.0 * result.history[i].residual, result.history[i].objective);
  std::printf("\n  smoothness");
  for (const double weight : result.smoothness) std::printf(" %.3g", weight);
  std::printf("\n");
}

void print_maps(const SyntheticPatch& patch, const InversionTables& tables,
                const InversionResult& result) {
  const auto print = [&](const char* name, const auto& found, const auto& wanted) {
    const MapError error = map_error(patch.capture, found, wanted);
    std::printf("  %-22s %6.2f %%  correlation %.3f", name, 100.0 * error.relative,
                error.correlation);
  };
  const auto value = [&](std::size_t n) {
    return [&, n](std::size_t t) { return static_cast<double>(result.numbers[n].value.values[t]); };
  };
  const auto truth = [&](std::size_t n) {
    return [&, n](std::size_t t) { return static_cast<double>(patch.truth[n].values[t]); };
  };
  for (std::size_t n = 0; n < result.numbers.size(); ++n) {
    print(result.numbers[n].name.c_str(), value(n), truth(n));
    if (!result.numbers[n].deviation.values.empty()) {
      const FitParameter& parameter = tables.numbers[n].parameter;
      double covered = 0.0, known = 0.0, mean = 0.0, off = 0.0, share = 0.0, bias = 0.0;
      std::vector<double> sizes;
      for (std::size_t t = 0; t < patch.truth[n].values.size(); ++t) {
        if (std::isinf(patch.capture.images[0].deviation.values[t])) continue;
        const double miss =
            fit_coordinate(parameter, value(n)(t)) - fit_coordinate(parameter, truth(n)(t));
        const auto deviation = static_cast<double>(result.numbers[n].deviation.values[t]);
        known += 1.0;
        bias += miss;
        sizes.push_back(std::abs(miss));
        covered += std::abs(miss) < deviation ? 1.0 : 0.0;
        mean += deviation;
        off += miss * miss;
        share += static_cast<double>(result.numbers[n].prior_share.values[t]);
      }
      std::ranges::sort(sizes);
      std::printf("  covered %.0f %%  deviation %.4f, missed by %.4f (bias %.3f, 68 %% within %.4f), prior share %.3f",
                  100.0 * covered / known, mean / known, std::sqrt(off / known), bias / known,
                  sizes[sizes.size() * 68 / 100], share / known);
    }
    std::printf("\n");
  }
  print(
      "eumelanin", [&](std::size_t t) { return value(0)(t) * value(1)(t); },
      [&](std::size_t t) { return truth(0)(t) * truth(1)(t); });
  std::printf("\n");
}

}  // namespace

int main(int count, char** arguments) {
  const int size = count > 1 ? std::atoi(arguments[1]) : 96;
  std::vector<std::string> methods(arguments + std::min(count, 2), arguments + count);
  if (methods.empty()) methods = {"per_pixel", "gauss_newton", "lbfgs", "gradient_descent"};
  const char* samples = std::getenv("SAMPLES");
  const std::optional<DiskCache> cache = user_cache();
  auto start = std::chrono::steady_clock::now();
  const SyntheticPatch patch = make_synthetic_patch({.size = size, .is_finer = !std::getenv("COARSE"), .cache = cache});
  std::printf("%d x %d texels, %zu bands, %d threads; truth %.1f s", size, size,
              patch.capture.images.size(), thread_count(), seconds_since(start));
  start = std::chrono::steady_clock::now();
  InversionModel model;
  model.skin = with_constants({}, SkinConstants::paper);
  const InversionTables tables = make_inversion_tables(patch.capture, model, cache);
  std::printf(", tables %.1f s\n", seconds_since(start));
  std::vector<double> ideal;
  std::printf("  smoothness of the truth");
  for (std::size_t n = 0; n < tables.numbers.size(); ++n) {
    double squares = 0.0, texels = 0.0;
    for (int y = 0; y + 1 < size; ++y)
      for (int x = 0; x + 1 < size; ++x) {
        const auto t = static_cast<std::size_t>(y * size + x);
        if (std::isinf(patch.capture.images[0].deviation.values[t])) continue;
        const auto at = [&](std::size_t texel) {
          return fit_coordinate(tables.numbers[n].parameter,
                                static_cast<double>(patch.truth[n].values[texel]));
        };
        squares += std::pow(at(t) - at(t + 1), 2) +
                   std::pow(at(t) - at(t + static_cast<std::size_t>(size)), 2);
        texels += 1.0;
      }
    ideal.push_back(texels / squares);
    std::printf(" %.3g", ideal.back());
  }
  std::printf("\n");
  for (const std::string& method : methods) {
    InversionOptions options;
    options.method = *find_enum_value<InversionMethod>(method);
    if (method == "lbfgs") options.most_forwards = 200.0;
    if (method == "gradient_descent") options.most_forwards = 1300.0;
    if (std::getenv("UNIFORM"))
      for (const double value : {0.02, 0.6, 0.003, 0.012, 0.003})
        options.start.push_back(make_plane(size, size, static_cast<float>(value)));
    if (std::getenv("TRUTH")) options.start = {patch.truth.begin(), patch.truth.end()};
    if (const char* most = std::getenv("MOST")) options.most_forwards = std::atof(most);
    if (std::getenv("IDEAL")) options.smoothness = ideal;
    if (samples) options.deviation_samples = std::atoi(samples);
    start = std::chrono::steady_clock::now();
    const InversionResult result = invert_patch(patch.capture, tables, options);
    std::printf("%s: %.2f s\n", method.c_str(), seconds_since(start));
    print_course(result);
    for (std::size_t i = 0; i < result.residual.size(); ++i) {
      double n = 0, a = 0, aa = 0, c = 0;
      for (std::size_t t = 0; t < result.residual[i].values.size(); ++t) {
        if (std::isinf(patch.capture.images[i].deviation.values[t])) continue;
        const double m = result.residual[i].values[t] -
                         (patch.capture.images[i].reflected.values[t] - patch.clean[i].values[t]);
        n += 1, a += m, aa += m * m, c += patch.clean[i].values[t];
      }
      std::printf("  image %zu: clean mean %.3f, off by %.3f %% mean, %.3f %% rms\n", i, c / n,
                  100 * a / c, 100 * std::sqrt(aa / n) / (c / n));
    }
    print_maps(patch, tables, result);
    std::fflush(stdout);
  }
}
