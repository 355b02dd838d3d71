// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit_shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <stdexcept>
#include <utility>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/base/io/json_input.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

/// A row for each sample, a value and an error for each number that any of them has.
std::string csv_table(const std::vector<FittedSample>& samples) {
  std::vector<std::string> names;
  for (const FittedSample& sample : samples)
    for (const FittedSample::Number& number : sample.numbers)
      if (std::ranges::count(names, number.name) == 0) names.push_back(number.name);
  std::string text = "file,chi_squared,degrees_of_freedom,has_converged";
  for (const std::string& name : names) text += "," + csv_cell(name) + "," + csv_cell(name + " sd");
  for (const FittedSample& sample : samples) {
    std::map<std::string, const FittedSample::Number*> found;
    for (const FittedSample::Number& number : sample.numbers) found[number.name] = &number;
    text += fmt::format("\n{},{},{},{}", csv_cell(sample.name), number_text(sample.chi_squared),
                        sample.degrees_of_freedom, sample.has_converged ? 1 : 0);
    for (const std::string& name : names) {
      const auto number = found.find(name);
      if (number == found.end()) {
        text += ",,";
        continue;
      }
      const auto& [_, value, error] = *number->second;
      text += "," + number_text(value) + "," + (error ? number_text(*error) : "");
    }
  }
  return text + "\n";
}

JsonOutput table_json(const std::vector<FittedSample>& samples) {
  JsonOutput table = JsonOutput::array();
  for (const FittedSample& sample : samples) {
    JsonOutput row = {{"file", sample.name},
                      {"chi_squared", sample.chi_squared},
                      {"degrees_of_freedom", sample.degrees_of_freedom},
                      {"has_converged", sample.has_converged},
                      {"numbers", JsonOutput::array()}};
    for (const auto& [name, value, error] : sample.numbers)
      row["numbers"].push_back(
          JsonOutput{{"name", name},
                     {"value", value},
                     {"sd", error ? JsonOutput(*error) : JsonOutput(nullptr)}});
    table.push_back(std::move(row));
  }
  return table;
}

FittedSample read_sample(const JsonInput& input) {
  const JsonObject json =
      input.object({"file", "chi_squared", "degrees_of_freedom", "has_converged", "numbers"});
  constexpr std::int64_t most = std::int64_t{1} << 40;
  FittedSample sample{
      .name = json.required("file").string(),
      .chi_squared = json.required("chi_squared").number(),
      .degrees_of_freedom = json.required("degrees_of_freedom").integer(-most, most),
      .has_converged = json.required("has_converged").boolean()};
  for (const JsonInput& entry : json.required("numbers").array()) {
    const JsonObject number = entry.object({"name", "value", "sd"});
    const JsonInput error = number.required("sd");
    sample.numbers.push_back({.name = number.required("name").string(),
                              .value = number.required("value").number(),
                              .error = error.is_null() ? std::optional<double>() : error.number()});
  }
  return sample;
}

JsonOutput refused_json(const std::vector<FittedBatch::Refused>& refused) {
  JsonOutput list = JsonOutput::array();
  for (const auto& [name, reason] : refused)
    list.push_back(JsonOutput{{"file", name}, {"reason", reason}});
  return list;
}

std::string checksum_of(const JsonOutput& part) {
  Hash hash;
  hash.add_text(part.text());
  return fmt::format("{:016x}", hash.value());
}

std::uint64_t hexadecimal(const JsonInput& input) {
  const std::string text = input.string();
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc() || end != text.data() + text.size() || text.empty())
    input.fail("must be a hexadecimal number in quotes");
  return value;
}

FitShard load_fit_shard(const std::string& file, MemoryBudget memory) {
  const JsonDocument document = load_json(file, memory);
  const std::optional<JsonInput> input = document.root().peek("shard");
  if (!input) document.root().fail("must hold \"shard\", as `lamina fit --shard I/N` writes it");
  const std::optional<JsonInput> sum = document.root().peek("checksum");
  if (!sum || !sum->is_string() || sum->string() != checksum_of(JsonOutput(*input)))
    throw FileError(file + ": is damaged; remove it, and make it again");
  const JsonObject json =
      input->object({"index", "of", "version", "key", "command", "fits", "table", "refused"});
  FitShard shard;
  shard.shard.count = static_cast<int>(json.required("of").integer(1, 1 << 24));
  shard.shard.index = static_cast<int>(json.required("index").integer(0, shard.shard.count - 1));
  shard.version = json.required("version").string();
  shard.key = hexadecimal(json.required("key"));
  for (const JsonInput& word : json.required("command").array())
    shard.command.push_back(word.string());
  for (const JsonInput& fit : json.required("fits").array()) shard.batch.fits.emplace_back(fit);
  for (const JsonInput& row : json.required("table").array())
    shard.batch.samples.push_back(read_sample(row));
  for (const JsonInput& entry : json.required("refused").array()) {
    const JsonObject refused = entry.object({"file", "reason"});
    shard.batch.refused.push_back(
        {refused.required("file").string(), refused.required("reason").string()});
  }
  return shard;
}

