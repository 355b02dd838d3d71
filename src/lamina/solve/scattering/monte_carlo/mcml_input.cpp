// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <sstream>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

constexpr std::string_view blanks = " \t\r\f\v";

/// Text for messages: printable, cut if long.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 40)) out.push_back(c >= ' ' && c < 127 ? c : '?');
  if (text.size() > 40) out.append("...");
  out.push_back('"');
  return out;
}

/// The data lines of a file, word by word.
class Lines {
 public:
  Lines(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
  }

  /// Goes to the next line with data. @param what  names it, for when the file ends before.
  void next(const std::string& what) {
    while (!rest_.empty()) {
      // Lines end as those of Unix, Windows or old Macs.
      const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(end);
      rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
      ++number_;
      line_ = line_.substr(0, line_.find('#'));
      skip_blanks();
      if (!line_.empty()) return;
    }
    ++number_;
    throw InvalidInput(name_ + ":" + std::to_string(number_) + ": " + what +
                       " is missing: the file ends");
  }

  [[nodiscard]] int number() const { return number_; }

  [[noreturn]] void fail(const std::string& message) const {
    throw InvalidInput(name_ + ":" + std::to_string(number_) + ": " + message);
  }

  /// The next word of the line; empty at its end.
  std::string_view word() {
    const std::string_view found = line_.substr(0, line_.find_first_of(blanks));
    line_.remove_prefix(found.size());
    skip_blanks();
    return found;
  }

  /// A finite number that obeys a rule such as "> 0 [cm]".
  template <class Rule>
  double number(const std::string& field, const std::string& rule, const Rule& holds) {
    const std::string_view text = word();
    if (text.empty()) fail(field + " is missing; it must be a number " + rule);
    const std::optional<double> value = parse(text);
    if (!value || !holds(*value))
      fail(field + " must be a number " + rule + ", but is " + quoted(text));
    return *value;
  }

  std::int64_t whole(const std::string& field, std::int64_t low, std::int64_t high) {
    const std::string rule =
        "in [" + std::to_string(low) + ", " + std::to_string(high) + "] without a fraction";
    const double value = number(field, rule, [&](double x) {
      return x >= static_cast<double>(low) && x <= static_cast<double>(high) && x == std::floor(x);
    });
    return static_cast<std::int64_t>(value);
  }

  /// MCML passes over words after the numbers of a line. Another number is a mistake.
  void end(const std::string& what) {
    const std::string_view text = word();
    if (!text.empty() && parse(text))
      fail(what + ": one number too many on the line, " + quoted(text));
  }

 private:
  void skip_blanks() {
    line_.remove_prefix(std::min(line_.find_first_not_of(blanks), line_.size()));
  }

  static std::optional<double> parse(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      return std::nullopt;
    return value;
  }

  std::string_view rest_, line_;
  std::string name_;
  int number_ = 0;
};

constexpr auto is_positive = [](double x) { return x > 0.0; };
constexpr auto is_not_negative = [](double x) { return x >= 0.0; };
constexpr auto is_mean_cosine = [](double x) { return -1.0 < x && x <= 1.0; };

