// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// The methods of subsurface light against converged random walks: time, noise, error and memory, on
// shapes that flat profiles get wrong each in its own way.
//
// usage: subsurface_methods reference DIR [SIZE] [SCENE ...]   makes SCENE_1.exr, SCENE_2.exr there
//        subsurface_methods measure DIR [FIGURE.svg]           the table of docs/measurements/
//
// A reference is two halves by random_walk of seeds of their own, so that its noise is known and
// taken out. What exists is kept, and a half that was broken off goes on. SIZE is that of the
// longer side of the picture; methods are measured at the size of the reference that is there.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/image/files/image_file.h"
#include "lamina/base/plot/plot.h"
#include "lamina/render/render.h"
#include "light_error.h"
#include "run_apart.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;
namespace fs = std::filesystem;

struct Place {
  const char* name;
  const char* title;
  const char* file;       ///< from the root of the sources
  int reference_samples;  ///< of a half, for some 2 % of noise at 128²; layers, bones: more
};

constexpr std::array<Place, 9> places = {{
    {"sphere", "ball", "benchmarks/scenes/sphere.json", 96},
    {"bumpy", "bumpy", "scenes/bumpy.json", 96},
    {"cube_edge", "edge of 90°", "benchmarks/scenes/cube_edge.json", 128},
    {"cube_corner", "corner of 90°", "benchmarks/scenes/cube_corner.json", 128},
    {"thin_sheet", "sheet of 2 mm", "benchmarks/scenes/thin_sheet.json", 128},
    {"ear", "ear", "benchmarks/scenes/ear.json", 256},
    {"finger", "finger with bones", "scenes/finger.json", 1024},
    {"layered_ball", "layered ball", "benchmarks/scenes/layered_ball.json", 256},
    {"freckled_ball", "freckled ball", "benchmarks/scenes/freckled_ball.json", 192},
}};

struct Tried {
  const char* name;
  Method method;
  bool is_corrected;
  std::vector<int> samples;  ///< of a pixel; the table shows the last
};

std::vector<Tried> all_tried() {
  return {{"shadow_map", Method::shadow_map, false, {4, 16}},
          {"probe", Method::probe, false, {4, 16, 64}},
          {"texture_space", Method::texture_space, false, {4, 16}},
          {"texture_space, corrected", Method::texture_space, true, {4, 16}},
          {"hierarchy", Method::hierarchy, false, {4, 16}},
          {"hierarchy, corrected", Method::hierarchy, true, {4, 16}},
          {"random_walk", Method::random_walk, false, {4, 16}}};
}

/// The scene with the longer side of its picture `size` pixels long.
Scene load_place(const Place& place, int size) {
  Scene scene = load_scene(fs::path(LAMINA_SOURCE_DIR) / place.file);
  const double scale = static_cast<double>(size) / std::max(scene.film.width, scene.film.height);
  scene.film.width = static_cast<int>(std::lround(scene.film.width * scale));
  scene.film.height = static_cast<int>(std::lround(scene.film.height * scale));
  return scene;
}

RenderResult picture(Scene scene, Method method, bool is_corrected, int samples, std::uint64_t seed,
                     const RenderOptions& options = {}) {
  scene.render.method = method;
  scene.render.is_corrected = is_corrected;
  scene.render.samples_per_pixel = samples;
  scene.render.seed = seed;
  return render(scene, options);
}

fs::path reference_file(const fs::path& folder, const Place& place, int half) {
  return folder / (std::string(place.name) + "_" + std::to_string(half) + ".exr");
}

bool is_missing(const Place& place) {
  return std::string_view(place.name) == "ear" &&
         !fs::exists(fs::path(LAMINA_SOURCE_DIR) / "demo/assets/head.obj");
}

