// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// In this order: libjpeg's header wants FILE, and that of its errors wants that.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <array>
#include <csetjmp>
#include <new>
#include <string>
#include <utility>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/image/files/internal/color_statement.h"
#include "lamina/base/image/files/internal/jpeg_notes.h"
#include "lamina/base/image/files/internal/orientation.h"

namespace lamina {
namespace {

// libjpeg reports errors by a long jump here. So the functions that call setjmp have no objects
// with destructors; everything that owns memory lives in JpegReader and in decode_jpeg.

/// Scans that a progressive file may have: a small file could ask for a whole decoding in each.
constexpr int most_scans = 200;

struct JpegReader {
  explicit JpegReader(std::span<const std::byte> bytes);
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&info); }

  std::span<const std::byte> bytes;
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf on_error{};
  std::array<char, JMSG_LENGTH_MAX> message{};
};

JpegReader& jpeg_reader_of(j_common_ptr info) {
  return *static_cast<JpegReader*>(info->client_data);
}

[[noreturn]] void leave_jpeg(j_common_ptr info) {
  JpegReader& reader = jpeg_reader_of(info);
  info->err->format_message(info, reader.message.data());
  std::longjmp(reader.on_error, 1);  // NOLINT(cert-err52-cpp): the way out of a C library
}

/// What libjpeg would mend in silence, with gray where bytes are missing.
void refuse_damage(j_common_ptr info, int level) {
  if (level >= 0) return;
  const int code = info->err->msg_code;
  if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE)
    leave_jpeg(info);
}

void refuse_too_many_scans(j_common_ptr info) {
  if (info->is_decompressor &&
      reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > most_scans)
    ERREXIT(info, JERR_BAD_SCAN_SCRIPT);
}

JpegReader::JpegReader(std::span<const std::byte> encoded) : bytes(encoded) {
  info.err = jpeg_std_error(&errors);
  errors.error_exit = leave_jpeg;
  errors.emit_message = refuse_damage;
  progress.progress_monitor = refuse_too_many_scans;
}

/// Everything before the pixels. Afterwards rows have one number per pixel, or red, green and blue.
bool read_jpeg_header(JpegReader& reader) {
  if (setjmp(reader.on_error)) return false;
  jpeg_create_decompress(&reader.info);
  reader.info.client_data = &reader;
  reader.info.progress = &reader.progress;
  jpeg_mem_src(&reader.info, reinterpret_cast<const unsigned char*>(reader.bytes.data()),
               reader.bytes.size());
  (void)jpeg_read_header(&reader.info, TRUE);
  reader.info.out_color_space = reader.info.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  reader.info.dct_method = JDCT_ISLOW;
  jpeg_calc_output_dimensions(&reader.info);
  return true;
}

bool start_jpeg(JpegReader& reader) {
  if (setjmp(reader.on_error)) return false;
  (void)jpeg_start_decompress(&reader.info);
  return true;
}

bool read_jpeg_row(JpegReader& reader, JSAMPROW row) {
  if (setjmp(reader.on_error)) return false;
  (void)jpeg_read_scanlines(&reader.info, &row, 1);
  return true;
}

bool read_jpeg_end(JpegReader& reader) {
  if (setjmp(reader.on_error)) return false;
  (void)jpeg_finish_decompress(&reader.info);
  return true;
}

}  // namespace

Image decode_jpeg(const EncodedImage& file) {
  JpegReader reader(file.bytes);
  const auto fail = [&] { fail_to_decode(file, "JPEG", reader.message.data()); };
  if (!read_jpeg_header(reader)) fail();
  const jpeg_decompress_struct& info = reader.info;
  const std::size_t width = info.output_width, height = info.output_height;
  if (info.num_components != 1 && info.num_components != 3)
    fail_to_decode(file, "JPEG",
                   "it has " + std::to_string(info.num_components) +
                       " components, as for print; save it as RGB or gray");
  const std::size_t channels = info.num_components == 1 ? 1 : 3;
  require_plausible_size(file, "JPEG", static_cast<std::int64_t>(width),
                         static_cast<std::int64_t>(height), static_cast<std::int64_t>(channels));
  // Several scans are kept as coefficients of two bytes, padded to blocks of up to 32 pixels.
  const std::size_t kept_rows = jpeg_has_multiple_scans(&reader.info) ? height + 32 : 64;
  const JpegNotes notes = read_jpeg_notes(file);
  const int orientation = file.is_turned_upright ? notes.exif.orientation : 1;
  take_image_memory(
      file, width, height, channels,
      checked_sum(file.name,
                  {checked_product(file.name, {width + 32, kept_rows, channels, sizeof(short)}),
                   turning_bytes(orientation, width, height, channels)}));
  const ColorReading colors(file, "JPEG", notes.colors, channels == 1, false);

  Image image = make_image(
      static_cast<int>(width), static_cast<int>(height),
      channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"});
  std::array<float, 256> linear{};
  for (std::uint32_t v = 0; v < 256; ++v) linear[v] = colors.number(v, 255);
  std::vector<unsigned char> row(width * channels);
  if (!start_jpeg(reader)) fail();
  for (std::size_t y = 0; y < height; ++y) {
    if (!read_jpeg_row(reader, row.data())) fail();
    float* to = image.at(0, static_cast<int>(y));
    for (std::size_t i = 0; i < row.size(); ++i) to[i] = linear[row[i]];
  }
  if (!read_jpeg_end(reader)) fail();
  return upright(colors.in_rec709(std::move(image)), orientation);
}

}  // namespace lamina
