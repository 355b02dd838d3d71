// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "lamina/scene/description/internal/scene_file.h"
#include "lamina/solve/scattering/diffusion/albedo_inversion.h"

namespace lamina::scene_file {

Material decode_color_material(const JsonInput& value) {
  const JsonObject object =
      value.object({"diffuse_color", "diffuse_mean_free_path", "length_unit", "g", "ior"});
  const auto color = object.required("diffuse_color")
                         .number_or_numbers(3, {.low = 0.0, .high = 0.999, .includes_low = false});
  const double mm = object.required("length_unit")
                        .choice<double>({{"mm", 1.0}, {"cm", 10.0}, {"um", 1e-3}, {"m", 1e3}});
  const auto mean_free_path =
      object.required("diffuse_mean_free_path").number_or_numbers(3, {.low = 1e-6, .high = 1e6});
  const auto g = object.optional("g");
  const auto ior = object.optional("ior");
  const double cosine = g ? g->number(closed_interval(-0.99, 0.99)) : 0.0;
  const double index = ior ? ior->number(closed_interval(1.0, 4.0)) : 1.4;
  Material material;
  material.name = "diffuse color";
  material.is_by_diffusion = true;
  material.layers.resize(1);
  MaterialLayer& layer = material.layers[0];
  layer.name = "inside";
  for (std::size_t band = 0; band < 3; ++band) {
    const Medium medium = medium_from_look(
        {.reflectance = color[band], .diffuse_mfp = mm * mean_free_path[band]}, cosine, index, 1.0);
    layer.sigma_a.push_back(medium.sigma_a);
    layer.sigma_s.push_back(medium.sigma_s);
    layer.g.push_back(cosine);
    layer.ior.push_back(index);
    material.ior_above.push_back(1.0);
    material.ior_below.push_back(index);
  }
  return material;
}

}  // namespace lamina::scene_file
