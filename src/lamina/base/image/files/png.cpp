// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstring>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/image/files/internal/color_statement.h"
#include "lamina/base/image/files/internal/orientation.h"
#include "lamina/base/image/files/internal/png_statement.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina {
namespace {

// libpng reports errors by a long jump. So the functions that call setjmp have no objects with
// destructors; everything that owns memory lives in these structs, in the functions that call them.

void on_error(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

struct Reader {
  explicit Reader(std::span<const std::byte> encoded) : bytes(encoded) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &error, on_error, on_warning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) throw std::bad_alloc();
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }

  std::span<const std::byte> bytes;
  std::size_t position = 0;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  Reader& reader = *static_cast<Reader*>(png_get_io_ptr(png));
  if (count > reader.bytes.size() - reader.position) png_error(png, "it ends too early");
  std::memcpy(to, reader.bytes.data() + reader.position, count);
  reader.position += count;
}

/// Everything before the pixels. Afterwards rows have 8 or 16 bits per channel and no palette.
bool read_header(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_set_read_fn(reader.png, &reader, read_bytes);
  png_set_user_limits(reader.png, 1u << 20, 1u << 20);
  // Texts and the like are not for us; a small file may hold gigabytes of them, deflated. What it
  // says of its colors is read by png_color_statement.
  png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_set_chunk_malloc_max(reader.png, 1u << 20);
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_row(Reader& reader, png_bytep row) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_row(reader.png, row, nullptr);
  return true;
}

/// All rows at once, which interlaced images need.
bool read_rows(Reader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_image(reader.png, rows);
  return true;
}

bool read_end(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_end(reader.png, nullptr);
  return true;
}

struct Writer {
  Writer() {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, on_error, on_warning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) throw std::bad_alloc();
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }

  std::vector<std::byte> bytes;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

void write_bytes(png_structp png, png_bytep from, std::size_t count) {
  Writer& writer = *static_cast<Writer*>(png_get_io_ptr(png));
  const auto* first = reinterpret_cast<const std::byte*>(from);
  writer.bytes.insert(writer.bytes.end(), first, first + count);
}

void flush_nothing(png_structp) {}

bool write_image(Writer& writer, int width, int height, int color_type, png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_set_write_fn(writer.png, &writer, write_bytes, flush_nothing);
  png_set_user_limits(writer.png, 1u << 20, 1u << 20);
  png_set_compression_level(writer.png, 6);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_ALL_FILTERS);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(width),
               static_cast<png_uint_32>(height), 8, color_type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(writer.png, writer.info);
  png_write_image(writer.png, rows);
  png_write_end(writer.png, writer.info);
  return true;
}

std::vector<png_bytep> row_pointers(std::vector<png_byte>& data, std::size_t row_bytes,
                                    std::size_t height) {
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = data.data() + y * row_bytes;
  return rows;
}

/// What becomes of all 8 bit or all 16 bit numbers.
template <class Decode>
std::vector<float> decoding_table(std::uint32_t largest, const Decode& decode_number) {
  std::vector<float> table(largest + 1);
  for (std::uint32_t v = 0; v <= largest; ++v) table[v] = decode_number(v);
  return table;
}

png_byte quantized(double value) {  // of [0, 1]; NaN is 0
  return value > 0.0 ? static_cast<png_byte>(std::lround(255.0 * std::min(value, 1.0)))
                     : png_byte{0};
}

}  // namespace