/// @throws InvalidInput if a shard is no part of the same batch as the first
void require_same(const FitShard& first, const std::string& first_file, const FitShard& shard,
                  const std::string& file) {
  if (shard.version != first.version)
    throw InvalidInput(fmt::format("{}: the version of lamina must be that of {}, {}, but is {}",
                                   file, first_file, first.version, shard.version));
  if (shard.shard.count != first.shard.count)
    throw InvalidInput(fmt::format("{}: must be one of {} shards, as {}, but is one of {}", file,
                                   first.shard.count, first_file, shard.shard.count));
  if (shard.key != first.key)
    throw InvalidInput(
        fmt::format("{}: must be of the measurement, samples and options of {}, but is of others",
                    file, first_file));
}

}  // namespace

void report_batch(const FittedBatch& batch, const std::string& command, const std::string& table,
                  const CommonOptions& common) {
  JsonOutput json = make_result(command);
  json["fits"] = JsonOutput(batch.fits);
  json["refused"] = refused_json(batch.refused);
  std::map<std::string, std::size_t> refusals;  // as one, what is wrong with the measurement itself
  for (const FittedBatch::Refused& refused : batch.refused) ++refusals[refused.reason];
  for (const auto& [reason, count] : refusals)
    say(count == 1 ? reason : fmt::format("{} (of {} files)", reason, count));
  if (!table.empty()) write_file(table, csv_table(batch.samples));
  write_json(json, common);
  std::string text;
  for (const FittedSample& sample : batch.samples)
    text += fmt::format("{}: chi squared {:.3g}, {} degrees of freedom{}\n", sample.name,
                        sample.chi_squared, sample.degrees_of_freedom,
                        sample.has_converged ? "" : ", not converged");
  print(common, text);
  if (!batch.refused.empty())
    throw std::runtime_error(fmt::format("{} of {} files could not be fitted", batch.refused.size(),
                                         batch.refused.size() + batch.samples.size()));
}

JsonOutput fit_shard_json(const FitShard& shard) {
  JsonOutput json = make_result("fit");
  json["shard"] = {{"index", shard.shard.index},
                   {"of", shard.shard.count},
                   {"version", shard.version},
                   {"key", fmt::format("{:016x}", shard.key)},
                   {"command", JsonOutput(shard.command)},
                   {"fits", JsonOutput(shard.batch.fits)},
                   {"table", table_json(shard.batch.samples)},
                   {"refused", refused_json(shard.batch.refused)}};
  json["checksum"] = checksum_of(json["shard"]);
  return json;
}

bool is_fit_shard(const std::string& file, MemoryBudget memory) {
  const JsonDocument document = load_json(file, memory);
  if (!document.root().is_object()) return false;
  const std::optional<JsonInput> command = document.root().peek("command");
  return command && command->is_string() && command->string() == "fit";
}

void merge_fits(const MergeOptions& options) {
  std::map<int, FitShard> shards;
  std::string first_file;
  for (const std::string& file : options.files) {
    FitShard shard = load_fit_shard(file, options.common.memory);
    if (shards.empty())
      first_file = file;
    else
      require_same(shards.begin()->second, first_file, shard, file);
    const int index = shard.shard.index, of = shard.shard.count;
    if (!shards.emplace(index, std::move(shard)).second)
      throw InvalidInput(
          fmt::format("{}: shard {}/{} must be given once, but is given twice", file, index, of));
  }
  const FitShard& first = shards.begin()->second;
  std::vector<int> missing;
  for (int i = 0; i < first.shard.count; ++i)
    if (!shards.contains(i)) missing.push_back(i);
  report_missing(missing, first.shard.count, options.needs_all, [&](int i) {
    std::vector<std::string> words = first.command;
    words.insert(words.end(), {"--shard", fmt::format("{}/{}", i, first.shard.count), "--json",
                               fmt::format("{}.json", i)});
    return words;
  });
  FittedBatch all;
  for (auto& [index, shard] : shards) {
    std::ranges::move(shard.batch.samples, std::back_inserter(all.samples));
    std::ranges::move(shard.batch.refused, std::back_inserter(all.refused));
    std::ranges::move(shard.batch.fits, std::back_inserter(all.fits));
  }
  report_batch(all, "merge", options.output, options.common);
}

}  // namespace lamina::cli
