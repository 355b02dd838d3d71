// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>

#include "bsdf_options.h"
#include "commands.h"
#include "lamina/core/error.h"
#include "lamina/core/parallel.h"

namespace lamina::cli {

void add_bsdf_command(CLI::App& app) {
  auto options = std::make_shared<BsdfOptions>();
  CLI::App* command =
      app.add_subcommand("bsdf", "Where light from one direction is scattered to: BRDF and BTDF.");
  command->add_option("MATERIAL", options->material, "a file, or the name of a built-in material");
  command->add_option("--model", options->model, "in place of a material: rough_transmission")
      ->check(CLI::IsMember({"rough_transmission"}));
  command->add_option("--method", options->method,
                      "of a material: adding_doubling (default), first_order (closed form) or "
                      "layered_bsdf (first order, the rest without shape); of rough_transmission: "
                      "analytic (default), monte_carlo or height_field");
  command->add_option("--theta-i", options->theta_i_deg, "angle of incidence, in [0, 90) degrees")
      ->capture_default_str();
  command->add_option("--photons", options->photons, "rays of the random methods")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000}))
      ->capture_default_str();
  command->add_option("--plot", options->plot, "draw the lobes in the plane of incidence as SVG")
      ->type_name("FILE");
  const std::string layered = "Layered materials";
  command
      ->add_option("--accuracy", options->accuracy, "of adding_doubling: relative, of each value")
      ->group(layered)
      ->check(CLI::Range(1e-8, 0.1))
      ->capture_default_str();
  command->add_option("--step", options->step_deg, "between the angles to look from, in degrees")
      ->group(layered)
      ->check(CLI::Range(0.5, 45.0))
      ->capture_default_str();
  const std::string rough = "Rough transmission";
  command->add_option("--eta", options->eta, "index beyond the surface over that before it")
      ->group(rough)
      ->capture_default_str();
  command
      ->add_option("--smoothness", options->smoothness,
                   "correlation length over RMS height; roughness alpha is 2 / smoothness")
      ->group(rough)
      ->capture_default_str();
  command
      ->add_option("--visibility", options->visibility,
                   "of monte_carlo: xu_sun, as published, or smith, which loses no energy")
      ->group(rough)
      ->check(CLI::IsMember({"xu_sun", "smith"}))
      ->capture_default_str();
  command->add_option("--realizations", options->realizations, "surfaces made by height_field")
      ->group(rough)
      ->type_name("N")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command->add_flag("--compare", options->compare,
                    "all methods side by side, with the light that each misplaces");
  add_common_options(*command, options->common);
  command->footer(
      "Example: how skin scatters light from 45 degrees\n"
      "  lamina bsdf donner_jensen_skin --theta-i 45 --json skin.json\n"
      "Its first order in closed form, drawn, and how far the approximations are off\n"
      "  lamina bsdf donner_jensen_skin --method first_order --plot skin.svg\n"
      "  lamina bsdf leaf --theta-i 45 --compare --plot leaf.svg\n"
      "A frosted plate by the model of Xu and Sun, and by rays through real surfaces\n"
      "  lamina bsdf --model rough_transmission --eta 1.4 --smoothness 3 --theta-i 30 --plot "
      "lobes.svg\n"
      "  lamina bsdf --model rough_transmission --smoothness 1 --method height_field --json -\n"
      "  lamina bsdf --model rough_transmission --smoothness 1 --compare --plot b.svg");
  command->callback([options] {
    set_thread_count(options->common.threads);
    if (options->material.empty() == options->model.empty())
      throw InvalidInput("bsdf: either a MATERIAL or --model is required");
    options->model.empty() ? run_material_bsdf(*options) : run_rough_transmission(*options);
  });
}

}  // namespace lamina::cli
