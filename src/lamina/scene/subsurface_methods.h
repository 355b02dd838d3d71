// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// The methods of subsurface transport as scenes, commands and pages speak of them: one table. Their
// code lies in render/subsurface; render/subsurface/methods says how each is made.

namespace lamina {

struct RenderSettings;

/// A number in the object of "render" that is named after a method.
struct MethodNumber {
  std::string_view key;
  double low, high;
  bool is_whole;
  double (*get)(const RenderSettings&);
  void (*set)(RenderSettings&, double);
  std::string_view unit = {};
  /// Whether light that is kept for other cameras follows from it; null: it does.
  bool (*shapes_kept_light)(const RenderSettings&) = nullptr;
};

/// A method of subsurface transport as users know it: a row of the table.
struct SubsurfaceMethodInfo {
  std::string_view name;
  // For people, a phrase each; a page of docs/ may say more.
  std::string_view how, noise, error, needs = "–", page = {};
  bool uses_profile = false;     ///< RenderSettings::profile is where its light comes from
  bool solves_transfer = false;  ///< all its light is that of radiative transfer
  bool is_bsdf = false;          ///< light leaves where it entered
  bool keeps_light = false;      ///< for other cameras, in RenderOptions::cache
  /// Of the keys that not all methods honour (method_settings.h) those that it does.
  std::array<std::string_view, 12> honours = {};
  std::span<const MethodNumber> numbers = {};

  [[nodiscard]] constexpr bool honours_key(std::string_view key) const {
    return std::ranges::find(honours, key) != honours.end();
  }
};

/// The method that a scene asks for, or that it leaves open.
class SceneMethod {
 public:
  constexpr SceneMethod() = default;  ///< "auto": chosen by what the scene needs and what it costs
  /// @param info  must outlive all scenes
  constexpr explicit SceneMethod(const SubsurfaceMethodInfo& info) : info_(&info) {}

  [[nodiscard]] constexpr bool is_open() const { return !info_; }
  /// Not of one that is left open.
  [[nodiscard]] constexpr const SubsurfaceMethodInfo& operator*() const { return *info_; }
  [[nodiscard]] constexpr const SubsurfaceMethodInfo* operator->() const { return info_; }
  [[nodiscard]] constexpr std::string_view name() const { return info_ ? info_->name : "auto"; }
  friend constexpr bool operator==(SceneMethod, SceneMethod) = default;

  // Those that lamina brings.
  static const SceneMethod automatic, probe, layered_bsdf, hierarchy, shadow_map, texture_space,
      random_walk;

 private:
  const SubsurfaceMethodInfo* info_ = nullptr;
};

/// The methods that lamina brings and some more, in the order in which users read of them.
[[nodiscard]] std::vector<SceneMethod> subsurface_methods(
    std::span<const SubsurfaceMethodInfo> more = {});

/// The names that files and commands know: "auto", then those of the methods.
[[nodiscard]] std::vector<std::string_view> method_names(const std::vector<SceneMethod>& methods);

/// The method of a name; absent if there is none.
[[nodiscard]] std::optional<SceneMethod> find_method(std::string_view name,
                                                     const std::vector<SceneMethod>& methods);

/// Whether any of a method's numbers is not the default.
[[nodiscard]] bool has_numbers_of(const RenderSettings& settings, SceneMethod method);

/// What the methods are, for the help of a command: "NAME HOW; NAME HOW".
[[nodiscard]] std::string describe_methods(const std::vector<SceneMethod>& methods);

/// The same as a table in Markdown, as docs/subsurface.md has it.
[[nodiscard]] std::string methods_table(const std::vector<SceneMethod>& methods);

/// The keys of "render" that are about methods, as the properties of a JSON schema: "method" and an
/// object for each method that has numbers.
[[nodiscard]] std::string methods_schema(const std::vector<SceneMethod>& methods);

}  // namespace lamina
