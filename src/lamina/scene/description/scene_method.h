// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

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
  bool is_of_papers = false;     ///< kept to compare with, others do better: out of the daily help
  /// Keys that this method honours, of those that not all methods do (method_settings.h).
  std::array<std::string_view, 13> honours = {};
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

}  // namespace lamina
