// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "reproduce_finished.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/json_output.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// A number of the content of a file, or of all files of a folder with their names; 0 if it is not
/// there.
std::uint64_t content_of(const fs::path& place) {
  std::error_code error;
  if (!fs::exists(place, error)) return 0;
  std::vector<fs::path> files;
  if (fs::is_directory(place, error))
    for (const fs::directory_entry& each : fs::recursive_directory_iterator(place)) {
      if (each.is_regular_file()) files.push_back(each.path());
    }
  else if (fs::is_regular_file(place, error))
    files.push_back(place);
  std::ranges::sort(files);
  Hash hash;
  for (const fs::path& file : files) {
    hash.add_text(file.lexically_relative(place).string());
    hash.add_text(read_file_bytes(file));
  }
  return hash.value();
}

/// Inputs of a result: the program, the item's own files and commands, and what it needs of
/// lamina's sources.
std::string made_by(const ReproductionItem& item, const fs::path& sources) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  JsonOutput json = {{"lamina", LAMINA_VERSION},
                     {"program",
                      {{"bytes", static_cast<std::uint64_t>(fs::file_size(program, error))},
                       {"time", fs::last_write_time(program, error).time_since_epoch().count()}}},
                     {"sources", sources.string()}};
  json["needs"] = JsonOutput::object();
  for (const std::string& need : item.needs) json["needs"][need] = content_of(sources / need);
  json["files"] = JsonOutput::array();
  for (const ReproductionFile& file : item.files)
    json["files"].push_back({{"name", file.name}, {"text", file.text}});
  json["commands"] = JsonOutput::array();
  for (const ReproductionRun& run : item.runs) json["commands"].emplace_back(run.arguments);
  return json.text();
}

}  // namespace

FinishedRuns::FinishedRuns(const ReproductionItem& item, const fs::path& folder,
                           const fs::path& sources, bool resumes)
    : file_(folder / "finished.json"), made_by_(made_by(item, sources)) {
  std::error_code error;
  if (resumes && fs::exists(file_, error)) {
    const JsonDocument document = load_json(file_.string());
    const JsonObject root = document.root().object({"made_by", "runs"});
    if (root.required("made_by").string() == made_by_)
      for (const JsonInput& each : root.required("runs").array()) {
        const JsonObject run = each.object({"result", "seconds"});
        finished_.push_back({.result = run.required("result").string(),
                             .seconds = run.required("seconds").number(at_least(0.0, "s"))});
      }
  }
  if (finished_.empty()) fs::remove(file_, error);
}

std::optional<std::string> FinishedRuns::next() {
  if (next_ == finished_.size()) return std::nullopt;
  reused_seconds_ += finished_[next_].seconds;
  return finished_[next_++].result;
}

void FinishedRuns::add(const std::string& result, double seconds) {
  finished_.push_back({.result = result, .seconds = seconds});
  next_ = finished_.size();
  JsonOutput json = {{"made_by", made_by_}};
  json["runs"] = JsonOutput::array();
  for (const Finished& run : finished_)
    json["runs"].push_back({{"result", run.result}, {"seconds", run.seconds}});
  write_file(file_.string(), json.text() + "\n");
}

}  // namespace lamina::cli
