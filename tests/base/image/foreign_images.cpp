// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "base/image/foreign_images.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>
// In this order: libjpeg's header wants FILE.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on
#include <png.h>
#include <tiffio.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <utility>

namespace lamina {
namespace {

std::string temporary_name(const char* suffix) {
  return testing::TempDir() + "lamina_foreign." + std::to_string(getpid()) + suffix;
}

std::vector<std::byte> take_file(const std::string& name) {
  std::ifstream stream(name, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  std::filesystem::remove(name);
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::vector<std::byte> taken(const Imf::StdOSStream& stream) {
  const std::string text = const_cast<Imf::StdOSStream&>(stream).str();
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

constexpr std::array<const char*, 4> exr_channels = {"B", "G", "R", "normal.X"};

}  // namespace

float ramp(int x, int y, std::size_t channel) {
  return static_cast<float>((x + 2 * y + static_cast<int>(channel)) % 5) * 0.25f;
}

std::vector<std::byte> foreign_exr(int width, int height, ExrKind kind, int compression, int inset,
                                   bool is_float) {
  const Imath::Box2i display({0, 0}, {width - 1, height - 1});
  const Imath::Box2i data({inset, inset}, {width - 1 - inset, height - 1 - inset});
  Imf::Header header(display, data);
  header.compression() = static_cast<Imf::Compression>(compression);
  const Imf::PixelType type = is_float ? Imf::FLOAT : Imf::HALF;
  const auto w = static_cast<std::size_t>(width - 2 * inset);
  const auto h = static_cast<std::size_t>(height - 2 * inset);
  std::vector<std::vector<float>> floats;
  std::vector<std::vector<half>> halves;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < exr_channels.size(); ++c) {
    std::vector<float>& plane = floats.emplace_back();
    for (int y = data.min.y; y <= data.max.y; ++y)
      for (int x = data.min.x; x <= data.max.x; ++x) plane.push_back(ramp(x + 100, y + 100, c));
    halves.emplace_back(plane.begin(), plane.end());
    const void* pixels = is_float ? static_cast<const void*>(floats.back().data())
                                  : static_cast<const void*>(halves.back().data());
    const std::size_t size = is_float ? 4 : 2;
    header.channels().insert(exr_channels[c], Imf::Channel(type));
    buffer.insert(exr_channels[c], Imf::Slice::Make(type, pixels, data, size, size * w));
  }
  Imf::StdOSStream stream;
  if (kind == ExrKind::scan_lines) {
    Imf::OutputFile output(stream, header, 0);
    output.setFrameBuffer(buffer);
    output.writePixels(static_cast<int>(h));
  } else {
    const bool has_mipmaps = kind == ExrKind::mipmaps;
    header.setTileDescription(
        Imf::TileDescription(16, 16, has_mipmaps ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL));
    Imf::TiledOutputFile output(stream, header, 0);
    output.setFrameBuffer(buffer);  // smaller levels repeat a corner of the largest
    for (int level = 0; level < output.numLevels(); ++level)
      output.writeTiles(0, output.numXTiles(level) - 1, 0, output.numYTiles(level) - 1, level);
  }
  return taken(stream);
}

std::vector<std::byte> deep_exr() {
  Imf::Header header(4, 4);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  std::vector<unsigned> counts(16, 1);
  std::vector<float> depths(16, 1.0f);
  std::vector<float*> pointers;
  for (float& depth : depths) pointers.push_back(&depth);
  Imf::StdOSStream stream;
  {
    Imf::DeepScanLineOutputFile output(stream, header, 0);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 16));
    buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()),
                                      sizeof(float*), 4 * sizeof(float*), sizeof(float)));
    output.setFrameBuffer(buffer);
    output.writePixels(4);
  }
  return taken(stream);
}

