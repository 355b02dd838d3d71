// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "incidence_option.h"
#include "lamina/base/core/error.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "material_bands.h"
#include "monte_carlo_method.h"
#include "slab_color.h"
#include "slab_comparison.h"
#include "slab_derivatives.h"

namespace lamina::cli {
namespace {

struct SlabOptions {
  CommonOptions common;
  std::string material, bands, method, incidence = "normal";
  std::vector<std::string> settings;  ///< of --set
  AddingDoublingOptions adding_doubling;
  Interreflections interreflections = Interreflections::all;  ///< of diffusion
  std::int64_t compared_photons = 0;                          ///< of --compare; 0 if not asked for
  MonteCarloEffort effort;                                    ///< of monte_carlo
  bool has_derivatives = false;                               ///< of radiative_transfer
};

/// What a method gives: the totals, [band], and remarks on how far to trust them.
struct SlabResult {
  std::vector<SlabTotals> totals;
  JsonOutput more = JsonOutput::object();  ///< what only this method says
  std::vector<std::string> remarks = {};
  std::vector<SlabTotals> standard_error = {};  ///< [band], of random methods; else empty
};

/// A solver: its name in --method, and what it does with the stacks, [band].
struct SlabMethod {
  std::string name;
  std::function<SlabResult(const std::vector<LayerStack>&, const Incidence&, const SlabOptions&)>
      solve;
};

SlabResult slab_by_radiative_transfer(const std::vector<LayerStack>& stacks,
                                      const Incidence& incidence, const SlabOptions& options) {
  SlabResult result;
  double error = 0.0;  // the largest that is not as small as asked
  AddingDoublingOptions effort = options.adding_doubling;
  effort.progress = make_progress("adding-doubling", Keeps::nothing);
  for (const auto& band : adding_doubling(stacks, incidence, effort)) {
    if (!band.is_accurate) error = std::max(error, band.estimated_error);
    result.totals.push_back(band.totals);
    result.more["unscattered_reflectance"].push_back(band.unscattered_reflectance);
    result.more["unscattered_transmittance"].push_back(band.unscattered_transmittance);
    result.more["estimated_error"].push_back(band.estimated_error);
  }
  if (error > 0.0)
    result.remarks.push_back(fmt::format("accurate to {:.1g}, not to {:.1g} (--accuracy)", error,
                                         options.adding_doubling.accuracy));
  return result;
}

SlabResult slab_by_diffusion(const std::vector<LayerStack>& stacks, const Incidence& incidence,
                             const SlabOptions& options) {
  SlabResult result;
  for (std::size_t band = 0; band < stacks.size(); ++band)
    result.totals.push_back(
        diffusion_totals(stacks[band], incidence, {.interreflections = options.interreflections}));
  return result;
}

SlabResult slab_by_monte_carlo(const std::vector<LayerStack>& stacks, const Incidence& incidence,
                               const SlabOptions& options) {
  MonteCarloTotals result = monte_carlo_totals(stacks, incidence, options.effort, options.common);
  SlabResult slab{.totals = std::move(result.totals),
                  .standard_error = std::move(result.standard_error)};
  slab.more["unfinished"] = result.unfinished;
  const std::string remark = unfinished_remark(std::ranges::max(result.unfinished));
  if (!remark.empty()) slab.remarks.push_back(remark);
  return slab;
}

/// Every method of `lamina slab`; the first is the default.
const std::vector<SlabMethod>& slab_methods() {
  static const std::vector<SlabMethod> methods = {
      {"radiative_transfer", slab_by_radiative_transfer},
      {"diffusion", slab_by_diffusion},
      {"monte_carlo", slab_by_monte_carlo}};
  return methods;
}

JsonOutput totals_json(const std::vector<SlabTotals>& bands) {
  JsonOutput specular, reflected, transmitted, absorbed = JsonOutput::array();
  for (const SlabTotals& band : bands) {
    specular.push_back(band.specular_reflectance);
    reflected.push_back(band.diffuse_reflectance);
    transmitted.push_back(band.transmittance);
  }
  for (std::size_t layer = 0; layer < bands[0].absorptance.size(); ++layer) {
    JsonOutput row;
    for (const SlabTotals& band : bands) row.push_back(band.absorptance[layer]);
    absorbed.push_back(row);
  }
  return {{"specular_reflectance", specular},
          {"diffuse_reflectance", reflected},
          {"transmittance", transmitted},
          {"absorptance", absorbed}};
}

JsonOutput slab_json(const SlabResult& result) {
  JsonOutput json = totals_json(result.totals);
  if (!result.standard_error.empty()) json["standard_error"] = totals_json(result.standard_error);
  return json;
}

std::string slab_text(const Material& material, const SlabResult& result) {
  std::size_t width = 22;
  for (const MaterialLayer& layer : material.layers)
    width = std::max(width, layer.name.size() + 12);
  std::string text = fmt::format("{:<{}}", "fraction of the light", width);
  for (std::size_t band = 0; band < result.totals.size(); ++band)
    text += fmt::format("  {:>8}", band_name(material.bands, band));
  const auto row = [&](const std::string& name, const auto& value) {
    text += fmt::format("\n{:<{}}", name, width);
    for (const SlabTotals& band : result.totals) text += fmt::format("  {:8.5f}", value(band));
  };
  row("specular reflectance", [](const SlabTotals& t) { return t.specular_reflectance; });
  row("diffuse reflectance", [](const SlabTotals& t) { return t.diffuse_reflectance; });
  row("transmittance", [](const SlabTotals& t) { return t.transmittance; });
  for (std::size_t i = 0; i < material.layers.size(); ++i)
    row("absorbed: " + (material.layers[i].name.empty() ? fmt::format("layer {}", i)
                                                        : material.layers[i].name),
        [i](const SlabTotals& t) { return t.absorptance[i]; });
  double error = 0.0;  // the largest of all
  for (const SlabTotals& band : result.standard_error) {
    error = std::max({error, band.diffuse_reflectance, band.transmittance});
    for (const double absorbed : band.absorptance) error = std::max(error, absorbed);
  }
  if (!result.standard_error.empty())
    text += fmt::format("\nstandard errors at most {:.1e}", error);
  return text + "\n";
}

void run_slab(const SlabOptions& options) {
  const Incidence incidence = parse_incidence(options.incidence);
  const Material material =
      find_material_at({options.material, options.bands, options.settings}, options.common.memory);
  const std::vector<LayerStack> stacks = layer_stacks(material);
  if (options.compared_photons > 0)
    return run_slab_comparison(material, stacks, incidence, options.compared_photons,
                               options.common);
  for (const SlabMethod& method : slab_methods()) {
    if (method.name != options.method) continue;
    const SlabResult result = method.solve(stacks, incidence, options);
    std::vector<AddingDoublingDerivatives> derivatives;
    if (options.has_derivatives) {
      AddingDoublingOptions effort = options.adding_doubling;
      effort.progress = make_progress("derivatives", Keeps::nothing);
      derivatives = slab_derivatives(material, stacks, incidence, effort);
    }
    for (const std::string& remark : result.remarks) say(fmt::format("note: {}", remark));
    JsonOutput json = make_result("slab");
    json["method"] = method.name;
    json["material"] = material.name;
    json["bands"] = bands_json(material.bands);
    json["incidence"] = options.incidence;
    json.update(slab_json(result));
    json.update(result.more);
    const std::optional<SlabColors> colors = slab_colors(material, result.totals);
    if (colors) json["color"] = slab_colors_json(*colors);
    std::string text = slab_text(material, result);
    if (options.has_derivatives) {
      json["derivatives"] = derivatives_json(derivatives);
      text += derivatives_text(material, stacks, derivatives);
    }
    write_json(json, options.common);
    print(options.common, text);
    if (colors && options.common.json != "-")
      write_output(slab_colors_text(*colors, shows_colors()));
  }
}

}  // namespace

void add_slab_command(CLI::App& app) {
  auto options = std::make_shared<SlabOptions>();
  const Command command(
      app, "slab", "Totals of a layered material: reflected, transmitted, absorbed by each layer.");
  command.add_option("material", options->material, "a material file or a built-in material")
      .type_name("MATERIAL")
      .required();
  add_material_options(command, options->bands, options->settings);
  std::vector<std::string> names;
  for (const SlabMethod& method : slab_methods()) names.push_back(method.name);
  options->method = names[0];
  command
      .add_option("--method", options->method,
                  "radiative_transfer: by adding-doubling; diffusion: layered multipoles; "
                  "monte_carlo: photons")
      .one_of(names)
      .show_default();
  command
      .add_flag(
          "--compare{1000000}", options->compared_photons,
          "radiative_transfer, monte_carlo (--compare=PHOTONS per band) and diffusion side by "
          "side")
      .range(std::int64_t{1}, std::int64_t{1'000'000'000'000});
  command
      .add_option("--accuracy", options->adding_doubling.accuracy,
                  "of radiative_transfer: absolute, of each total")
      .range(1e-10, 0.1)
      .show_default();
  command.add_flag("--derivatives", options->has_derivatives,
                   "of radiative_transfer: of the totals by sigma_a, sigma_s, g and thickness of "
                   "each layer");
  command
      .add_option("--incidence", options->incidence,
                  "normal, diffuse, or an angle from the normal in degrees, in [0, 90)")
      .type_name("normal|diffuse|DEG")
      .show_default();
  command.add_choice("--interreflections", options->interreflections,
                     "of diffusion, between layers; none: light turns round once, as in Eqs. 17 "
                     "and 18 of Donner & Jensen 2005");
  add_effort_options(command, options->effort);
  add_common_options(command, options->common);
  command.footer(
      "Fractions are of the light that arrives. The first reflection at the surface is specular;\n"
      "all other light that leaves at the top is diffuse. The color is that of diffuse light "
      "under\n"
      "D65, in sRGB; terminals show a piece of it unless NO_COLOR is set.\n\n"
      "Example: where the light goes in skin, lit from all sides\n"
      "  lamina slab donner_jensen_skin --incidence diffuse\n"
      "A spectrum\n"
      "  lamina slab skin_type_2 --bands 400:700:10 --json spectrum.json");
  command.callback([options, command] {
    const bool is_comparison = options->compared_photons > 0;
    if (is_comparison && command.is_given("--method"))
      throw InvalidInput("--method: must be left out with --compare, which runs all methods");
    refuse_unused(command, is_comparison ? "compare" : options->method,
                  {{"--accuracy", {"radiative_transfer"}},
                   {"--derivatives", {"radiative_transfer"}},
                   {"--interreflections", {"diffusion"}},
                   {"--photons", {"monte_carlo"}},
                   {"--relative-error", {"monte_carlo"}},
                   {"--time", {"monte_carlo"}},
                   {"--independent-bands", {"monte_carlo"}}});
    run_slab(*options);
  });
}

}  // namespace lamina::cli
