// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/photon_formats.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

// Source: MCX's JSON input of 2024 and its schema (mcxinput.json), lengths in voxels of LengthUnit
// mm, coefficients in 1/mm; PyXOpto's mcml, in m and 1/m.

namespace lamina::detail {
namespace {

constexpr int most_voxels = 400, lateral_voxels = 200;

/// Layers as whole voxels. Where a layer is then thicker or thinner than it was, its coefficients
/// are less or more, so that its optical thickness stays.
struct Voxels {
  double size = 0.0;        ///< [mm]
  std::vector<int> counts;  ///< [layer]
  std::vector<Medium> media;
};

/// The depth at which an endless layer ends without being seen: what comes back from there is below
/// 1e-7, or has gone 900 reduced mean free paths.
double depth_of(const Medium& medium) {
  constexpr double lengths = 9.0;
  const double slowest = std::max(sigma_tr(medium), 0.02 * sigma_t_prime(medium));
  return slowest > 0.0 ? lengths / slowest : 1.0;
}

std::vector<double> depths_of(const LayerStack& stack) {
  std::vector<double> depths;
  for (const Layer& layer : stack.layers())
    depths.push_back(std::isfinite(layer.thickness) ? layer.thickness : depth_of(layer.medium));
  return depths;
}

/// The layers in voxels of that size; none if there would be too many. What is below may be cut.
Voxels voxels_of(const LayerStack& stack, std::span<const double> depths, double size) {
  Voxels voxels{.size = size};
  double total = 0.0;
  for (std::size_t l = 0; l < depths.size(); ++l) {
    const Layer& layer = stack.layers()[l];
    const bool is_endless = !std::isfinite(layer.thickness);
    double count = std::max(1.0, std::round(depths[l] / size));
    if (is_endless) count = std::min(count, std::max(1.0, most_voxels - total));
    total += count;
    Medium medium = layer.medium;
    const double ratio = depths[l] / (count * size);
    constexpr double rounding = 1e-12;
    if (!is_endless && std::abs(ratio - 1.0) > rounding) {
      medium.sigma_a *= ratio;
      medium.sigma_s *= ratio;
    }
    voxels.counts.push_back(static_cast<int>(std::min(count, 1e6)));
    voxels.media.push_back(medium);
  }
  return total <= most_voxels ? voxels : Voxels{};
}

/// The layers as MCX has them.
LayerStack written_stack(const LayerStack& stack, const Voxels& voxels) {
  std::vector<Layer> layers;
  for (std::size_t l = 0; l < voxels.counts.size(); ++l)
    layers.push_back({.medium = voxels.media[l], .thickness = voxels.counts[l] * voxels.size});
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_above());
}

/// The voxels whose layers reflect and transmit a normal beam most nearly as the stack does.
Voxels best_voxels(const LayerStack& stack) {
  const AddingDoublingOptions coarse{.accuracy = 1e-4, .max_nodes = 24};
  const std::vector<double> depths = depths_of(stack);
  double sum = 0.0;
  for (const double depth : depths) sum += depth;
  const SlabTotals wanted = adding_doubling(stack, {}, coarse).totals;
  std::vector<double> sizes;
  for (const double depth : depths)
    for (const double parts : {1.0, 2.0, 3.0, 5.0, 10.0, 50.0, 100.0})
      sizes.push_back(depth / parts);
  for (const double parts : {50.0, 100.0, 200.0, 390.0}) sizes.push_back(sum / parts);
  Voxels best;
  double least = std::numeric_limits<double>::infinity();
  for (const double size : sizes) {
    Voxels trial = voxels_of(stack, depths, size);
    if (trial.counts.empty()) continue;
    const SlabTotals totals = adding_doubling(written_stack(stack, trial), {}, coarse).totals;
    double error = std::abs(totals.diffuse_reflectance - wanted.diffuse_reflectance);
    if (!is_semi_infinite(stack)) error += std::abs(totals.transmittance - wanted.transmittance);
    constexpr double as_good = 1e-4;  // then the finer voxels, for R(r)
    const bool is_finer = !best.counts.empty() && trial.size < best.size;
    if (is_finer ? error < least + as_good : error < least - as_good) {
      least = std::min(error, least);
      best = std::move(trial);
    }
  }
  return best;
}

JsonOutput medium_json(double mua, double mus, double g, double n) {
  return {{"mua", mua}, {"mus", mus}, {"g", g}, {"n", n}};
}

JsonOutput band_json(const LayerStack& stack, const Voxels& voxels, const std::string& id) {
  JsonOutput media = JsonOutput::array({medium_json(0.0, 0.0, 1.0, stack.ior_above())});
  JsonOutput layers = JsonOutput::array();
  int first = 1;
  for (std::size_t l = 0; l < voxels.counts.size(); ++l) {
    const Medium& medium = voxels.media[l];
    media.push_back(medium_json(medium.sigma_a, medium.sigma_s, medium.g, medium.ior));
    const int last = first + voxels.counts[l] - 1;
    layers.push_back(JsonOutput::array({first, last, l + 1}));
    first = last + 1;
  }
  const int depth = first - 1;
  constexpr double middle = lateral_voxels / 2.0;
  return {
      {"Session",
       {{"ID", id},
        {"Photons", 10'000'000},
        {"RNGSeed", 1},
        {"DoMismatch", true},
        {"DoAutoThread", true},
        {"DoSaveVolume", true},
        {"DoSaveRef", true},
        {"DoNormalize", true},
        {"DoSpecular", true},
        {"BCFlags", "ccrccr"}}},
      {"Forward", {{"T0", 0.0}, {"T1", 1e-7}, {"Dt", 1e-7}}},
      {"Optode",
       {{"Source",
         {{"Type", "pencil"},
          {"Pos", JsonOutput::array({middle, middle, 0.0})},
          {"Dir", JsonOutput::array({0.0, 0.0, 1.0})}}}}},
      {"Domain",
       {{"OriginType", true},
        {"LengthUnit", voxels.size},
        {"Dim", JsonOutput::array({lateral_voxels, lateral_voxels, depth})},
        {"Media", media}}},
      {"Shapes",
       JsonOutput::array(
           {{{"Grid",
              {{"Tag", 1}, {"Size", JsonOutput::array({lateral_voxels, lateral_voxels, depth})}}}},
            {{"ZLayers", layers}}})}};
}

/// A literal of Python.
std::string python_number(double value) {
  return std::isfinite(value) ? number_text(value) : "float('inf')";
}

std::string pyxopto_text(const ExportInput& input, const std::vector<std::string>& lines) {
  constexpr double m_per_mm = 1e-3;
  std::string text = python_head("PyXOpto", lines);
  text += "material = " + python_literal(input.material.name) + "\n";
  text += "source = " + python_literal(input.material.source) + "\n";
  text +=
      "# Layers for PyXOpto's mcml, in m and 1/m:\n"
      "#   from xopto.mcml import mc\n"
      "#   layers = mc.mclayer.Layers([mc.mclayer.Layer(d=x['d'], n=x['n'], mua=x['mua'], "
      "mus=x['mus'],\n"
      "#                                                pf=mc.mcpf.Hg(x['g'])) for x in "
      "layers[band]])\n"
      "layers = {\n";
  const auto row = [](double d, double n, double mua, double mus, double g) {
    return "        {'d': " + python_number(d) + ", 'n': " + python_number(n) +
           ", 'mua': " + python_number(mua) + ", 'mus': " + python_number(mus) +
           ", 'g': " + python_number(g) + "},\n";
  };
  for (std::size_t b = 0; b < input.stacks.size(); ++b) {
    const LayerStack& stack = input.stacks[b];
    text +=
        "    '" + input.channels.names[b] + "': [\n" + row(0.0, stack.ior_above(), 0.0, 0.0, 0.0);
    for (const Layer& layer : stack.layers())
      text += row(layer.thickness * m_per_mm, layer.medium.ior, layer.medium.sigma_a / m_per_mm,
                  layer.medium.sigma_s / m_per_mm, layer.medium.g);
    text += row(0.0, stack.ior_below(), 0.0, 0.0, 0.0) + "    ],\n";
  }
  return text + "}\n";
}

}  // namespace

