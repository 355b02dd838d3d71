// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// A small run of what works in four threads, for the thread sanitizer, tools/sanitize.sh: a program
// that needs half of what the command does, and compiles in half the time.
//
//   thread_sanitizer_runs photons | bsdf | profile | slab
//   thread_sanitizer_runs SCENE [KEY=VALUE...]      as `lamina render SCENE --set KEY=VALUE`
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/materials/material.h"
#include "lamina/render/render.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace {

std::vector<lamina::LayerStack> bands_of(const char* name) {
  const lamina::Material material = lamina::find_material(name);
  std::vector<lamina::LayerStack> bands;
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    bands.push_back(layer_stack(material, band));
  return bands;
}

/// A number of the result, which is printed.
double run(const std::string& what, std::span<const std::string> settings) {
  using lamina::cli::Keeps, lamina::cli::make_progress;
  if (what == "photons") {
    lamina::MonteCarloOptions options{.photons = 4000};
    options.tallies.r = {.count = 50, .width = 0.1};
    options.tallies.angles = 30;
    return trace_photons(bands_of("marble")[0], options).diffuse_reflectance.value;
  }
  if (what == "bsdf") {
    lamina::MonteCarloOptions options{.photons = 2000, .incidence = {.theta = 0.5}};
    options.tallies.bsdf_cosines = 20;
    options.tallies.bsdf_azimuths = 36;
    return trace_photons(bands_of("marble")[0], options).bsdf.reflection.back().value;
  }
  if (what == "profile")
    return lamina::make_diffusion_profile(bands_of("donner_jensen_skin"))
        .profile.reflectance_profile[0];
  if (what == "slab")
    return lamina::adding_doubling(std::span<const lamina::LayerStack>(bands_of("donner_jensen_skin")))[0].totals.diffuse_reflectance;
  const lamina::Scene scene = lamina::load_scene(what, {}, settings);
  const lamina::Progress progress = make_progress("rendering", Keeps::nothing);
  return static_cast<double>(lamina::render(scene, {}, progress).image.pixels[0]);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty()) throw lamina::InvalidInput("usage: thread_sanitizer_runs RUN [KEY=VALUE...]");
  lamina::set_thread_count(4);
  std::printf("%g\n", run(words[0], std::span(words).subspan(1)));
} catch (const lamina::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
