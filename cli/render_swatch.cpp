// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "render_swatch.h"

#include "console.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/tone.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/swatch_scene.h"

namespace lamina::cli {

void save_swatch(const Material& material, const std::string& file) {
  constexpr int side = 256;
  require_writable(file);
  const Scene scene = load_scene(JsonFile("swatch", swatch_scene(material, side).text(1)));
  const RenderResult result =
      render(scene, {}, make_progress("swatch of " + material.name, Keeps::nothing));
  if (!result.statistics.is_complete) throw Interrupted();
  save_png(view_image(rgb_image(result.image), scene.film.view,
                      static_cast<double>(scene.film.exposure)),
           file);
}

}  // namespace lamina::cli