ExportedMaterial write_mcx(const ExportInput& input) {
  ExportedMaterial result{.notes = notes_of_photons("MCX", input)};
  std::vector<LayerStack> written;
  bool is_scaled = false;
  for (std::size_t b = 0; b < input.stacks.size(); ++b) {
    const Voxels voxels = best_voxels(input.stacks[b]);
    if (voxels.counts.empty())
      throw InvalidInput("mcx: a material must have at most " + std::to_string(most_voxels) +
                         " layers, but has " + std::to_string(input.stacks[b].layers().size()));
    for (std::size_t l = 0; l < voxels.media.size(); ++l)
      is_scaled |= sigma_t(voxels.media[l]) != sigma_t(input.stacks[b].layers()[l].medium);
    written.push_back(written_stack(input.stacks[b], voxels));
    const std::string id = input.stem + "_" + input.channels.names[b];
    result.files.push_back(
        {id + ".mcx.json", band_json(input.stacks[b], voxels, id).text(1) + "\n"});
  }
  if (std::ranges::any_of(input.stacks, [](const LayerStack& stack) {
        return !is_semi_infinite(stack) && stack.ior_below() != stack.ior_above();
      }))
    result.notes.emplace_back(
        "MCX has the medium above on all sides; that below has another index");
  result.notes.emplace_back(
      "the grid is cyclic to the sides, so that no light is lost there: totals are right, and R(r) "
      "within the grid");
  if (is_scaled)
    result.notes.emplace_back(
        "layers are whole voxels; where one is thicker for that, its coefficients are less, so "
        "that "
        "its optical thickness stays");
  result.notes.emplace_back("not tested in MCX or PyXOpto themselves");
  result.misfits = beam_misfits(input, written);
  std::vector<std::string> lines = {channels_text(input)};
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  result.files.push_back({input.stem + "_pyxopto.py", pyxopto_text(input, lines)});
  return result;
}

}  // namespace lamina::detail
