// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/camera_raw.h"

#include <span>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/io/file_bytes.h"

#ifdef LAMINA_CAMERA_RAW
#include <libraw/libraw.h>

#include <algorithm>
#include <memory>

#include "lamina/base/core/checked_size.h"
#endif

namespace lamina {

#ifdef LAMINA_CAMERA_RAW
namespace {

void require_success(const EncodedImage& file, int status) {
  if (status == LIBRAW_SUCCESS) return;
  fail_to_decode(file, "camera raw", libraw_strerror(status));
}

/// What libraw holds at its most: the sensor's numbers, and four of 16 bits for each pixel, twice.
std::size_t libraw_bytes(const EncodedImage& file, const libraw_image_sizes_t& sizes) {
  const std::size_t sensor = checked_product(file.name, {sizes.raw_width, sizes.raw_height, 2});
  const std::size_t pixels = checked_product(file.name, {sizes.width, sizes.height, 16});
  return checked_sum(file.name, {sensor, sensor, pixels});
}

/// Linear numbers of the sensor, of which the largest is white, whatever the picture shows.
void set_linear(libraw_output_params_t& params, Demosaic demosaic) {
  params.output_color = 0;
  params.use_auto_wb = params.use_camera_wb = params.use_camera_matrix = 0;
  std::fill(std::begin(params.user_mul), std::end(params.user_mul), 1.0f);
  params.gamm[0] = params.gamm[1] = 1.0;
  params.no_auto_bright = 1;
  params.adjust_maximum_thr = 0.0f;
  params.highlight = 0;
  params.user_flip = 0;
  params.output_bps = 16;
  params.user_qual = 0;
  params.half_size = demosaic == Demosaic::half_size ? 1 : 0;
}

}  // namespace

bool reads_camera_raw() { return true; }

CameraRaw decode_camera_raw(const EncodedImage& file, Demosaic demosaic) {
  const auto raw = std::make_unique<LibRaw>();  // too large for a stack
  bool is_cut = false;
  raw->set_dataerror_handler(  // or else it prints
      [](void* flag, const char*, auto) { *static_cast<bool*>(flag) = true; }, &is_cut);
  set_linear(raw->imgdata.params, demosaic);
  constexpr std::size_t mebibyte = std::size_t{1} << 20, most_mebibytes = 2048;
  raw->imgdata.params.max_raw_memory_mb =
      static_cast<unsigned>(std::min(file.memory.left / mebibyte, most_mebibytes));
  require_success(file,
                  raw->open_buffer(const_cast<std::byte*>(file.bytes.data()), file.bytes.size()));
  const libraw_image_sizes_t& sizes = raw->imgdata.sizes;
  require_plausible_size(file, "camera raw", sizes.raw_width, sizes.raw_height, 1);
  if (raw->imgdata.idata.colors != 3)
    fail_to_decode(
        file, "camera raw",
        "it must have the colors R, G and B, but has " + std::to_string(raw->imgdata.idata.colors));
  const std::size_t shrunk = demosaic == Demosaic::half_size ? 2 : 1;
  take_image_memory(file, (sizes.width + shrunk - 1) / shrunk, (sizes.height + shrunk - 1) / shrunk,
                    3, libraw_bytes(file, sizes));
  require_success(file, raw->unpack());
  if (is_cut) fail_to_decode(file, "camera raw", "its numbers are cut short or damaged");
  require_success(file, raw->dcraw_process());
  if (!raw->imgdata.image) fail_to_decode(file, "camera raw", "it has no pixels");

  const auto& other = raw->imgdata.other;
  CameraRaw result{.image = make_image(sizes.iwidth, sizes.iheight, {"R", "G", "B"}),
                   .camera = std::string(raw->imgdata.idata.make) + " " + raw->imgdata.idata.model,
                   .exposure_s = static_cast<double>(other.shutter),
                   .iso = static_cast<double>(other.iso_speed),
                   .f_number = static_cast<double>(other.aperture)};
  for (std::size_t i = 0; i < result.image.pixels.size(); ++i)
    result.image.pixels[i] = static_cast<float>(raw->imgdata.image[i / 3][i % 3]) / 65535.0f;
  return result;
}

#else

bool reads_camera_raw() { return false; }

CameraRaw decode_camera_raw(const EncodedImage& file, Demosaic) {
  throw FileError(file.name +
                  ": is a camera raw file, for which lamina must be built with libraw (Debian: "
                  "libraw-dev); or convert it to a linear TIFF of 16 bits");
}

#endif

CameraRaw load_camera_raw(const std::filesystem::path& file, Demosaic demosaic,
                          MemoryBudget& memory) {
  const std::string bytes = read_file_bytes(file, memory);
  CameraRaw raw = decode_camera_raw({.bytes = std::as_bytes(std::span(bytes)),
                                     .name = file.string(),
                                     .encoding = ColorEncoding::linear,
                                     .memory = memory},
                                    demosaic);
  memory.left += bytes.size();  // which end here
  return raw;
}

}  // namespace lamina
