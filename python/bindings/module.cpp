// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// lamina._lamina: the library for the modules in Python beside it, which check what users give,
// and say what things are. Nothing here is for users.
#include <pybind11/pybind11.h>

#include "acquire.h"
#include "bsdf.h"
#include "edit.h"
#include "errors.h"
#include "exchange.h"
#include "fit.h"
#include "half_spaces.h"
#include "images.h"
#include "lamina/base/io/reading_warnings.h"
#include "layer_stacks.h"
#include "map_photons.h"
#include "material.h"
#include "media.h"
#include "optics.h"
#include "patch.h"
#include "photons.h"
#include "profile.h"
#include "recipes.h"
#include "render.h"
#include "reproduction.h"
#include "session.h"
#include "slab.h"
#include "surfaces.h"
#include "work.h"

PYBIND11_MODULE(_lamina, module) {
  using namespace lamina::python;
  module.attr("__version__") = LAMINA_VERSION;
  lamina::tell_reading_warnings([](const std::string& text) {
    const pybind11::gil_scoped_acquire locked;
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw pybind11::error_already_set();
  });
  bind_errors(module);
  bind_work(module);
  bind_layer_stacks(module);
  bind_material(module);
  bind_recipes(module);
  bind_slab(module);
  bind_profile(module);
  bind_photons(module);
  bind_patch(module);
  bind_edit(module);
  bind_acquire(module);
  bind_fit(module);
  bind_bsdf(module);
  bind_optics(module);
  bind_media(module);
  bind_half_spaces(module);
  bind_surfaces(module);
  bind_map_photons(module);
  bind_reproduction(module);
  bind_exchange(module);
  bind_images(module);
  bind_render(module);
  bind_session(module);
}
