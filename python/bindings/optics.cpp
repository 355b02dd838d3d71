// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "optics.h"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <complex>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/base/spectrum/cie_1931.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/mie.h"
#include "tables.h"

namespace lamina::python {
namespace {

using Complexes = py::array_t<std::complex<double>, py::array::c_style | py::array::forcecast>;

Illuminant illuminant_named(const std::string& name) {
  if (name == "d65") return Illuminant::d65;
  if (name == "a") return Illuminant::a;
  if (name == "e") return Illuminant::equal_energy;
  throw InvalidInput("illuminant: must be one of d65, a, e, but is " + name);
}

Lab lab_of(const double* rgb) { return lab(LinearSrgb{rgb[0], rgb[1], rgb[2]}); }

}  // namespace

void bind_optics(py::module_& module) {
  module.def("fresnel", [](const Doubles& cosine, const Doubles& eta) {
    return table_of(shape_of(cosine), 1, [&](std::size_t i, double* out) {
      out[0] = fresnel(cosine.data()[i], eta.data()[i]);
    });
  });
  module.def("fresnel_diffuse", [](const Doubles& eta) {
    return table_of(shape_of(eta), 1,
                    [&](std::size_t i, double* out) { out[0] = fresnel_diffuse(eta.data()[i]); });
  });
  module.def("mie_sphere", [](const Doubles& size, const Complexes& ior) {
    return table_of(shape_of(size), 3, [&](std::size_t i, double* out) {
      const MieSphere sphere = mie_sphere(size.data()[i], ior.data()[i]);
      out[0] = sphere.extinction;
      out[1] = sphere.scattering;
      out[2] = sphere.g;
    });
  });
  module.def("mie_bulk",
             [](const Doubles& fraction, const Doubles& radius, const Doubles& spread,
                const Complexes& ior, const Doubles& ior_medium, const Doubles& wavelength) {
               return table_of(shape_of(fraction), 3, [&](std::size_t i, double* out) {
                 const MieBulk bulk = mie_bulk({.volume_fraction = fraction.data()[i],
                                                .median_radius = radius.data()[i],
                                                .sigma_log_radius = spread.data()[i],
                                                .ior = ior.data()[i]},
                                               ior_medium.data()[i], wavelength.data()[i]);
                 out[0] = bulk.sigma_a;
                 out[1] = bulk.sigma_s;
                 out[2] = bulk.g;
               });
             });
  module.def("band_weights", [](const std::vector<double>& wavelengths,
                                const std::string& illuminant) {
    std::vector<double> weights;
    for (const auto& band : make_band_weights(BandSet(wavelengths), illuminant_named(illuminant)))
      weights.insert(weights.end(), band.begin(), band.end());
    return to_array(std::move(weights), with_axis(with_axis({}, wavelengths.size()), 3));
  });
  module.def("lab", [](const Doubles& rgb, Shape shape) {
    shape.pop_back();
    return table_of(shape, 3, [&](std::size_t i, double* out) {
      const Lab color = lab_of(rgb.data() + 3 * i);
      out[0] = color.lightness;
      out[1] = color.a;
      out[2] = color.b;
    });
  });
  module.def("color_difference", [](const Doubles& first, const Doubles& second, Shape shape) {
    shape.pop_back();
    return table_of(shape, 1, [&](std::size_t i, double* out) {
      out[0] = color_difference(lab_of(first.data() + 3 * i), lab_of(second.data() + 3 * i));
    });
  });
}

}  // namespace lamina::python
