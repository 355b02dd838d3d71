// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/image_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/envi_file.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/kept_readings.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(), [](char a, std::byte b) {
           return static_cast<unsigned char>(a) == std::to_integer<unsigned char>(b);
         });
}

using namespace std::string_view_literals;

/// Formats that people may well try, by their first bytes.
std::string_view known_but_unread(std::span<const std::byte> bytes) {
  constexpr std::array<std::array<std::string_view, 2>, 4> formats = {
      {{"GIF8", "a GIF"}, {"BM", "a BMP"}, {"RIFF", "a WebP"}, {"8BPS", "a Photoshop"}}};
  for (const auto& [magic, what] : formats)
    if (starts_with(bytes, magic)) return what;
  return {};
}

/// Files of cameras that are no TIFF, by their first bytes: RAF, ORF, RW2, X3F and CR3.
bool is_camera_raw(std::span<const std::byte> bytes) {
  for (const std::string_view magic :
       {"FUJIFILM"sv, "IIRO"sv, "IIRS"sv, "MMOR"sv, "IIU\0"sv, "FOVb"sv})
    if (starts_with(bytes, magic)) return true;
  return bytes.size() > 12 && starts_with(bytes.subspan(4), "ftypcrx");
}

}  // namespace

void fail_to_decode(const EncodedImage& file, const char* format, const std::string& why) {
  std::string line = why;
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 32; }, ' ');
  while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
  throw FileError(file.name + ": cannot be read as " + format + ": " + line);
}

void require_plausible_size(const EncodedImage& file, const char* format, std::int64_t width,
                            std::int64_t height, std::int64_t channels) {
  constexpr std::int64_t longest_side = std::int64_t{1} << 20;
  constexpr std::int64_t most_numbers = std::int64_t{1} << 31;
  // A file this much shorter than its pixels is cut or lies: deflate shrinks 1032 times at most.
  // Up to `always_allowed` numbers (64 MiB) even that is read, since uniform blocks of some EXR
  // compressions shrink further.
  constexpr std::int64_t largest_shrinkage = 1032;
  constexpr std::int64_t always_allowed = std::int64_t{1} << 24;
  if (width < 1 || height < 1 || channels < 1) fail_to_decode(file, format, "it has no pixels");
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels of " +
                           std::to_string(channels) + (channels == 1 ? " channel" : " channels");
  if (width > longest_side || height > longest_side || channels > 1024 ||
      width * height > most_numbers / channels)
    fail_to_decode(file, format, "it claims " + size + ", which is too large");
  const std::int64_t numbers = width * height * channels;
  if (numbers > always_allowed &&
      numbers / largest_shrinkage > static_cast<std::int64_t>(file.bytes.size()))
    fail_to_decode(
        file, format,
        "it claims " + size + ", but has only " + std::to_string(file.bytes.size()) + " bytes");
}