std::vector<std::byte> chroma_exr() {
  Imf::Header header(4, 4);
  std::vector<half> pixels(16, half(0.5f));
  Imf::FrameBuffer buffer;
  for (const auto& [name, sampling] : {std::pair{"Y", 1}, std::pair{"RY", 2}, std::pair{"BY", 2}}) {
    header.channels().insert(name, Imf::Channel(Imf::HALF, sampling, sampling));
    buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(pixels.data()), 2, 8,
                                   sampling, sampling));
  }
  Imf::StdOSStream stream;
  {
    Imf::OutputFile output(stream, header, 0);
    output.setFrameBuffer(buffer);
    output.writePixels(4);
  }
  return taken(stream);
}

std::vector<std::byte> foreign_png(int width, int height, int color_type, int bits,
                                   bool is_interlaced) {
  constexpr std::array<int, 7> channel_counts = {1, 0, 3, 1, 2, 0, 4};
  const int channels = channel_counts[static_cast<std::size_t>(color_type)];
  const std::uint32_t largest = (1u << bits) - 1u;
  const std::size_t row_bytes = static_cast<std::size_t>((width * channels * bits + 7) / 8);
  std::vector<png_byte> data(row_bytes * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) {
        const double fraction = static_cast<double>(ramp(x, y, static_cast<std::size_t>(c)));
        const std::uint32_t value =
            color_type == 3 ? static_cast<std::uint32_t>((x + y) % 2)
                            : static_cast<std::uint32_t>(std::lround(fraction * largest));
        const std::size_t bit = static_cast<std::size_t>((x * channels + c) * bits);
        png_byte* byte = data.data() + static_cast<std::size_t>(y) * row_bytes + bit / 8;
        if (bits == 16) {
          byte[0] = static_cast<png_byte>(value >> 8);
          byte[1] = static_cast<png_byte>(value & 255);
        } else {
          const std::size_t shift = 8u - static_cast<std::size_t>(bits) - bit % 8;
          *byte = static_cast<png_byte>(*byte | (value << shift));
        }
      }
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y)
    rows.push_back(data.data() + static_cast<std::size_t>(y) * row_bytes);
  std::vector<std::byte> bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep from, std::size_t count) {
        auto& to = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(p));
        const auto* first = reinterpret_cast<const std::byte*>(from);
        to.insert(to.end(), first, first + count);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits,
               color_type, is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
  const png_color palette[2] = {{0, 128, 255}, {255, 128, 0}};
  if (color_type == 3) png_set_PLTE(png, info, palette, 2);
  png_write_info(png, info);
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

namespace {

void append_big_endian(std::vector<std::byte>& to, std::uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) to.push_back(static_cast<std::byte>(value >> (8 * i)));
}

}  // namespace

std::vector<std::byte> with_png_chunk(std::vector<std::byte> png, const std::string& name,
                                      const std::vector<std::byte>& data) {
  std::vector<std::byte> chunk;
  append_big_endian(chunk, static_cast<std::uint32_t>(data.size()), 4);
  const std::vector<std::byte> letters = bytes_of(name);
  chunk.insert(chunk.end(), letters.begin(), letters.end());
  chunk.insert(chunk.end(), data.begin(), data.end());
  append_big_endian(
      chunk,
      static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(chunk.data()) + 4,
                                       static_cast<uInt>(chunk.size() - 4))),
      4);
  constexpr std::ptrdiff_t after_header = 8 + 25;
  png.insert(png.begin() + after_header, chunk.begin(), chunk.end());
  return png;
}

std::vector<std::byte> iccp_of(const std::vector<std::byte>& profile) {
  std::vector<std::byte> data = bytes_of(std::string_view("name\0\0", 6));
  uLongf size = compressBound(static_cast<uLong>(profile.size()));
  std::vector<std::byte> shrunk(size);
  compress(reinterpret_cast<Bytef*>(shrunk.data()), &size,
           reinterpret_cast<const Bytef*>(profile.data()), static_cast<uLong>(profile.size()));
  data.insert(data.end(), shrunk.begin(), shrunk.begin() + static_cast<std::ptrdiff_t>(size));
  return data;
}

