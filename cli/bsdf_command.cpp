// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "bsdf_options.h"
#include "commands.h"
#include "lamina/base/core/error.h"
#include "material_bands.h"

namespace lamina::cli {
namespace {

void run_bsdf(const Command& command, const BsdfOptions& options) {
  if (options.material.empty() == options.model.empty())
    throw InvalidInput("bsdf: either a MATERIAL or --model is required");
  const bool is_material = options.model.empty();
  const std::vector<std::string> of_materials = {"--bands",   "--set",      "--accuracy", "--step",
                                                 "--cosines", "--azimuths", "--orders"};
  const std::vector<std::string> of_the_model = {"--eta", "--smoothness", "--visibility",
                                                 "--realizations"};
  for (const std::string& name : is_material ? of_the_model : of_materials)
    if (command.is_given(name))
      throw InvalidInput(name + (is_material ? ": is read with --model rough_transmission only"
                                             : ": is read with a MATERIAL only"));
  if (!is_material) {
    if (!options.compare)
      refuse_unused(command, options.method.empty() ? "analytic" : options.method,
                    {{"--photons", {"monte_carlo", "height_field"}},
                     {"--visibility", {"monte_carlo"}},
                     {"--realizations", {"height_field"}}});
    return run_rough_transmission(options);
  }
  if (options.compare && !options.method.empty())
    throw InvalidInput("--method: must be left out with --compare, which runs all methods");
  refuse_unused(command, options.method.empty() ? "radiative_transfer" : options.method,
                {{"--accuracy", {"radiative_transfer"}},
                 {"--step", {"radiative_transfer", "first_order", "layered_bsdf"}},
                 {"--cosines", {"monte_carlo"}},
                 {"--azimuths", {"monte_carlo"}},
                 {"--orders", {"monte_carlo"}},
                 {"--photons", {"monte_carlo"}},
                 {"--relative-error", {"monte_carlo"}},
                 {"--time", {"monte_carlo"}},
                 {"--independent-bands", {"monte_carlo"}}});
  options.method == "monte_carlo" ? run_monte_carlo_bsdf(options) : run_material_bsdf(options);
}

}  // namespace

void add_bsdf_command(CLI::App& app) {
  auto options = std::make_shared<BsdfOptions>();
  const Command command(app, "bsdf",
                        "Where light from one direction is scattered to: BRDF and BTDF.");
  command.add_option("MATERIAL", options->material, "a file, or the name of a built-in material");
  add_material_options(command, options->bands, options->settings);
  command.add_option("--model", options->model, "in place of a material: rough_transmission")
      .one_of({"rough_transmission"});
  command.add_option("--method", options->method,
                     "of a material: radiative_transfer (default, by adding-doubling), first_order "
                     "(closed form), layered_bsdf (first order, the rest without shape) or "
                     "monte_carlo; of "
                     "rough_transmission: analytic (default), monte_carlo or height_field");
  command.add_option("--theta-i", options->theta_i_deg, "angle of incidence, in [0, 90) degrees")
      .show_default();
  command.add_output_file("--plot", options->plot,
                          "draw the lobes in the plane of incidence as SVG", ".svg");
  const std::string layered = "Layered materials";
  command
      .add_option("--accuracy", options->accuracy, "of radiative_transfer: relative, of each value")
      .group(layered)
      .range(1e-8, 0.1)
      .show_default();
  command.add_option("--step", options->step_deg, "between the angles to look from, in degrees")
      .group(layered)
      .range(0.5, 45.0)
      .show_default();
  command.add_option("--cosines", options->cosines, "of monte_carlo: rows of equal solid angle")
      .group(layered)
      .range(1, 10000)
      .show_default();
  command.add_option("--azimuths", options->azimuths, "of monte_carlo: cells of a row, even")
      .group(layered)
      .range(2, 10000)
      .show_default();
  command
      .add_flag("--orders", options->orders,
                "of monte_carlo: light by the number of times that it was scattered")
      .group(layered);
  add_effort_options(command, options->effort);
  const std::string rough = "Rough transmission";
  command.add_option("--eta", options->eta, "index beyond the surface over that before it")
      .group(rough)
      .show_default();
  command
      .add_option("--smoothness", options->smoothness,
                  "correlation length over RMS height; roughness alpha is 2 / smoothness")
      .group(rough)
      .show_default();
  command
      .add_choice("--visibility", options->visibility,
                  "of monte_carlo: xu_sun, as published, or smith, which loses no energy")
      .group(rough);
  command.add_option("--realizations", options->realizations, "surfaces made by height_field")
      .group(rough)
      .type_name("N")
      .range(2, 1000)
      .show_default();
  command.add_flag("--compare", options->compare,
                   "all methods side by side, with the light that each misplaces");
  add_common_options(command, options->common);
  command.footer(
      "Example: how skin scatters light from 45 degrees\n"
      "  lamina bsdf donner_jensen_skin --theta-i 45 --json skin.json\n"
      "Its first order in closed form, drawn, and how far the approximations are off\n"
      "  lamina bsdf donner_jensen_skin --method first_order --plot skin.svg\n"
      "  lamina bsdf leaf --theta-i 45 --compare --plot leaf.svg\n"
      "The same by photons, order by order\n"
      "  lamina bsdf donner_jensen_skin --theta-i 45 --method monte_carlo --orders --photons 1e7 "
      "--plot skin.svg\n"
      "A frosted plate by the model of Xu and Sun, and by rays through real surfaces\n"
      "  lamina bsdf --model rough_transmission --eta 1.4 --smoothness 3 --theta-i 30 --plot "
      "lobes.svg\n"
      "  lamina bsdf --model rough_transmission --smoothness 1 --method height_field --json -\n"
      "  lamina bsdf --model rough_transmission --smoothness 1 --compare --plot b.svg");
  command.callback([options, command] { run_bsdf(command, *options); });
}

}  // namespace lamina::cli
