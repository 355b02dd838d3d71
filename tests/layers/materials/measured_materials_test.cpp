// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Sand, dust and varnish beside what is published of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/pigments.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/mie.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

double reflectance_of(const LayerStack& stack) {
  return adding_doubling(stack, {}, {.accuracy = 1e-5}).totals.diffuse_reflectance;
}

std::vector<double> reflectances(const Material& material) {
  std::vector<double> all;
  for (const LayerStack& stack : layer_stacks(material)) all.push_back(reflectance_of(stack));
  return all;
}

Lab color(const std::string& name) {
  const Material material = find_material(name);
  return lab(linear_srgb(make_band_weights(material.bands), reflectances(material)));
}

// Rows of [Baldridge2009] at the default wavelengths: soils 87P706, 0015 and 90P0142 of Johns
// Hopkins University. The third is no built-in material.
using Spectrum = std::array<double, 8>;
constexpr Spectrum quartz = {0.0106, 0.0454, 0.0667, 0.0957, 0.1307, 0.1621, 0.1818, 0.2013};
constexpr Spectrum gypsum = {0.4681, 0.5407, 0.6035, 0.6486, 0.6952, 0.7435, 0.7642, 0.7728};
constexpr Spectrum third = {0.0211, 0.0457, 0.0670, 0.0852, 0.1084, 0.1401, 0.1575, 0.1843};

TEST(Sand, ReflectsWhatWasMeasured) {
  const std::vector<double> brown = reflectances(find_material("sand")),
                            white = reflectances(find_material("white_sand"));
  for (std::size_t band = 0; band < 8; ++band) {
    EXPECT_NEAR(brown[band], quartz[band], 2e-4);
    EXPECT_NEAR(white[band], gypsum[band], 2e-4);
  }
}

/// The sand with its absorption times a factor; extinction stays.
double with_absorption(std::size_t band, double factor) {
  Medium medium = layer_stack(find_material("sand"), band).layers()[0].medium;
  const double extinction = sigma_t(medium);
  medium.sigma_a *= factor;
  medium.sigma_s = extinction - medium.sigma_a;
  return reflectance_of(LayerStack({{.medium = medium}}));
}

// Iron colors every sand. So one number that scales the absorption of `sand` leads to the spectra
// of two others. (At 400 nm the brown sands reflect little more than the noise of the instrument.)
TEST(Sand, ScaledAbsorptionGivesTheColorOfOtherSands) {
  for (std::size_t band = 1; band < 8; ++band) {
    EXPECT_NEAR(with_absorption(band, 1.1), third[band], 0.012) << band;
    EXPECT_NEAR(with_absorption(band, 0.0265), gypsum[band], 0.045) << band;
  }
}

// [Feister1995]: dry bright sand of a beach has .24 at 400 nm. [Aoki2005]: deserts of China have
// .05 to .11 in the ultraviolet and .2 to .3 at 600 nm.
TEST(Sand, KindsLieOnBothSidesOfBeachesAndDeserts) {
  EXPECT_LT(quartz[0], 0.05);
  EXPECT_GT(reflectances(find_material("white_sand"))[0], 0.24);
  EXPECT_NEAR(with_absorption(0, 0.1), 0.24, 0.05);
  EXPECT_GT(with_absorption(6, 0.8), 0.2);
  EXPECT_LT(with_absorption(6, 0.5), 0.3);
}

TEST(Sand, IsWarm) {
  const Lab brown = color("sand"), white = color("white_sand");
  EXPECT_NEAR(brown.lightness, 44.0, 4.0);
  EXPECT_GT(brown.a, 3.0);
  EXPECT_GT(brown.b, 12.0);
  EXPECT_GT(white.lightness, 83.0);
  EXPECT_GT(white.b, 4.0);
}

/// Desert dust as [Dubovik2002] found it over the Persian Gulf at an optical thickness of .5: two
/// modes, by volume .15 and 2.54 µm, of spreads .42 and .61, and of volumes .02 + .1 t and .92 t -
/// .02.
MieBulk gulf_dust(double wavelength) {
  const auto mode = [&](double radius, double sigma, double share) {
    return mie_bulk({.volume_fraction = 1e-9 * share,
                     .median_radius = 1e-3 * radius * std::exp(-3.0 * sigma * sigma),
                     .sigma_log_radius = sigma,
                     .ior = mineral_dust_ior(wavelength)},
                    1.0, wavelength);
  };
  const MieBulk fine = mode(0.15, 0.42, 0.07), coarse = mode(2.54, 0.61, 0.44);
  const double sigma_s = fine.sigma_s + coarse.sigma_s;
  return {fine.sigma_a + coarse.sigma_a, sigma_s,
          (fine.sigma_s * fine.g + coarse.sigma_s * coarse.g) / sigma_s};
}

double albedo_of(const MieBulk& bulk) { return bulk.sigma_s / (bulk.sigma_s + bulk.sigma_a); }

TEST(Dust, HasTheIndexOfItsSource) {
  EXPECT_EQ(mineral_dust_ior(440.0), std::complex(1.55, 0.0025));
  EXPECT_NEAR(mineral_dust_ior(670.0).imag(), 0.0014, 1e-12);
  EXPECT_EQ(mineral_dust_ior(870.0).imag(), 0.0010);
  EXPECT_EQ(mineral_dust_ior(1000.0).imag(), 0.0010);
  EXPECT_NEAR(mineral_dust_ior(669.999).imag(), mineral_dust_ior(670.001).imag(), 1e-8);
  // [DiBiagio2019]: .0011 to .0088 at 370 nm, .0006 to .0048 at 520 nm, for 19 dusts of the world.
  EXPECT_GT(mineral_dust_ior(380.0).imag(), 0.0011);
  EXPECT_LT(mineral_dust_ior(380.0).imag(), 0.0088);
  EXPECT_NEAR(mineral_dust_ior(520.0).imag(), 0.002, 0.0003);
}

