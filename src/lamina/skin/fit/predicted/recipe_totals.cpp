// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/recipe_totals.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "lamina/base/core/number_text.h"
#include "lamina/solve/reflectance/leaf_totals_table.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina::fit_detail {
namespace {

/// What tables are off at most, of totals; of smaller ones as of the least.
constexpr double table_error = 1e-3, least_total = 3e-3;

/// Members of a recipe and the free number that each is set to, [member].
template <class Parameters>
struct FreeMembers {
  std::vector<double Parameters::*> values;
  std::vector<std::size_t> free;

  [[nodiscard]] Parameters with(Parameters parameters, std::span<const double> numbers) const {
    for (std::size_t i = 0; i < values.size(); ++i) parameters.*values[i] = numbers[free[i]];
    return parameters;
  }
};

/// The members of a recipe that are free, by their paths; nothing if a path is another's, or its
/// range is not within that of tables.
template <class Parameters, class Range>
std::optional<FreeMembers<Parameters>> free_members(const Measurement& measurement,
                                                    std::string_view recipe,
                                                    std::span<const Range> all,
                                                    const Parameters& low, const Parameters& high) {
  FreeMembers<Parameters> members;
  for (std::size_t f = 0; f < measurement.free.size(); ++f) {
    const FreeNumber& free = measurement.free[f];
    for (const std::string& path : free.paths()) {
      const auto found = std::ranges::find_if(all, [&](const Range& range) {
        return path == std::string(recipe) + "." + std::string(range.name);
      });
      if (found == all.end() || found->is_length) return {};
      if (free.parameter.low < low.*found->value || free.parameter.high > high.*found->value)
        return {};
      members.values.push_back(found->value);
      members.free.push_back(f);
    }
  }
  return members;
}

bool is_same(const LayerStack& a, const LayerStack& b) {
  const auto same_layer = [](const Layer& x, const Layer& y) {
    return x.medium.sigma_a == y.medium.sigma_a && x.medium.sigma_s == y.medium.sigma_s &&
           x.medium.g == y.medium.g && x.medium.ior == y.medium.ior && x.thickness == y.thickness &&
           x.top == y.top;
  };
  return a.ior_above() == b.ior_above() && a.ior_below() == b.ior_below() &&
         a.ground().reflectance == b.ground().reflectance && a.ground().top == b.ground().top &&
         std::ranges::equal(a.layers(), b.layers(), same_layer);
}

/// The material where the fit starts, if it has nothing that its recipe does not say.
template <class Recipe>
bool is_recipe_alone(const Material& material, Recipe recipe) {
  const std::vector<LayerStack> stacks = layer_stacks(material);
  for (std::size_t band = 0; band < stacks.size(); ++band)
    if (!is_same(stacks[band], recipe(material.bands.wavelengths()[band]))) return false;
  return true;
}

Material at_start(const Measurement& measurement) {
  std::vector<std::vector<double>> values;
  for (const FreeNumber& free : measurement.free)
    values.push_back(free.starts(measurement.bands.size()));
  return material_with(measurement, values);
}

std::vector<double> wavelengths_of(const Measurement& measurement) {
  const std::span<const double> nm = measurement.bands.wavelengths();
  return {nm.begin(), nm.end()};
}

using RecipeValues = RecipeTotals::Totals;

RecipeValues look_up(const SkinReflectanceTable& table, const SkinParameters& skin,
                     std::size_t band, std::span<double SkinParameters::*const> members,
                     std::span<RecipeValues> by) {
  std::vector<double> derivatives(by.size());
  const double value = table.reflectance_at(band, skin, members.first(by.size()), derivatives);
  for (std::size_t i = 0; i < by.size(); ++i) by[i] = {derivatives[i], 0.0};
  return {value, 0.0};
}

RecipeValues look_up(const LeafTotalsTable& table, const LeafParameters& leaf, std::size_t band,
                     std::span<double LeafParameters::*const> members, std::span<RecipeValues> by) {
  std::vector<LeafTotalsTable::Totals> derivatives(by.size());
  const auto totals = table.totals(leaf, band, members.first(by.size()), derivatives);
  for (std::size_t i = 0; i < by.size(); ++i)
    by[i] = {derivatives[i].reflectance, derivatives[i].transmittance};
  return {totals.reflectance, totals.transmittance};
}

std::optional<FreeMembers<SkinParameters>> members_of(const Measurement& measurement,
                                                      const SkinParameters& skin) {
  const SkinRange range = skin_fit_range(skin);
  return free_members(measurement, "skin", skin_parameter_ranges(), range.low, range.high);
}

std::optional<FreeMembers<LeafParameters>> members_of(const Measurement& measurement,
                                                      const LeafParameters& leaf) {
  const LeafRange range = leaf_fit_range(leaf);
  return free_members(measurement, "leaf", leaf_parameter_ranges(), range.low, range.high);
}

template <class Parameters, class Table>
class TableTotals final : public RecipeTotals {
 public:
  TableTotals(Parameters fixed, FreeMembers<Parameters> members, Table table)
      : fixed_(std::move(fixed)), members_(std::move(members)), table_(std::move(table)) {}

