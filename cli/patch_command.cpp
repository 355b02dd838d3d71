// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/plot/plot.h"
#include "lamina/skin/patch/files/skin_patch_file.h"
#include "lamina/skin/patch/skin_patch.h"
#include "picture_files.h"

namespace lamina::cli {
namespace {

struct PatchOptions {
  CommonOptions common;
  std::string patch, output;
  std::string fit_plot;
  std::vector<std::string> settings;
  double exposure = 0.0;
  bool uses_no_cache = false;
};

/// How well sums of Gaussians follow each operator, over absorption or over all states of a layer.
void save_fit_plot(const std::string& file, const SkinPatch& patch,
                   const std::vector<StackTables>& tables) {
  Plot plot;
  plot.title = "Error of the tables of Gaussians";
  plot.caption = fmt::format(
      "Largest over spatial frequencies up to {:.0f}/mm, of the value at 0, with {} Gaussians and "
      "a delta.",
      highest_fitted_frequency, tables[0].grid.gaussians);
  plot.panel_width = 260.0;
  plot.panel_height = 180.0;
  const std::array<std::pair<const char*, GaussianTable LayerTables::*>, 4> operators = {
      {{"R+", &LayerTables::reflection_above},
       {"T+", &LayerTables::transmission_down},
       {"R-", &LayerTables::reflection_below},
       {"T-", &LayerTables::transmission_up}}};
  for (std::size_t layer = 0; layer < tables[0].layers.size(); ++layer)
    for (const auto& [name, table] : operators) {
      if ((tables[0].layers[layer].*table).error.empty()) continue;
      PlotPanel& panel = plot.panels.emplace_back();
      panel.title = fmt::format("{} of layer {}", name, layer);
      const bool varies_in_absorption =
          std::ranges::all_of(tables, [&](const StackTables& of_band) {
            const StateLattice& lattice = of_band.lattices[layer];
            return lattice.axes.size() == 1 && lattice.axes[0].direction[0] == 1.0;
          });
      panel.x = {.label = varies_in_absorption ? "absorption [1/mm]" : "state of the layer"};
      if (varies_in_absorption) panel.x.scale = AxisScale::logarithmic;
      panel.y = {.label = "error", .scale = AxisScale::logarithmic};
      for (std::size_t b = 0; b < tables.size(); ++b) {
        PlotCurve curve{.name = band_label(patch.bands, b), .color = band_color(patch.bands, b)};
        curve.y = (tables[b].layers[layer].*table).error;
        for (std::size_t node = 0; node < curve.y.size(); ++node)
          curve.x.push_back(varies_in_absorption
                                ? node_state(tables[b].lattices[layer], node).sigma_a
                                : static_cast<double>(node));
        panel.curves.push_back(std::move(curve));
      }
    }
  save_svg(plot, file);
}

/// Linear sRGB, the mean of all texels.
std::array<double, 3> mean_color(const Image& image) {
  const Image rgb = rgb_image(image);
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < rgb.pixels.size(); ++i)
    sum[i % 3] += static_cast<double>(rgb.pixels[i]);
  for (double& channel : sum) channel *= 3.0 / static_cast<double>(rgb.pixels.size());
  return sum;
}

/// Where the light that comes through is shown, beside the picture; empty: nowhere.
std::string transmitted_file(const std::string& png, const Image& image) {
  if (png.empty() || !channel_index(image, "transmitted.R")) return {};
  return png.substr(0, png.size() - std::string_view(".png").size()) + "_transmitted.png";
}

Image transmitted_light(const Image& image) {
  Image light = select_channels(image, {"transmitted.R", "transmitted.G", "transmitted.B"});
  light.channels = {"R", "G", "B"};
  return light;
}

void run_patch(const PatchOptions& options) {
  const SkinPatch patch = [&] {
    const Progress loading = make_progress("loading the patch", Keeps::nothing);
    return load_skin_patch(options.patch, options.common.memory, options.settings);
  }();
  for (const std::string& warning : patch.warnings) say("warning: " + warning);
  const PictureFiles files = picture_files(options.output, options.patch);
  require_different({{"--output", files.exr},
                     {"--output", files.png},
                     {"--json", options.common.json},
                     {"--fit-plot", options.fit_plot},
                     {"the patch", options.patch}});

  const auto start = std::chrono::steady_clock::now();
  const SkinPatchResult result =
      render_skin_patch(patch, options.uses_no_cache ? std::nullopt : user_cache(),
                        make_progress("light through layers", Keeps::nothing));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!files.exr.empty()) save_exr(result.image, files.exr, ExrPrecision::single_float);
  if (!options.fit_plot.empty()) save_fit_plot(options.fit_plot, patch, result.tables);
  if (!files.png.empty())
    save_png(view_image(result.image, View::standard, options.exposure), files.png);
  const std::string other_side = transmitted_file(files.png, result.image);
  if (!other_side.empty())
    save_png(view_image(transmitted_light(result.image), View::standard, options.exposure),
             other_side);

