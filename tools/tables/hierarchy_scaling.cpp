// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Time and memory of the method `hierarchy` over the size of a mesh, with two samples of the light
// per triangle: the table and the figure of docs/subsurface_hierarchy.md. Each size is a process of
// its own, so that its peak of memory is its own.
//
// usage: hierarchy_scaling [FIGURE.svg]
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "lamina/base/plot/plot.h"
#include "lamina/render/render.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "run_apart.h"

namespace lamina {
namespace {

struct Row {
  double triangles = 0, samples = 0, cpu_seconds = 0, peak_mib = 0;
};

/// The scene bumpy.json with a mesh of 12 tessellation² triangles.
Row measure(int tessellation) {
  Scene scene = load_scene(LAMINA_SOURCE_DIR "/scenes/bumpy.json");
  const std::array<std::uint32_t, 1> material = {0};
  scene.meshes = {make_mesh(make_bumpy_sphere(10.0, tessellation), {}, material).mesh};
  scene.render.method = RenderSettings::Method::hierarchy;
  scene.render.samples_per_pixel = 4;
  scene.film = {.width = 128, .height = 128};
  Row row{.triangles = 12.0 * tessellation * tessellation};
  row.samples = 2.0 * row.triangles;
  constexpr double area = 1300.0;  // [mm²]
  scene.render.hierarchy = {.spacing = static_cast<float>(std::sqrt(area / row.samples)),
                            .max_points = 4'000'000,
                            .irradiance_samples = 4};
  const RenderStatistics all = render(scene).statistics;
  row.cpu_seconds = all.cpu_seconds;
  row.peak_mib = all.peak_memory_mib;
  return row;
}

}  // namespace
}  // namespace lamina

int main(int count, char** arguments) {
  using namespace lamina;
  std::vector<double> samples, cpu, memory, line;
  std::printf("%10s %10s %8s %9s\n", "triangles", "samples", "CPU s", "peak MiB");
  for (const int tessellation : {29, 50, 91, 158, 289}) {
    const Row row = run_apart([=] { return measure(tessellation); }).value_or(Row{});
    std::printf("%10.0f %10.0f %8.2f %9.0f\n", row.triangles, row.samples, row.cpu_seconds,
                row.peak_mib);
    std::fflush(stdout);
    samples.push_back(row.samples);
    cpu.push_back(row.cpu_seconds);
    memory.push_back(row.peak_mib / 1024.0);
  }
  for (const double n : samples)
    line.push_back(cpu.back() * n * std::log(n) / (samples.back() * std::log(samples.back())));
  if (count < 2) return 0;
  Plot plot{.title = "hierarchy over the number of samples, 1 triangle to 2 of them"};
  plot.panels.resize(2);
  for (PlotPanel& panel : plot.panels)
    panel.x = {.label = "samples", .scale = AxisScale::logarithmic};
  plot.panels[0].y = {.label = "CPU time [s]", .scale = AxisScale::logarithmic};
  plot.panels[0].curves = {
      {.name = "measured", .x = samples, .y = cpu, .style = CurveStyle::line_and_points},
      {.name = "n log n", .x = samples, .y = line, .style = CurveStyle::dashed}};
  plot.panels[1].y = {.label = "peak memory [GiB]", .scale = AxisScale::logarithmic};
  plot.panels[1].curves = {{.x = samples, .y = memory, .style = CurveStyle::line_and_points}};
  save_svg(plot, arguments[1]);
}
