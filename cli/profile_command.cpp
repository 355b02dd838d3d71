// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "incidence_option.h"
#include "lamina/base/core/error.h"
#include "lamina/base/plot/plot.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/dipole_profile.h"
#include "lamina/solve/scattering/transport_profile/doubtful_profile.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"
#include "material_bands.h"
#include "monte_carlo_method.h"
#include "profile_frequency.h"
#include "profile_oblique.h"

namespace lamina::cli {
namespace {

struct ProfileOptions {
  CommonOptions common;
  std::string material, bands, method, plot;
  std::vector<std::string> settings;  ///< of --set
  bool compare = false;
  std::string domain = "radius";
  bool has_derivatives = false;  ///< of responses at spatial frequencies
  int gaussians = 0;             ///< 0: not asked for
  int moments = 8;
  std::string incidence = "normal", from = "above";
  double accuracy = 0.005;
  bool no_cache = false;
  Interreflections interreflections = Interreflections::all;  ///< of diffusion
  RadialGrid grid;
  MonteCarloEffort effort;  ///< of monte_carlo
};

/// What a method gives: the profile, and remarks on how far to trust it, one line each.
struct ProfileResult {
  Profile profile;
  std::vector<std::string> remarks = {};
  JsonOutput more = JsonOutput::object();      ///< what only this method says
  std::optional<Profile> standard_error = {};  ///< of random methods
};

/// A solver: its name in --method, and what it does with the stacks, [band].
struct ProfileMethod {
  std::string name;
  std::function<ProfileResult(const std::vector<LayerStack>&, const ProfileOptions&)> solve;
};

TransferProfileOptions transfer_options(const ProfileOptions& options) {
  return {.accuracy = options.accuracy,
          .illumination =
              options.incidence == "diffuse" ? Illumination::diffuse : Illumination::normal_beam,
          .is_from_below = options.from == "below",
          .progress = make_progress("radiative transfer", Keeps::nothing)};
}

ProfileResult profile_by_radiative_transfer(const std::vector<LayerStack>& stacks,
                                            const ProfileOptions& options) {
  auto [result, was_cached] =
      cached_transfer_profile(options.no_cache ? std::nullopt : user_cache(), stacks, options.grid,
                              transfer_options(options));
  refuse_doubtful(result.mean_error,
                  options.from == "below"          ? "lamina photons of the layers turned over"
                  : options.incidence == "diffuse" ? "lamina photons --incidence diffuse"
                                                   : "--method monte_carlo");
  std::vector<std::string> remarks;
  for (std::size_t band = 0; band < stacks.size(); ++band)
    if (result.estimated_error[band] > options.accuracy)
      remarks.push_back(fmt::format(
          "band {}: accurate to {:.1f} % on average{}", band, 100.0 * result.mean_error[band],
          result.estimated_error[band] < 1.0
              ? fmt::format(", to {:.1f} % where it is worst", 100.0 * result.estimated_error[band])
              : ", less where there is little light"));
  JsonOutput more = {
      {"accuracy", table_json(result.relative_error, stacks.size())},
      {"transmittance_accuracy", table_json(result.transmittance_error, stacks.size())},
      {"estimated_error", result.estimated_error},
      {"mean_error", result.mean_error},
      {"photons", result.photons},
      {"from_cache", was_cached}};
  return {std::move(result.profile), std::move(remarks), std::move(more)};
}

ProfileResult profile_by_diffusion(const std::vector<LayerStack>& stacks,
                                   const ProfileOptions& options) {
  DiffusionProfile result =
      make_diffusion_profile(stacks, {.interreflections = options.interreflections}, options.grid);
  std::vector<std::string> remarks;
  for (std::size_t band = 0; band < stacks.size(); ++band) {
    for (const std::size_t layer : result.thin_layers[band])
      remarks.push_back(fmt::format(
          "band {}, layer {}: thinner than one reduced mean free path, diffusion is crude there",
          band, layer));
    const double clamped = result.clamped_reflectance[band] + result.clamped_transmittance[band];
    if (clamped > 1e-6)
      remarks.push_back(fmt::format(
          "band {}: the model is negative at some radii, by {:.1e} of the flux; set to 0", band,
          clamped));
  }
  return {std::move(result.profile), std::move(remarks), JsonOutput::object()};
}

ProfileResult by_dipole(const std::vector<LayerStack>& stacks, const ProfileOptions& options) {
  return {make_dipole_profile(stacks, {}, options.grid)};
}

ProfileResult profile_by_monte_carlo(const std::vector<LayerStack>& stacks,
                                     const ProfileOptions& options) {
  MonteCarloProfile result =
      monte_carlo_profile(stacks, options.grid, options.effort, options.common);
  const std::string remark = unfinished_remark(std::ranges::max(result.unfinished));
  return {.profile = std::move(result.profile),
          .remarks = remark.empty() ? std::vector<std::string>() : std::vector{remark},
          .standard_error = std::move(result.standard_error)};
}

/// Every method of `lamina profile`; the first is the default.
const std::vector<ProfileMethod>& profile_methods() {
  static const std::vector<ProfileMethod> methods = {
      {"radiative_transfer", profile_by_radiative_transfer},
      {"diffusion", profile_by_diffusion},
      {"dipole", by_dipole},
      {"monte_carlo", profile_by_monte_carlo}};
  return methods;
}

JsonOutput profile_json(const Profile& profile) {
  return {{"per", name_of(profile.per)},
          {"r_mm", profile.r},
          {"reflectance_profile", table_json(profile.reflectance_profile, profile.bands)},
          {"transmittance_profile", table_json(profile.transmittance_profile, profile.bands)},
          {"total_reflectance", profile.total_reflectance},
          {"total_transmittance", profile.total_transmittance}};
}

using Value = std::function<double(std::size_t i, std::size_t band)>;

/// A row of numbers per radius; some 16 radii are enough to read.
std::string table_text(const BandSet& bands, const Profile& profile, const std::string& title,
                       const Value& value, const char* format) {
  std::string text = fmt::format("\n{}\n{:>10}", title, "r [mm]");
  for (std::size_t band = 0; band < bands.size(); ++band)
    text += fmt::format("  {:>10}", band_name(bands, band));
  const std::size_t n = profile.r.size(), rows = std::min<std::size_t>(n, 16);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t i = rows > 1 ? row * (n - 1) / (rows - 1) : 0;
    text += fmt::format("\n{:10.4g}", profile.r[i]);
    for (std::size_t band = 0; band < bands.size(); ++band) {
      const double number = value(i, band);
      text += std::isfinite(number) ? fmt::format(fmt::runtime(format), number)
                                    : fmt::format("  {:>10}", "-");
    }
  }
  return text + "\n";
}

std::string totals_text(const BandSet& bands, const std::string& name,
                        std::span<const double> totals) {
  std::string text = fmt::format("\n{:<26}", name);
  for (std::size_t band = 0; band < bands.size(); ++band)
    text += fmt::format("  {:8.5f}", totals[band]);
  return text;
}

bool transmits(const Profile& profile) {
  return std::ranges::any_of(profile.total_transmittance, [](double t) { return t > 0.0; });
}

std::string profile_text(const Material& material, const Profile& profile) {
  const BandSet& bands = material.bands;
  std::string text = fmt::format(
      "{:<26}", profile.per == ProfilePer::entered_flux ? "per entered flux" : "per arriving flux");
  for (std::size_t band = 0; band < bands.size(); ++band)
    text += fmt::format("  {:>8}", band_name(bands, band));
  text += totals_text(bands, "total reflectance", profile.total_reflectance);
  if (transmits(profile))
    text += totals_text(bands, "total transmittance", profile.total_transmittance);
  text += "\n";
  text += table_text(
      bands, profile, "R(r) [1/mm²]",
      [&](std::size_t i, std::size_t b) { return profile.reflectance_at(i, b); }, "  {:10.3e}");
  if (transmits(profile))
    text += table_text(
        bands, profile, "T(r) [1/mm²]",
        [&](std::size_t i, std::size_t b) { return profile.transmittance_at(i, b); }, "  {:10.3e}");
  return text;
}

/// What a method is shown beside, and what it is called: an approximation to judge.
struct Rival {
  Profile profile;
  std::string method, title, legend;
};

/// The single-layer dipole beside diffusion, diffusion beside radiative transfer.
Rival make_rival(const std::vector<LayerStack>& stacks, const ProfileOptions& options,
                 const Profile& shown) {
  if (shown.per == ProfilePer::entered_flux)
    return {by_dipole(stacks, options).profile, "dipole", "dipole", ", one layer"};
  std::vector<double> entry;
  for (const LayerStack& stack : stacks)
    entry.push_back(1.0 - fresnel(1.0, stack.layers()[0].medium.ior / stack.ior_above()));
  return {per_arriving_flux(profile_by_diffusion(stacks, options).profile, entry), "diffusion",
          "diffusion", ", diffusion"};
}

/// Relative difference of the rival; not a number where the shown profile is 0 or lost in rounding.
double difference(const Profile& layered, const Profile& dipole, std::size_t i, std::size_t band) {
  constexpr double rounding = 1e-14;
  const double value = layered.reflectance_at(i, band);
  if (!(value > rounding * layered.reflectance_at(0, band)))
    return std::numeric_limits<double>::quiet_NaN();
  return dipole.reflectance_at(i, band) / value - 1.0;
}

std::string comparison_text(const Material& material, const Profile& layered, const Rival& rival) {
  const Profile& dipole = rival.profile;
  std::string text = "\n" + rival.title + " beside it";
  text += totals_text(material.bands, "total reflectance", dipole.total_reflectance);
  if (transmits(dipole))
    text += totals_text(material.bands, "total transmittance", dipole.total_transmittance);
  text +=
      "\n" +
      table_text(
          material.bands, layered, "R(r) of the " + rival.title + " over that above - 1 [%]",
          [&](std::size_t i, std::size_t b) { return 100.0 * difference(layered, dipole, i, b); },
          "  {:10.1f}");
  return text;
}

JsonOutput comparison_json(const Profile& layered, const Rival& rival) {
  const Profile& dipole = rival.profile;
  auto differences = JsonOutput::array();
  for (std::size_t i = 0; i < layered.r.size(); ++i) {
    auto row = JsonOutput::array();
    for (std::size_t band = 0; band < layered.bands; ++band) {
      const double value = difference(layered, dipole, i, band);
      row.push_back(std::isfinite(value) ? JsonOutput(value) : JsonOutput(nullptr));
    }
    differences.push_back(std::move(row));
  }
  JsonOutput json = {{"method", rival.method}};
  json.update(profile_json(dipole));
  json["relative_difference"] = std::move(differences);
  return json;
}

/// R or T of all bands, with the rival dashed; down to 1e-8 of the highest peak.
PlotPanel profile_panel(const Material& material, const Profile& layered, const Rival& rival,
                        bool is_reflectance) {
  PlotPanel panel;
  panel.title = is_reflectance ? "Reflectance" : "Transmittance";
  panel.x = {.label = "distance r from the beam [mm]", .scale = AxisScale::logarithmic};
  panel.y = {.label = is_reflectance ? "R(r) [mm⁻²]" : "T(r) [mm⁻²]",
             .scale = AxisScale::logarithmic};
  const auto value = [&](const Profile& profile, std::size_t i, std::size_t b) {
    return is_reflectance ? profile.reflectance_at(i, b) : profile.transmittance_at(i, b);
  };
  double peak = 0.0;
  for (std::size_t i = 0; i < layered.r.size(); ++i)
    for (std::size_t b = 0; b < layered.bands; ++b) peak = std::max(peak, value(layered, i, b));
  double last_r = layered.r[0];
  const auto add = [&](const Profile& profile, CurveStyle style, const std::string& kind) {
    for (std::size_t b = 0; b < profile.bands; ++b) {
      PlotCurve curve{.name = band_label(material.bands, b) + kind,
                      .color = band_color(material.bands, b),
                      .style = style,
                      .width = style == CurveStyle::line ? 1.8 : 1.2};
      std::size_t end = profile.r.size();  // photons may leave bins empty anywhere before
      while (end > 0 && !(value(profile, end - 1, b) > 1e-8 * peak)) --end;
      for (std::size_t i = 0; i < end; ++i) {
        curve.x.push_back(profile.r[i]);
        curve.y.push_back(value(profile, i, b));
        last_r = std::max(last_r, profile.r[i]);
      }
      panel.curves.push_back(std::move(curve));
    }
  };
  add(layered, CurveStyle::line, "");
  add(rival.profile, CurveStyle::dashed, rival.legend);
  panel.x.low = layered.r[0];
  panel.x.high = last_r;
  panel.y.low = 1e-8 * peak;
  return panel;
}

void save_plot(const std::string& file, const Material& material, const std::string& method,
               const Profile& layered, const Rival& rival) {
  Plot plot;
  plot.title = material.name;
  plot.caption = fmt::format("Lines: {}, per {} flux. Dashed: {}.", method,
                             layered.per == ProfilePer::entered_flux ? "entered" : "arriving",
                             rival.title == "dipole" ? "dipole of a single layer" : rival.title);
  plot.panels.push_back(profile_panel(material, layered, rival, true));
  if (transmits(layered)) plot.panels.push_back(profile_panel(material, layered, rival, false));
  save_svg(plot, file);
}

/// The other methods know the normal beam from above only, and so nothing to compare with.
void require_radiative_transfer_for_illumination(const ProfileOptions& options) {
  const bool is_usual = options.incidence == "normal" && options.from == "above" &&
                        options.domain == "radius" && options.gaussians == 0;
  if (is_usual) return;
  if (options.incidence != "normal" && options.incidence != "diffuse")
    (void)parse_incidence_degrees(options.incidence);
  if (options.method != "radiative_transfer")
    throw InvalidInput(
        "--incidence, --from, --domain, --gaussians: --method must be radiative_transfer, but is " +
        options.method);
  if (options.compare || !options.plot.empty())
    throw InvalidInput("--compare, --plot: --incidence must be normal and --from above, but are " +
                       options.incidence + " and " + options.from);
}

void run_profile(const ProfileOptions& options) {
  const Material material =
      find_material_at({options.material, options.bands, options.settings}, options.common.memory);
  const std::vector<LayerStack> stacks = layer_stacks(material);
  require_radiative_transfer_for_illumination(options);
  const JsonOutput head = {{"material", material.name},
                           {"bands", bands_json(material.bands)},
                           {"incidence", options.incidence},
                           {"from", options.from}};
  const bool is_oblique = options.incidence != "normal" && options.incidence != "diffuse";
  if (is_oblique && (options.domain == "frequency" || options.gaussians > 0))
    throw InvalidInput(
        "--domain frequency, --gaussians: --incidence must be normal or diffuse, "
        "but is " +
        options.incidence);
  if (is_oblique) {
    return run_profile_oblique(material, options.from == "below" ? lit_from_below(stacks) : stacks,
                               parse_incidence_degrees(options.incidence), options.grid,
                               options.moments, head, options.common);
  }
  if (options.domain == "frequency")
    return run_profile_frequency(material, options.grid, transfer_options(options),
                                 options.has_derivatives, head, options.common);
  if (options.gaussians > 0)
    return run_profile_gaussians(material, options.gaussians, transfer_options(options), head,
                                 options.common);
  for (const ProfileMethod& method : profile_methods()) {
    if (method.name != options.method) continue;
    const ProfileResult result = method.solve(stacks, options);
    for (const std::string& remark : result.remarks) say(fmt::format("note: {}", remark));
    std::string text = profile_text(material, result.profile);
    JsonOutput json = make_result("profile");
    json["method"] = method.name;
    json["material"] = material.name;
    json["bands"] = bands_json(material.bands);
    json["incidence"] = options.incidence;
    json["from"] = options.from;
    json.update(profile_json(result.profile));
    if (result.standard_error) {
      JsonOutput error = profile_json(*result.standard_error);
      error.erase("r_mm");
      error.erase("per");
      json["standard_error"] = error;
    }
    json.update(result.more);
    if (!result.remarks.empty()) json["remarks"] = result.remarks;
    if (options.compare || !options.plot.empty()) {
      const Rival rival = make_rival(stacks, options, result.profile);
      if (options.compare) {
        text += comparison_text(material, result.profile, rival);
        json["comparison"] = comparison_json(result.profile, rival);
      }
      if (!options.plot.empty())
        save_plot(options.plot, material, method.name, result.profile, rival);
    }
    write_json(json, options.common);
    print(options.common, text);
  }
}

}  // namespace

