// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/base/plot/plot.h"
#include "lamina/skin/acquire/bands/band_choice.h"

namespace lamina::cli {
namespace {

constexpr int drawn_skins = 30;

struct FiltersOptions {
  CommonOptions common;
  int count = 5;
  double noise = 0.005;
  std::string candidates, population, plot;
  std::vector<std::string> numbers = {"melanin", "melanin_blend", "hemoglobin_epidermis",
                                      "hemoglobin_dermis", "carotene"};
  std::vector<double> compare;
};

/// 400 to 700 nm by 10 nm, or those of a table.
std::vector<CandidateBand> candidates_of(const FiltersOptions& options) {
  std::vector<CandidateBand> bands;
  if (options.candidates.empty()) {
    for (int nm = 400; nm <= 700; nm += 10) bands.push_back({static_cast<double>(nm)});
    return bands;
  }
  MemoryBudget memory = options.common.memory;
  const CsvTable table = load_csv(options.candidates, memory);
  const std::size_t nm = table.column("wavelength_nm");
  const auto width = table.find_column("width_nm");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    CandidateBand band{table.number(row, nm, closed_interval(350.0, 1000.0, "nm"))};
    if (width) band.width = table.number(row, *width, closed_interval(0.0, 200.0, "nm"));
    if (std::ranges::count(bands, band.wavelength, &CandidateBand::wavelength) > 0)
      table.fail(row, nm, "is there twice");
    bands.push_back(band);
  }
  std::ranges::sort(bands, {}, &CandidateBand::wavelength);
  return bands;
}

/// The places of wavelengths that are to be compared.
std::vector<std::size_t> places_of(const std::vector<double>& wavelengths,
                                   const std::vector<CandidateBand>& candidates) {
  std::vector<std::size_t> places;
  for (const double nm : wavelengths) {
    const auto found = std::ranges::find(candidates, nm, &CandidateBand::wavelength);
    if (found == candidates.end())
      throw InvalidInput("--compare: must be of the candidates, but one is " + number_text(nm) +
                         " nm");
    places.push_back(static_cast<std::size_t>(found - candidates.begin()));
  }
  return places;
}

struct NamedRating {
  std::string name;
  BandSetRating rating;
};

std::string bands_text(const BandInformation& information, const BandSetRating& rating) {
  std::string text;
  for (const std::size_t band : rating.bands)
    text += (text.empty() ? "" : " ") + number_text(information.candidates()[band].wavelength);
  return text;
}

std::string deviation_text(double deviation) {
  return std::isfinite(deviation) ? fmt::format("{:.3f}", deviation) : std::string("unknown");
}

std::string table_text(const BandInformation& information, const std::vector<NamedRating>& rows) {
  std::size_t width = 8;
  for (const NamedRating& row : rows)
    if (row.rating.bands.size() <= 12)
      width = std::max(width, bands_text(information, row.rating).size());
  std::string text = fmt::format("{:<14} {:<{}} {:>8}", "", "bands [nm]", width, "score");
  for (const std::string& number : information.numbers())
    text += fmt::format("  {:>{}}", number, std::max<std::size_t>(7, number.size()));
  for (const NamedRating& row : rows) {
    const std::string bands = row.rating.bands.size() <= 12
                                  ? bands_text(information, row.rating)
                                  : fmt::format("{} bands", row.rating.bands.size());
    text += fmt::format("\n{:<14} {:<{}} {:>8}", row.name, bands, width,
                        deviation_text(row.rating.score));
    for (std::size_t n = 0; n < information.numbers().size(); ++n)
      text += fmt::format("  {:>{}}", deviation_text(row.rating.deviations[n]),
                          std::max<std::size_t>(7, information.numbers()[n].size()));
  }
  return text + "\n";
}

JsonOutput rating_json(const BandInformation& information, const NamedRating& row) {
  JsonOutput json = {{"name", row.name}, {"wavelength_nm", JsonOutput::array()}};
  for (const std::size_t band : row.rating.bands)
    json["wavelength_nm"].push_back(information.candidates()[band].wavelength);
  const auto finite = [](double x) {
    return std::isfinite(x) ? JsonOutput(x) : JsonOutput(nullptr);
  };
  json["score"] = finite(row.rating.score);
  for (std::size_t n = 0; n < information.numbers().size(); ++n)
    json["standard_deviation"][information.numbers()[n]] = finite(row.rating.deviations[n]);
  return json;
}

/// How much the light of each candidate changes with each number, for one skin, and which were
/// chosen.
Plot filters_plot(const BandInformation& information, const BandSetRating& best, double noise) {
  std::vector<double> nm;
  for (const CandidateBand& band : information.candidates()) nm.push_back(band.wavelength);
  Plot plot;
  plot.title = fmt::format("The best {} of {} bands", best.bands.size(), nm.size());
  PlotPanel skin, change;
  skin.x = change.x = {.label = "wavelength [nm]"};
  skin.y = {.label = "reflectance"};
  change.y = {.label = "relative change by a number, over the noise"};
  PlotCurve curve{.name = "first skin", .color = palette_color(5)};
  curve.x = nm;
  curve.y = information.reflectance(0);
  PlotCurve chosen{.name = "chosen", .color = palette_color(1), .style = CurveStyle::points};
  for (const std::size_t band : best.bands) {
    chosen.x.push_back(nm[band]);
    chosen.y.push_back(information.reflectance(0)[band]);
  }
  skin.curves = {curve, chosen};
  for (std::size_t n = 0; n < information.numbers().size(); ++n) {
    PlotCurve by{.name = information.numbers()[n], .color = palette_color(n)};
    by.x = nm;
    for (std::size_t c = 0; c < nm.size(); ++c)
      by.y.push_back(information.derivatives(0)(c, n) / noise);
    change.curves.push_back(std::move(by));
  }
  plot.panels = {skin, change};
  plot.caption = fmt::format(
      "Each band known to {} of its reflectance. Changes are by the logarithm of fractions and the "
      "logit of shares.",
      number_text(noise));
  return plot;
}

void run_filters(const FiltersOptions& options) {
  const std::vector<CandidateBand> candidates = candidates_of(options);
  std::optional<SkinPopulation> population;
  if (!options.population.empty())
    population = find_skin_population(options.population, options.common.memory);
  const std::vector<SkinParameters> skins =
      population ? draw_skins(*population, drawn_skins, options.common.seed) : skins_of_choice();
  const Progress progress = make_progress("filters", Keeps::nothing);
  const BandInformation information(candidates, skins, options.numbers, options.noise,
                                    population ? &*population : nullptr);
  std::vector<NamedRating> rows = {{"best", information.choose(options.count, progress)},
                                   {"evenly spaced", information.evenly_spaced(options.count)}};
  if (!options.compare.empty())
    rows.push_back({"compared", information.rate(places_of(options.compare, candidates))});
  std::vector<std::size_t> all;
  for (std::size_t c = 0; c < candidates.size(); ++c) all.push_back(c);
  rows.push_back({"all", information.rate(all)});

  JsonOutput json = make_result("filters");
  json["noise"] = options.noise;
  json["skins"] = skins.size();
  for (const NamedRating& row : rows) json["sets"].push_back(rating_json(information, row));
  if (!options.plot.empty())
    save_svg(filters_plot(information, rows[0].rating, options.noise), options.plot);
  write_json(json, options.common);
  std::string text = table_text(information, rows);
  if (std::isfinite(rows[1].rating.score))
    text += fmt::format("{:.1f} times as well told as by evenly spaced bands\n",
                        rows[1].rating.score / rows[0].rating.score);
  print(options.common, text);
}

}  // namespace

