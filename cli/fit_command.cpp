// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "fit_report.h"
#include "lamina/fit/measurement_fit.h"
#include "lamina/materials/material.h"

namespace lamina::cli {
namespace {

struct FitCommandOptions {
  CommonOptions common;
  std::string measurement, output, plot;
  std::vector<std::string> settings;
};

void run_fit(const FitCommandOptions& options) {
  require_different({{"--output", options.output},
                     {"--plot", options.plot},
                     {"--json", options.common.json},
                     {"the measurement", options.measurement}});
  const Measurement measurement =
      load_measurement(options.measurement, options.common.memory, options.settings);
  const MeasurementFit fit = fit_measurement(
      measurement, {.seed = options.common.seed, .progress = make_progress("fit", Keeps::nothing)});
  JsonOutput json = make_result("fit");
  json.update(fit_json(measurement, fit));
  if (!options.output.empty())
    write_file(options.output, format_material(material_with(measurement, fit.values)));
  if (!options.plot.empty()) save_svg(fit_plot(measurement, fit), options.plot);
  write_json(json, options.common);
  print(options.common, fit_text(measurement, fit));
}

}  // namespace

void add_fit_command(CLI::App& app) {
  auto options = std::make_shared<FitCommandOptions>();
  const Command command(app, "fit",
                        "Finds numbers of a material from measurements, with error bars.");
  command
      .add_option("measurement", options->measurement,
                  "a measurement file: what was measured, and what is free")
      .type_name("MEASUREMENT")
      .required();
  command
      .add_output_file("-o,--output", options->output, "write the material as it was found",
                       ".json")
      .type_name("FILE.json");
  command
      .add_output_file("--plot", options->plot,
                       "plot what was measured, what the fit predicts and what is left", ".svg")
      .type_name("FILE.svg");
  add_settings_option(command, options->settings, "measurement");
  add_common_options(command, options->common);
  command.footer(
      "Errors are one standard deviation; notes say what the measurement cannot tell.\n\n"
      "Example: absorption and scattering of a phantom from its reflectance and transmittance\n"
      "  lamina fit examples/measurements/phantom.json -o phantom.json --plot phantom.svg");
  command.callback([options] { run_fit(*options); });
}

}  // namespace lamina::cli