void make_reference(const fs::path& folder, const Place& place, int size) {
  for (const int half : {1, 2}) {
    const fs::path file = reference_file(folder, place, half);
    if (fs::exists(file)) continue;
    fs::path part = file;
    part.replace_extension(".part");
    try {
      const RenderResult made =
          picture(load_place(place, size), Method::random_walk, false, place.reference_samples,
                  100U + static_cast<unsigned>(half), {.checkpoint = part, .resumes = true});
      save_exr(subsurface_light(made.image), file);
      std::printf("%s: %.0f CPU-s\n", file.c_str(), made.statistics.cpu_seconds);
    } catch (const Error& error) {
      std::printf("%s: %s\n", place.name, error.what());
      return;
    }
    std::fflush(stdout);
  }
}

struct Row {
  double cpu_seconds = 0.0, memory = 0.0;  ///< [MiB]
  std::array<LightError, 3> error{};       ///< of R, G, B
  bool has_reference = false;
  std::array<char, 400> refusal{};  ///< why there are no numbers; empty: there are
};

/// Two pictures of other seeds, of which the first is timed.
Row measure(const fs::path& folder, const Place& place, const Tried& tried, int samples) {
  Row row;
  try {
    std::array<Image, 2> reference;
    row.has_reference = fs::exists(reference_file(folder, place, 1)) &&
                        fs::exists(reference_file(folder, place, 2));
    if (row.has_reference)
      for (const std::size_t half : {0U, 1U})
        reference[half] = subsurface_light(load_image(
            reference_file(folder, place, static_cast<int>(half) + 1), ColorEncoding::linear));
    const int size = row.has_reference ? std::max(reference[0].width, reference[0].height) : 128;
    const Scene scene = load_place(place, size);
    const RenderResult first = picture(scene, tried.method, tried.is_corrected, samples, 1);
    row.cpu_seconds = first.statistics.cpu_seconds;
    row.memory = first.statistics.peak_memory_mib;
    const Image a = subsurface_light(first.image);
    const Image b =
        subsurface_light(picture(scene, tried.method, tried.is_corrected, samples, 2).image);
    if (!row.has_reference) reference = {a, b};  // of use for the noise alone
    if (reference[0].pixels.size() != a.pixels.size() ||
        reference[1].pixels.size() != a.pixels.size())
      throw InvalidInput("the reference must have the proportions of the scene");
    row.error = light_error(a, b, reference[0], reference[1]);
  } catch (const Error& error) {
    std::string_view why = error.what();
    if (why.starts_with('/'))
      why.remove_prefix(std::min(why.size(), why.find(": ") + 2));  // a file
    std::ranges::copy(why.substr(0, row.refusal.size() - 1), row.refusal.begin());
  }
  return row;
}

/// Percents of R, G and B, as in "1.5 / 1.8 / 2.1".
template <class Format>
std::string three(const std::array<LightError, 3>& errors, const Format& format) {
  return format(errors[0]) + " / " + format(errors[1]) + " / " + format(errors[2]);
}

std::string percent(const char* format, double fraction) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, 100.0 * fraction);
  return text.data();
}

/// Below what its noise lets be told an error is an upper bound: of two standard errors.
std::string percent_of_rms(const LightError& e) {
  if (e.rms > 1.5 * e.rms_known) return percent("%.1f", e.rms);
  return "< " + percent("%.1f", std::hypot(e.rms, 1.5 * e.rms_known));
}

double over_bands(const std::array<LightError, 3>& errors, double LightError::*value) {
  double square = 0.0;
  for (const LightError& error : errors) square += error.*value * (error.*value);
  return std::sqrt(square / 3.0);
}

void print_row(const Tried& tried, const Row& row) {
  if (row.refusal[0] != '\0') {
    std::printf("| %s | – | – | – | refused: %s | – | – |\n", tried.name, row.refusal.data());
    return;
  }
  const std::string noise = percent("%.1f", over_bands(row.error, &LightError::noise));
  std::printf(
      "| %s | %d | %.2f | %s | %s | %s | %.0f |\n", tried.name, tried.samples.back(),
      row.cpu_seconds, noise.c_str(),
      row.has_reference ? three(row.error, percent_of_rms).c_str() : "–",
      row.has_reference
          ? three(row.error, [](const LightError& e) { return percent("%+.1f", e.mean); }).c_str()
          : "–",
      row.memory);
}