// The source prints albedo and mean cosine, too: .92 .95 .96 .97 and .68 .66 .66 .66 at these
// wavelengths, the albedo good to .03. [Kim2011] have .944 and .752 at 550 nm for all of the Sahara
// and Arabia, [Kaufman2001] .97 +- .02 at 640 nm.
TEST(Dust, ScattersAsThroughTheSkyOfItsSource) {
  const double wavelengths[] = {440.0, 670.0, 870.0, 1020.0}, albedos[] = {0.92, 0.95, 0.96, 0.97};
  for (int i = 0; i < 4; ++i) {
    const MieBulk bulk = gulf_dust(wavelengths[i]);
    EXPECT_NEAR(albedo_of(bulk), albedos[i], 0.033) << wavelengths[i];
    EXPECT_NEAR(bulk.g, 0.68, 0.06) << wavelengths[i];
  }
  EXPECT_NEAR(albedo_of(gulf_dust(550.0)), 0.944, 0.02);
  EXPECT_NEAR(albedo_of(gulf_dust(640.0)), 0.97, 0.02);
}

// The film of the built-in material is the coarse mode alone, which is what falls down.
TEST(Dust, FilmVeilsWhatItLiesOn) {
  const Material material = find_material("dust");
  const Layer film = layer_stack(material, 4).layers()[0];
  EXPECT_NEAR(sigma_t(film.medium) * film.thickness, 2.0, 0.5);
  EXPECT_GT(albedo(film.medium), 0.9);
  EXPECT_LT(albedo(film.medium), 0.97);
  Material clean = material;
  clean.layers[0].mixture.clear();
  for (std::size_t band = 0; band < 8; ++band) {
    const double bare = reflectance_of(layer_stack(clean, band));
    EXPECT_NEAR(bare, 0.05, 1e-6);
    EXPECT_GT(reflectance_of(layer_stack(material, band)), bare + 0.02);
  }
  const Lab veil = color("dust");
  EXPECT_GT(veil.b, 3.0);
  EXPECT_LT(veil.b, 15.0);
}

/// A clear film on a Lambertian ground, as seen with light from all directions gathered: the
/// equation of Williams and Clapper [WilliamsClapper1953], integrated over the directions of view.
double williams_clapper(double ior, double absorbance, double ground) {
  const double critical = std::sqrt(1.0 - 1.0 / (ior * ior));
  double inside = 0.0, out = 0.0;
  for (const auto& [low, high] : {std::pair(0.0, critical), std::pair(critical, 1.0)}) {
    const Quadrature rule = gauss_legendre(400, low, high);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double mu = rule.nodes[i], weight = 2.0 * mu * rule.weights[i];
      const double mirrored = fresnel(mu, 1.0 / ior), once = std::exp(-absorbance / mu);
      inside += weight * mirrored * once * once;
      out += weight * (1.0 - mirrored) * once;
    }
  }
  const double in = (1.0 - fresnel(1.0, ior)) * std::exp(-absorbance);
  return in * ground * out / (1.0 - ground * inside);
}

TEST(Varnish, FilmIsThatOfWilliamsAndClapper) {
  const Material material = find_material("varnish");
  for (std::size_t band = 0; band < 8; ++band)
    for (const double ground : {0.1, 0.5, 0.9}) {
      const Layer film = layer_stack(material, band).layers()[0];
      const double reflectance =
          reflectance_of(LayerStack({film}, 1.0, film.medium.ior, {.reflectance = ground}));
      EXPECT_NEAR(reflectance,
                  williams_clapper(film.medium.ior, film.medium.sigma_a * film.thickness, ground),
                  2e-5);
    }
}

/// ASTM E313 under D65 for the observer of 1931.
double yellowness_index(const Material& material) {
  const auto [x, y, z] =
      linear_srgb_to_xyz() * linear_srgb(make_band_weights(material.bands), reflectances(material));
  return 100.0 * (1.2985 * x - 1.1335 * z) / y;
}

// [Whitmore2002]: 23 of films of gloss medium that aged naturally, on gesso.
TEST(Varnish, IsAsYellowAsFilmsThatAged) {
  Material material = find_material("varnish");
  EXPECT_NEAR(yellowness_index(material), 23.0, 0.1);
  const Lab aged = color("varnish");
  EXPECT_NEAR(aged.b, 12.0, 3.0);
  EXPECT_GT(aged.lightness, 88.0);
  for (double& sigma_a : material.layers[0].sigma_a) sigma_a = 0.0;  // fresh
  EXPECT_NEAR(yellowness_index(material), 0.0, 1.0);
}

// [Sultanova2009]; PMMA has 1.491 at 589 nm by any handbook.
TEST(Varnish, HasTheIndexOfAcrylic) {
  const Material material = find_material("varnish");
  EXPECT_NEAR(material.layers[0].ior[5], 1.4912, 1e-4);
  EXPECT_NEAR(0.6 * material.layers[0].ior[5] + 0.4 * material.layers[0].ior[6], 1.491, 1e-3);
  EXPECT_EQ(material.layers[0].ior, material.layers[1].ior);
}

}  // namespace
}  // namespace lamina
