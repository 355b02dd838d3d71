// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <tuple>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/render/film/render_options.h"
#include "lamina/scene/description/subsurface_methods.h"

namespace lamina {

/// Inputs of the methods of a picture; all must outlive them.
template <int N>
struct MethodContext {
  const RenderScene& scene;
  const BandConversion<N>& conversion;
  const ProfileMaker& make_profile;
  bool is_printed_exit;  ///< RenderSettings::ExitAngle
};

/// Makes a method for the translucent materials of a scene that are in use, `make(material)` each.
template <int N, class Make>
[[nodiscard]] SubsurfaceMethods<N> make_for_each_material(const MethodContext<N>& context,
                                                          const Make& make) {
  const Scene& scene = *context.scene.scene;
  SubsurfaceMethods<N> methods(scene.materials.size());
  for (const std::uint32_t m : translucent_materials_in_use(scene)) methods[m] = make(m);
  return methods;
}

/// A row of the table of methods, and how it is made, whatever the number of bands.
struct SubsurfaceMethodMaker {
  SceneMethod method;
  template <int N>
  using Make = SubsurfaceMethods<N> (*)(const MethodContext<N>&);
  std::tuple<Make<4>, Make<8>, Make<16>> make;

  /// @param any_make  `[]<int N>(const MethodContext<N>&) { return SubsurfaceMethods<N>…; }`
  template <class AnyMake>
  SubsurfaceMethodMaker(SceneMethod of, AnyMake any_make)
      : method(of), make(any_make, any_make, any_make) {}
};

/// Makes what the scene's method is, all materials, with what goes with it: colors that scale what
/// leaves, and light scattered once. Empty entries for a method that is a BSDF.
///
/// @param options  may bring more methods
/// @throws InvalidInput if nobody knows how the method is made, if light scattered once would count
///         twice, and as the methods do.
template <int N>
[[nodiscard]] SubsurfaceMethods<N> make_subsurface_methods(const RenderScene& scene,
                                                           const BandConversion<N>& conversion,
                                                           const RenderOptions& options,
                                                           const Progress& progress);

/// Makers of all methods, in the order of subsurface_methods().
[[nodiscard]] std::span<const SubsurfaceMethodMaker> subsurface_method_makers();

}  // namespace lamina
