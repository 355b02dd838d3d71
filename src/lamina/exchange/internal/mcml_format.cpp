// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/photon_formats.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"

// Source: [Wang1995] §5.1.

namespace lamina::detail {
namespace {

constexpr double mm_per_cm = 10.0;
constexpr double endless = 1e8;  // [cm], as MCML's own examples have it
constexpr int bins = 200, angles = 30;

/// Bins that resolve where most of the light leaves.
McmlRun run_of(const LayerStack& stack, const std::string& output) {
  McmlRun run{.output_file = output, .photons = 1'000'000, .nz = bins, .nr = bins, .na = angles};
  run.n_above = stack.ior_above();
  run.n_below = stack.ior_below();
  double widest = 0.0, thickness = 0.0;
  for (const Layer& layer : stack.layers()) {
    const Medium& medium = layer.medium;
    const bool is_endless = !std::isfinite(layer.thickness);
    run.layers.push_back({.n = medium.ior,
                          .mua = medium.sigma_a * mm_per_cm,
                          .mus = medium.sigma_s * mm_per_cm,
                          .g = medium.g,
                          .d = is_endless ? endless : layer.thickness / mm_per_cm});
    if (sigma_t_prime(medium) > 0.0) {
      constexpr double free_paths = 10.0;
      const double depth = free_paths * mfp_prime(medium);
      widest = std::max(widest, std::min(depth, layer.thickness));
      thickness += std::min(depth, layer.thickness);
    } else if (!is_endless) {
      thickness += layer.thickness;
    }
  }
  run.dr = std::max(widest, 1e-6) / mm_per_cm / bins;
  run.dz = std::max(thickness, 1e-6) / mm_per_cm / bins;
  return run;
}

std::string run_text(const McmlRun& run, const std::string& band) {
  std::string text = "\n" + run.output_file + " A   # " + band + "\n";
  text += std::to_string(run.photons) + "   # photons\n";
  text += number_text(run.dz) + " " + number_text(run.dr) + "   # dz, dr [cm]\n";
  text += printf_text("%d %d %d   # bins in z, r and angle\n", run.nz, run.nr, run.na);
  text += std::to_string(run.layers.size()) + "   # layers\n";
  text += number_text(run.n_above) + "   # n above\n";
  text += "# n  mua [1/cm]  mus [1/cm]  g  d [cm]\n";
  for (const McmlRun::Layer& layer : run.layers)
    text += numbers_text(std::vector{layer.n, layer.mua, layer.mus, layer.g, layer.d}, "  ") + "\n";
  return text + number_text(run.n_below) + "   # n below\n";
}

}  // namespace

ExportedMaterial write_mcml(const ExportInput& input) {
  ExportedMaterial result{.notes = notes_of_photons("MCML", input)};
  if (std::ranges::any_of(input.stacks, [](const LayerStack& stack) {
        return std::ranges::any_of(stack.layers(), [](const Layer& layer) {
          return layer.medium.sigma_s > 0.0 && layer.medium.g < 0.0;
        });
      }))
    result.notes.emplace_back(
        "MCML 1.2 refuses g < 0; lamina photons and MCML's descendants take it");
  std::string runs;
  std::vector<LayerStack> written;
  for (std::size_t b = 0; b < input.stacks.size(); ++b) {
    const std::string band = band_name(input.material.bands, b);
    const McmlRun run = run_of(input.stacks[b], input.stem + "_" + band + ".mco");
    written.push_back(layer_stack(run));
    runs += run_text(run, "band " + band + (input.material.bands.is_rgb() ? "" : " nm"));
  }
  result.misfits = beam_misfits(input, written);
  std::vector<std::string> lines = head_lines(input, "MCML 1.2");
  lines.emplace_back("lengths in cm; totals below are of a beam along the normal");
  for (const std::string& line : misfit_lines(result.misfits)) lines.push_back(line);
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  result.files.push_back({input.stem + ".mci", comment(lines, "# ") + "1.0   # version\n" +
                                                   std::to_string(written.size()) + "   # runs\n" +
                                                   runs});
  return result;
}

}  // namespace lamina::detail
