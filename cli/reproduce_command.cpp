// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/io/write_places.h"
#include "lamina/reproduction/page.h"
#include "reproduce_finished.h"
#include "reproduce_run.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions {
  CommonOptions common;
  std::vector<std::string> items;
  std::string output = "reproduction", sources, before, shard;
  ReproductionQuality quality = ReproductionQuality::draft;
  bool only_lists = false, only_checks = false, resumes = false;
};

/// The folder of lamina's sources, above the program or the current one; empty if there is none.
fs::path find_sources() {
  std::error_code error;
  for (fs::path start : {fs::read_symlink("/proc/self/exe", error), fs::current_path(error)})
    for (; start != start.parent_path(); start = start.parent_path())
      if (fs::exists(start / "reproduce", error) && fs::exists(start / "scenes", error))
        return start;
  return {};
}

bool is_in(const std::vector<ReproductionItem>& items, const std::string& id) {
  return std::ranges::find(items, id, &ReproductionItem::id) != items.end();
}

/// The part of them that a shard makes: each N-th, as those of one paper take alike.
std::vector<ReproductionItem> items_of(const Shard& shard, std::vector<ReproductionItem> items) {
  std::vector<ReproductionItem> part;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (static_cast<int>(i % static_cast<std::size_t>(shard.count)) == shard.index)
      part.push_back(std::move(items[i]));
  return part;
}

/// The items that are asked for, each once: all, those of papers, single ones, or those of files.
std::vector<ReproductionItem> find_items(const ReproduceOptions& options) {
  std::vector<ReproductionItem> known, found;
  for (const BuiltinReproduction& item : builtin_reproductions())
    known.push_back(decode_reproduction(parse_json(item.text, item.name).root(), options.quality));
  if (options.items.empty()) return known;
  for (const std::string& name : options.items) {
    const auto is_meant = [&](const ReproductionItem& item) {
      return item.id == name || item.paper == name;
    };
    if (name.ends_with(".json")) {
      ReproductionItem item = decode_reproduction(load_json(name).root(), options.quality);
      if (is_in(found, item.id))
        throw InvalidInput(fmt::format("{}: an item \"{}\" was already named", name, item.id));
      found.push_back(std::move(item));
      continue;
    }
    if (std::ranges::none_of(known, is_meant)) {
      std::vector<std::string_view> names;
      for (const ReproductionItem& item : known) names.insert(names.end(), {item.id, item.paper});
      throw InvalidInput(
          fmt::format("there is no item or paper \"{}\"{}; see lamina reproduce --list", name,
                      did_you_mean(name, names)));
    }
    for (const ReproductionItem& item : known)
      if (is_meant(item) && !is_in(found, item.id)) found.push_back(item);
  }
  return found;
}

void list_items(const std::vector<ReproductionItem>& items, const CommonOptions& options) {
  std::string text, paper;
  JsonOutput json = make_result("reproduce");
  json["items"] = JsonOutput::array();
  for (const ReproductionItem& item : items) {
    if (item.paper != paper) text += fmt::format("{}{}\n", text.empty() ? "" : "\n", item.paper);
    paper = item.paper;
    text += fmt::format("  {:<18} {}\n", item.id, item.title);
    json["items"].push_back({{"id", item.id}, {"paper", item.paper}, {"title", item.title}});
  }
  write_json(json, options);
  print(options, text);
}