void add_profile_command(CLI::App& app) {
  auto options = std::make_shared<ProfileOptions>();
  const Command command(app, "profile",
                        "Light around a pencil beam on a layered material: R(r) and T(r).");
  command.add_option("material", options->material, "a material file or a built-in material")
      .type_name("MATERIAL")
      .required();
  add_material_options(command, options->bands, options->settings);
  std::vector<std::string> names;
  for (const ProfileMethod& method : profile_methods()) names.push_back(method.name);
  options->method = names[0];
  command
      .add_option("--method", options->method,
                  "radiative_transfer; diffusion: layered multipoles; dipole: diffusion in one "
                  "half-space like the layers; monte_carlo: photons")
      .one_of(names)
      .show_default();
  command.add_flag("--compare", options->compare,
                   "show an approximation beside it: diffusion beside radiative_transfer, the "
                   "single-layer dipole beside the others");
  command
      .add_option("--incidence", options->incidence,
                  "of radiative_transfer: normal, a pencil beam; diffuse, equal radiance from the "
                  "hemisphere; "
                  "or the angle of a pencil beam in degrees")
      .type_name("WHAT")
      .show_default();
  command
      .add_option("--from", options->from,
                  "of radiative_transfer: the side that is lit, and that R(r) then leaves on")
      .one_of({"above", "below"})
      .show_default();
  command.add_option("--accuracy", options->accuracy, "of radiative_transfer: relative")
      .range(1e-4, 0.1)
      .show_default();
  command.add_flag(
      "--no-cache", options->no_cache,
      "of radiative_transfer: neither look for the result in the cache nor keep it there");
  command
      .add_option("--domain", options->domain,
                  "radius, or frequency: what leaves as a wave J0(k r), diffuse light only")
      .one_of({"radius", "frequency"})
      .show_default();
  command.add_flag(
      "--derivatives", options->has_derivatives,
      "of --domain frequency: of the responses by sigma_a, sigma_s, g and thickness of each layer");
  command
      .add_option("--moments", options->moments,
                  "of an oblique beam: how many moments in azimuth to write to --json")
      .type_name("N")
      .range(1, 32)
      .show_default();
  command
      .add_option(
          "--gaussians", options->gaussians,
          "of radiative_transfer, instead of the profile: N Gaussians that make it, fitted over "
          "spatial frequency, the same for all bands but for their weights")
      .type_name("N")
      .range(1, 40);
  command.add_output_file("--plot", options->plot,
                          "write R(r) and T(r) with that approximation as SVG to FILE", ".svg");
  command.add_option("--radii", options->grid.size, "number of radii, in a geometric series")
      .type_name("N")
      .range(2, 100000)
      .show_default();
  command.add_option("--r-min", options->grid.first, "first radius [mm]").length().show_default();
  command.add_option("--r-max", options->grid.last, "last radius [mm]").length().show_default();
  command.add_choice("--interreflections", options->interreflections,
                     "of diffusion, between layers; none: light turns round once, as in Eqs. 17 "
                     "and 18 of Donner & Jensen 2005");
  add_effort_options(command, options->effort);
  add_common_options(command, options->common);
  command.footer(
      "The dipole has the coefficients of a single layer, made infinitely thick; of several "
      "layers\n"
      "it takes the total reflectance and the frequency of half reflectance. Its T(r) is R(r + "
      "d).\n"
      "Profiles of radiative transfer are kept in $XDG_CACHE_HOME/lamina or ~/.cache/lamina, at "
      "most 256 MiB; "
      "the\n"
      "environment variable LAMINA_CACHE moves them to a folder, or is \"off\".\n\n"
      "Example: how far light spreads in skin, and what diffusion makes of it\n"
      "  lamina profile donner_jensen_skin --compare --plot skin.svg --json skin.json");
  command.callback([options, command] {
    refuse_unused(command, options->method,
                  {{"--accuracy", {"radiative_transfer"}},
                   {"--interreflections", {"diffusion"}},
                   {"--no-cache", {"radiative_transfer"}},
                   {"--photons", {"monte_carlo"}},
                   {"--relative-error", {"monte_carlo"}},
                   {"--time", {"monte_carlo"}},
                   {"--independent-bands", {"monte_carlo"}}});
    if (options->domain == "frequency" && (options->compare || !options->plot.empty()))
      throw InvalidInput("--domain frequency: has neither --compare nor --plot, but one is given");
    if (options->has_derivatives && options->domain != "frequency")
      throw InvalidInput("--derivatives: --domain must be frequency, but is " + options->domain);
    run_profile(*options);
  });
}

}  // namespace lamina::cli