Image decode_png(const EncodedImage& file) {
  Reader reader(file.bytes);
  if (!read_header(reader)) fail_to_decode(file, "PNG", reader.error);
  const std::size_t width = png_get_image_width(reader.png, reader.info);
  const std::size_t height = png_get_image_height(reader.png, reader.info);
  const std::size_t channel_count = png_get_channels(reader.png, reader.info);
  const bool is_16_bit = png_get_bit_depth(reader.png, reader.info) == 16;
  require_plausible_size(file, "PNG", static_cast<std::int64_t>(width),
                         static_cast<std::int64_t>(height),
                         static_cast<std::int64_t>(channel_count));

  const bool is_interlaced = png_get_interlace_type(reader.png, reader.info) != PNG_INTERLACE_NONE;
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const std::size_t rows_at_once = is_interlaced ? height : 1;
  constexpr std::size_t rows_of_libpng = 4;
  const int orientation = file.is_turned_upright ? png_orientation(file.bytes) : 1;
  take_image_memory(file, width, height, channel_count,
                    rows_at_once * sizeof(png_bytep) + (rows_at_once + rows_of_libpng) * row_bytes +
                        turning_bytes(orientation, width, height, channel_count));
  const ColorReading reading(file, "PNG", png_color_statement(file), channel_count < 3, false);

  const bool has_alpha = channel_count % 2 == 0;
  std::vector<std::string> names =
      channel_count < 3 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  if (has_alpha) names.emplace_back("A");
  Image image = make_image(static_cast<int>(width), static_cast<int>(height), std::move(names));

  const std::uint32_t largest = is_16_bit ? 65535 : 255;
  const std::vector<float> color =
      decoding_table(largest, [&](std::uint32_t v) { return reading.number(v, largest); });
  const std::vector<float> alpha = decoding_table(largest, [&](std::uint32_t v) {
    return static_cast<float>(static_cast<double>(v) / static_cast<double>(largest));
  });
  std::vector<png_byte> data(rows_at_once * row_bytes);
  std::vector<png_bytep> rows = row_pointers(data, row_bytes, rows_at_once);
  if (is_interlaced && !read_rows(reader, rows.data())) fail_to_decode(file, "PNG", reader.error);
  for (std::size_t y = 0; y < height; ++y) {
    if (!is_interlaced && !read_row(reader, rows[0])) fail_to_decode(file, "PNG", reader.error);
    const png_byte* row = rows[is_interlaced ? y : 0];
    float* to = image.at(0, static_cast<int>(y));
    for (std::size_t i = 0; i < width * channel_count; ++i) {
      const std::uint32_t value = is_16_bit ? row[2 * i] * 256u + row[2 * i + 1] : row[i];
      const bool is_alpha = has_alpha && i % channel_count == channel_count - 1;
      to[i] = (is_alpha ? alpha : color)[value];
    }
  }
  if (!read_end(reader)) fail_to_decode(file, "PNG", reader.error);
  return upright(reading.in_rec709(std::move(image)), orientation);
}

std::vector<std::byte> encode_png(const Image& image) {
  if (image.width < 1 || image.height < 1)
    throw InvalidInput("image: a PNG file needs at least one pixel");
  const bool is_grey = !channel_index(image, "R") && channel_index(image, "Y");
  std::vector<std::size_t> sources;
  for (const char* name : {"R", "G", "B"}) {
    const std::optional<std::size_t> index = channel_index(image, is_grey ? "Y" : name);
    if (!index) throw InvalidInput("image: a PNG file needs channels R, G, B, or Y");
    sources.push_back(*index);
  }
  if (is_grey) sources.resize(1);
  const std::size_t color_count = sources.size();
  if (const std::optional<std::size_t> alpha = channel_index(image, "A")) sources.push_back(*alpha);

  const std::size_t row_bytes = sources.size() * static_cast<std::size_t>(image.width);
  std::vector<png_byte> data;
  data.reserve(row_bytes * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (std::size_t c = 0; c < sources.size(); ++c) {
        const double value = static_cast<double>(image.at(x, y)[sources[c]]);
        data.push_back(quantized(c < color_count && value > 0.0 ? srgb_encode(value) : value));
      }
  std::vector<png_bytep> rows =
      row_pointers(data, row_bytes, static_cast<std::size_t>(image.height));
  constexpr std::array<int, 5> color_types = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                              PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
  Writer writer;
  if (!write_image(writer, image.width, image.height, color_types[sources.size()], rows.data()))
    throw InvalidInput("image: cannot be written as PNG: " + writer.error);
  return std::move(writer.bytes);
}

}  // namespace lamina
