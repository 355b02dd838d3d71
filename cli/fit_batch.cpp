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
#include <set>
#include <utility>

#include "fit_report.h"
#include "fit_shard.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/files_read.h"
#include "lamina/base/io/folder_names.h"
#include "lamina/base/spectrum/spectrum_table.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "shard_option.h"

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
  bool is_unreadable = false;  ///< rather than wrong
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
    file.is_unreadable = true;
  }
}

/// A file of a folder, or a column of a table: where it comes from, and what that sets in the
/// measurement.
struct BatchSample {
  std::string name;
  fs::path file;                                       ///< that it comes from
  std::function<std::vector<std::string>()> settings;  ///< throws what is wrong with it
};

std::vector<BatchSample> samples_of_folder(const std::string& folder) {
  std::vector<BatchSample> samples;
  for (const fs::path& path : csv_files(folder))
    samples.push_back({path.filename().string(), path, [path] {
                         return std::vector{"measured[0].file=" +
                                            json_quoted(fs::absolute(path).string())};
                       }});
  return samples;
}

/// Each column of a table but its wavelengths: a spectrum of reflectance.
std::vector<BatchSample> samples_of_table(const std::string& file, MemoryBudget memory) {
  CsvTable loaded = load_csv(file, memory);
  const std::size_t wavelengths = loaded.column("wavelength_nm");
  raise_wavelengths(loaded, wavelengths);
  const auto table = std::make_shared<const CsvTable>(std::move(loaded));
  const auto list = [table](std::size_t column) {
    std::string text;
    for (std::size_t row = 0; row < table->rows(); ++row)
      text += (row == 0 ? "[" : ",") + number_text(table->number(row, column));
    return text + "]";
  };
  std::vector<BatchSample> samples;
  for (std::size_t column = 0; column < table->columns().size(); ++column)
    if (column != wavelengths)
      samples.push_back({table->columns()[column], file, [=] {
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

FittedSample sample_of(const FittedFile& file) {
  FittedSample sample{.name = file.name,
                      .chi_squared = file.fit->chi_squared,
                      .degrees_of_freedom = file.fit->degrees_of_freedom,
                      .has_converged = file.fit->has_converged};
  for (const FittedNumber& number : file.fit->numbers) {
    const FittedParameter& fitted = number.fitted;
    const double error = 0.5 * (fitted.low_error + fitted.high_error);
    sample.numbers.push_back(
        {number.name, fitted.value, std::isfinite(error) ? std::optional(error) : std::nullopt});
  }
  return sample;
}

FittedBatch batch_of(const std::vector<FittedFile>& files) {
  FittedBatch batch;
  for (const FittedFile& file : files) {
    if (file.fit) {
      batch.samples.push_back(sample_of(file));
      batch.fits.push_back(file.json);
    } else {
      batch.refused.push_back({file.name, file.refusal});
    }
  }
  return batch;
}

std::uint64_t hash_of(const fs::path& file, MemoryBudget memory) {
  Hash hash;
  std::error_code error;
  if (fs::is_regular_file(file, error)) hash.add_text(read_file_bytes(file, memory));
  return hash.value();
}

/// A number that shards of one batch have in common: of the call, and of all files that any of them
/// reads, wherever these are.
std::uint64_t key_of(const FitBatch& batch, const CommonOptions& common,
                     const std::vector<BatchSample>& samples) {
  Hash hash;
  for (const std::string& word : words_of_shards(words_of_call())) hash.add_text(word);
  std::map<fs::path, std::uint64_t> of_samples;
  for (const BatchSample& sample : samples) {
    hash.add_text(sample.name);
    if (!of_samples.contains(sample.file))
      of_samples[sample.file] = hash_of(sample.file, common.memory);
    hash.add(of_samples[sample.file]);
  }
  // Samples share all files but their own; one that is wrong may be refused before all are read.
  std::set<std::uint64_t> shared;
  for (const BatchSample& sample : samples) {
    const FilesRead reading;
    const bool is_whole = load_sample(batch, common, sample).measurement.has_value();
    for (const FileState& file : reading.files()) shared.insert(hash_of(file.file, common.memory));
    if (is_whole) break;
  }
  for (const std::uint64_t content : shared) hash.add(content);
  return hash.value();
}

std::vector<BatchSample> find_samples(const FitBatch& batch, MemoryBudget memory) {
  return lower_case_ending(batch.samples) == ".csv" && !fs::is_directory(batch.samples)
             ? samples_of_table(batch.samples, memory)
             : samples_of_folder(batch.samples);
}

}  // namespace

void check_fit_batch(const FitBatch& batch, const CommonOptions& common) {
  const std::vector<BatchSample> samples = find_samples(batch, common.memory);
  const FittedFile first = load_sample(batch, common, samples[0]);
  if (!first.measurement) throw InvalidInput(first.refusal);
  JsonOutput json = make_result("fit");
  json["samples"] = samples.size();
  write_json(json, common);
  print(common, fmt::format("{} samples\n", samples.size()));
}

void run_fit_batch(const FitBatch& batch, const CommonOptions& common) {
  std::vector<BatchSample> samples = find_samples(batch, common.memory);
  FitShard part{.shard = batch.shard.value_or(Shard()), .version = LAMINA_VERSION};
  if (batch.shard) {
    part.key = key_of(batch, common, samples);
    part.command = words_of_shards(words_of_call());
    const IndexRange range = range_of(part.shard, static_cast<std::int64_t>(samples.size()));
    samples = {samples.begin() + range.begin, samples.begin() + range.end};
  }
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

  if (batch.shard) {
    // Another machine, or a later run, may be able to read it.
    for (const FittedFile& file : files)
      if (file.is_unreadable) throw FileError(file.refusal);
    part.batch = batch_of(files);
    write_json(fit_shard_json(part), common);
    print(common, fmt::format("{}: {} samples fitted, {} refused\n", common.json,
                              part.batch.samples.size(), part.batch.refused.size()));
    return;
  }
  if (!batch.report.empty()) {
    std::vector<BatchRow> rows;
    for (const FittedFile& file : files)
      rows.push_back({file.name, file.fit ? &*file.fit : nullptr, file.refusal});
    write_file(batch.report, batch_page(rows, batch.making));
  }
  report_batch(batch_of(files), "fit", batch.output, common);
}

}  // namespace lamina::cli
