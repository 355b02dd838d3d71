// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <Imath/half.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/image/files/internal/color_statement.h"
#include "lamina/base/image/files/internal/exif.h"
#include "lamina/base/image/files/internal/orientation.h"

namespace lamina {
namespace {

constexpr std::size_t most_at_once = std::size_t{1} << 30;  ///< [bytes] that libtiff takes

/// The file in memory and the first error that libtiff reports.
struct Source {
  std::span<const std::byte> bytes;
  std::size_t most_at_once;  ///< no table, row, strip or tile is larger [bytes]
  std::size_t position = 0;
  std::string error;
};

Source& source_of(thandle_t handle) { return *static_cast<Source*>(handle); }

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
  Source& source = source_of(handle);
  const std::size_t left =
      source.position < source.bytes.size() ? source.bytes.size() - source.position : 0;
  const std::size_t size = std::min(left, static_cast<std::size_t>(std::max<tmsize_t>(count, 0)));
  if (size > 0) std::memcpy(to, source.bytes.data() + source.position, size);
  source.position += size;
  return static_cast<tmsize_t>(size);
}

tmsize_t write_nothing(thandle_t, void*, tmsize_t) { return -1; }

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  Source& source = source_of(handle);
  const std::size_t base = whence == SEEK_CUR   ? source.position
                           : whence == SEEK_END ? source.bytes.size()
                                                : 0;
  source.position = base + static_cast<std::size_t>(offset);
  return source.position;
}

int close_nothing(thandle_t) { return 0; }
toff_t size_of(thandle_t handle) { return source_of(handle).bytes.size(); }

int on_error(TIFF*, void* user, const char*, const char* format, std::va_list arguments) {
  char line[256];
  std::vsnprintf(line, sizeof line, format, arguments);
  std::string& error = static_cast<Source*>(user)->error;
  if (error.empty()) error = line;
  return 1;
}

int on_warning(TIFF*, void*, const char*, const char*, std::va_list) { return 1; }

struct Close {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using Handle = std::unique_ptr<TIFF, Close>;

Handle open(Source& source) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
      TIFFOpenOptionsAlloc(), TIFFOpenOptionsFree);
  if (!options) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), on_error, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), on_warning, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), static_cast<tmsize_t>(source.most_at_once));
  return Handle(TIFFClientOpenExt("image", "rm", &source, read_bytes, write_nothing, seek,
                                  close_nothing, size_of, nullptr, nullptr, options.get()));
}

/// How the pixels are laid out; all of it is checked.
struct Layout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t samples = 1;  ///< per pixel
  std::uint16_t bits = 1;     ///< per sample
  bool is_float = false, is_planar = false, is_white_zero = false;
  std::size_t colors = 1;            ///< 0: bands, all alike
  std::optional<std::size_t> alpha;  ///< the sample that is declared to be it
  int orientation = 1;

  [[nodiscard]] std::size_t bytes_per_sample() const { return bits / 8u; }
  /// Alpha, or what stands beside colors.
  [[nodiscard]] bool is_data(std::size_t sample) const {
    return alpha == sample || (colors > 0 && sample >= colors);
  }
  [[nodiscard]] std::size_t samples_together() const { return is_planar ? 1u : samples; }
};

Layout read_layout(const EncodedImage& file, TIFF* tiff) {
  const auto require = [&](bool holds, const std::string& why) {
    if (!holds) fail_to_decode(file, "TIFF", why);
  };
  Layout layout;
  std::uint16_t planes = PLANARCONFIG_CONTIG, format = SAMPLEFORMAT_UINT, photometric = 0;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &layout.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &layout.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &layout.samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &layout.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
  require(TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric) == 1,
          "it does not say what its colours mean");
  require(
      photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE ||
          photometric == PHOTOMETRIC_RGB,
      "it must be grey or RGB, but has photometric interpretation " + std::to_string(photometric));
  layout.is_float = format == SAMPLEFORMAT_IEEEFP;
  layout.is_planar = planes == PLANARCONFIG_SEPARATE;
  layout.is_white_zero = photometric == PHOTOMETRIC_MINISWHITE;
  require(layout.is_float || format == SAMPLEFORMAT_UINT,
          "its numbers must be unsigned or floating point");
  require(layout.is_float ? layout.bits == 16 || layout.bits == 32 || layout.bits == 64
                          : layout.bits == 8 || layout.bits == 16 || layout.bits == 32,
          "it must have 8, 16 or 32 bits, or 16, 32 or 64 bit floating point, but has " +
              std::to_string(layout.bits) + " bits");
  require_plausible_size(file, "TIFF", layout.width, layout.height, layout.samples);
  layout.colors = photometric == PHOTOMETRIC_RGB ? 3 : 1;
  require(layout.samples >= layout.colors, "it has fewer than three channels for RGB");
  std::uint16_t extra_count = 0, orientation = ORIENTATION_TOPLEFT;
  const std::uint16_t* extra = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_EXTRASAMPLES, &extra_count, &extra) == 1)
    for (std::size_t i = 0; i < extra_count && layout.colors + i < layout.samples; ++i)
      if (!layout.alpha &&
          (extra[i] == EXTRASAMPLE_ASSOCALPHA || extra[i] == EXTRASAMPLE_UNASSALPHA))
        layout.alpha = layout.colors + i;
  if (file.is_turned_upright && TIFFGetField(tiff, TIFFTAG_ORIENTATION, &orientation) == 1 &&
      orientation >= 1 && orientation <= 8)
    layout.orientation = orientation;
  // A grey file with samples that nobody declared is one of many bands, none of which is its color.
  const std::size_t declared = layout.alpha ? 1 : 0;
  if (layout.colors == 1 && layout.samples > 1 + declared) layout.colors = 0;
  return layout;
}

