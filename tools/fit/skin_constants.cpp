// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Fits the constants "calibrated_diffusion" of skin to measured spectra: five fractions for each
// person and four constants for all of them, by the closed form of layered diffusion.
//
//   skin_constants SPECTRA.csv
//
// of [Cooksey2017], doi 10.18434/M38597: nm, then three columns of total reflectance per person.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "lamina/layers/materials/skin.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

namespace {

using namespace lamina;

struct Free {
  double SkinParameters::*value;
  double low, high, step;  ///< of finite differences
};

constexpr std::array<Free, 5> fractions = {
    {{&SkinParameters::melanin, 0.0, 0.5, 1e-5},
     {&SkinParameters::melanin_blend, 0.0, 1.0, 1e-4},
     {&SkinParameters::hemoglobin_epidermis, 0.0, 0.05, 1e-6},
     {&SkinParameters::carotene, 0.0, 0.05, 1e-6},
     {&SkinParameters::hemoglobin_dermis, 0.0, 0.1, 1e-6}}};
constexpr std::array<Free, 4> constants = {{{&SkinParameters::baseline_scale, 0.0, 5.0, 1e-4},
                                            {&SkinParameters::scattering_scale, 0.3, 3.0, 1e-4},
                                            {&SkinParameters::scattering_power, -1.5, 1.5, 1e-4},
                                            {&SkinParameters::saturation_dermis, 0.0, 1.0, 1e-4}}};

struct Spectra {
  std::vector<double> wavelengths;
  std::vector<Eigen::VectorXd> reflectance;  ///< [person][wavelength] mean of three
};

Spectra load(const char* file) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::atof(cell.c_str()));
    const bool is_whole = rows.empty() ? !row.empty() : row.size() == rows[0].size();
    if (is_whole && row[0] >= 400.0 && row[0] <= 700.0) rows.push_back(row);
  }
  Spectra spectra;
  for (std::size_t i = 0; i < rows.size(); i += 2) spectra.wavelengths.push_back(rows[i][0]);
  for (std::size_t c = 1; !rows.empty() && c + 2 < rows[0].size(); c += 3) {
    Eigen::VectorXd& mean = spectra.reflectance.emplace_back(spectra.wavelengths.size());
    for (Eigen::Index i = 0; i < mean.size(); ++i) {
      const std::vector<double>& row = rows[2 * static_cast<std::size_t>(i)];
      mean[i] = (row[c] + row[c + 1] + row[c + 2]) / 3.0;
    }
  }
  return spectra;
}

/// Both saturations are one constant.
std::vector<LayerStack> stacks(SkinParameters skin, const std::vector<double>& wavelengths) {
  skin.saturation_epidermis = skin.saturation_dermis;
  std::vector<LayerStack> result;
  for (const double nm : wavelengths) result.push_back(skin_layer_stack(skin, nm));
  return result;
}

