// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// The methods of subsurface light against each other on scenes/bumpy.json: error over CPU time,
// once with respect to what each method itself converges to (noise), once to the truth (noise and
// bias). Equal time is a vertical line through the figure, equal error a horizontal one.
//
// usage: subsurface_methods SIZE TRUTH_SAMPLES [FIGURE.svg]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "lamina/plot/plot.h"
#include "lamina/render/render.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;

struct Tried {
  const char* name;
  Method method;
  std::vector<int> samples;
  int converged;  ///< samples of what counts as without noise
};

RenderResult picture(Scene scene, Method method, int samples, std::uint64_t seed) {
  scene.render.method = method;
  scene.render.samples_per_pixel = samples;
  scene.render.seed = seed;
  return render(scene);
}

/// Mean absolute difference of the light from inside, R, G and B, over the mean of the reference.
double error_of(const Image& image, const Image& reference) {
  const std::vector<std::string> names = {"subsurface.R", "subsurface.G", "subsurface.B"};
  const Image a = select_channels(image, names), b = select_channels(reference, names);
  double apart = 0.0, total = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    apart += std::abs(static_cast<double>(a.pixels[i] - b.pixels[i]));
    total += static_cast<double>(b.pixels[i]);
  }
  return apart / total;
}

}  // namespace
}  // namespace lamina

int main(int count, char** arguments) {
  using namespace lamina;
  const int size = count > 1 ? std::atoi(arguments[1]) : 96;
  const int truth_samples = count > 2 ? std::atoi(arguments[2]) : 64;
  Scene scene = load_scene(LAMINA_SOURCE_DIR "/scenes/bumpy.json");
  scene.film.width = scene.film.height = size;
  const std::vector<Tried> all = {{"shadow_map", Method::shadow_map, {1, 4, 16, 64}, 512},
                                  {"hierarchy", Method::hierarchy, {1, 4, 16}, 64},
                                  {"probe", Method::probe, {1, 4, 16, 64}, 1024},
                                  {"random_walk", Method::random_walk, {1, 4, 16}, truth_samples}};
  const Image truth = picture(scene, Method::random_walk, truth_samples, 99).image;
  Plot plot{.title = "bumpy.json: error over CPU time"};
  plot.panels.resize(2);
  plot.panels[0].title = "to what the method converges to";
  plot.panels[1].title = "to random_walk";
  for (PlotPanel& panel : plot.panels) {
    panel.x = {.label = "CPU time [s]", .scale = AxisScale::logarithmic};
    panel.y = {.label = "mean error over mean", .scale = AxisScale::logarithmic};
  }
  std::printf("%-12s %8s %8s %10s %10s\n", "method", "samples", "CPU s", "noise %", "error %");
  for (const Tried& tried : all) {
    PlotCurve noise{.name = tried.name, .style = CurveStyle::line_and_points}, error = noise;
    const bool is_truth = tried.method == Method::random_walk;
    const Image converged =
        is_truth ? truth : picture(scene, tried.method, tried.converged, 98).image;
    for (const int samples : tried.samples) {
      const RenderResult result = picture(scene, tried.method, samples, 1);
      noise.x.push_back(result.statistics.cpu_seconds);
      noise.y.push_back(error_of(result.image, converged));
      error.y.push_back(error_of(result.image, truth));
      std::printf("%-12s %8d %8.2f %10.2f %10.2f\n", tried.name, samples, noise.x.back(),
                  100.0 * noise.y.back(), 100.0 * error.y.back());
      std::fflush(stdout);
    }
    error.x = noise.x;
    plot.panels[0].curves.push_back(noise);
    plot.panels[1].curves.push_back(error);
  }
  if (count > 3) save_svg(plot, arguments[3]);
}