/// What the samples are called.
std::vector<std::string> names_of_samples(const Layout& layout) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < layout.samples; ++s)
    names.push_back(layout.alpha == s              ? "A"
                    : layout.colors == 3 && s < 3  ? std::string(1, "RGB"[s])
                    : layout.colors == 1 && s == 0 ? "Y"
                                                   : "band " + std::to_string(s + 1));
  return names;
}

ColorStatement statement_of_tiff(const EncodedImage& file, TIFF* tiff) {
  ColorStatement said;
  if (!follows_statement(file.encoding)) return said;
  std::uint32_t size = 0;
  const void* profile = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &size, &profile) == 1 && profile && size > 0) {
    const auto* const first = static_cast<const std::byte*>(profile);
    said.icc.assign(first, first + size);
  } else if (parse_exif(file.bytes).is_adobe_rgb) {
    said.encoding = adobe_rgb();
  }
  return said;
}

/// Turns raw samples into linear floats.
class Decoder {
 public:
  Decoder(const Layout& layout, const ColorReading& reading) : layout_(layout), reading_(reading) {
    if (layout.is_float || layout.bits == 32) return;
    const std::uint32_t largest = (1u << layout.bits) - 1u;
    for (std::uint32_t v = 0; v <= largest; ++v) {
      color_.push_back(reading.number(layout.is_white_zero ? largest - v : v, largest));
      data_.push_back(fraction(v, largest));
    }
  }

  /// @param is_data  alpha, or what is no color
  [[nodiscard]] float operator()(const std::byte* from, bool is_data) const {
    if (!layout_.is_float && layout_.bits == 32) {
      const auto value = as<std::uint32_t>(from);
      return is_data ? fraction(value, ~0u)
                     : reading_.number(layout_.is_white_zero ? ~value : value, ~0u);
    }
    if (!layout_.is_float) {
      const std::uint32_t value =
          layout_.bits == 8 ? std::to_integer<std::uint32_t>(*from) : as<std::uint16_t>(from);
      return (is_data ? data_ : color_)[value];
    }
    if (layout_.bits == 32) return as<float>(from);
    if (layout_.bits == 64) return static_cast<float>(as<double>(from));
    half value;
    value.setBits(as<std::uint16_t>(from));
    return value;
  }

 private:
  template <class T>
  static T as(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
  }

  static float fraction(std::uint32_t value, std::uint32_t largest) {
    return static_cast<float>(static_cast<double>(value) / static_cast<double>(largest));
  }

  Layout layout_;
  const ColorReading& reading_;
  std::vector<float> color_, data_;  ///< of each number of 8 or 16 bits
};

/// Puts raw samples of a rectangle into the image; for planar files, of one channel of it.
struct Placer {
  Image& image;
  const Layout& layout;
  const Decoder& decode;

  /// How many planes of the file the image needs.
  [[nodiscard]] std::uint16_t planes() const {
    return static_cast<std::uint16_t>(layout.is_planar ? image.channel_count() : 1);
  }

  void place(const std::byte* from, std::uint32_t x0, std::uint32_t y, std::uint32_t count,
             std::size_t plane) const {
    const std::size_t together = layout.samples_together();
    for (std::uint32_t x = x0; x < x0 + count; ++x)
      for (std::size_t s = 0; s < together; ++s, from += layout.bytes_per_sample()) {
        const std::size_t c = layout.is_planar ? plane : s;
        image.at(static_cast<int>(x), static_cast<int>(y))[c] = decode(from, layout.is_data(c));
      }
  }
};

