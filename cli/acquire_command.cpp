// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "acquire_page.h"
#include "commands.h"
#include "console.h"
#include "lamina/acquire/acquired_files.h"
#include "lamina/acquire/acquisition_check.h"
#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/image/image_file.h"
#include "lamina/io/file_bytes.h"
#include "lamina/plot/html_page.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct AcquireOptions {
  CommonOptions common;
  std::string capture, output;
  std::vector<std::string> settings;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string text_of(const Capture& capture, const AcquiredSkin& skin,
                    const AcquisitionCheck& check) {
  std::string text = pixels_text(capture, skin);
  text += fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>8}  {}\n", "", "median", "5 %", "95 %",
                      "error", "of the prior's error");
  for (const NumberSummary& each : summaries_of(skin))
    text +=
        fmt::format("{:<22} {:>9.4g} {:>9.4g} {:>9.4g} {:>8}  {:.2f}, {}\n", each.name, each.median,
                    each.low, each.high, deviation_text(each.deviation, each.is_relative),
                    each.prior_share, told_text(each));
  text += "what the maps reflect differs from the capture by";
  for (std::size_t b = 0; b < check.residual.size(); ++b)
    text +=
        fmt::format(" {:.1f} % ({})", 100.0 * check.residual[b], capture.reflectance.channels[b]);
  if (check.mean_difference) text += fmt::format(", CIEDE2000 {:.2f}", *check.mean_difference);
  for (const std::string& note : capture.notes) text += "\nnote: " + note;
  return text + "\n";
}

JsonOutput json_of(const Capture& capture, const AcquiredSkin& skin, const AcquisitionCheck& check,
                   const AcquiredFiles& files) {
  JsonOutput json = make_result("acquire");
  json["width"] = skin.width;
  json["height"] = skin.height;
  json["lateral"] = "none";
  json["bands"] = capture.reflectance.channels;
  json["pixels"] = {{"skin", skin.counts[0]}, {"not_skin", skin.counts[2]}};
  const MaskCounts counts = count_pixels(capture.mask);
  for (std::size_t f = 0; f < counts.faults.size(); ++f)
    json["pixels"][enum_names<PixelFault>[f].name] = counts.faults[f];
  json["notes"] = capture.notes;
  const std::vector<NumberSummary> summaries = summaries_of(skin);
  for (std::size_t n = 0; n < summaries.size(); ++n) {
    const NumberSummary& each = summaries[n];
    JsonOutput by_band;
    for (std::size_t b = 0; b < check.by_calibration.rows; ++b)
      by_band[capture.reflectance.channels[b]] = check.by_calibration(b, n);
    json["numbers"].push_back({{"name", each.name},
                               {"file", files.maps[n].string()},
                               {"standard_deviation_file", files.deviations[n].string()},
                               {"median", each.median},
                               {"percentile_5", each.low},
                               {"percentile_95", each.high},
                               {"standard_deviation", each.deviation},
                               {"prior_share", each.prior_share},
                               {"within_share", each.within_share},
                               {"told", told_text(each)},
                               {"change_by_2_percent", by_band}});
  }
  json["residual"] = check.residual;
  if (check.mean_difference) json["mean_ciede2000"] = *check.mean_difference;
  json["mask"] = files.mask.string();
  json["material"] = files.material.string();
  if (!files.patch.empty()) json["patch"] = files.patch.string();
  return json;
}

void run_acquire(const AcquireOptions& options) {
  for (const char* ending : {".exr", ".png", ".json"})
    if (lower_case_ending(options.output) == ending)
      throw InvalidInput("--output: must be a folder, not a file, but is " + options.output);
  const Capture capture = load_capture(options.capture, options.common.memory, options.settings);
  const Progress progress = make_progress("acquiring", Keeps::nothing);
  const double start = seconds();
  const SkinReflectanceTable table(capture.wavelengths, capture.incidence,
                                   skin_fit_range(capture.skin.skin), part_of(progress, 0.0, 0.1));
  const SkinColorTable colors = color_table_of(capture, table, part_of(progress, 0.1, 0.7));
  AcquiredSkin skin = acquire_pixels(capture, colors, part_of(progress, 0.7, 0.9));
  const double solved = seconds() - start;
  const AcquisitionCheck check =
      check_acquisition(capture, skin, table, 320, part_of(progress, 0.9, 1.0));
  add_gain_errors(capture, check, skin);
  const fs::path folder =
      options.output.empty() ? fs::path(options.capture).stem() : fs::path(options.output);
  const AcquiredFiles files = save_acquired(skin, capture, folder, LAMINA_VERSION);
  const fs::path page = folder / "report.html";
  std::vector<std::string> arguments = {"acquire", options.capture, "-o", folder.string()};
  for (const std::string& setting : options.settings)
    arguments.insert(arguments.end(), {"--set", setting});
  MemoryBudget memory = options.common.memory;
  write_file(page.string(), acquire_page(capture, skin, check, lamina_command_line(arguments),
                                         is_device(options.capture) || options.capture == "-"
                                             ? ""
                                             : read_file_bytes(options.capture, memory)));
  JsonOutput json = json_of(capture, skin, check, files);
  json["report"] = page.string();
  json["solving_seconds"] = solved;
  write_json(json, options.common);
  print(options.common,
        text_of(capture, skin, check) + fmt::format("solved in {:.1f} s; {}, {}\n", solved,
                                                    files.material.string(), page.string()));
}

}  // namespace

void add_acquire_command(CLI::App& app) {
  auto options = std::make_shared<AcquireOptions>();
  const Command command(app, "acquire",
                        "Maps of melanin, blood and other numbers of skin from photographs, each "
                        "with its error.");
  command.add_option("capture", options->capture, "capture file").type_name("CAPTURE").required();
  add_settings_option(command, options->settings, "capture file");
  command
      .add_option("-o,--output", options->output,
                  "folder for an EXR per number, one of its standard deviation, material.json that "
                  "uses them, and report.html")
      .type_name("FOLDER");
  add_common_options(command, options->common);
  command.footer(
      "docs/acquire.md has the file format; a capture file may be as short as\n"
      "  { \"lamina\": \"capture\", \"version\": 1,\n"
      "    \"images\": [ { \"image\": \"skin.png\", \"encoding\": \"srgb\", \"sensor\": \"srgb\" } "
      "] }\n"
      "Example: lamina acquire skin.json -o maps && xdg-open maps/report.html");
  command.callback([options] { run_acquire(*options); });
}

}  // namespace lamina::cli