std::vector<std::byte> with_jpeg_segment(std::vector<std::byte> jpeg, int marker,
                                         const std::vector<std::byte>& data) {
  std::vector<std::byte> segment = {std::byte{0xFF}, static_cast<std::byte>(marker)};
  append_big_endian(segment, static_cast<std::uint32_t>(data.size() + 2), 2);
  segment.insert(segment.end(), data.begin(), data.end());
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

std::vector<std::byte> with_jpeg_profile(std::vector<std::byte> jpeg,
                                         const std::vector<std::byte>& profile, int pieces) {
  const std::size_t step = profile.size() / static_cast<std::size_t>(pieces) + 1;
  for (int i = 0; i < pieces; ++i) {
    std::vector<std::byte> data = bytes_of(std::string_view("ICC_PROFILE\0", 12));
    data.push_back(static_cast<std::byte>(i + 1));
    data.push_back(static_cast<std::byte>(pieces));
    const std::size_t first = static_cast<std::size_t>(i) * step;
    const std::size_t last = std::min(first + step, profile.size());
    data.insert(data.end(), profile.begin() + static_cast<std::ptrdiff_t>(first),
                profile.begin() + static_cast<std::ptrdiff_t>(last));
    jpeg = with_jpeg_segment(std::move(jpeg), 0xE2, data);
  }
  return jpeg;
}

std::vector<std::byte> foreign_exif(int orientation, int color_space) {
  std::vector<std::byte> exif = bytes_of("MM");
  const auto add = [&](int value, int bytes) {
    append_big_endian(exif, static_cast<std::uint32_t>(value), bytes);
  };
  const auto entry = [&](int tag, int type, int count, int value) {
    add(tag, 2), add(type, 2), add(count, 4);
    if (type == 3)
      add(value, 2), add(0, 2);
    else
      add(value, 4);
  };
  add(42, 2), add(8, 4);
  add(2, 2);  // the first table, at 8
  entry(0x112, 3, 1, orientation);
  entry(0x8769, 4, 1, 8 + 2 + 24 + 4);
  add(0, 4);
  add(2, 2);  // that of the camera, at 38
  entry(0xA001, 3, 1, color_space);
  entry(0xA005, 4, 1, 38 + 2 + 24 + 4);
  add(0, 4);
  add(1, 2);
  add(1, 2), add(2, 2), add(4, 4);
  const std::vector<std::byte> rule =
      bytes_of(std::string_view(color_space == 1 ? "R98\0" : "R03\0", 4));
  exif.insert(exif.end(), rule.begin(), rule.end());
  add(0, 4);
  return exif;
}

std::vector<std::byte> foreign_tiff(int width, int height, const TiffKind& kind) {
  const std::string name = temporary_name(".tif");
  TIFF* tiff = TIFFOpen(name.c_str(), kind.is_big_endian ? "wb" : "wl");
  const bool is_rgb = kind.samples >= 3 && !kind.is_grey;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kind.is_float ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, is_rgb ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG,
               kind.is_planar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
  if (kind.orientation > 0) TIFFSetField(tiff, TIFFTAG_ORIENTATION, kind.orientation);
  if (!kind.profile.empty())
    TIFFSetField(tiff, TIFFTAG_ICCPROFILE, static_cast<std::uint32_t>(kind.profile.size()),
                 kind.profile.data());
  if (kind.samples % 2 == 0 && !kind.is_grey) {
    const std::uint16_t extra = EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra);
  }
  constexpr int tile = 16;
  if (kind.is_tiled) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, tile);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);
  }
  const int planes = kind.is_planar ? kind.samples : 1;
  const int together = kind.is_planar ? 1 : kind.samples;
  const auto row = [&](int x0, int y, int count, int plane) {
    std::vector<std::byte> bytes;
    for (int x = x0; x < x0 + count; ++x)
      for (int c = plane; c < plane + together; ++c) {
        const float value = ramp(x, y, static_cast<std::size_t>(c));
        const auto integer = static_cast<std::uint32_t>(
            std::llround(static_cast<double>(value) * (std::exp2(kind.bits) - 1.0)));
        const std::size_t at = bytes.size();
        bytes.resize(at + static_cast<std::size_t>(kind.bits) / 8);
        const double wide = static_cast<double>(value);
        const std::uint16_t half_bits = half(value).bits();
        const void* from = !kind.is_float    ? static_cast<const void*>(&integer)
                           : kind.bits == 16 ? static_cast<const void*>(&half_bits)
                           : kind.bits == 32 ? static_cast<const void*>(&value)
                                             : static_cast<const void*>(&wide);
        std::memcpy(bytes.data() + at, from, bytes.size() - at);
      }
    return bytes;
  };
  for (int plane = 0; plane < planes; ++plane) {
    if (!kind.is_tiled) {
      for (int y = 0; y < height; ++y)
        TIFFWriteScanline(tiff, row(0, y, width, plane).data(), static_cast<std::uint32_t>(y),
                          static_cast<std::uint16_t>(plane));
      continue;
    }
    for (int y0 = 0; y0 < height; y0 += tile)
      for (int x0 = 0; x0 < width; x0 += tile) {
        std::vector<std::byte> bytes;
        for (int y = y0; y < y0 + tile; ++y) {
          const std::vector<std::byte> line = row(x0, y, tile, plane);
          bytes.insert(bytes.end(), line.begin(), line.end());
        }
        TIFFWriteTile(tiff, bytes.data(), static_cast<std::uint32_t>(x0),
                      static_cast<std::uint32_t>(y0), 0, static_cast<std::uint16_t>(plane));
      }
  }
  TIFFClose(tiff);
  return take_file(name);
}

