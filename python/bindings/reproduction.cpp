// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "reproduction.h"

#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "choices.h"
#include "json_files.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/plot/plot.h"
#include "lamina/reproduction/item.h"
#include "lamina/reproduction/page.h"
#include "lamina/reproduction/run_item.h"

namespace lamina::python {
namespace {

std::vector<ReproductionItem> builtin_items(ReproductionQuality quality) {
  std::vector<ReproductionItem> items;
  for (const BuiltinReproduction& each : builtin_reproductions())
    items.push_back(decode_reproduction(parse_json(each.text, each.name).root(), quality));
  return items;
}

py::list list_items() {
  py::list list;
  for (const ReproductionItem& item : builtin_items(ReproductionQuality::draft))
    list.append(py::make_tuple(item.id, item.paper, item.title, item.shows));
  return list;
}

/// One that comes with lamina, or that of a file.
ReproductionItem find_item(const std::string& id, const std::optional<std::string>& path,
                           const std::optional<std::string>& text, ReproductionQuality quality) {
  if (path)
    return load_unlocked(json_file(*path, text), [&](const JsonFile& file) {
      MemoryBudget memory;
      return decode_reproduction(load_json(file, memory).root(), quality);
    });
  for (ReproductionItem& item : builtin_items(quality))
    if (item.id == id) return item;
  throw InvalidInput("there is no item \"" + id + "\"");
}

py::dict result_dict(const ReproductionResult& result, ReproductionQuality quality) {
  const ReproductionItem& item = result.item;
  py::dict out;
  out["id"] = item.id;
  out["paper"] = item.paper;
  out["title"] = item.title;
  out["shows"] = item.shows;
  out["verdict"] = std::string(name_of(result.verdict));
  out["seconds"] = result.seconds;
  py::list numbers, features, pictures;
  for (std::size_t i = 0; i < result.numbers.size(); ++i) {
    const NumberCheck& check = item.numbers[i];
    numbers.append(py::make_tuple(check.text, result.numbers[i].value, check.expected,
                                  check.tolerance, check.from, result.numbers[i].holds));
  }
  for (std::size_t i = 0; i < result.features.size(); ++i)
    features.append(py::make_tuple(item.features[i].text, result.features[i].measure,
                                   result.features[i].holds));
  for (const ReproductionPicture& picture : item.pictures)
    pictures.append(py::make_tuple((result.folder / picture.file).string(), picture.caption));
  out["numbers"] = numbers;
  out["features"] = features;
  out["pictures"] = pictures;
  out["columns"] = item.table.columns;
  out["cells"] = result.cells;
  out["svg"] = result.plot.panels.empty() ? std::string() : format_svg(result.plot);
  out["html"] = format_page(std::array{result}, quality);
  return out;
}

/// @param run  called as run(arguments, folder); returns the command's JSON
py::dict reproduce(const std::string& id, const std::optional<std::string>& path,
                   const std::optional<std::string>& text, const std::string& quality_name,
                   const std::string& folder, const std::string& sources, const py::function& run) {
  const auto quality = choice<ReproductionQuality>(quality_name);
  const ReproductionItem item = find_item(id, path, text, quality);
  // What takes time is the commands, which Python waits for; it keeps its lock for the rest.
  return result_dict(make_reproduction(item, folder, sources,
                                       [&](const std::vector<std::string>& arguments,
                                           const std::filesystem::path& in) {
                                         return run(arguments, in.string()).cast<std::string>();
                                       }),
                     quality);
}

}  // namespace

void bind_reproduction(py::module_& module) {
  module.def("reproduction_items", &list_items);
  module.def("reproduce", &reproduce);
}

}  // namespace lamina::python
