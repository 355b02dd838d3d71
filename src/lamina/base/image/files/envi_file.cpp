// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/envi_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <span>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// The file of the numbers beside a header.
fs::path envi_data_file(const fs::path& header_file) {
  std::vector<fs::path> candidates = {fs::path(header_file).replace_extension()};
  for (const char* extension : {".raw", ".img", ".dat", ".bin", ".bsq", ".bil", ".bip"})
    candidates.push_back(fs::path(header_file).replace_extension(extension));
  for (const fs::path& candidate : candidates) {
    std::error_code ignored;
    if (candidate != header_file && fs::is_regular_file(candidate, ignored)) return candidate;
  }
  throw FileError(header_file.string() + ": its numbers must be beside it in " +
                  candidates[0].filename().string() +
                  " or that name with .raw, .img, .dat, .bin, " +
                  ".bsq, .bil or .bip, but there is no such file");
}

/// Numbers of a file as floats over its scale, a run at a time.
class EnviNumbers {
 public:
  EnviNumbers(const fs::path& file, const EnviHeader& header)
      : file_(file.string()), header_(header), stream_(file, std::ios::binary) {
    const std::size_t bytes =
        checked_sum(file_, {header.offset, checked_product(file_, {header.samples, header.lines,
                                                                   header.bands, number_size_})});
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (error || !stream_) throw FileError(file_ + ": cannot be read");
    if (size != bytes)
      throw FileError(file_ + ": must have " + std::to_string(bytes) +
                      " bytes, as its header says (" + std::to_string(header.samples) + " x " +
                      std::to_string(header.lines) + " pixels, " + std::to_string(header.bands) +
                      " bands of " + std::to_string(number_size_) + " bytes), but has " +
                      std::to_string(size));
  }

  /// `count` numbers from the one at this place on; valid until the next call.
  [[nodiscard]] std::span<const float> read(std::size_t place, std::size_t count) {
    bytes_.resize(count * number_size_);
    numbers_.resize(count);
    stream_.seekg(static_cast<std::streamoff>(header_.offset + place * number_size_));
    stream_.read(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    if (!stream_) throw FileError(file_ + ": cannot be read to its end");
    for (std::size_t i = 0; i < count; ++i) {
      const double value = number(bytes_.data() + i * number_size_);
      numbers_[i] = header_.ignored == value ? std::numeric_limits<float>::quiet_NaN()
                                             : static_cast<float>(value / header_.scale);
    }
    return numbers_;
  }

 private:
  [[nodiscard]] double number(const char* from) const {
    switch (header_.data_type) {
      case 1:
        return as<std::uint8_t>(from);
      case 2:
        return as<std::int16_t>(from);
      case 3:
        return as<std::int32_t>(from);
      case 4:
        return static_cast<double>(as<float>(from));
      case 5:
        return as<double>(from);
      case 12:
        return as<std::uint16_t>(from);
      default:
        return as<std::uint32_t>(from);
    }
  }

  template <class T>
  [[nodiscard]] T as(const char* from) const {
    std::array<char, sizeof(T)> bytes;
    std::copy_n(from, sizeof(T), bytes.begin());
    if (header_.is_big_endian != (std::endian::native == std::endian::big))
      std::ranges::reverse(bytes);
    return std::bit_cast<T>(bytes);
  }

  std::string file_;
  const EnviHeader& header_;
  std::size_t number_size_ = envi_number_size(header_);
  std::ifstream stream_;
  std::vector<char> bytes_;
  std::vector<float> numbers_;
};

/// A band of the file, the channel that it is added to, and its weight there.
struct Contribution {
  std::size_t band, channel;
  float weight;
};

struct EnviPlan {
  std::vector<std::string> channels;
  std::vector<Contribution> contributions;
};

EnviPlan plan_of(const EnviHeader& header, const EnviSelection& selection,
                 const std::string& name) {
  EnviPlan plan;
  for (const EnviBand& wanted : selection.bands) {
    const auto [bands, weights] = envi_band_weights(header, wanted, name);
    for (std::size_t i = 0; i < bands.size(); ++i)
      plan.contributions.push_back(
          {bands[i], plan.channels.size(), static_cast<float>(weights[i])});
    plan.channels.push_back(wanted.shape == EnviBandShape::nearest
                                ? envi_channel_name(header, bands[0])
                                : number_text(wanted.wavelength) + "nm");
  }
  for (std::size_t band = 0; selection.bands.empty() && band < header.bands; ++band) {
    if (!header.is_bad.empty() && header.is_bad[band]) continue;
    plan.contributions.push_back({band, plan.channels.size(), 1.0f});
    plan.channels.push_back(envi_channel_name(header, band));
  }
  if (plan.channels.empty()) throw FileError(name + ": bbl leaves no band");
  std::set<std::string> names;
  for (const std::string& channel : plan.channels)
    if (!names.insert(channel).second)
      throw FileError(name + ": two channels would be called " + channel);
  return plan;
}

/// Adds the numbers of a row, one of each pixel and `stride` apart, to a channel.
void add_row(std::span<const float> numbers, std::size_t first, std::size_t stride,
             const Contribution& to, float* pixels, std::size_t channels, std::size_t count) {
  for (std::size_t x = 0; x < count; ++x)
    pixels[x * channels + to.channel] += to.weight * numbers[first + x * stride];
}

}  // namespace