McmlRun parse_run(Lines& lines, const std::string& which) {
  McmlRun run;
  lines.next(which + ": the name of the output file");
  run.line = lines.number();
  run.output_file = lines.word();
  for (const char c : run.output_file)
    if (static_cast<unsigned char>(c) < 32 || c == 127)
      lines.fail(which + ": the name of the output file must be of printable characters, but is " +
                 quoted(std::string_view(run.output_file)));
  // Without a format it is text: many files leave it out.
  if (const std::string_view format = lines.word();
      !format.empty() && format != "A" && format != "a")
    lines.fail(which + ": the format of the output file must be A (text), but is " +
               quoted(format));
  lines.next(which + ": the number of photons");
  run.photons = static_cast<std::uint64_t>(
      lines.whole(which + ": the number of photons", 1, 1'000'000'000'000'000));
  lines.end(which + ": the number of photons");
  lines.next(which + ": dz and dr");
  run.dz = lines.number(which + ": dz", "> 0 [cm]", is_positive);
  run.dr = lines.number(which + ": dr", "> 0 [cm]", is_positive);
  lines.end(which + ": dz and dr");
  lines.next(which + ": the numbers of bins");
  constexpr std::int64_t most_bins = 1'000'000;
  run.nz = static_cast<int>(lines.whole(which + ": the number of bins in z", 1, most_bins));
  run.nr = static_cast<int>(lines.whole(which + ": the number of bins in r", 1, most_bins));
  run.na = static_cast<int>(lines.whole(which + ": the number of bins in angle", 1, most_bins));
  lines.end(which + ": the numbers of bins");
  lines.next(which + ": the number of layers");
  const auto count = lines.whole(which + ": the number of layers", 1, 10'000);
  lines.end(which + ": the number of layers");
  lines.next(which + ": n above");
  run.n_above = lines.number(which + ": n above", "> 0", is_positive);
  lines.end(which + ": n above");
  for (std::int64_t i = 1; i <= count; ++i) {
    const std::string layer = which + ", layer " + std::to_string(i);
    lines.next(layer);
    McmlRun::Layer values;
    values.n = lines.number(layer + ": n", "> 0", is_positive);
    values.mua = lines.number(layer + ": mua", ">= 0 [1/cm]", is_not_negative);
    values.mus = lines.number(layer + ": mus", ">= 0 [1/cm]", is_not_negative);
    values.g = lines.number(layer + ": g", "in (-1, 1]", is_mean_cosine);
    values.d = lines.number(layer + ": d", "> 0 [cm]", is_positive);
    lines.end(layer);
    run.layers.push_back(values);
  }
  lines.next(which + ": n below");
  run.n_below = lines.number(which + ": n below", "> 0", is_positive);
  lines.end(which + ": n below");
  return run;
}

}  // namespace

std::vector<McmlRun> parse_mcml(std::string_view text, const std::string& name) {
  Lines lines(text, name);
  lines.next("the version of the file");
  const double version = lines.number("the version of the file", "from 1 to below 2",
                                      [](double x) { return x >= 1.0 && x < 2.0; });
  static_cast<void>(version);
  lines.end("the version of the file");
  lines.next("the number of runs");
  const auto count = lines.whole("the number of runs", 1, 1'000'000);
  lines.end("the number of runs");
  std::vector<McmlRun> runs;
  for (std::int64_t i = 1; i <= count; ++i)
    runs.push_back(parse_run(lines, "run " + std::to_string(i)));
  return runs;  // MCML does not read on, either
}

std::vector<McmlRun> load_mcml(const std::filesystem::path& file, MemoryBudget memory) {
  constexpr std::size_t most = std::size_t{64} << 20;
  return parse_mcml(read_stream_bytes(file, std::min(most, memory.left)), file.string());
}

LayerStack layer_stack(const McmlRun& run) {
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < run.layers.size(); ++i) {
    const McmlRun::Layer& given = run.layers[i];
    const bool is_endless = i + 1 == run.layers.size() && given.d >= 1e7;
    const bool is_turned = given.g < 1.0;  // else light goes straight on, as if not scattered
    layers.push_back(
        {.medium = {.sigma_a = given.mua / 10.0,
                    .sigma_s = is_turned ? given.mus / 10.0 : 0.0,
                    .g = is_turned ? given.g : 0.0,
                    .ior = given.n},
         .thickness = is_endless ? std::numeric_limits<double>::infinity() : given.d * 10.0});
  }
  return LayerStack(std::move(layers), run.n_above, run.n_below);
}

MonteCarloOptions monte_carlo_options(const McmlRun& run) {
  MonteCarloOptions options;
  options.photons = run.photons;
  options.tallies.r = {run.nr, run.dr * 10.0};
  options.tallies.depth = {run.nz, run.dz * 10.0};
  options.tallies.angles = run.na;
  options.clear_top_is_specular = true;
  return options;
}

}  // namespace lamina
