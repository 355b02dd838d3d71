// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit_batch.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "fit_report.h"
#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/core/parallel.h"
#include "lamina/fit/measurement_fit.h"
#include "lamina/io/csv_table.h"
#include "lamina/io/folder_names.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// A file of the batch: fitted, or why not.
struct FittedFile {
  std::string name;
  std::optional<Measurement> measurement = {};
  std::optional<MeasurementFit> fit = {};
  JsonOutput json = {};
  std::string refusal = {};
};

std::vector<fs::path> csv_files(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const std::string& name : folder_names(folder, error))
    if (lower_case_ending(name) == ".csv") files.push_back(fs::path(folder) / name);
  if (error) throw FileError("--batch: " + folder + ": " + error.message());
  if (files.empty()) throw InvalidInput("--batch: " + folder + ": holds no CSV file");
  std::ranges::sort(files);
  return files;
}

/// Does something with a file, or says why that cannot be.
template <class Work>
void attempt(FittedFile& file, const Work& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    file.refusal = error.what();
  } catch (const FileError& error) {
    file.refusal = error.what();
  }
}

/// A file of a folder, or a column of a table: where it comes from, and what that sets in the
/// measurement.
struct BatchSample {
  std::string name;
  std::function<std::vector<std::string>()> settings;  ///< throws what is wrong with it
};

std::vector<BatchSample> samples_of_folder(const std::string& folder) {
  std::vector<BatchSample> samples;
  for (const fs::path& path : csv_files(folder))
    samples.push_back({path.filename().string(), [path] {
                         return std::vector{"measured[0].file=" +
                                            json_quoted(fs::absolute(path).string())};
                       }});
  return samples;
}

/// Each column of a table but its wavelengths: a spectrum of reflectance.
std::vector<BatchSample> samples_of_table(const std::string& file, MemoryBudget memory) {
  const auto table = std::make_shared<const CsvTable>(load_csv(file, memory));
  const std::size_t wavelengths = table->column("wavelength_nm");
  const auto list = [table](std::size_t column) {
    std::string text;
    for (std::size_t row = 0; row < table->rows(); ++row)
      text += (row == 0 ? "[" : ",") + number_text(table->number(row, column));
    return text + "]";
  };
  std::vector<BatchSample> samples;
  for (std::size_t column = 0; column < table->columns().size(); ++column)
    if (column != wavelengths)
      samples.push_back({table->columns()[column], [=] {
                           return std::vector{std::string("measured[0].file=null"),
                                              "measured[0].wavelength_nm=" + list(wavelengths),
                                              "measured[0].reflectance=" + list(column)};
                         }});
  if (samples.empty())
    throw InvalidInput("--batch: " + file +
                       ": must have a column for each sample beside "
                       "wavelength_nm, but has none");
  return samples;
}

FittedFile load_sample(const FitBatch& batch, const CommonOptions& common,
                       const BatchSample& sample) {
  FittedFile file{.name = sample.name};
  attempt(file, [&] {
    std::vector<std::string> settings = batch.settings;
    for (std::string& setting : sample.settings()) settings.push_back(std::move(setting));
    file.measurement = load_measurement(batch.measurement, common.memory, settings);
  });
  return file;
}

void fit_file(FittedFile& file, const MeasurementFitOptions& options) {
  if (!file.measurement) return;
  attempt(file, [&] {
    file.fit = fit_measurement(*file.measurement, options);
    file.json = fit_json(*file.measurement, *file.fit);
    file.json["file"] = file.name;
  });
}

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// A row for each file that was fitted, a value and an error for each number that any of them has.
std::string csv_table(const std::vector<FittedFile>& files) {
  std::vector<std::string> names;
  for (const FittedFile& file : files)
    if (file.fit)
      for (const FittedNumber& number : file.fit->numbers)
        if (std::ranges::count(names, number.name) == 0) names.push_back(number.name);
  std::string text = "file,chi_squared,degrees_of_freedom,has_converged";
  for (const std::string& name : names) text += "," + cell(name) + "," + cell(name + " sd");
  for (const FittedFile& file : files) {
    if (!file.fit) continue;
    std::map<std::string, const FittedParameter*> found;
    for (const FittedNumber& number : file.fit->numbers) found[number.name] = &number.fitted;
    text += fmt::format("\n{},{},{},{}", cell(file.name), number_text(file.fit->chi_squared),
                        file.fit->degrees_of_freedom, file.fit->has_converged ? 1 : 0);
    for (const std::string& name : names) {
      const auto number = found.find(name);
      if (number == found.end()) {
        text += ",,";
        continue;
      }
      const FittedParameter& fitted = *number->second;
      const double error = 0.5 * (fitted.low_error + fitted.high_error);
      const bool has_error = std::isfinite(error) && !fitted.is_at_bound;
      text += "," + number_text(fitted.value) + "," + (has_error ? number_text(error) : "");
    }
  }
  return text + "\n";
}

}  // namespace

void run_fit_batch(const FitBatch& batch, const CommonOptions& common) {
  const std::vector<BatchSample> samples =
      lower_case_ending(batch.samples) == ".csv" && !fs::is_directory(batch.samples)
          ? samples_of_table(batch.samples, common.memory)
          : samples_of_folder(batch.samples);
  std::vector<FittedFile> files(samples.size());
  parallel_for(samples.size(),
               [&](std::size_t i) { files[i] = load_sample(batch, common, samples[i]); });
  MeasurementTables tables;
  for (const FittedFile& file : files)
    if (file.measurement)
      tables.prepare(*file.measurement, make_progress("tables", Keeps::nothing));
  parallel_for(
      samples.size(),
      [&](std::size_t i) { fit_file(files[i], {.tables = &tables, .seed = common.seed}); },
      make_progress("fits", Keeps::nothing));

  JsonOutput json = make_result("fit");
  json["fits"] = JsonOutput::array();
  json["refused"] = JsonOutput::array();
  std::string text;
  std::map<std::string, std::size_t> refusals;  // as one, what is wrong with the measurement itself
  std::size_t refused = 0;
  for (const FittedFile& file : files) {
    if (file.fit) {
      json["fits"].push_back(file.json);
      text += fmt::format("{}: chi squared {:.3g}, {} degrees of freedom{}\n", file.name,
                          file.fit->chi_squared, file.fit->degrees_of_freedom,
                          file.fit->has_converged ? "" : ", not converged");
    } else {
      ++refused;
      json["refused"].push_back(JsonOutput{{"file", file.name}, {"reason", file.refusal}});
      ++refusals[file.refusal];
    }
  }
  for (const auto& [reason, count] : refusals)
    say(count == 1 ? reason : fmt::format("{} (of {} files)", reason, count));
  if (!batch.output.empty()) write_file(batch.output, csv_table(files));
  if (!batch.report.empty()) {
    std::vector<BatchRow> rows;
    for (const FittedFile& file : files)
      rows.push_back({file.name, file.fit ? &*file.fit : nullptr, file.refusal});
    write_file(batch.report, batch_page(rows, batch.making));
  }
  write_json(json, common);
  print(common, text);
  if (refused > 0)
    throw std::runtime_error(
        fmt::format("{} of {} files could not be fitted", refused, files.size()));
}

}  // namespace lamina::cli