EnviBandWeights envi_band_weights(const EnviHeader& header, const EnviBand& band,
                                  const std::string& name) {
  const std::string place = name + ": a band at " + number_text(band.wavelength) + " nm";
  if (header.wavelengths.empty())
    throw InvalidInput(place + " is asked for, but the file names no wavelengths");
  const bool is_nearest = band.shape == EnviBandShape::nearest;
  if (!std::isfinite(band.wavelength) || !std::isfinite(band.width) ||
      (!is_nearest && band.width <= 0.0))
    throw InvalidInput(place + " must have a width > 0 nm, but has " + number_text(band.width));
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < header.bands; ++i)
    if (header.is_bad.empty() || !header.is_bad[i]) order.push_back(i);
  const auto nm = [&](std::size_t i) { return header.wavelengths[order[i]]; };
  std::ranges::sort(order, {}, [&](std::size_t i) { return header.wavelengths[i]; });
  if (order.empty()) throw InvalidInput(place + " is asked for, but all are bad");
  const auto spacing = [&](std::size_t i) {  // half the way between the neighbours
    const std::size_t low = i == 0 ? 0 : i - 1, high = std::min(i + 1, order.size() - 1);
    return low == high ? 1.0 : (nm(high) - nm(low)) / static_cast<double>(high - low);
  };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < order.size(); ++i)
    if (std::abs(nm(i) - band.wavelength) < std::abs(nm(nearest) - band.wavelength)) nearest = i;
  const double reach = std::max(spacing(nearest), is_nearest ? 0.0 : 0.5 * band.width);
  if (std::abs(nm(nearest) - band.wavelength) > reach)
    throw InvalidInput(place + " is asked for, but the nearest is at " + number_text(nm(nearest)) +
                       " nm");
  if (is_nearest) return {{order[nearest]}, {1.0}};
  EnviBandWeights result;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double away = std::abs(nm(i) - band.wavelength) / band.width;
    const double weight = band.shape == EnviBandShape::box
                              ? (away <= 0.5 ? 1.0 : 0.0)
                              : std::exp2(-4.0 * away * away);  // 1/2 at half the width
    if (weight < 1e-4) continue;
    result.bands.push_back(order[i]);
    result.weights.push_back(weight * spacing(i));
  }
  const double sum = std::accumulate(result.weights.begin(), result.weights.end(), 0.0);
  if (!(sum > 0.0)) return {{order[nearest]}, {1.0}};  // narrower than the file's own bands
  for (double& weight : result.weights) weight /= sum;
  return result;
}

EnviHeader load_envi_header(const fs::path& header_file, MemoryBudget& memory) {
  const std::string text = read_file_bytes(header_file, memory);
  memory.left += text.size();  // which end here
  return parse_envi_header(text, header_file.string());
}

Image load_envi(const fs::path& header_file, const EnviSelection& selection, MemoryBudget& memory) {
  const std::string name = header_file.string();
  const EnviHeader header = load_envi_header(header_file, memory);
  const EnviPlan plan = plan_of(header, selection, name);
  const PixelRectangle whole{0, 0, static_cast<int>(header.samples),
                             static_cast<int>(header.lines)};
  const PixelRectangle area = selection.rectangle.value_or(whole);
  require_inside(area, whole.width, whole.height, name + ": the rectangle to read");
  EnviNumbers numbers(envi_data_file(header_file), header);

  const auto width = static_cast<std::size_t>(area.width);
  const bool is_pixelwise = header.interleave == EnviInterleave::bip;
  const std::size_t run = is_pixelwise ? checked_product(name, {width, header.bands}) : width;
  const std::size_t channels = plan.channels.size();
  take_memory(
      memory,
      checked_sum(name, {checked_product(name, {width, static_cast<std::size_t>(area.height),
                                                channels, sizeof(float)}),
                         checked_product(name, {run, 12})}),
      name);
  memory.left += run * 12;
  Image image = make_image(area.width, area.height, plan.channels);
  for (int row = 0; row < area.height; ++row) {
    const auto y = static_cast<std::size_t>(area.y + row), x = static_cast<std::size_t>(area.x);
    float* to = image.at(0, row);
    if (is_pixelwise) {
      const std::span<const float> all = numbers.read((y * header.samples + x) * header.bands, run);
      for (const Contribution& each : plan.contributions)
        add_row(all, each.band, header.bands, each, to, channels, width);
      continue;
    }
    for (const Contribution& each : plan.contributions) {
      const std::size_t line = header.interleave == EnviInterleave::bsq
                                   ? each.band * header.lines + y
                                   : y * header.bands + each.band;
      add_row(numbers.read(line * header.samples + x, run), 0, 1, each, to, channels, width);
    }
  }
  return image;
}

}  // namespace lamina
