// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/envi_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/reading_warnings.h"
#include "lamina/base/io/utf8_text.h"

namespace lamina {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// `key = value` and `key = {several, values}`, the latter over any number of lines.
class Entries {
 public:
  Entries(std::string_view text, const std::string& name) : name_(name) {
    std::string_view first = take_line(text);
    if (trimmed(first) != "ENVI")
      throw FileError(name + ": must be an ENVI header, whose first line is ENVI");
    for (int line = 2; !text.empty(); ++line) {
      const int started = line;
      std::string whole(take_line(text));
      if (trimmed(whole).empty() || trimmed(whole).front() == ';') continue;
      const std::size_t equals = whole.find('=');
      const auto fail = [&](const std::string& why) {
        throw FileError(name + ":" + std::to_string(started) + ": " + why);
      };
      if (equals == std::string::npos) fail("must be KEY = VALUE");
      const std::string key = lower_case(trimmed(std::string_view(whole).substr(0, equals)));
      std::string value(trimmed(std::string_view(whole).substr(equals + 1)));
      if (!value.empty() && value.front() == '{') {
        for (bool is_closed = value.find('}') != std::string::npos; !is_closed; ++line) {
          if (text.empty()) fail(key + " has no closing }");
          const std::string_view next = take_line(text);
          is_closed = next.find('}') != std::string_view::npos;
          (value += '\n') += next;
        }
        value = value.substr(1, value.find('}') - 1);
      }
      if (!values_.emplace(key, std::string(trimmed(value))).second) fail(key + " is there twice");
    }
  }

  [[noreturn]] void fail(const std::string& why) const { throw FileError(name_ + ": " + why); }
  void warn(const std::string& what) const { warn_of_file(name_ + ": " + what); }

  [[nodiscard]] const std::string* find(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? nullptr : &found->second;
  }

  [[nodiscard]] std::uint64_t integer(const std::string& key, std::uint64_t low, std::uint64_t high,
                                      std::optional<std::uint64_t> otherwise = {}) const {
    const std::string* text = find(key);
    if (!text && otherwise) return *otherwise;
    if (!text) fail(key + " is missing");
    std::uint64_t value = 0;
    const char* end = text->data() + text->size();
    const auto [at, error] = std::from_chars(text->data(), end, value);
    if (error != std::errc() || at != end || value < low || value > high)
      fail(key + " must be a whole number from " + std::to_string(low) + " to " +
           std::to_string(high) + ", but is " + excerpt(*text));
    return value;
  }

  [[nodiscard]] double number(const std::string& key, std::string_view text) const {
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || at != end || !std::isfinite(value))
      fail(key + " must be a number, but is " + excerpt(text));
    return value;
  }

  /// The values between commas; absent if there is no such key.
  [[nodiscard]] std::vector<std::string> list(const std::string& key, std::size_t count) const {
    const std::string* text = find(key);
    if (!text) return {};
    std::vector<std::string> values;
    std::string_view rest = *text;
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
      comma = rest.find(',');
      values.emplace_back(trimmed(rest.substr(0, comma)));
      if (comma != std::string_view::npos) rest.remove_prefix(comma + 1);
    }
    if (values.size() != count)
      fail(key + " must have one value for each of the " + std::to_string(count) +
           " bands, but has " + std::to_string(values.size()));
    return values;
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& key, std::size_t count) const {
    std::vector<double> values;
    for (const std::string& text : list(key, count)) values.push_back(number(key, text));
    return values;
  }

 private:
  static std::string_view take_line(std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
  }

  std::string name_;
  std::map<std::string, std::string> values_;
};

/// Nanometers in the file's unit of wavelengths. Where it says none, numbers below 100 are
/// micrometers: 0.1 to 100 um are 100 to 100 000 nm, and there is no light of less than 100 nm
/// here.
double nanometers(const Entries& entries, const std::vector<double>& wavelengths) {
  const std::string* given = entries.find("wavelength units");
  const std::string unit = given ? lower_case(*given) : "";
  for (const std::string_view name : {"nanometers", "nanometer", "nanometres", "nm"})
    if (unit == name) return 1.0;
  for (const std::string_view name :
       {"micrometers", "micrometer", "micrometres", "microns", "um", "\u00b5m", "\u03bcm"})
    if (unit == name) return 1000.0;
  if (!unit.empty() && unit != "unknown")
    entries.fail("wavelength units must be Nanometers or Micrometers, but is " + excerpt(*given));
  constexpr double least_nanometers = 100.0;
  const auto [low, high] = std::ranges::minmax(wavelengths);
  const bool are_micrometers = high < least_nanometers;
  if (!are_micrometers && low < least_nanometers)
    entries.fail("wavelength units are missing, and wavelengths from " + number_text(low) + " to " +
                 number_text(high) + " may have any");
  entries.warn("does not say its wavelength units: wavelengths from " + number_text(low) + " to " +
               number_text(high) + " are taken for " +
               (are_micrometers ? "micrometers" : "nanometers"));
  return are_micrometers ? 1000.0 : 1.0;
}

