// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "lamina/base/core/error.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/layers/materials/builtin_texts.h"
#include "lamina/layers/materials/internal/jensen2001.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina {
namespace {

const std::vector<Material>& tabulated_materials() {
  static const std::vector<Material> materials = jensen2001_materials();
  return materials;
}

Material parse_builtin(const BuiltinText& builtin) {
  return parse_material(std::string(builtin.text), std::string(builtin.name));
}

/// Without parsing the others: the spheres of a powder take a few milliseconds.
std::optional<Material> find_builtin(const std::string& name) {
  for (const BuiltinText& builtin : builtin_texts())
    if (builtin.name == name) return parse_builtin(builtin);
  const auto found = std::ranges::find(tabulated_materials(), name, &Material::name);
  if (found != tabulated_materials().end()) return *found;
  return std::nullopt;
}

std::string nearest_builtin(const std::string& name) {
  return did_you_mean(name, builtin_material_names());
}

}  // namespace

const std::vector<std::string_view>& builtin_material_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const BuiltinText& builtin : builtin_texts()) all.push_back(builtin.name);
    for (const Material& material : tabulated_materials()) all.push_back(material.name);
    return all;
  }();
  return names;
}

const std::vector<Material>& builtin_materials() {
  static const std::vector<Material> materials = [] {
    std::vector<Material> all;
    for (const BuiltinText& builtin : builtin_texts()) all.push_back(parse_builtin(builtin));
    std::ranges::copy(tabulated_materials(), std::back_inserter(all));
    return all;
  }();
  return materials;
}

std::string builtin_material_text(const std::string& name) {
  for (const BuiltinText& builtin : builtin_texts())
    if (builtin.name == name) return std::string(builtin.text);
  if (const auto material = find_builtin(name)) return format_material(*material);
  throw InvalidInput("there is no built-in material \"" + name + "\"" + nearest_builtin(name));
}

Material find_material(const std::string& name_or_path, MemoryBudget memory) {
  return find_sampled_material(name_or_path, {}, memory);
}

Material find_sampled_material(const std::string& name_or_path, std::span<const double> wavelengths,
                               MemoryBudget memory, std::span<const std::string> settings) {
  if (const auto material = find_builtin(name_or_path)) {
    if (wavelengths.empty() && settings.empty()) return *material;
    const JsonDocument document =
        parse_json(builtin_material_text(name_or_path), name_or_path, memory, settings);
    return decode_material(document.root(), {}, wavelengths);
  }
  std::error_code ignored;
  const bool looks_like_a_file =
      name_or_path == "-" || name_or_path.find_first_of("./\\") != std::string::npos;
  if (looks_like_a_file || std::filesystem::exists(name_or_path, ignored))
    return decode_material(load_json(name_or_path, memory, settings).root(), {}, wavelengths);
  throw InvalidInput("there is no built-in material and no file \"" + name_or_path + "\"" +
                     nearest_builtin(name_or_path));
}

}  // namespace lamina