  Totals at(std::span<const double> numbers, std::size_t band,
            std::span<Totals> derivatives) const override {
    std::vector<Totals> by(derivatives.empty() ? 0 : members_.values.size());
    const Totals totals =
        look_up(table_, members_.with(fixed_, numbers), band, members_.values, by);
    std::ranges::fill(derivatives, Totals{});
    for (std::size_t i = 0; i < by.size(); ++i) {
      derivatives[members_.free[i]].reflectance += by[i].reflectance;
      derivatives[members_.free[i]].transmittance += by[i].transmittance;
    }
    return totals;
  }
  double specular_reflectance() const override { return table_.specular_reflectance(); }

 private:
  Parameters fixed_;
  FreeMembers<Parameters> members_;
  Table table_;
};

}  // namespace

bool has_recipe_totals(const Measurement& measurement, const MeasuredSeries& series) {
  if (series.kind != MeasurementKind::totals || measurement.bands.is_rgb()) return false;
  const std::string_view path = measurement.free[0].parameter.name;
  if (!path.starts_with("skin.") && !path.starts_with("leaf.")) return false;
  if (std::ranges::any_of(measurement.free, &FreeNumber::is_per_band)) return false;
  const Material material = at_start(measurement);
  const bool is_skin = material.skin.has_value();
  for (const MeasuredPoint& point : series.points) {
    const bool is_reflected = point.quantity == MeasuredQuantity::reflectance;
    if (point.sphere ||
        (!is_reflected && (is_skin || point.quantity != MeasuredQuantity::transmittance)))
      return false;
    const double error = table_error * std::max(point.value, least_total);
    if (error > 0.5 * point.standard_deviation) return false;
  }
  if (is_skin) {
    const SkinParameters& skin = material.skin->skin;
    return members_of(measurement, skin) && !std::isfinite(skin.dermis_thickness) &&
           is_recipe_alone(material, [&](double nm) { return skin_layer_stack(skin, nm); });
  }
  return material.leaf && members_of(measurement, *material.leaf) &&
         is_recipe_alone(material, [&](double nm) { return leaf_layer_stack(*material.leaf, nm); });
}

std::shared_ptr<const RecipeTotals> make_recipe_totals(const Measurement& measurement,
                                                       const MeasuredSeries& series,
                                                       const Progress& progress) {
  const Material material = at_start(measurement);
  const std::vector<double> nm = wavelengths_of(measurement);
  if (material.skin) {
    const SkinParameters& skin = material.skin->skin;
    return std::make_shared<TableTotals<SkinParameters, SkinReflectanceTable>>(
        skin, *members_of(measurement, skin),
        SkinReflectanceTable(nm, series.incidence, skin_fit_range(skin), progress));
  }
  const LeafParameters& leaf = *material.leaf;
  return std::make_shared<TableTotals<LeafParameters, LeafTotalsTable>>(
      leaf, *members_of(measurement, leaf),
      LeafTotalsTable(nm, series.incidence, leaf_fit_range(leaf), progress));
}

std::string recipe_totals_key(const Measurement& measurement, const MeasuredSeries& series) {
  std::string key = series.incidence.is_diffuse ? "diffuse" : number_text(series.incidence.theta);
  for (const double nm : measurement.bands.wavelengths()) key += " " + number_text(nm);
  for (const FreeNumber& free : measurement.free)
    for (const std::string& path : free.paths()) key += "\n" + path;
  return key + "\n" + measurement.material.name + "\n" + measurement.material.text;
}

}  // namespace lamina::fit_detail