std::vector<std::byte> foreign_jpeg(int width, int height, int components, bool is_progressive) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &buffer, &size);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = components;
  info.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 100, TRUE);
  for (int c = 0; c < info.num_components; ++c)  // a color at each pixel, not at every second
    info.comp_info[c].h_samp_factor = info.comp_info[c].v_samp_factor = 1;
  if (is_progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<unsigned char> row;
  for (int y = 0; y < height; ++y) {
    row.clear();
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < components; ++c)
        row.push_back(static_cast<unsigned char>(
            std::lround(255.0F * ramp(x, y, static_cast<std::size_t>(c)))));
    JSAMPROW pointer = row.data();
    (void)jpeg_write_scanlines(&info, &pointer, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::vector<std::byte> bytes(size);
  std::memcpy(bytes.data(), buffer, size);
  std::free(buffer);
  return bytes;
}

std::vector<std::byte> foreign_hdr(int width, int height, HdrRows rows, const std::string& lines) {
  std::string text = "#?RADIANCE\n" + lines + "FORMAT=32-bit_rle_rgbe\n\n-Y " +
                     std::to_string(height) + " +X " + std::to_string(width) + "\n";
  for (int y = 0; y < height; ++y) {
    std::vector<std::array<unsigned char, 4>> row;
    for (int x = 0; x < width; ++x) {
      std::array<unsigned char, 4> pixel = {0, 0, 0, 129};  // an exponent of 1: steps of 1 / 128
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<unsigned char>(std::lround(128.0F * ramp(x / 3, y, c)));
      row.push_back(pixel);
    }
    if (rows == HdrRows::runs) {
      text += {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
      for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t x = 0; x < row.size();) {
          std::size_t end = x + 1;
          while (end < row.size() && row[end][c] == row[x][c]) ++end;
          if (end - x > 1) {
            text += static_cast<char>(128 + (end - x));
          } else {
            text += static_cast<char>(1);
          }
          text += static_cast<char>(row[x][c]);
          x = end;
        }
      continue;
    }
    for (std::size_t x = 0; x < row.size(); ++x) {
      std::size_t end = x + 1;
      while (end < row.size() && row[end] == row[x]) ++end;
      for (const unsigned char part : row[x]) text += static_cast<char>(part);
      if (rows == HdrRows::old_runs && end - x > 1) {
        text += {1, 1, 1, static_cast<char>(end - x - 1)};
        x = end - 1;
      }
    }
  }
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

}  // namespace lamina
