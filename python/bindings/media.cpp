// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "media.h"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "heard.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/mie.h"
#include "lamina/layers/optics/phase_function.h"
#include "lamina/solve/integrating_sphere/integrating_sphere.h"
#include "lamina/solve/integrating_sphere/lost_light.h"
#include "lamina/solve/scattering/diffusion/albedo_inversion.h"
#include "lamina/solve/scattering/diffusion/pulsed_diffusion.h"
#include "layer_stacks.h"
#include "tables.h"
#include "work.h"

namespace lamina::python {
namespace {

PhaseFunction phase_named(const std::string& kind, double g) {
  if (kind == "rayleigh") return Rayleigh{};
  return HenyeyGreenstein{g};
}

/// Half-spaces as layers of one shape.
LayerStacks half_spaces(const std::vector<Medium>& media, const Doubles& ior_outside,
                        const Shape& shape) {
  LayerStacks result{.stacks = {}, .shape = shape};
  for (std::size_t i = 0; i < media.size(); ++i)
    result.stacks.emplace_back(std::vector<Layer>{{.medium = media[i]}}, ior_outside.data()[i],
                               media[i].ior);
  return result;
}

LayerStacks by_look(const Doubles& reflectance, const Doubles& diffuse_mfp, const Doubles& g,
                    const Doubles& ior, const Doubles& ior_outside) {
  const Shape shape = shape_of(reflectance);
  std::vector<Medium> media(size_of(shape));
  for (std::size_t i = 0; i < media.size(); ++i) {
    try {
      media[i] = medium_from_look({reflectance.data()[i], diffuse_mfp.data()[i]}, g.data()[i],
                                  ior.data()[i], ior_outside.data()[i]);
    } catch (const InvalidInput& error) {
      throw InvalidInput(place_text(i, shape) + error.what());
    }
  }
  return half_spaces(media, ior_outside, shape);
}

LayerStacks equivalent(const LayerStacks& stacks, const py::object& callback) {
  Work work(callback);
  std::vector<Medium> media = work.run([&](const Progress& progress) {
    std::vector<Medium> all(stacks.stacks.size());
    parallel_for(
        all.size(), [&](std::size_t i) { all[i] = equivalent_half_space(stacks.stacks[i]); },
        progress);
    return all;
  });
  LayerStacks result{.stacks = {}, .shape = stacks.shape};
  for (std::size_t i = 0; i < media.size(); ++i)
    result.stacks.emplace_back(std::vector<Layer>{{.medium = media[i]}},
                               stacks.stacks[i].ior_above(), media[i].ior);
  return result;
}

/// [..., r, t]
py::array_t<double> pulsed(const LayerStacks& stacks, const std::vector<double>& r,
                           const std::vector<double>& t, const py::object& callback) {
  Work work(callback);
  std::vector<double> values = work.run([&](const Progress& progress) {
    const std::size_t size = r.size() * t.size();
    std::vector<double> all(stacks.stacks.size() * size);
    parallel_for(
        stacks.stacks.size(),
        [&](std::size_t i) {
          auto out = all.begin() + static_cast<std::ptrdiff_t>(i * size);
          try {
            for (const std::vector<double>& row : pulsed_diffusion(stacks.stacks[i], r, t))
              out = std::ranges::copy(row, out).out;
          } catch (const InvalidInput& error) {
            throw InvalidInput(place_text(i, stacks.shape) + error.what());
          }
        },
        progress);
    return all;
  });
  return to_array(std::move(values), with_axis(with_axis(stacks.shape, r.size()), t.size()));
}

IntegratingSphere sphere_of(const py::dict& given) {
  IntegratingSphere sphere;
  const auto read = [&](const char* name, double& value) {
    if (given.contains(name)) value = given[name].cast<double>();
  };
  read("diameter", sphere.diameter);
  read("sample_port", sphere.sample_port);
  read("detector_port", sphere.detector_port);
  read("entrance_port", sphere.entrance_port);
  read("open_port", sphere.open_port);
  read("wall_reflectance", sphere.wall_reflectance);
  read("detector_reflectance", sphere.detector_reflectance);
  read("standard_reflectance", sphere.standard_reflectance);
  if (given.contains("has_baffle")) sphere.has_baffle = given["has_baffle"].cast<bool>();
  if (given.contains("method"))
    sphere.method = choice<SphereMethod>(given["method"].cast<std::string>());
  check_sphere(sphere);
  return sphere;
}

/// Value and derivatives by what the sample does, [..., 4].
py::array_t<double> reading(const std::string& side, const py::dict& given,
                            const Doubles& scattered, const Doubles& straight,
                            const Doubles& diffuse_reflectance) {
  const IntegratingSphere sphere = sphere_of(given);
  const auto read = side == "reflectance" ? &reflectance_reading : &transmittance_reading;
  return table_of(shape_of(scattered), 4, [&](std::size_t i, double* out) {
    const SphereReading one =
        read(sphere, {scattered.data()[i], straight.data()[i]}, diffuse_reflectance.data()[i]);
    out[0] = one.value;
    out[1] = one.by_scattered;
    out[2] = one.by_straight;
    out[3] = one.by_diffuse_reflectance;
  });
}

/// Light lost above and below with standard errors, [..., 4].
py::array_t<double> lost(const LayerStacks& stacks, bool is_diffuse, double theta,
                         double beam_diameter, double port_diameter, std::uint64_t photons,
                         std::uint64_t seed, const py::object& callback) {
  Work work(callback);
  std::vector<double> values = work.run([&](const Progress& progress) {
    std::vector<double> all;
    for (std::size_t i = 0; i < stacks.stacks.size(); ++i) {
      const auto count = static_cast<double>(stacks.stacks.size()), at = static_cast<double>(i);
      const LostLight one =
          lost_light(stacks.stacks[i], {is_diffuse, theta}, beam_diameter, port_diameter,
                     {.photons = photons,
                      .seed = seed,
                      .progress = part_of(progress, at / count, (at + 1) / count)});
      all.insert(all.end(), {one.reflected.value, one.reflected.standard_error,
                             one.transmitted.value, one.transmitted.standard_error});
    }
    return all;
  });
  return to_array(std::move(values), with_axis(stacks.shape, 4));
}

}  // namespace

void bind_media(py::module_& module) {
  module.def("phase_function",
             [](const std::string& kind, const Doubles& cos_theta, const Doubles& g) {
               return table_of(shape_of(cos_theta), 1, [&](std::size_t i, double* out) {
                 out[0] = evaluate(phase_named(kind, g.data()[i]), cos_theta.data()[i]);
               });
             });
  module.def("phase_moments", [](const std::string& kind, const Doubles& g, int count) {
    return table_of(shape_of(g), static_cast<std::size_t>(count), [&](std::size_t i, double* out) {
      const PhaseFunction phase = phase_named(kind, g.data()[i]);
      for (int l = 0; l < count; ++l) out[l] = legendre_moment(phase, l);
    });
  });
  module.def("mie_phase",
             [](double size, const std::complex<double>& ior, const std::vector<double>& cosines) {
               return to_array(heard([&] { return mie_phase(size, ior, cosines); }));
             });
  module.def("invert_dipole_albedo",
             [](const Doubles& reflectance, const Doubles& ior, const Doubles& ior_outside) {
               return table_of(shape_of(reflectance), 2, [&](std::size_t i, double* out) {
                 const AlbedoInversion found = invert_dipole_albedo(
                     reflectance.data()[i], ior.data()[i], ior_outside.data()[i]);
                 out[0] = found.albedo_prime;
                 out[1] = found.residual;
               });
             });
  module.def("medium_from_look", &by_look);
  module.def("equivalent_half_space", &equivalent);
  module.def("pulsed_diffusion", &pulsed);
  module.def("sphere_reading", &reading);
  module.def("lost_light", &lost);
}

}  // namespace lamina::python
