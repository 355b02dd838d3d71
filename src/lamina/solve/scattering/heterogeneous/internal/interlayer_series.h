// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

namespace lamina::detail {

/// The operators of a layer in their order: R+, T+, R-, T-.
enum LayerOperator : std::size_t {
  reflection_above,
  transmission_down,
  reflection_below,
  transmission_up
};

/// Layers whose absorption varies over a surface, and light on them: what the series below needs.
/// Planes of texels and graphs of cells are two such fields.
///
/// - `blur(layer, operator, light)`: what an operator makes of light; with two operators, which
///   share their blurs, what both make of it.
/// - `multiply(light, junction)`: by what crossing a junction leaves.
/// - `add(sum, light)`: an empty sum becomes the light.
/// - `close(down)`: light that goes down at each junction becomes that of all further bounces, as
///   if the surroundings of each point were like it.
template <class F>
concept LayeredField = requires(const F& field, typename F::Light& light,
                                std::vector<typename F::Light>& all, std::size_t i,
                                LayerOperator which) {
  { field.junctions() } -> std::convertible_to<std::size_t>;
  { field.blur(i, which, light) } -> std::same_as<typename F::Light>;
  { field.blur(i, which, which, light) } -> std::same_as<std::array<typename F::Light, 2>>;
  field.multiply(light, i);
  field.add(light, std::move(light));
  field.close(all);
};

/// A field whose last layer may let light through.
///
/// - `turn_round(up, arriving)`: adds to the light on the last layer what the light that goes up
///   at each junction brings there when it turns round, as if all points were alike.
template <class F>
concept TransmittingField = LayeredField<F> &&
    requires(const F& field, std::vector<typename F::Light>& up, typename F::Light& arriving) {
  { field.has_bottom() } -> std::same_as<bool>;
  field.turn_round(up, arriving);
};

template <class Light>
struct InterlayerLight {
  Light reflected;
  Light transmitted;  ///< empty where nothing comes through
};

/// The series of heterogeneous_transport.h.
///
/// @param is_last  asked at each bounce, with the light that goes down through the first junction:
///                 whether the series ends with it.
template <LayeredField F, class IsLast>
[[nodiscard]] InterlayerLight<typename F::Light> sum_interlayer_bounces(
    const F& field, const typename F::Light& irradiance, bool has_local_closure,
    const IsLast& is_last) {
  using Light = typename F::Light;
  const std::size_t n = field.junctions();
  bool has_bottom = false;
  if constexpr (TransmittingField<F>) has_bottom = field.has_bottom();
  if (n == 0)
    return {field.blur(0, reflection_above, irradiance),
            has_bottom ? field.blur(0, transmission_down, irradiance) : Light()};
  std::vector<Light> up(n), down(n);
  auto [reflected, entered] = field.blur(0, reflection_above, transmission_down, irradiance);
  down[0] = std::move(entered);
  Light all_up;    // through the uppermost junction
  Light arriving;  // on the last layer, where it lets some through
  for (bool ends = false; !ends;) {
    // Down: what has turned round, and what passes on from above.
    for (std::size_t j = 0; j < n; ++j) {
      if (j > 0) field.add(down[j], field.blur(j, transmission_down, down[j - 1]));
      field.multiply(down[j], j);
    }
    ends = is_last(down[0]);
    if (has_bottom) field.add(arriving, Light(down[n - 1]));
    const bool closes = ends && has_local_closure;
    if (closes) field.close(down);
    // Up again; of what comes up, a part turns round once more.
    for (std::size_t j = n; j-- > 0;) {
      up[j] = field.blur(j + 1, reflection_above, down[j]);
      if (j + 1 < n) {
        auto [back, on] = field.blur(j + 1, reflection_below, transmission_up, up[j + 1]);
        down[j + 1] = std::move(back);
        field.add(up[j], std::move(on));
      }
      field.multiply(up[j], j);
    }
    if constexpr (TransmittingField<F>)
      if (closes && has_bottom) field.turn_round(up, arriving);
    if (!ends) down[0] = field.blur(0, reflection_below, up[0]);
    field.add(all_up, std::move(up[0]));
  }
  field.add(reflected, field.blur(0, transmission_up, all_up));
  return {std::move(reflected), has_bottom ? field.blur(n, transmission_down, arriving) : Light()};
}

}  // namespace lamina::detail
