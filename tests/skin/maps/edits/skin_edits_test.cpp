// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/skin_edits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/maps/edits/skin_preview.h"
#include "lamina/skin/maps/edits/skin_variations.h"
#include "lamina/solve/reflectance/material_totals.h"

namespace lamina {
namespace {

Image image_of(int width, int height, const std::function<double(int x, int y)>& value) {
  Image image = make_image(width, height, {"Y"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) *image.at(x, y) = static_cast<float>(value(x, y));
  return image;
}

/// A map of values that wander by a share around one, some of them with the map before.
Image uneven(int width, int height, double middle, double share, std::uint64_t seed) {
  Random shared = make_random(7, 0), own = make_random(seed, 1);
  return image_of(width, height, [&](int, int) {
    return middle * std::exp(share * (shared.uniform() + own.uniform() - 1.0));
  });
}

/// 4 mm of skin whose melanin and blood vary, and the oxygen of the blood.
EditableSkin varied_skin(int width = 40, int height = 30, double melanin = 0.02) {
  EditableSkin skin;
  skin.width_mm = 4.0;
  skin.skin.maps = {{"melanin", &SkinParameters::melanin, uneven(width, height, melanin, 0.8, 1)},
                    {"hemoglobin_dermis", &SkinParameters::hemoglobin_dermis,
                     uneven(width, height, 0.012, 0.5, 2)},
                    {"saturation_dermis", &SkinParameters::saturation_dermis,
                     uneven(width, height, 0.6, 0.3, 3)}};
  return skin;
}

const Image& map_of(const EditableSkin& skin, std::string_view name) {
  const auto map = std::ranges::find(skin.skin.maps, name, &SkinMap::name);
  if (map == skin.skin.maps.end()) throw std::runtime_error("no map " + std::string(name));
  return map->values;
}

EditableSkin edited(const EditableSkin& skin, const SkinEdit& edit) {
  return edited_skin(skin, edit).skin;
}

std::string message_of(const EditableSkin& skin, const SkinEdit& edit) {
  try {
    (void)edited_skin(skin, edit);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no error";
}

bool are_same(const EditableSkin& a, const EditableSkin& b) {
  if (a.skin.maps.size() != b.skin.maps.size()) return false;
  for (std::size_t i = 0; i < a.skin.maps.size(); ++i)
    if (a.skin.maps[i].values.pixels != b.skin.maps[i].values.pixels) return false;
  for (const SkinParameterRange& range : skin_parameter_ranges())
    if (a.skin.skin.*range.value != b.skin.skin.*range.value) return false;
  return a.skin.oiliness == b.skin.oiliness && a.skin.skin.inks.size() == b.skin.skin.inks.size();
}

/// One edit of each kind that changes the skin above, all of it unless there is a mask.
std::vector<SkinEdit> edits_of_all_kinds(const Image& mask) {
  std::vector<SkinEdit> edits;
  for (const auto& [name, kind] : enum_names<SkinEditKind>) {
    SkinEdit edit{.kind = kind, .amount = 0.7, .number = "melanin", .mask = mask};
    if (kind == SkinEditKind::set) edit.amount = 0.07;
    if (kind == SkinEditKind::homogenize || kind == SkinEditKind::transfer) edit.amount = 0.0;
    edit.reference = varied_skin(20, 15, 0.06);
    edit.image = image_of(40, 30, [](int x, int y) { return 0.001 * (1 + x % 7 + y % 5); });
    if (!skin_edit_range(kind).has_number) edit.number.clear();
    if (skin_edit_range(kind).size > 0.0) edit.size = 0.5;
    edits.push_back(edit);
  }
  return edits;
}

TEST(SkinEdits, OfNoAmountOrStrengthChangeNoBit) {
  const EditableSkin skin = varied_skin();
  const Image everywhere = image_of(40, 30, [](int, int) { return 1.0; });
  for (SkinEdit edit : edits_of_all_kinds(everywhere)) {
    EXPECT_FALSE(are_same(edited(skin, edit), skin)) << name_of(edit.kind);
    edit.strength = 0.0;
    EXPECT_TRUE(are_same(edited(skin, edit), skin)) << name_of(edit.kind);
    edit.strength = 1.0;
    edit.amount = edit.kind == SkinEditKind::scale || edit.kind == SkinEditKind::gamma ? 1.0 : 0.0;
    const bool has_amount =
        edit.kind != SkinEditKind::saturation && edit.kind != SkinEditKind::set &&
        edit.kind != SkinEditKind::homogenize && edit.kind != SkinEditKind::transfer;
    EXPECT_EQ(are_same(edited(skin, edit), skin), has_amount) << name_of(edit.kind);
  }
}

TEST(SkinEdits, LeaveTexelsOfMaskZeroAsTheyAreAndDoAllWhereItIsOne) {
  const EditableSkin skin = varied_skin();
  const Image left = image_of(40, 30, [](int x, int) { return x < 20 ? 1.0 : 0.0; });
  for (SkinEdit edit : edits_of_all_kinds(left)) {
    const EditableSkin masked = edited(skin, edit);
    for (const SkinMap& before : skin.skin.maps) {
      const Image& after = map_of(masked, before.name);
      for (int y = 0; y < 30; ++y)
        for (int x = 20; x < 40; ++x)
          ASSERT_EQ(*after.at(x, y), *before.values.at(x, y))
              << name_of(edit.kind) << " " << before.name;
    }
    // Where an edit looks at each texel by itself, the other half is as without a mask.
    if (edit.kind != SkinEditKind::tan && edit.kind != SkinEditKind::flush &&
        edit.kind != SkinEditKind::scale && edit.kind != SkinEditKind::even)
      continue;
    edit.mask = {};
    const EditableSkin all = edited(skin, edit);
    for (const SkinMap& map : skin.skin.maps)
      for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 20; ++x)
          ASSERT_EQ(*map_of(masked, map.name).at(x, y), *map_of(all, map.name).at(x, y));
  }
}

TEST(SkinEdits, MakeMapsOfNumbersWhereAMaskVariesThem) {
  EditableSkin skin;  // numbers only
  skin.skin.skin.melanin = 0.02;
  const Image half = image_of(4, 1, [](int x, int) { return x < 2 ? 0.0 : 1.0; });
  const EditableSkin tanned =
      edited(skin, {.kind = SkinEditKind::tan, .amount = 0.5, .mask = half});
  EXPECT_EQ(map_of(tanned, "melanin").pixels, (std::vector<float>{0.02f, 0.02f, 0.03f, 0.03f}));
  const EditableSkin all = edited(skin, {.kind = SkinEditKind::tan, .amount = 0.5});
  EXPECT_TRUE(all.skin.maps.empty());
  EXPECT_DOUBLE_EQ(all.skin.skin.melanin, 0.03);
}

TEST(SkinEdits, ShareTheWayInTheLogarithmWhereTheMaskIsBetween) {
  EditableSkin skin;
  skin.skin.skin.scattering_scale = 0.5;
  const EditableSkin halfway = edited(
      skin,
      {.kind = SkinEditKind::scale, .amount = 4.0, .number = "scattering_scale", .strength = 0.5});
  EXPECT_NEAR(halfway.skin.skin.scattering_scale, 1.0, 1e-6);
}

TEST(SkinEdits, AreUndoneByTheirInverse) {
  const EditableSkin skin = varied_skin();
  const double tan = 0.5;
  const EditableSkin faded = edited(edited(skin, {.kind = SkinEditKind::tan, .amount = tan}),
                                    {.kind = SkinEditKind::tan, .amount = -tan / (1.0 + tan)});
  EXPECT_NEAR(faded.skin.skin.melanin_blend, skin.skin.skin.melanin_blend, 1e-6);
  const auto scale = [](double factor) {
    return SkinEdit{.kind = SkinEditKind::scale, .amount = factor, .number = "melanin"};
  };
  const auto gamma = [](double factor) {
    return SkinEdit{.kind = SkinEditKind::gamma, .amount = factor, .number = "saturation_dermis"};
  };
  const EditableSkin scaled = edited(edited(skin, scale(3.0)), scale(1.0 / 3.0));
  const EditableSkin flat = edited(edited(skin, gamma(0.5)), gamma(2.0));
  for (std::size_t i = 0; i < map_of(skin, "melanin").pixels.size(); ++i) {
    const float melanin = map_of(skin, "melanin").pixels[i];
    EXPECT_NEAR(map_of(faded, "melanin").pixels[i], melanin, 1e-6f * melanin);
    EXPECT_NEAR(map_of(scaled, "melanin").pixels[i], melanin, 1e-6f * melanin);
    EXPECT_NEAR(map_of(flat, "saturation_dermis").pixels[i],
                map_of(skin, "saturation_dermis").pixels[i], 1e-5f);
  }
}

// What is added, by amounts: melanin of 74 % eumelanin, arterial blood.
TEST(SkinEdits, TanAndFlushAddPigmentOfTheirComposition) {
  const EditableSkin skin = varied_skin();
  const EditableSkin after = edited(edited(skin, {.kind = SkinEditKind::tan, .amount = 0.4}),
                                    {.kind = SkinEditKind::flush, .amount = 0.8});
  const SkinParameters &from = skin.skin.skin, &to = after.skin.skin;
  EXPECT_NEAR(1.4 * to.melanin_blend - from.melanin_blend, 0.4 * tanned_blend, 1e-6);
  EXPECT_NEAR(to.hemoglobin_epidermis, 1.8 * from.hemoglobin_epidermis, 1e-9);
  for (std::size_t i = 0; i < 1200; ++i) {
    const auto at = [i](const EditableSkin& of, const char* name) {
      return static_cast<double>(map_of(of, name).pixels[i]);
    };
    const double blood = at(skin, "hemoglobin_dermis"), more = at(after, "hemoglobin_dermis");
    EXPECT_NEAR(more, 1.8 * blood, 1e-8);
    EXPECT_NEAR(more * at(after, "saturation_dermis"),
                blood * at(skin, "saturation_dermis") + 0.8 * blood * flush_saturation, 1e-8);
  }
}

/// Uniform skin in D65 by adding-doubling, 20 nm apart, with the bands' own weights.
Lab color_of(const SkinParameters& skin) {
  std::vector<double> wavelengths;
  for (int nm = 400; nm <= 700; nm += 20) wavelengths.push_back(nm);
  std::vector<LayerStack> stacks;
  for (const double nm : wavelengths) stacks.push_back(skin_layer_stack(skin, nm));
  std::vector<double> reflected;
  for (const EnteredTotals& totals : material_totals(stacks))
    reflected.push_back(totals.reflectance);
  return lab(linear_srgb(make_band_weights(BandSet(wavelengths)), reflected));
}

TEST(SkinEdits, ColorSkinTheWayTheyAreCalled) {
  EditableSkin skin;
  skin.skin.skin.melanin = 0.008;
  const Lab before = color_of(skin.skin.skin);
  const auto color_after = [&](SkinEditKind kind, double amount) {
    return color_of(edited(skin, {.kind = kind, .amount = amount}).skin.skin);
  };
  const Lab tanned = color_after(SkinEditKind::tan, 0.5);
  EXPECT_LT(tanned.lightness, before.lightness - 2.0);
  EXPECT_GT(tanned.b, before.b + 1.0);
  EXPECT_LT(typology_angle(tanned), typology_angle(before) - 5.0);
  const Lab flushed = color_after(SkinEditKind::flush, 1.0);
  EXPECT_GT(flushed.a, before.a + 2.0);
  const Lab pale = color_after(SkinEditKind::pale, 0.5);
  EXPECT_LT(pale.a, before.a - 1.5);
  EXPECT_GT(pale.lightness, before.lightness + 1.0);
  const Lab blue = color_after(SkinEditKind::cyanosis, 0.8);
  EXPECT_LT(blue.a, before.a - 1.0);
  EXPECT_LT(blue.lightness, before.lightness);
  EXPECT_GT(color_after(SkinEditKind::saturation, 0.95).a, before.a + 0.5);
}

TEST(SkinEdits, RougeAndLipstickAreRed) {
  EditableSkin skin;
  skin.skin.skin.melanin = 0.01;
  const Image here = image_of(1, 1, [](int, int) { return 1.0; });
  const Lab before = color_of(skin.skin.skin);
  double reddest = before.a + 1.0;
  for (const SkinEditKind kind : {SkinEditKind::blush, SkinEditKind::lipstick}) {
    const EditableSkin made_up = edited(skin, {.kind = kind, .amount = 1.0, .mask = here});
    const Lab after = color_of(made_up.skin.skin);
    EXPECT_GT(after.a, reddest) << name_of(kind);
    reddest = after.a + 3.0;
    EXPECT_GT(after.b, 5.0) << "mauve";
    EXPECT_EQ(made_up.skin.skin.inks.size(), 1u);
  }
}

/// Mean and covariance of ln(melanin + .001), ln(blood + .0003) and logit(saturation).
struct Statistics {
  double mean[3] = {}, covariance[3][3] = {};
};
Statistics statistics_of(const EditableSkin& skin) {
  const Image *melanin = &map_of(skin, "melanin"), *blood = &map_of(skin, "hemoglobin_dermis"),
              *oxygen = &map_of(skin, "saturation_dermis");
  const std::size_t count = melanin->pixels.size();
  std::vector<std::array<double, 3>> all;
  for (std::size_t i = 0; i < count; ++i) {
    const auto s = static_cast<double>(oxygen->pixels[i]);
    all.push_back({std::log(static_cast<double>(melanin->pixels[i]) + 1e-3),
                   std::log(static_cast<double>(blood->pixels[i]) + 3e-4), std::log(s / (1 - s))});
  }
  Statistics result;
  const auto n = static_cast<double>(count);
  for (const auto& each : all)
    for (std::size_t i = 0; i < 3; ++i) result.mean[i] += each[i] / n;
  for (const auto& each : all)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        result.covariance[i][j] += (each[i] - result.mean[i]) * (each[j] - result.mean[j]) / n;
  return result;
}

TEST(Homogenize, ReachesMeanAndCovarianceOfTheReference) {
  const EditableSkin skin = varied_skin(), other = varied_skin(25, 50, 0.05);
  const EditableSkin alike = edited(skin, {.kind = SkinEditKind::homogenize, .reference = other});
  const Statistics got = statistics_of(alike), wanted = statistics_of(other),
                   had = statistics_of(skin);
  EXPECT_GT(wanted.mean[0] - had.mean[0], 0.5);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(got.mean[i], wanted.mean[i], 1e-4);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(got.covariance[i][j], wanted.covariance[i][j], 1e-4);
  }
  // Half of the way to the means.
  const EditableSkin half =
      edited(skin, {.kind = SkinEditKind::homogenize, .strength = 0.5, .reference = other});
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(statistics_of(half).mean[i], 0.5 * (had.mean[i] + wanted.mean[i]), 1e-3);
}

TEST(Homogenize, ToItselfChangesNothing) {
  const EditableSkin skin = varied_skin();
  EXPECT_TRUE(are_same(edited(skin, {.kind = SkinEditKind::homogenize, .reference = skin}), skin));
}

// Of skin only, in both: texels of another kind do not count.
TEST(Homogenize, LooksWhereThereIsSkin) {
  EditableSkin skin = varied_skin(), other = varied_skin(40, 30, 0.05);
  const EditableSkin wanted = edited(skin, {.kind = SkinEditKind::homogenize, .reference = other});
  const auto add_background = [](EditableSkin& to) {
    to.mask = image_of(40, 60, [](int, int y) { return y < 30 ? 1.0 : 0.0; });
    for (SkinMap& map : to.skin.maps) {
      map.values.height = 60;
      map.values.pixels.resize(2400, 0.4f);
    }
  };
  add_background(skin);
  add_background(other);
  const EditableSkin got = edited(skin, {.kind = SkinEditKind::homogenize, .reference = other});
  for (std::size_t i = 0; i < 1200; ++i)
    EXPECT_NEAR(map_of(got, "melanin").pixels[i], map_of(wanted, "melanin").pixels[i], 1e-6f);
}

TEST(Homogenize, TakesTheNumbersOfSkinWithoutMaps) {
  EditableSkin uniform;
  uniform.skin.skin.melanin = 0.09;
  uniform.skin.skin.carotene = 0.004;
  const EditableSkin flat =
      edited(varied_skin(), {.kind = SkinEditKind::homogenize, .reference = uniform});
  for (const float melanin : map_of(flat, "melanin").pixels) EXPECT_NEAR(melanin, 0.09f, 1e-5f);
  EXPECT_NEAR(flat.skin.skin.carotene, 0.004, 1e-8);
}

/// Even skin with one round freckle, 8 mm wide.
EditableSkin freckled_skin() {
  EditableSkin skin;
  skin.width_mm = 8.0;
  Random random = make_random(3, 0);
  skin.skin.maps = {{"melanin", &SkinParameters::melanin, image_of(80, 80, [&](int x, int y) {
                       const double noise = 0.05 * (random.uniform() - 0.5);
                       return (std::hypot(x - 40, y - 40) < 6 ? 0.03 : 0.01) * (1.0 + noise);
                     })}};
  return skin;
}

TEST(Freckles, GrowAndVanishWhileTheSkinBetweenThemStays) {
  const EditableSkin skin = freckled_skin();
  const auto with = [&](double amount) {
    return map_of(edited(skin, {.kind = SkinEditKind::freckles, .amount = amount}), "melanin");
  };
  const Image &before = map_of(skin, "melanin"), stronger = with(0.5), none = with(-1.0);
  EXPECT_GT(*stronger.at(40, 40), 1.25f * *before.at(40, 40));
  EXPECT_LE(*stronger.at(40, 40), std::exp(0.5f) * *before.at(40, 40));
  EXPECT_NEAR(*none.at(40, 40), 0.01f, 0.0015f);
  for (int x = 0; x < 20; ++x) {
    EXPECT_NEAR(*stronger.at(x, 5), *before.at(x, 5), 0.03f * *before.at(x, 5));
    EXPECT_NEAR(*none.at(x, 5), *before.at(x, 5), 0.03f * *before.at(x, 5));
  }
}

TEST(Even, LessensContrastByItsAmountAndKeepsTheMean) {
  const EditableSkin skin = freckled_skin();
  const auto contrast = [](const Image& map) {
    return std::log(static_cast<double>(*map.at(40, 40)) / static_cast<double>(*map.at(5, 5)));
  };
  const auto with = [&](double amount) {
    return contrast(
        map_of(edited(skin, {.kind = SkinEditKind::even, .amount = amount}), "melanin"));
  };
  const double before = contrast(map_of(skin, "melanin"));
  EXPECT_LT(with(1.0), 0.15 * before);
  EXPECT_NEAR(with(0.5), 0.5 * (before + with(1.0)), 0.03);
}

TEST(SkinEdits, StayWithinTheRangesAndCountWhatTheyClamp) {
  const EditableSkin skin = varied_skin();
  const Image everywhere = image_of(40, 30, [](int, int) { return 1.0; });
  for (SkinEdit edit : edits_of_all_kinds(everywhere)) {
    const SkinEditRange range = skin_edit_range(edit.kind);
    for (const double amount : {range.low, range.high}) {
      edit.amount = edit.kind == SkinEditKind::set ? std::clamp(amount, 0.0, 0.5) : amount;
      const EditableSkin after = edited(skin, edit);
      for (const SkinMap& map : after.skin.maps)
        for (const SkinParameterRange& of : skin_parameter_ranges())
          if (of.name == map.name)
            for (const float value : map.values.pixels) {
              ASSERT_GE(value, static_cast<float>(of.low)) << name_of(edit.kind);
              ASSERT_LE(value, static_cast<float>(of.high)) << name_of(edit.kind);
            }
    }
  }
  const EditedSkin most =
      edited_skin(skin, {.kind = SkinEditKind::add, .amount = 0.5, .number = "melanin"});
  ASSERT_EQ(most.clamped.size(), 1u);
  EXPECT_EQ(most.clamped[0].name, "melanin");
  EXPECT_EQ(most.clamped[0].count, 1200u);
}

TEST(SkinEdits, CarryStandardDeviationsOnWhereTheyKeepTheirMeaning) {
  EditableSkin skin = varied_skin();
  skin.deviations = {{"melanin", image_of(40, 30, [](int, int) { return 0.1; })}};
  const auto deviation = [&](SkinEditKind kind, double amount) {
    const EditableSkin after = edited(skin, {.kind = kind, .amount = amount, .number = "melanin"});
    return after.deviations.empty() ? -1.0
                                    : static_cast<double>(after.deviations[0].values.pixels[77]);
  };
  // Of ln(melanin + .001), by hand.
  const double melanin = static_cast<double>(map_of(skin, "melanin").pixels[77]) + 1e-3;
  EXPECT_NEAR(deviation(SkinEditKind::tan, 0.5), 0.15 * melanin / (1.5 * melanin - 5e-4), 1e-5);
  EXPECT_NEAR(deviation(SkinEditKind::scale, 2.0), 0.2 * melanin / (2 * melanin - 1e-3), 1e-5);
  EXPECT_NEAR(deviation(SkinEditKind::add, 0.02), 0.1 * melanin / (melanin + 0.02), 1e-5);
  EXPECT_NEAR(deviation(SkinEditKind::gamma, 2.0), 0.2, 1e-5);
  EXPECT_EQ(deviation(SkinEditKind::blur, 0.3), -1.0);
  EXPECT_NE(edited(skin, {.kind = SkinEditKind::blur, .amount = 0.3, .number = "melanin"})
                .skin.warnings.at(0)
                .find("dropped"),
            std::string::npos);
}

TEST(SkinEdits, RefuseWhatCannotBeInOneLine) {
  const EditableSkin skin = varied_skin();
  EXPECT_EQ(message_of(skin, {.kind = SkinEditKind::tan, .amount = -1.0}),
            "must lie in [-0.95, 10], but is -1");
  EXPECT_NE(message_of(skin, {.kind = SkinEditKind::tan, .amount = std::nan("")}).find("nan"),
            std::string::npos);
  EXPECT_EQ(message_of(skin, {.kind = SkinEditKind::scale, .amount = 2, .number = "melanim"}),
            "skin has no number \"melanim\"; did you mean \"melanin\"?");
  EXPECT_EQ(message_of(skin, {.kind = SkinEditKind::set, .amount = 0.7, .number = "melanin"}),
            "melanin must lie in [0, 0.5], but is 0.7");
  EXPECT_EQ(message_of(skin, {.kind = SkinEditKind::lipstick, .amount = 1.0}),
            "needs a mask that says where");
  const Image square = image_of(30, 30, [](int, int) { return 1.0; });
  EXPECT_EQ(message_of(skin, {.amount = 0.1, .mask = square}),
            "the mask must have the proportions of the maps, 40 x 30, but is 30 x 30");
  const Image bright = image_of(40, 30, [](int, int) { return 2.0; });
  EXPECT_EQ(message_of(skin, {.amount = 0.1, .mask = bright}),
            "the mask must lie in [0, 1], but has 2");
  EXPECT_NE(
      message_of(skin, {.kind = SkinEditKind::scale, .amount = 2.0, .number = "dermis_thickness"})
          .find("infinite"),
      std::string::npos);
  EditableSkin on_mesh = skin;
  on_mesh.width_mm = 0.0;
  EXPECT_NE(message_of(on_mesh, {.kind = SkinEditKind::even, .amount = 0.5}).find("mm"),
            std::string::npos);
}

TEST(SkinVariations, HaveTheMeansOfThePersonAndTheDetailOfTheMaps) {
  const EditableSkin skin = varied_skin();
  const SkinParameters person = draw_skins(forearm_population(), 1, 5).front();
  const EditableSkin other = skin_of_person(skin, person).skin;
  EXPECT_NEAR(other.skin.skin.scattering_scale, person.scattering_scale, 1e-7);
  EXPECT_NEAR(statistics_of(other).mean[0], std::log(person.melanin + 1e-3), 1e-3);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(statistics_of(other).covariance[i][i], statistics_of(skin).covariance[i][i], 1e-4);
}

// Without a width texels are seen by themselves: each as uniform skin by adding-doubling.
TEST(SkinPreview, ShowsEachTexelAsUniformSkin) {
  EditableSkin skin;
  skin.skin.maps = {{"melanin", &SkinParameters::melanin,
                     image_of(16, 16, [](int x, int) { return x < 8 ? 0.008 : 0.06; })}};
  const Image picture = skin_preview(skin, 512);
  for (const auto& [x, melanin] : {std::pair(3, 0.008), std::pair(12, 0.06)}) {
    SkinParameters uniform = skin.skin.skin;
    uniform.melanin = melanin;
    const float* rgb = picture.at(x, 8);
    const Lab shown = lab(LinearSrgb{static_cast<double>(rgb[0]), static_cast<double>(rgb[1]),
                                     static_cast<double>(rgb[2])});
    // Even light in the one, from above in the other; eight bands against sixteen.
    EXPECT_LT(color_difference(shown, color_of(uniform)), 3.0) << melanin;
  }
}

}  // namespace
}  // namespace lamina