PlotPanel measure_place(const fs::path& folder, const Place& place, bool has_legend) {
  PlotPanel panel{.title = place.title};
  panel.x = {.label = "CPU time [s]", .scale = AxisScale::logarithmic, .low = 0.1, .high = 60.0};
  panel.y = {.label = "RMS error [%]", .scale = AxisScale::logarithmic, .low = 0.5, .high = 200.0};
  std::printf("\n**%s** (`%s`)\n\n", place.title, place.file);
  std::printf("| | samples | CPU s | noise %% | RMS error %% | mean error %% | MiB |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  std::array<LightError, 3> reference{};
  std::size_t color = 0;
  for (const Tried& tried : all_tried()) {
    PlotCurve curve{.color = palette_color(color++), .style = CurveStyle::line_and_points};
    if (has_legend) curve.name = tried.name;
    Row row;
    for (const int samples : tried.samples) {
      const auto ran = run_apart([&] { return measure(folder, place, tried, samples); });
      if (!ran)
        throw InvalidInput("a process that rendered " + std::string(place.name) + " failed");
      row = *ran;
      if (row.refusal[0] != '\0' || !row.has_reference) continue;
      reference = row.error;
      curve.x.push_back(row.cpu_seconds);
      curve.y.push_back(100.0 * std::max(over_bands(row.error, &LightError::rms),
                                         over_bands(row.error, &LightError::rms_known)));
    }
    print_row(tried, row);
    std::fflush(stdout);
    panel.curves.push_back(curve);
  }
  if (reference[0].pixels > 0)
    std::printf(
        "\nReference: %s %% of noise in %zu pixels, its mean known to %s %%.\n",
        three(reference, [](const LightError& e) { return percent("%.1f", e.reference_noise); })
            .c_str(),
        reference[0].pixels,
        three(reference, [](const LightError& e) {
          return percent("%.2f", e.reference_noise / std::sqrt(static_cast<double>(e.pixels)));
        }).c_str());
  return panel;
}

int run(std::span<const std::string> arguments) {
  const bool makes = arguments.size() >= 2 && arguments[0] == "reference";
  const bool measures = arguments.size() >= 2 && arguments[0] == "measure";
  if (!makes && !measures) {
    std::fprintf(stderr,
                 "usage: subsurface_methods reference DIR [SIZE] [SCENE ...]\n"
                 "       subsurface_methods measure DIR [FIGURE.svg]\n");
    return 2;
  }
  const fs::path folder = arguments[1];
  const int size = makes && arguments.size() > 2 ? std::atoi(arguments[2].c_str()) : 128;
  if (size < 1) throw InvalidInput("SIZE must be a whole number above 0, but is " + arguments[2]);
  const auto asked = makes && arguments.size() > 3 ? arguments.subspan(3) : arguments.first(0);
  fs::create_directories(folder);
  Plot plot{.title = "Error against random walks over CPU time",
            .caption =
                "Root mean square over pixels and R, G, B, over the mean; the reference's "
                "noise taken out."};
  plot.columns = 3;
  plot.panel_width = 260.0;
  plot.panel_height = 200.0;
  for (const Place& place : places) {
    if (!asked.empty() && std::ranges::find(asked, place.name) == asked.end()) continue;
    if (is_missing(place)) {
      std::printf("\n%s: skipped, demo/assets/head.obj is not there (./demo.sh fetches it)\n",
                  place.name);
    } else if (makes) {
      make_reference(folder, place, size);
    } else {
      PlotPanel panel = measure_place(folder, place, plot.panels.empty());
      if (std::ranges::any_of(panel.curves, [](const PlotCurve& c) { return !c.x.empty(); }))
        plot.panels.push_back(std::move(panel));
    }
  }
  if (measures && arguments.size() > 2 && !plot.panels.empty()) save_svg(plot, arguments[2]);
  return 0;
}

}  // namespace
}  // namespace lamina

int main(int count, char** arguments) {
  try {
    return lamina::run(std::vector<std::string>(arguments + 1, arguments + count));
  } catch (const lamina::Error& error) {
    std::fprintf(stderr, "subsurface_methods: %s\n", error.what());
    return 2;
  }
}
