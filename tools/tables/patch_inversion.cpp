// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The table of docs/acquire_accuracy.md, "With lateral transport": maps of a synthetic patch by
// texel and by invert_patch, in how many forward equivalents and seconds.
//
//     patch_inversion [SIZE [SAMPLES [noise=SHARE | calibrated]...]]
//
// SIZE is the side in texels, a multiple of 16; SAMPLES are those of the standard deviations. Noise
// is .005 of the mean of each image, constants of skin are those of the paper unless "calibrated".
// The cache of the user keeps the tables.
#include "lamina/skin/acquire/inversion/patch_inversion.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "skin/acquire/inversion/synthetic_patch.h"

namespace {

using namespace lamina;

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  [[nodiscard]] double processor_seconds() const {
    return static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::clock_t processor_start_ = std::clock();
};

/// In how many forward equivalents the residual, relative to each image's mean, falls below shares.
void print_course(const InversionResult& result) {
  std::printf("  forwards to");
  for (const double share : {0.04, 0.02, 0.01, 0.0055}) {
    const auto found = std::ranges::find_if(
        result.history, [&](const InversionStep& step) { return step.residual < share; });
    if (found == result.history.end())
      std::printf("  %g %%: never", 100.0 * share);
    else
      std::printf("  %g %%: %.0f", 100.0 * share, found->forwards);
  }
  const InversionStep& last = result.history.back();
  std::printf("\n  residual %.3f %%, %.3f standard deviations after %.0f: %s; smoothness",
              100.0 * last.residual, last.in_deviations, last.forwards,
              std::string(name_of(result.stop)).c_str());
  for (const double weight : result.smoothness) std::printf(" %.3g", weight);
  std::printf("\n");
}

/// How often a map misses the truth by less than one standard deviation.
void print_coverage(const SyntheticPatch& patch, const FitParameter& parameter,
                    const NumberMap& found, const Plane& truth) {
  double covered = 0.0, known = 0.0, deviation = 0.0, squares = 0.0, share = 0.0, off = 0.0;
  for (std::size_t t = 0; t < truth.values.size(); ++t) {
    if (std::isinf(patch.capture.images[0].deviation.values[t])) continue;
    const double miss = fit_coordinate(parameter, static_cast<double>(found.value.values[t])) -
                        fit_coordinate(parameter, static_cast<double>(truth.values[t]));
    const auto expected = static_cast<double>(found.deviation.values[t]);
    known += 1.0;
    covered += std::abs(miss) < expected ? 1.0 : 0.0;
    deviation += expected;
    squares += miss * miss;
    off += miss / expected;
    share += static_cast<double>(found.prior_share.values[t]);
  }
  std::printf("  covers %2.0f %%, deviation %.4f, error %.4f, mean %.2f of it, of the prior %.3f",
              100.0 * covered / known, deviation / known, std::sqrt(squares / known), off / known,
              share / known);
}

void print_maps(const SyntheticPatch& patch, const InversionTables& tables,
                const InversionResult& result) {
  const auto print = [&](const std::string& name, const auto& found, const auto& wanted) {
    const MapError error = map_error(patch.capture, found, wanted);
    std::printf("  %-21s %6.2f %%  correlation %.3f", name.c_str(), 100.0 * error.relative,
                error.correlation);
  };
  const auto found = [&](std::size_t n) {
    return [&, n](std::size_t t) { return static_cast<double>(result.numbers[n].value.values[t]); };
  };
  const auto truth = [&](std::size_t n) {
    return [&, n](std::size_t t) { return static_cast<double>(patch.truth[n].values[t]); };
  };
  for (std::size_t n = 0; n < result.numbers.size(); ++n) {
    print(result.numbers[n].name, found(n), truth(n));
    if (!result.numbers[n].deviation.values.empty())
      print_coverage(patch, tables.numbers[n].parameter, result.numbers[n], patch.truth[n]);
    std::printf("\n");
  }
  print(
      "eumelanin", [&](std::size_t t) { return found(0)(t) * found(1)(t); },
      [&](std::size_t t) { return truth(0)(t) * truth(1)(t); });
  std::printf("\n");
}

}  // namespace

int main(int count, char** arguments) {
  const int size = count > 1 ? std::atoi(arguments[1]) : 96;
  const int samples = count > 2 ? std::atoi(arguments[2]) : 0;
  SyntheticSetup setup{.size = size, .cache = user_cache()};
  InversionModel model;
  model.skin = with_constants({}, SkinConstants::paper);
  for (int i = 3; i < count; ++i) {
    const std::string word = arguments[i];
    if (word.starts_with("noise=")) setup.noise = std::atof(word.c_str() + 6);
    if (word == "calibrated") setup.skin = model.skin = {};
  }
  const SyntheticPatch patch = make_synthetic_patch(setup);
  const Stopwatch of_tables;
  const InversionTables tables = make_inversion_tables(patch.capture, model, setup.cache);
  std::printf("%d x %d texels, %zu bands, %d threads; tables %.1f s\n", size, size,
              patch.capture.images.size(), thread_count(), of_tables.seconds());
  for (const bool is_by_texel : {true, false}) {
    InversionOptions options{.is_by_texel = is_by_texel};
    const Stopwatch of_maps;
    InversionResult result = invert_patch(patch.capture, tables, options);
    std::printf("%s: %.2f s, %.2f of processors\n",
                is_by_texel ? "each texel by itself" : "Gauss-Newton", of_maps.seconds(),
                of_maps.processor_seconds());
    print_course(result);
    if (samples > 0 && !is_by_texel) {
      // The same again from where it ended, with errors.
      options.deviation_samples = samples;
      options.smoothness = result.smoothness;
      for (const NumberMap& map : result.numbers) options.start.push_back(map.value);
      options.most_forwards = 3.0;
      const Stopwatch of_errors;
      result = invert_patch(patch.capture, tables, options);
      std::printf("  standard deviations: %.0f forwards, %.2f s, %.2f of processors\n",
                  result.deviation_forwards, of_errors.seconds(), of_errors.processor_seconds());
    }
    print_maps(patch, tables, result);
    std::fflush(stdout);
  }
}