  const double texel_bands =
      static_cast<double>(patch.width) * patch.height * static_cast<double>(patch.bands.size());
  std::string text = fmt::format("{}{}{}{}{}\n{:>8}  {:>16}  {:>9}  {:>7}  {:>11}\n", files.exr,
                                 files.exr.empty() || files.png.empty() ? "" : ", ", files.png,
                                 other_side.empty() ? "" : ", ", other_side, "band",
                                 "mean reflectance", "fit error", "bounces", "last bounce");
  JsonOutput json = make_result("patch");
  json["name"] = patch.name;
  json["width"] = patch.width;
  json["height"] = patch.height;
  for (std::size_t b = 0; b < result.bands.size(); ++b) {
    const SkinPatchBand& band = result.bands[b];
    text += fmt::format("{:>5} nm  {:16.5f}  {:9.1e}  {:7}  {:9.2f} %\n", band_name(patch.bands, b),
                        band.mean_reflectance, band.fit_error, band.interlayer_bounces,
                        100.0 * band.last_bounce);
    json["bands"].push_back(patch.bands.wavelengths()[b]);
    json["mean_reflectance"].push_back(band.mean_reflectance);
    json["fit_error"].push_back(band.fit_error);
    json["interlayer_bounces"].push_back(band.interlayer_bounces);
    json["last_bounce"].push_back(band.last_bounce);
  }
  text += fmt::format(
      "{:.2f} s; tables {:.2f} s, transport {:.2f} s ({:.0f} ns per texel and band), "
      "summed over threads\n",
      seconds, result.table_seconds, result.transport_seconds,
      1e9 * result.transport_seconds / texel_bands);
  json["mean_rgb"] = mean_color(result.image);
  json["wall_seconds"] = seconds;
  json["table_seconds"] = result.table_seconds;
  json["transport_seconds"] = result.transport_seconds;
  json["warnings"] = patch.warnings;
  write_json(json, options.common);
  print(options.common, text);
}

}  // namespace

void add_patch_command(CLI::App& app) {
  auto options = std::make_shared<PatchOptions>();
  const Command command(
      app, "patch",
      "A flat piece of skin, or of other layers, whose numbers are maps, under a pattern of "
      "light.");
  command.add_option("patch", options->patch, "patch file").type_name("PATCH").required();
  add_settings_option(command, options->settings, "patch");
  command
      .add_option(
          "-o,--output", options->output,
          "NAME.exr: a channel per band and R, G, B; NAME.png: as it looks; without an ending, "
          "or with a frame number for one, both; in a folder, or without the option, both "
          "named after the patch")
      .type_name("NAME");
  command.add_option("--exposure", options->exposure, "stops, for the PNG only")
      .type_name("EV")
      .range(-50.0, 50.0);
  command.add_output_file("--fit-plot", options->fit_plot,
                          "plot of the error of the tables, as SVG", ".svg");
  command.add_flag("--no-cache", options->uses_no_cache,
                   "make the tables anew and do not keep them");
  add_common_options(command, options->common);
  command.footer(
      "Mirror reflection is left out. docs/heterogeneous_skin.md has the file format.\n"
      "Example: a patch with freckles and a vein, from maps made on the spot\n"
      "  lamina maps examples/skin/freckles.json -o freckles && lamina patch "
      "freckles/patch.json");
  command.callback([options] { run_patch(*options); });
}

}  // namespace lamina::cli