/// What libtiff and we hold beside the image: the strip or tile as it is in the file, and for most
/// compressions as it is without; a row or tile of ours.
std::size_t decoder_bytes(const EncodedImage& file, TIFF* tiff) {
  std::uint16_t compression = COMPRESSION_NONE;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
  bool goes_by_rows = false;
  for (const int known : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                          COMPRESSION_DEFLATE, COMPRESSION_PACKBITS})
    goes_by_rows = goes_by_rows || compression == known;
  const bool is_tiled = TIFFIsTiled(tiff) != 0;
  const std::size_t own = is_tiled ? TIFFTileSize64(tiff) : TIFFScanlineSize64(tiff);
  const std::size_t piece = is_tiled ? own : TIFFStripSize64(tiff);
  return checked_sum(file.name,
                     {own, file.bytes.size(), goes_by_rows ? 0 : piece, goes_by_rows ? 0 : piece});
}

void read_scan_lines(const EncodedImage& file, TIFF* tiff, Source& source, const Placer& to) {
  const Layout& layout = to.layout;
  const std::size_t row_bytes =
      layout.width * layout.samples_together() * layout.bytes_per_sample();
  if (TIFFScanlineSize64(tiff) != row_bytes) fail_to_decode(file, "TIFF", "its rows are damaged");
  std::vector<std::byte> row(row_bytes);
  for (std::uint16_t plane = 0; plane < to.planes(); ++plane)
    for (std::uint32_t y = 0; y < layout.height; ++y) {
      if (TIFFReadScanline(tiff, row.data(), y, plane) != 1)
        fail_to_decode(file, "TIFF", source.error);
      to.place(row.data(), 0, y, layout.width, plane);
    }
}

void read_tiles(const EncodedImage& file, TIFF* tiff, Source& source, const Placer& to) {
  const Layout& layout = to.layout;
  std::uint32_t width = 0, height = 0;
  TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
  TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
  constexpr std::uint32_t longest = 1u << 14;
  if (width < 1 || height < 1 || width > longest || height > longest)
    fail_to_decode(
        file, "TIFF",
        "it claims tiles of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  const std::size_t row_bytes = width * layout.samples_together() * layout.bytes_per_sample();
  if (TIFFTileSize64(tiff) != row_bytes * height)
    fail_to_decode(file, "TIFF", "its tiles are damaged");
  std::vector<std::byte> tile(row_bytes * height);
  for (std::uint16_t plane = 0; plane < to.planes(); ++plane)
    for (std::uint32_t y0 = 0; y0 < layout.height; y0 += height)
      for (std::uint32_t x0 = 0; x0 < layout.width; x0 += width) {
        if (TIFFReadTile(tiff, tile.data(), x0, y0, 0, plane) < 0)
          fail_to_decode(file, "TIFF", source.error);
        for (std::uint32_t y = y0; y < std::min(y0 + height, layout.height); ++y)
          to.place(tile.data() + (y - y0) * row_bytes, x0, y, std::min(width, layout.width - x0),
                   plane);
      }
}

}  // namespace

bool is_raw_tiff(const EncodedImage& file) {
  Source source{.bytes = file.bytes, .most_at_once = std::min(most_at_once, file.memory.left)};
  const Handle tiff = open(source);
  if (!tiff) return false;
  const std::uint8_t* version = nullptr;
  if (TIFFGetField(tiff.get(), TIFFTAG_DNGVERSION, &version) == 1) return true;
  std::uint32_t kind = 0;
  std::uint16_t count = 0;
  const std::uint64_t* others = nullptr;
  TIFFGetField(tiff.get(), TIFFTAG_SUBFILETYPE, &kind);
  return (kind & FILETYPE_REDUCEDIMAGE) != 0 &&
         TIFFGetField(tiff.get(), TIFFTAG_SUBIFD, &count, &others) == 1;
}

Image decode_tiff(const EncodedImage& file) {
  Source source{.bytes = file.bytes, .most_at_once = std::min(most_at_once, file.memory.left)};
  const Handle tiff = open(source);
  if (!tiff) fail_to_decode(file, "TIFF", source.error);
  const Layout layout = read_layout(file, tiff.get());
  const std::vector<std::string> names = names_of_samples(layout);
  take_image_memory(file, layout.width, layout.height, names.size(),
                    checked_sum(file.name, {decoder_bytes(file, tiff.get()),
                                            turning_bytes(layout.orientation, layout.width,
                                                          layout.height, names.size())}));
  const bool has_colors = layout.colors > 0;
  const ColorReading reading(file, "TIFF",
                             has_colors ? statement_of_tiff(file, tiff.get()) : ColorStatement{},
                             layout.colors < 3, layout.is_float);
  Image image = make_image(static_cast<int>(layout.width), static_cast<int>(layout.height), names);
  const Decoder decoder(layout, reading);
  const Placer placer{image, layout, decoder};
  if (TIFFIsTiled(tiff.get()))
    read_tiles(file, tiff.get(), source, placer);
  else
    read_scan_lines(file, tiff.get(), source, placer);
  if (has_colors) image = reading.in_rec709(std::move(image));
  return upright(std::move(image), layout.orientation);
}

}  // namespace lamina
