// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "fit_batch.h"
#include "fit_page.h"
#include "fit_report.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/layers/materials/material.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

struct FitCommandOptions {
  CommonOptions common;
  std::string measurement, output, plot, report, batch, shard;
  bool only_checks = false;
  std::vector<std::string> settings;
};

/// The ending that the output of --output has. @throws InvalidInput
void require_ending(const FitCommandOptions& options) {
  const std::string ending = options.batch.empty() ? ".json" : ".csv";
  if (!options.output.empty() && lower_case_ending(options.output) != ending)
    throw InvalidInput("--output: must end in " + ending +
                       (options.batch.empty() ? ", the material" : " with --batch, a table") +
                       ", but is " + options.output);
}

/// What the result depends on, and nothing else: the same report for the same fit.
FitMaking making_of(const FitCommandOptions& options) {
  FitMaking making{.arguments = {"fit", options.measurement}, .file = {}};
  const auto add = [&](const std::string& option, const std::string& value) {
    making.arguments.insert(making.arguments.end(), {option, value});
  };
  for (const std::string& setting : options.settings) add("--set", setting);
  if (!options.batch.empty()) add("--batch", options.batch);
  if (options.common.seed != 0) add("--seed", std::to_string(options.common.seed));
  MemoryBudget memory = options.common.memory;
  if (!options.report.empty() && options.measurement != "-" && !is_device(options.measurement))
    making.file = read_file_bytes(options.measurement, memory);
  return making;
}

void run_fit(const FitCommandOptions& options) {
  require_ending(options);
  require_different({{"--output", options.output},
                     {"--plot", options.plot},
                     {"--report", options.report},
                     {"--json", options.common.json},
                     {"the measurement", options.measurement}});
  if (!options.batch.empty()) {
    FitBatch batch{options.measurement, options.settings, options.batch,
                   options.output,      options.report,   making_of(options)};
    if (!options.shard.empty()) batch.shard = read_shard(options.shard);
    return options.only_checks ? check_fit_batch(batch, options.common)
                               : run_fit_batch(batch, options.common);
  }
  const Measurement measurement =
      load_measurement(options.measurement, options.common.memory, options.settings);
  const MeasurementFit fit = fit_measurement(
      measurement, {.seed = options.common.seed, .progress = make_progress("fit", Keeps::nothing)});
  JsonOutput json = make_result("fit");
  json.update(fit_json(measurement, fit));
  if (!options.output.empty())
    write_file(options.output, format_material(material_with(measurement, fit.values)));
  if (!options.plot.empty()) save_svg(fit_plot(measurement, fit), options.plot);
  if (!options.report.empty())
    write_file(options.report, fit_page(measurement, fit, making_of(options)));
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
      .add_output_file("-o,--output", options->output,
                       "write the material as it was found; with --batch a table, .csv")
      .type_name("FILE.json");
  command
      .add_output_file("--plot", options->plot,
                       "plot what was measured, what the fit predicts and what is left", ".svg")
      .type_name("FILE.svg");
  command
      .add_output_file("--report", options->report,
                       "write all of it as one page: what was measured, assumed and found, plots, "
                       "correlations, notes",
                       ".html")
      .type_name("FILE.html");
  command
      .add_option("--batch", options->batch,
                  "fits each CSV file of a folder, or each column of a CSV file as a spectrum of "
                  "reflectance, in place of the file of the first measured entry")
      .type_name("FOLDER|FILE.csv");
  command
      .add_option("--shard", options->shard,
                  "fits part I of N of the samples of --batch; `lamina merge` puts the parts "
                  "together")
      .type_name("I/N");
  command.add_flag("--check", options->only_checks,
                   "reads the samples of --batch and says how many there are, without fitting");
  add_settings_option(command, options->settings, "measurement");
  add_common_options(command, options->common);
  command.footer(
      "Errors are one standard deviation; notes say what the measurement cannot tell.\n\n"
      "Example: absorption and scattering of a phantom from its reflectance and transmittance\n"
      "  lamina fit examples/measurements/liquid.json -o liquid_found.json --report liquid.html\n"
      "Many samples, measured alike\n"
      "  lamina fit examples/measurements/liquid.json --batch spectra -o found.csv");
  command.callback([options, command] {
    const auto refuse = [&](const char* name, const std::string& why) {
      if (command.is_given(name)) throw InvalidInput(std::string(name) + ": " + why);
    };
    if (!options->batch.empty()) refuse("--plot", "must be left out with --batch");
    if (options->batch.empty())
      for (const char* name : {"--shard", "--check"})
        refuse(name, "is for samples of --batch, which is not given");
    if (!options->shard.empty()) {
      for (const char* name : {"--output", "--report"})
        refuse(name, "is of all samples, and --shard of some; `lamina merge -o` makes the table");
      if (options->common.json.empty())
        refuse("--shard", "needs --json FILE, which keeps the part for `lamina merge`");
    }
    run_fit(*options);
  });
}

}  // namespace lamina::cli