/// Mirror reflection included, as the spectra have it.
Eigen::VectorXd by_diffusion(const SkinParameters& skin, const std::vector<double>& wavelengths) {
  const auto models = make_layered_diffusion(stacks(skin, wavelengths));
  const double mirror = fresnel(1.0, 1.4);
  Eigen::VectorXd result(static_cast<Eigen::Index>(models.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result[i] = mirror + (1.0 - mirror) *
                             response(models[static_cast<std::size_t>(i)], 0.0).reflection_above;
  return result;
}

/// Columns: derivatives by some parameters, forward where that is in range.
template <std::size_t N>
Eigen::MatrixXd derivatives(const SkinParameters& skin, const std::array<Free, N>& by,
                            const std::vector<double>& wavelengths, const Eigen::VectorXd& now) {
  Eigen::MatrixXd result(now.size(), static_cast<Eigen::Index>(N));
  for (std::size_t p = 0; p < N; ++p) {
    SkinParameters other = skin;
    const double step = skin.*by[p].value + by[p].step <= by[p].high ? by[p].step : -by[p].step;
    other.*by[p].value += step;
    result.col(static_cast<Eigen::Index>(p)) = (by_diffusion(other, wavelengths) - now) / step;
  }
  return result;
}

template <std::size_t N>
void move(SkinParameters& skin, const std::array<Free, N>& which, const Eigen::VectorXd& by) {
  for (std::size_t p = 0; p < N; ++p)
    skin.*which[p].value = std::clamp(skin.*which[p].value + by[static_cast<Eigen::Index>(p)],
                                      which[p].low, which[p].high);
}

/// People at a bound of a fraction that they would cross stay there.
void hold_at_bounds(const SkinParameters& skin, const Eigen::VectorXd& error,
                    Eigen::MatrixXd& own) {
  for (std::size_t p = 0; p < fractions.size(); ++p) {
    const auto column = static_cast<Eigen::Index>(p);
    const double value = skin.*fractions[p].value, slope = own.col(column).dot(error);
    if ((value <= fractions[p].low && slope > 0.0) || (value >= fractions[p].high && slope < 0.0))
      own.col(column).setZero();
  }
}

double squares(const std::vector<SkinParameters>& people, const Spectra& spectra) {
  double sum = 0.0;
  for (std::size_t i = 0; i < people.size(); ++i)
    sum += (by_diffusion(people[i], spectra.wavelengths) - spectra.reflectance[i]).squaredNorm();
  return sum;
}

/// Levenberg and Marquardt's steps for all parameters at once; those of a person meet others only
/// through the constants, so the normal equations reduce to theirs.
/// @param moves_constants  false: fits the fractions only
double fit(std::vector<SkinParameters>& people, const Spectra& spectra, bool moves_constants) {
  constexpr Eigen::Index shared = constants.size();
  double damping = 1e-3, now = squares(people, spectra);
  for (int iteration = 0; iteration < 200 && damping < 1e9; ++iteration) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(shared, shared);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(shared);
    std::vector<Eigen::MatrixXd> from_shared;
    std::vector<Eigen::VectorXd> alone;
    for (std::size_t i = 0; i < people.size(); ++i) {
      const Eigen::VectorXd seen = by_diffusion(people[i], spectra.wavelengths);
      const Eigen::VectorXd error = seen - spectra.reflectance[i];
      Eigen::MatrixXd own = derivatives(people[i], fractions, spectra.wavelengths, seen);
      hold_at_bounds(people[i], error, own);
      Eigen::MatrixXd all = Eigen::MatrixXd::Zero(error.size(), shared);
      if (moves_constants) all = derivatives(people[i], constants, spectra.wavelengths, seen);
      Eigen::MatrixXd inner = own.transpose() * own;
      inner.diagonal() *= 1.0 + damping;
      inner.diagonal().array() += 1e-14;
      const Eigen::LDLT<Eigen::MatrixXd> solver(inner);
      const Eigen::MatrixXd cross = own.transpose() * all;
      from_shared.push_back(solver.solve(cross));
      alone.push_back(solver.solve(own.transpose() * error));
      H += all.transpose() * all - cross.transpose() * from_shared.back();
      b += all.transpose() * error - cross.transpose() * alone.back();
    }
    H.diagonal() *= 1.0 + damping;
    H.diagonal().array() += 1e-14;
    const Eigen::VectorXd step = -H.ldlt().solve(b);
    std::vector<SkinParameters> moved = people;
    for (std::size_t i = 0; i < people.size(); ++i) {
      move(moved[i], constants, step);
      move(moved[i], fractions, -alone[i] - from_shared[i] * step);
    }
    const double then = squares(moved, spectra);
    if (then >= now) {
      damping *= 10.0;
      continue;
    }
    const bool is_done = now - then < 1e-7 * now;
    people = std::move(moved);
    now = then;
    damping = std::max(1e-9, 0.2 * damping);
    if (is_done) break;
  }
  return now;
}

/// Reflectance of skin of the same fractions by diffusion with a set of constants, over that by
/// adding-doubling with those made for it; mean over wavelengths and every fifth person.
double brightness(const std::vector<SkinParameters>& people, const SkinParameters& set,
                  const std::vector<double>& wavelengths) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < people.size(); i += 5) {
    SkinParameters ours = people[i];
    for (const Free& constant : constants) ours.*constant.value = set.*constant.value;
    const Eigen::VectorXd by_us = by_diffusion(ours, wavelengths);
    const auto solid = stacks(with_constants(people[i], SkinConstants::calibrated), wavelengths);
    for (std::size_t w = 0; w < wavelengths.size(); ++w, ++count) {
      const SlabTotals exact = adding_doubling(solid[w]).totals;
      sum += (by_us[static_cast<Eigen::Index>(w)] - exact.specular_reflectance) /
             exact.diffuse_reflectance;
    }
  }
  return sum / count;
}

void report(const char* name, const std::vector<SkinParameters>& people, const Spectra& spectra,
            double brighter) {
  std::vector<double> rms;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const Eigen::VectorXd error =
        by_diffusion(people[i], spectra.wavelengths) - spectra.reflectance[i];
    rms.push_back(std::sqrt(error.squaredNorm() / static_cast<double>(error.size())));
  }
  std::ranges::sort(rms);
  const auto median = [&](double SkinParameters::*value) {
    std::vector<double> values;
    for (const SkinParameters& skin : people) values.push_back(skin.*value);
    std::ranges::sort(values);
    return values[values.size() / 2];
  };
  const SkinParameters& any = people[0];
  std::printf(
      "| %s | %.3f | %.3f | %.3f | %.2f | %.4f | %.4f | %.4f | %.2f | %.4f | %.4f | %.4f | %.2f "
      "|\n",
      name, any.saturation_dermis, any.baseline_scale, any.scattering_scale, any.scattering_power,
      rms[rms.size() / 2], rms[rms.size() * 95 / 100], median(&SkinParameters::melanin),
      median(&SkinParameters::melanin_blend), median(&SkinParameters::hemoglobin_epidermis),
      median(&SkinParameters::carotene), median(&SkinParameters::hemoglobin_dermis), brighter);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Spectra spectra = argc == 2 ? load(argv[1]) : Spectra{};
  if (spectra.reflectance.empty()) {
    std::fprintf(stderr, "usage: skin_constants SPECTRA.csv; columns: nm, three per person\n");
    return 2;
  }
  std::printf(
      "| constants | saturation | baseline | scattering | power | RMS, median | 95 %% | melanin | "
      "blend | blood in epidermis | carotene | blood in dermis | to exact, same fractions |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const auto fitted = [&](SkinConstants set, bool moves_constants) {
    std::vector<SkinParameters> people(spectra.reflectance.size(),
                                       with_constants({.melanin = 0.02}, set));
    fit(people, spectra, moves_constants);
    return people;
  };
  const auto by_calibrated = fitted(SkinConstants::calibrated, false);
  for (const auto& [name, set, moves_constants] :
       {std::tuple{"paper", SkinConstants::paper, false},
        std::tuple{"calibrated", SkinConstants::calibrated, false},
        std::tuple{"calibrated_diffusion", SkinConstants::calibrated_diffusion, false},
        std::tuple{"fitted from there", SkinConstants::calibrated_diffusion, true},
        std::tuple{"fitted from calibrated", SkinConstants::calibrated, true}}) {
    const auto people = fitted(set, moves_constants);
    report(name, people, spectra, brightness(by_calibrated, people[0], spectra.wavelengths));
  }
}
