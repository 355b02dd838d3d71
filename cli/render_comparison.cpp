// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "render_comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/files/image_frame.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/plot/picture_sheet.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/method_settings.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

constexpr double full_color = 0.2;  ///< relative difference, in the maps

struct MethodResult {
  std::string method;
  RenderResult render;
};

/// How far a picture is from the reference, over the mean of the reference.
struct MethodError {
  double mean = 0.0;                ///< absolute difference of luminance
  double of_noise = 0.0;            ///< what that would be if only noise made them differ
  std::array<double, 3> bias = {};  ///< difference of the means of R, G and B
};

MethodError error_against(const Image& image, const Image& reference) {
  const Image a = select_channels(image, {"R", "G", "B", "variance"});
  const Image b = select_channels(reference, {"R", "G", "B", "variance"});
  std::array<double, 3> sum_a{}, sum_b{};
  double apart = 0.0, of_noise = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); i += 4) {
    constexpr std::array weights = {0.2126, 0.7152, 0.0722};
    double difference = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      sum_a[c] += static_cast<double>(a.pixels[i + c]);
      sum_b[c] += static_cast<double>(b.pixels[i + c]);
      difference += weights[c] * static_cast<double>(a.pixels[i + c] - b.pixels[i + c]);
    }
    apart += std::abs(difference);
    const double variance =
        static_cast<double>(a.pixels[i + 3]) + static_cast<double>(b.pixels[i + 3]);
    of_noise += std::sqrt(variance * 2.0 / std::numbers::pi);  // mean of |x| if x is normal
  }
  const double total = 0.2126 * sum_b[0] + 0.7152 * sum_b[1] + 0.0722 * sum_b[2];
  MethodError error{.mean = apart / total, .of_noise = of_noise / total};
  for (std::size_t c = 0; c < 3; ++c) error.bias[c] = sum_a[c] / sum_b[c] - 1.0;
  return error;
}

void write_sheet(const Scene& scene, const std::vector<MethodResult>& results,
                 const MethodResult& slowest, const std::string& file) {
  const double exposure = static_cast<double>(scene.film.exposure);
  std::vector<SheetPicture> pictures;
  for (const auto& [method, render] : results)
    pictures.push_back({fmt::format("{}: {:.1f} CPU-s", method, render.statistics.cpu_seconds),
                        view_image(rgb_image(render.image), scene.film.view, exposure)});
  for (const MethodResult& result : results) {
    const bool is_slowest = &result == &slowest;
    pictures.push_back({is_slowest
                            ? "the reference"
                            : fmt::format("less {}: red +{:.0f} %, blue -{:.0f} %", slowest.method,
                                          100.0 * full_color, 100.0 * full_color),
                        difference_map(result.render.image, slowest.render.image, full_color)});
  }
  write_file(file, format_sheet("", pictures, static_cast<int>(results.size())));
}

}  // namespace

void run_comparison(Scene scene, const std::vector<NamedMethod>& methods, const fs::path& name,
                    const CommonOptions& common) {
  const auto beside = [&](const std::string& ending) { return name.string() + ending; };
  require_writable(beside(".svg"));
  for (const auto& [method, ignored] : methods)
    for (const char* ending : {".exr", ".png"}) require_writable(beside("_" + method + ending));

  std::vector<MethodResult> results;
  std::size_t refused = 0;
  const RenderSettings asked = scene.render;
  const auto places = scene.places;
  for (const auto& [method, chosen] : methods) {
    scene.render = asked;
    scene.places = places;
    scene.render.method = chosen;
    for (const std::string& line : leave_out_unhonoured(scene)) say("warning: " + line);
    try {
      MethodResult result{method, render(scene, {}, make_progress(method))};
      if (!result.render.statistics.is_complete) break;
      save_exr(result.render.image, beside("_" + method + ".exr"), ExrPrecision::half, {},
               RgbSpace::rec709, frame_of(scene.film));
      save_png(view_image(unpremultiplied(result.render.image), scene.film.view,
                          static_cast<double>(scene.film.exposure)),
               beside("_" + method + ".png"));
      results.push_back(std::move(result));
    } catch (const Interrupted&) {
      break;
    } catch (const InvalidInput& refusal) {  // the others can be compared all the same
      if (methods.size() - ++refused < 2) throw;
      say(fmt::format("warning: left out: {}", refusal.what()));
    }
  }
  if (results.empty()) return;
  const MethodResult& slowest = *std::ranges::max_element(
      results, {}, [](const MethodResult& result) { return result.render.statistics.cpu_seconds; });
  write_sheet(scene, results, slowest, beside(".svg"));

  std::string table =
      fmt::format("{}\n{:<14}{:>9}{:>9}{:>10}{:>9}   {:<14}{}\n", beside(".svg"), "method", "CPU s",
                  "samples", "noise %", "error %", "noise alone", "bias R G B %");
  JsonOutput json = make_result("render");
  json["reference"] = slowest.method;
  json["methods"] = JsonOutput::array();
  for (const MethodResult& result : results) {
    const RenderStatistics& s = result.render.statistics;
    const bool is_slowest = &result == &slowest;
    const MethodError error = error_against(result.render.image, slowest.render.image);
    const std::string noise =
        s.relative_noise ? fmt::format("{:.2f}", 100.0 * *s.relative_noise) : "-";
    table += fmt::format("{:<14}{:>9.1f}{:>9.4g}{:>10}", result.method, s.cpu_seconds,
                         s.samples_per_pixel, noise);
    JsonOutput row = {{"method", result.method},
                      {"wall_seconds", s.wall_seconds},
                      {"cpu_seconds", s.cpu_seconds},
                      {"samples_per_pixel", s.samples_per_pixel}};
    if (s.relative_noise) row["relative_noise"] = *s.relative_noise;
    if (s.relative_noise_rms) row["relative_noise_rms"] = *s.relative_noise_rms;
    if (is_slowest) {
      table += "        -   the reference\n";
    } else {
      table += fmt::format("{:>9.2f}   {:<14.2f}{:+.2f} {:+.2f} {:+.2f}\n", 100.0 * error.mean,
                           100.0 * error.of_noise, 100.0 * error.bias[0], 100.0 * error.bias[1],
                           100.0 * error.bias[2]);
      row["mean_error"] = error.mean;
      row["mean_error_of_noise"] = error.of_noise;
      row["bias"] = error.bias;
    }
    json["methods"].push_back(row);
  }
  write_json(json, common);
  print(common, table);
}

}  // namespace lamina::cli
