// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "images.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "lamina/base/image/compare.h"
#include "lamina/base/image/files/envi_file.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/files/image_frame.h"
#include "lamina/base/image/files/ocio_view.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina::python {
namespace {

/// For screens, 8 bit sRGB, (height, width, channel).
py::array_t<std::uint8_t> bytes_of(const Image& seen, const Floats& rgb) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(seen.pixels.size());
  for (const float value : seen.pixels) {
    const double v = std::clamp(static_cast<double>(value), 0.0, 1.0);
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0 * srgb_encode(v))));
  }
  return to_array(std::move(bytes), shape_of(rgb));
}

py::array_t<std::uint8_t> view(const Floats& rgb, const std::string& name, double exposure) {
  return bytes_of(view_image(image_of(rgb, {"R", "G", "B"}), choice<View>(name), exposure), rgb);
}

/// Through a view of an OpenColorIO config; empty names are the config's defaults.
py::array_t<std::uint8_t> ocio_view(const Floats& rgb, const std::string& config,
                                    const std::string& display, const std::string& name,
                                    double exposure) {
  const OcioView view({.config = config, .display = display, .view = name});
  return bytes_of(view.see(image_of(rgb, {"R", "G", "B"}), exposure), rgb);
}

/// Bands of an ENVI file, or a part of its pixels.
py::tuple load_part(const std::string& file, const std::vector<double>& wavelengths,
                    const std::vector<double>& widths, const std::string& shape,
                    const std::optional<std::array<int, 4>>& rectangle) {
  EnviSelection selection;
  const EnviBandShape kind = shape == "gaussian" ? EnviBandShape::gaussian
                             : shape == "box"    ? EnviBandShape::box
                                                 : EnviBandShape::nearest;
  for (std::size_t i = 0; i < wavelengths.size(); ++i)
    selection.bands.push_back({wavelengths[i], kind, widths[i]});
  if (rectangle)
    selection.rectangle = {(*rectangle)[0], (*rectangle)[1], (*rectangle)[2], (*rectangle)[3]};
  Image image = [&] {
    const py::gil_scoped_release unlocked;
    MemoryBudget memory;
    return load_envi(file, selection, memory);
  }();
  std::vector<std::string> channels = image.channels;
  return py::make_tuple(image_array(std::move(image)), channels);
}

/// Whether renders show the same scene, by their means and variances of these.
py::dict compare(const Floats& a, const Floats& a_variance, const Floats& b,
                 const Floats& b_variance, double significance) {
  std::vector<std::string> channels;
  for (py::ssize_t c = 0; c < a.shape(2); ++c) channels.push_back("c" + std::to_string(c));
  const RenderEstimate first{image_of(a, channels), image_of(a_variance, channels)};
  const RenderEstimate second{image_of(b, channels), image_of(b_variance, channels)};
  ImageComparison found = [&] {
    const py::gil_scoped_release unlocked;
    return compare_renders(first, second, significance);
  }();
  py::dict result;
  result["report"] = found.report();
  result["agrees"] = found.agrees;
  result["smallest_p_value"] = found.smallest_p_value;
  result["threshold"] = found.threshold;
  result["differing"] = found.differing;
  result["bias_z"] = found.bias_z;
  result["mean_square_z"] = found.mean_square_z;
  result["rmse"] = found.rmse;
  result["p_values"] = plane_array(found.p_values);
  return result;
}

}  // namespace

void bind_images(py::module_& module) {
  module.def("view", &view);
  module.def("ocio_view", &ocio_view);
  module.def("load_image", [](const std::string& file, const std::string& encoding) {
    Image image = [&] {
      const py::gil_scoped_release unlocked;
      return load_image(file, choice<ColorEncoding>(encoding));
    }();
    std::vector<std::string> channels = image.channels;
    return py::make_tuple(image_array(std::move(image)), channels);
  });
  module.def("save_png", [](const Floats& pixels, const std::vector<std::string>& channels,
                            const std::string& file) {
    const Image image = image_of(pixels, channels);
    const py::gil_scoped_release unlocked;
    save_png(image, file);
  });
  module.def("save_exr",
             [](const Floats& pixels, const std::vector<std::string>& channels,
                const std::string& file, const std::map<std::string, std::string>& notes,
                const std::string& space, const std::optional<std::array<int, 4>>& frame) {
               const Image image = image_of(pixels, channels);
               std::vector<ImageNote> said;
               for (const auto& [name, text] : notes) said.push_back({name, text});
               const auto of = choice<RgbSpace>(space);
               ImageFrame place;
               if (frame) place = {(*frame)[0], (*frame)[1], (*frame)[2], (*frame)[3]};
               const py::gil_scoped_release unlocked;
               save_exr(image, file, ExrPrecision::single_float, said, of, place);
             });
  module.def("load_envi", &load_part);
  module.def("compare_images", &compare);
}

}  // namespace lamina::python