void take_image_memory(const EncodedImage& file, std::size_t width, std::size_t height,
                       std::size_t channels, std::size_t decoder_bytes) {
  const std::string what = file.name + ": " + std::to_string(width) + " x " +
                           std::to_string(height) + " pixels of " + std::to_string(channels) +
                           (channels == 1 ? " channel" : " channels");
  const std::size_t image_bytes = checked_product(what, {width, height, channels, sizeof(float)});
  MemoryBudget while_decoding = file.memory;
  take_memory(while_decoding, checked_sum(what, {image_bytes, decoder_bytes}), what);
  MemoryBudget for_reader = file.memory;
  take_memory(
      for_reader,
      checked_sum(what,
                  {image_bytes, checked_product(what, {width, height, file.more_bytes_per_pixel})}),
      what);
  take_memory(file.memory, image_bytes, what);
}

Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                   const ImageReading& reading, MemoryBudget& memory) {
  const EncodedImage file{.bytes = bytes,
                          .name = name,
                          .encoding = reading.encoding,
                          .memory = memory,
                          .is_turned_upright = reading.is_turned_upright,
                          .more_bytes_per_pixel = reading.more_bytes_per_pixel};
  if (bytes.empty()) throw FileError(name + ": must be an image, but is empty");
  if (starts_with(bytes, "\x76\x2f\x31\x01"sv)) return decode_exr(file);
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n"sv)) return decode_png(file);
  for (const std::string_view magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (starts_with(bytes, magic))
      return is_raw_tiff(file) ? decode_camera_raw(file, Demosaic::bilinear).image
                               : decode_tiff(file);
  if (starts_with(bytes, "\xff\xd8\xff")) return decode_jpeg(file);
  if (starts_with(bytes, "#?R")) return decode_radiance_hdr(file);  // #?RADIANCE, #?RGBE
  if (is_camera_raw(bytes)) return decode_camera_raw(file, Demosaic::bilinear).image;
  if (starts_with(bytes, "ENVI"))
    throw FileError(name +
                    ": must be an image, but is the header of an ENVI image, whose numbers " +
                    "are in a file beside it");
  const std::string_view other = known_but_unread(bytes);
  throw FileError(
      name + ": must be an EXR, PNG, JPEG, TIFF, Radiance HDR, ENVI or camera raw image, but " +
      (other.empty() ? "is none of them" : "is " + std::string(other) + " file"));
}

Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                   ColorEncoding encoding, MemoryBudget& memory) {
  return decode_image(bytes, name, ImageReading{.encoding = encoding}, memory);
}

Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                   ColorEncoding encoding) {
  MemoryBudget memory;
  return decode_image(bytes, name, encoding, memory);
}

Image load_image(const std::filesystem::path& file, ColorEncoding encoding, MemoryBudget& memory) {
  return load_image(file, ImageReading{.encoding = encoding}, memory);
}

namespace {

Image read_image(const std::filesystem::path& file, const ImageReading& reading,
                 MemoryBudget& memory) {
  const std::string bytes = read_file_bytes(file, memory);
  if (bytes.starts_with("ENVI")) {
    memory.left += bytes.size();
    return load_envi(file, {}, memory);
  }
  Image image = decode_image(std::as_bytes(std::span(bytes)), file.string(), reading, memory);
  memory.left += bytes.size();  // which end here
  return image;
}

}  // namespace

Image load_image(const std::filesystem::path& file, const ImageReading& reading,
                 MemoryBudget& memory) {
  const auto& [encoding, is_turned_upright, more_bytes_per_pixel] = reading;
  return kept_reading<Image>("image " + std::to_string(static_cast<int>(encoding)) + " " +
                                 std::to_string(is_turned_upright) + " " +
                                 std::to_string(more_bytes_per_pixel) + " " + file.string(),
                             [&] { return read_image(file, reading, memory); });
}

Image load_image(const std::filesystem::path& file, ColorEncoding encoding) {
  MemoryBudget memory;
  return load_image(file, encoding, memory);
}

void require_finite(const Image& image, const std::filesystem::path& file) {
  const auto bad = std::ranges::find_if(image.pixels, [](float v) { return !std::isfinite(v); });
  if (bad == image.pixels.end()) return;
  const auto index = static_cast<std::size_t>(bad - image.pixels.begin());
  const std::size_t pixel = index / image.channel_count();
  const auto width = static_cast<std::size_t>(image.width);
  throw FileError(file.string() + ": pixel (" + std::to_string(pixel % width) + ", " +
                  std::to_string(pixel / width) + "), channel " +
                  image.channels[index % image.channel_count()] + " must be finite, but is " +
                  (std::isnan(*bad) ? "nan"
                   : *bad > 0.0f    ? "inf"
                                    : "-inf"));
}

void save_exr(const Image& image, const std::filesystem::path& file, ExrPrecision precision,
              std::span<const ImageNote> notes, RgbSpace space) {
  write_file_bytes(file, encode_exr(image, precision, notes, space));
}

void save_png(const Image& image, const std::filesystem::path& file) {
  write_file_bytes(file, encode_png(image));
}

}  // namespace lamina