void read_bands(const Entries& entries, EnviHeader& header) {
  header.wavelengths = entries.numbers("wavelength", header.bands);
  header.widths = entries.numbers("fwhm", header.bands);
  header.names = entries.list("band names", header.bands);
  for (const double flag : entries.numbers("bbl", header.bands))
    header.is_bad.push_back(flag == 0.0);
  if (header.wavelengths.empty()) {
    header.widths.clear();  // without a unit
    return;
  }
  const double unit = nanometers(entries, header.wavelengths);
  for (double& nm : header.wavelengths) {
    nm = std::round(nm * unit * 1e6) / 1e6;  // 0.54 um is 540 nm
    if (!(nm > 0.0)) entries.fail("wavelength must be > 0, but is " + number_text(nm));
  }
  for (double& nm : header.widths) {
    nm *= unit;
    if (nm < 0.0) entries.fail("fwhm must be >= 0, but is " + number_text(nm));
  }
}

}  // namespace

std::size_t envi_number_size(const EnviHeader& header) {
  switch (header.data_type) {
    case 1:
      return 1;
    case 2:
    case 12:
      return 2;
    case 5:
      return 8;
    default:
      return 4;
  }
}

std::string envi_channel_name(const EnviHeader& header, std::size_t band) {
  if (!header.wavelengths.empty()) return number_text(header.wavelengths[band]) + "nm";
  if (!header.names.empty() && !header.names[band].empty()) return header.names[band];
  return "band " + std::to_string(band + 1);
}

EnviHeader parse_envi_header(std::string_view text, const std::string& name) {
  constexpr std::size_t longest_text = std::size_t{1} << 24;
  if (text.size() > longest_text) throw FileError(name + ": is too long for an ENVI header");
  const Entries entries(text, name);
  constexpr std::uint64_t longest_side = std::uint64_t{1} << 20, most_bands = 1u << 14;
  EnviHeader header;
  header.samples = entries.integer("samples", 1, longest_side);
  header.lines = entries.integer("lines", 1, longest_side);
  header.bands = entries.integer("bands", 1, most_bands);
  header.offset = entries.integer("header offset", 0, std::uint64_t{1} << 40, 0);
  header.data_type = static_cast<int>(entries.integer("data type", 0, 99));
  constexpr std::array known = {1, 2, 3, 4, 5, 12, 13};
  if (std::ranges::find(known, header.data_type) == known.end())
    entries.fail(
        "data type must be 1, 2, 3, 4, 5, 12 or 13 (real numbers of up to 32 bits, or "
        "64 bit floating point), but is " +
        std::to_string(header.data_type));
  header.is_big_endian = entries.integer("byte order", 0, 1, 0) == 1;
  if (!entries.find("byte order") && header.data_type != 1)
    entries.warn("does not say its byte order, which is taken for 0, the least significant first");
  const std::string* interleave = entries.find("interleave");
  const std::string order = interleave ? lower_case(*interleave) : header.bands == 1 ? "bsq" : "";
  if (order != "bsq" && order != "bil" && order != "bip")
    entries.fail("interleave must be bsq, bil or bip, but is " +
                 (interleave ? excerpt(*interleave) : std::string("missing")));
  header.interleave = order == "bsq"   ? EnviInterleave::bsq
                      : order == "bil" ? EnviInterleave::bil
                                       : EnviInterleave::bip;
  const std::string* type = entries.find("file type");
  if (type && !lower_case(*type).starts_with("envi"))
    entries.fail("file type must be ENVI Standard, but is " + excerpt(*type));
  const std::string* compression = entries.find("file compression");
  if (compression && *compression != "0") entries.fail("file compression must be 0 (none)");
  if (const std::string* scale = entries.find("reflectance scale factor"))
    header.scale = entries.number("reflectance scale factor", *scale);
  if (!(header.scale > 0.0))
    entries.fail("reflectance scale factor must be > 0, but is " + number_text(header.scale));
  if (const std::string* ignored = entries.find("data ignore value"))
    header.ignored = entries.number("data ignore value", *ignored);
  read_bands(entries, header);
  return header;
}

}  // namespace lamina
