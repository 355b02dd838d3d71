// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Raw sums of photon runs in files: written by `photons`, read by `merge`.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/spectrum/band_set.h"
#include "photons_options.h"

namespace lamina::cli {
namespace {

constexpr std::size_t digits = 32;  // of a 128-bit sum

std::string hexadecimal(const std::vector<WideSum>& sums) {
  std::string text;
  text.reserve(sums.size() * digits);
  for (const WideSum& sum : sums) text += fmt::format("{:016x}{:016x}", sum.high, sum.low);
  return text;
}

std::vector<WideSum> sums(const JsonInput& input, std::size_t expected) {
  const std::string text = input.string();
  if (text.size() % digits != 0 || text.size() / digits != expected)
    input.fail(fmt::format("must hold {} sums of {} hexadecimal digits, but has {} digits",
                           expected, digits, text.size()));
  std::vector<WideSum> values(expected);
  const auto read = [&](std::size_t at) {
    std::uint64_t word = 0;
    const char* end = text.data() + at + 16;
    if (std::from_chars(text.data() + at, end, word, 16).ptr != end)
      input.fail("must be hexadecimal digits, but is not");
    return word;
  };
  for (std::size_t i = 0; i < expected; ++i)
    values[i] = {.low = read(i * digits + 16), .high = read(i * digits)};
  return values;
}

JsonOutput tallies_json(const PhotonTallies& t) {
  JsonOutput directions = JsonOutput::array();
  for (const ExitDirection& d : t.directions)
    directions.push_back({{"theta", d.theta}, {"phi", d.phi}, {"is_below", d.is_below}});
  JsonOutput json = {{"r", JsonOutput::array({t.r.count, t.r.width})},
                     {"angles", t.angles},
                     {"log_r", JsonOutput::array({t.log_r.count, t.log_r.low, t.log_r.high})},
                     {"depth", JsonOutput::array({t.depth.count, t.depth.width})},
                     {"fluence", t.fluence},
                     {"bsdf", JsonOutput::array({t.bsdf_cosines, t.bsdf_azimuths})},
                     {"orders", t.orders},
                     {"path_length", JsonOutput::array({t.path_length.count, t.path_length.width})},
                     {"mean_path_length", t.mean_path_length},
                     {"detectors", t.detectors},
                     {"detector_width", t.detector_width},
                     {"directions", directions}};
  // Only where asked for, so that files of other runs stay as they were.
  if (t.time.count > 0) json["time"] = JsonOutput::array({t.time.count, t.time.width});
  if (!t.frequencies.empty()) json["frequencies"] = t.frequencies;
  return json;
}

JsonOutput counts_json(const PhotonCounts& counts) {
  return {{"run", counts.run},
          {"tallies", tallies_json(counts.tallies)},
          {"layers", counts.layers},
          {"specular", counts.specular},
          {"random_specular", counts.has_random_specular},
          {"length_unit", counts.length_unit},
          {"photons", counts.photons},
          {"batches", counts.batches},
          {"events", fmt::format("{:x}", counts.events)},
          {"was_stopped", counts.was_stopped},
          {"first", hexadecimal(counts.first)},
          {"second", hexadecimal(counts.second)},
          {"volume_first", hexadecimal(counts.volume_first)},
          {"volume_second", hexadecimal(counts.volume_second)}};
}

/// A run without its checksum.
JsonOutput run_json(const PhotonRun& run) {
  JsonOutput counts = JsonOutput::array();
  for (const PhotonCounts& band : run.counts) counts.push_back(counts_json(band));
  return {{"name", run.name},
          {"bands", run.bands},
          {"shards", run.shards},
          {"of", run.of},
          {"bands_counts", counts}};
}

/// Of the text of a run, which is the same for the same run.
std::uint64_t checksum(const JsonOutput& run) {
  Hash hash;
  hash.add_text(run.text());
  return hash.value();
}

constexpr std::int64_t most_bins = 1'000'000'000;

int count_of(const JsonInput& input) { return static_cast<int>(input.integer(0, most_bins)); }

UniformBins uniform_bins(const JsonInput& input) {
  const auto parts = input.array(2, 2);
  return {.count = count_of(parts[0]), .width = parts[1].number(at_least(0.0))};
}

PhotonTallies read_tallies(const JsonInput& input) {
  const JsonObject object = input.object({"r", "angles", "log_r", "depth", "fluence", "bsdf",
                                          "orders", "path_length", "mean_path_length", "detectors",
                                          "detector_width", "directions", "time", "frequencies"});
  PhotonTallies t;
  t.r = uniform_bins(object.required("r"));
  t.angles = count_of(object.required("angles"));
  const auto log_r = object.required("log_r").array(3, 3);
  t.log_r = {.count = count_of(log_r[0]), .low = log_r[1].number(), .high = log_r[2].number()};
  t.depth = uniform_bins(object.required("depth"));
  t.fluence = object.required("fluence").boolean();
  const auto bsdf = object.required("bsdf").array(2, 2);
  t.bsdf_cosines = count_of(bsdf[0]);
  t.bsdf_azimuths = count_of(bsdf[1]);
  t.orders = object.required("orders").boolean();
  t.path_length = uniform_bins(object.required("path_length"));
  t.mean_path_length = object.required("mean_path_length").boolean();
  if (const auto time = object.optional("time")) t.time = uniform_bins(*time);
  if (const auto frequencies = object.optional("frequencies"))
    for (const JsonInput& frequency : frequencies->array(1))
      t.frequencies.push_back(frequency.number(closed_interval(0.0, 1e6, "MHz")));
  for (const JsonInput& r : object.required("detectors").array())
    t.detectors.push_back(r.number(at_least(0.0, "mm")));
  t.detector_width = object.required("detector_width").number(at_least(0.0, "mm"));
  for (const JsonInput& entry : object.required("directions").array()) {
    const JsonObject direction = entry.object({"theta", "phi", "is_below"});
    t.directions.push_back({.theta = direction.required("theta").number(),
                            .phi = direction.required("phi").number(),
                            .is_below = direction.required("is_below").boolean()});
  }
  return t;
}

std::uint64_t word(const JsonInput& input) {
  const std::string text = input.string();
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc() || end != text.data() + text.size())
    input.refuse("must be 1 to 16 hexadecimal digits");
  return value;
}

/// What a check without a place refuses is refused here.
template <class Check>
auto at(const JsonInput& input, const Check& check) {
  try {
    return check();
  } catch (const InvalidInput& error) {
    input.fail(error.what());
  }
}

PhotonCounts read_counts(const JsonInput& input) {
  const JsonObject object = input.object(
      {"run", "tallies", "layers", "specular", "random_specular", "length_unit", "photons",
       "batches", "events", "was_stopped", "first", "second", "volume_first", "volume_second"});
  constexpr std::int64_t most = std::int64_t{1} << 53;
  const auto whole = [&](const char* key) {
    return static_cast<std::uint64_t>(object.required(key).integer(0, most));
  };
  PhotonCounts counts;
  counts.run = object.required("run").string();
  counts.tallies = read_tallies(object.required("tallies"));
  counts.layers = static_cast<std::size_t>(object.required("layers").integer(1, 100'000));
  counts.specular = object.required("specular").number(closed_interval(0.0, 1.0));
  counts.has_random_specular = object.required("random_specular").boolean();
  counts.length_unit = object.required("length_unit").number(greater_than(0.0, "mm"));
  counts.photons = whole("photons");
  counts.batches = whole("batches");
  counts.events = word(object.required("events"));
  counts.was_stopped = object.required("was_stopped").boolean();
  const PhotonLayout layout =
      at(input, [&] { return make_photon_layout(counts.tallies, counts.layers); });
  counts.first = sums(object.required("first"), layout.cells);
  counts.second = sums(object.required("second"), layout.cells);
  counts.volume_first = sums(object.required("volume_first"), layout.volume_cells);
  counts.volume_second = sums(object.required("volume_second"), layout.volume_cells);
  at(input, [&] { check_counts(counts); });
  return counts;
}

/// Channels, wavelengths, or one without a name; the first of them, if a run was stopped.
void check_bands(const JsonInput& input, const std::vector<std::string>& bands) {
  constexpr std::array<std::string_view, 3> channels = {"R", "G", "B"};
  const bool are_channels =
      bands.size() <= 3 && std::equal(bands.begin(), bands.end(), channels.begin());
  if (are_channels || bands == std::vector<std::string>{""}) return;
  std::vector<double> wavelengths;
  for (const std::string& band : bands) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(band.data(), band.data() + band.size(), value);
    if (error != std::errc() || end != band.data() + band.size())
      input.fail("must be channels or wavelengths, but has \"" + band + "\"");
    wavelengths.push_back(value);
  }
  at(input, [&] { static_cast<void>(BandSet(wavelengths)); });
}

PhotonRun read_run(const JsonInput& input) {
  const JsonObject object =
      input.object({"name", "bands", "shards", "of", "bands_counts", "checksum"});
  PhotonRun run{.name = object.required("name").string(), .bands = {}, .counts = {}, .shards = {}};
  for (const JsonInput& band : object.required("bands").array(1))
    run.bands.push_back(band.string());
  check_bands(object.required("bands"), run.bands);
  run.of = static_cast<int>(object.required("of").integer(1, 1'000'000));
  for (const JsonInput& shard : object.required("shards").array(1))
    if (!run.shards.insert(static_cast<int>(shard.integer(0, run.of - 1))).second)
      shard.fail("must be named once, but is named twice");
  for (const JsonInput& counts :
       object.required("bands_counts").array(run.bands.size(), run.bands.size())) {
    run.counts.push_back(read_counts(counts));
    if (run.counts.back().tallies != run.counts[0].tallies ||
        run.counts.back().layers != run.counts[0].layers)
      counts.fail("must have the tallies and layers of the first band, but has others");
  }
  if (word(object.required("checksum")) != checksum(run_json(run)))
    object.required("checksum").fail("must be that of the run, but is not: the file was changed");
  return run;
}

}  // namespace

JsonOutput counts_json(const std::vector<PhotonRun>& runs) {
  JsonOutput list = JsonOutput::array();
  for (const PhotonRun& run : runs) {
    JsonOutput& json = list.emplace_back(run_json(run));
    json["checksum"] = fmt::format("{:016x}", checksum(json));
  }
  return list;
}

void save_photon_runs(const std::vector<PhotonRun>& runs, const std::string& file) {
  JsonOutput result = make_result("photons");
  result["counts"] = counts_json(runs);
  write_file(file, result.text(1) + "\n");
}

std::vector<PhotonRun> load_photon_runs(const std::filesystem::path& file, MemoryBudget memory) {
  const JsonDocument document = load_json(file, memory);
  const std::optional<JsonInput> list =
      document.root().is_object() ? document.root().peek("counts") : std::optional<JsonInput>();
  if (!list)
    document.root().fail("must hold \"counts\", as `lamina photons --counts --json` writes them");
  std::vector<PhotonRun> runs;
  for (const JsonInput& run : list->array(1)) {
    runs.push_back(read_run(run));
    if (runs.back().shards != runs[0].shards || runs.back().of != runs[0].of)
      run.fail("must be of the shards of the first run, but is of others");
  }
  return runs;
}

std::size_t cells_of(const PhotonTallies& tallies, std::size_t layers) {
  const PhotonLayout layout = make_photon_layout(tallies, layers);
  return checked_sum("tallies: all cells", {layout.cells, layout.volume_cells});
}

void require_readable(const PhotonsOptions& options, std::size_t cells) {
  if (options.checkpoint.empty() && !writes_counts(options)) return;
  const double bytes = 2.0 * digits * static_cast<double>(cells);
  if (bytes > 0.9 * static_cast<double>(json_max_bytes))
    throw InvalidInput(
        fmt::format("--checkpoint, --counts and --shard: a file of sums must have less than {} "
                    "MiB, but would have {:.0f}; take fewer bins",
                    json_max_bytes >> 20, bytes / (1 << 20)));
}

}  // namespace lamina::cli