void add_filters_command(CLI::App& app) {
  auto options = std::make_shared<FiltersOptions>();
  const Command command(app, "filters",
                        "Chooses bands in which photographs tell most of skin's pigments.");
  command.add_option("--count", options->count, "how many bands").range(1, 100).show_default();
  command.add_option("--noise", options->noise, "error of each band, of the light that it reflects")
      .range(1e-6, 1.0)
      .show_default();
  command
      .add_option("--candidates", options->candidates,
                  "a table of bands to choose from: wavelength_nm, width_nm; 400 to 700 nm by 10 "
                  "nm if not given")
      .type_name("FILE.csv");
  command
      .add_option("--population", options->population,
                  "what \"forearms\" or a population file knows before, and 30 skins drawn from it "
                  "in place of "
                  "five kinds")
      .type_name("NAME|FILE");
  command.add_option("--numbers", options->numbers, "numbers of skin that are to be told")
      .delimiter(',')
      .type_name("NAME,...");
  command
      .add_option("--compare", options->compare, "bands of the candidates to rate beside the best")
      .delimiter(',')
      .type_name("NM,...");
  command
      .add_output_file("--plot", options->plot,
                       "plot how much light of each band changes with each number", ".svg")
      .type_name("FILE.svg");
  add_common_options(command, options->common);
  command.footer(
      "The score is the root mean square of what the bands leave as errors: relative of fractions, "
      "of the logit of shares.\n\n"
      "Example: five filters, and how good those of a camera are\n"
      "  lamina filters --count 5 --compare 450,540,570,610,650 --plot filters.svg");
  command.callback([options] { run_filters(*options); });
}

}  // namespace lamina::cli