/// Makes an item by running this program, but for commands that an earlier call has finished.
ReproductionResult make_item(const ReproductionItem& item, const fs::path& folder,
                             const fs::path& sources, const ReproduceOptions& options,
                             const Progress& progress) {
  FinishedRuns finished(item, folder, sources, options.resumes || !options.shard.empty());
  const RunLamina run = [&](std::vector<std::string> arguments, const fs::path& in) {
    if (std::optional<std::string> result = finished.next()) return *result;
    if (options.common.threads > 0)
      arguments.insert(arguments.end(), {"--threads", std::to_string(options.common.threads)});
    const auto started = std::chrono::steady_clock::now();
    std::string result = run_this_program(arguments, in, progress);
    finished.add(result,
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
    return result;
  };
  ReproductionResult result = make_reproduction(item, folder, sources, run);
  result.seconds += finished.reused_seconds();
  return result;
}

void run_reproduce(const ReproduceOptions& options) {
  std::vector<ReproductionItem> items = find_items(options);
  if (options.only_checks) {
    JsonOutput json = make_result("reproduce");
    json["items"] = items.size();
    json["output"] = options.output;
    write_json(json, options.common);
    return print(options.common, fmt::format("{} items\n", items.size()));
  }
  const bool is_part = !options.shard.empty();
  if (is_part) items = items_of(read_shard(options.shard), std::move(items));
  if (options.only_lists) return list_items(items, options.common);
  const fs::path out = fs::absolute(options.output);
  const fs::path sources = options.sources.empty() ? find_sources() : fs::absolute(options.sources);
  make_folder(out);
  std::vector<ReproductionResult> results;
  bool has_failed = false;
  const Progress progress = make_progress("reproduce");
  for (const ReproductionItem& item : items) {
    const double finished = static_cast<double>(results.size()) / static_cast<double>(items.size());
    if (!report_progress(progress, finished)) break;
    try {
      if (!is_inside(out / item.id, out))  // a link that was there
        throw WriteError((out / item.id).string() + ": must be inside of " + out.string());
      results.push_back(make_item(item, out / item.id, sources, options,
                                  [&](double) { return report_progress(progress, finished); }));
    } catch (const Interrupted&) {
      break;
    } catch (const WriteError&) {
      throw;
    } catch (const Error& refusal) {
      has_failed = true;
      results.push_back({.item = item, .why_not_made = refusal.what()});
    }
    const ReproductionResult& result = results.back();
    say(fmt::format("{:<18} {} ({:.1f} s){}", item.id, name_of(result.verdict), result.seconds,
                    result.why_not_made.empty() ? "" : ": " + result.why_not_made));
  }
  if (results.size() < items.size() && (is_part || results.empty())) throw Interrupted();
  if (is_part) {
    JsonOutput json = make_result("reproduce");
    json["items"] = results.size();
    write_json(json, options.common);
    if (has_failed) throw ReproductionFailed("not all items could be made");
    return;
  }
  write_file((out / "index.html").string(), format_page(results, options.quality));
  const JsonOutput summary = reproduction_json(results, options.quality);
  write_file((out / "summary.json").string(), summary.text(1) + "\n");
  JsonOutput json = make_result("reproduce");
  json["summary"] = summary;
  write_json(json, options.common);
  print(options.common, fmt::format("{}\n", (out / "index.html").string()));
  if (!options.before.empty()) {
    const auto worse = worse_verdicts(results, load_json(options.before).root());
    for (const std::string& line : worse) say(line);
    if (!worse.empty())
      throw ReproductionFailed(
          fmt::format("{} verdicts are worse than in {}", worse.size(), options.before));
  }
  if (has_failed) throw ReproductionFailed("not all items could be made");
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
  auto options = std::make_shared<ReproduceOptions>();
  const Command command(app, "reproduce",
                        "Tables and figures of the five papers, made again, each with a verdict.");
  command
      .add_option("items", options->items, "papers, items, or files of items; all if none is named")
      .type_name("ITEM");
  command.add_flag("--list", options->only_lists, "the papers and items that there are");
  command.add_choice("--quality", options->quality,
                     "draft: minutes for all; full: the photons and samples of a publication");
  command.add_option("-o,--output", options->output, "a folder for the page and what it shows")
      .type_name("DIR")
      .show_default();
  command.add_flag(
      "--resume", options->resumes,
      "go on after an interrupted call: commands that have finished in DIR are not run "
      "again, if program, item and what it needs are the same");
  command
      .add_option(
          "--shard", options->shard,
          "makes part I of N of the items, and no page: the same call with --resume in place "
          "of it makes that of all. What has finished in DIR is not run again")
      .type_name("I/N");
  command.add_flag("--check", options->only_checks, "says how many items would be made");
  command
      .add_option("--sources", options->sources,
                  "the folder with lamina's scenes/ and demo/, if it is not found")
      .type_name("DIR");
  command
      .add_option("--before", options->before,
                  "summary.json of an earlier run: exit code 1 if a verdict is worse")
      .type_name("FILE");
  add_common_options(command, options->common);
  command.footer(
      "DIR/index.html shows all; DIR/ITEM/ has numbers.csv, pictures and what each command wrote.\n"
      "Exit code 1: an item could not be made, or --before found a worse verdict.\n\n"
      "Example: the tables of Donner & Jensen 2005, and one figure of another paper\n"
      "  lamina reproduce donner_jensen_2005 hk93.fig8 -o papers");
  command.callback([options, command] {
    if (!options->shard.empty() && command.is_given("--before"))
      throw InvalidInput("--before: is compared with all items, and --shard makes some");
    run_reproduce(*options);
  });
}

}  // namespace lamina::cli
