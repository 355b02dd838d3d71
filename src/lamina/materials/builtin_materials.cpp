// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lamina/core/error.h"
#include "lamina/io/nearest_name.h"
#include "lamina/materials/builtin_texts.h"
#include "lamina/materials/internal/jensen2001.h"
#include "lamina/materials/material.h"

namespace lamina {
namespace {

const Material* find_builtin(const std::string& name) {
  const auto& all = builtin_materials();
  const auto found = std::ranges::find(all, name, &Material::name);
  return found == all.end() ? nullptr : &*found;
}

std::string nearest_builtin(const std::string& name) {
  std::vector<std::string_view> names;
  for (const Material& material : builtin_materials()) names.push_back(material.name);
  return did_you_mean(name, names);
}

}  // namespace

const std::vector<Material>& builtin_materials() {
  static const std::vector<Material> materials = [] {
    std::vector<Material> all;
    for (const BuiltinText& builtin : builtin_texts())
      all.push_back(parse_material(std::string(builtin.text), std::string(builtin.name)));
    std::ranges::move(jensen2001_materials(), std::back_inserter(all));
    return all;
  }();
  return materials;
}

std::string builtin_material_text(const std::string& name) {
  for (const BuiltinText& builtin : builtin_texts())
    if (builtin.name == name) return std::string(builtin.text);
  if (const Material* material = find_builtin(name)) return format_material(*material);
  throw InvalidInput("there is no built-in material \"" + name + "\"" + nearest_builtin(name));
}

Material find_material(const std::string& name_or_path, MemoryBudget memory) {
  if (const Material* material = find_builtin(name_or_path)) return *material;
  std::error_code ignored;
  const bool looks_like_a_file = name_or_path == "-" || name_or_path.find_first_of("./\\") != std::string::npos;
  if (looks_like_a_file || std::filesystem::exists(name_or_path, ignored))
    return load_material(name_or_path, memory);
  throw InvalidInput("there is no built-in material and no file \"" + name_or_path + "\"" +
                     nearest_builtin(name_or_path));
}

}  // namespace lamina
