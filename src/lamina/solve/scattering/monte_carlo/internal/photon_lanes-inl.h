// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Photons one by one: how they start, cross rough boundaries and leave; included once per
// instruction set. All of it works on one lane of a group of photons in memory.

#if defined(LAMINA_PHOTON_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_PHOTON_LANES_INL_H_
#undef LAMINA_PHOTON_LANES_INL_H_
#else
#define LAMINA_PHOTON_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/henyey_greenstein.h"
#include "lamina/layers/optics/rough/multiple_scattering.h"
#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_scene.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::photon::HWY_NAMESPACE {

inline constexpr std::size_t max_lanes = 16;

/// A group of photons, one per SIMD lane.
struct PhotonLanes {
  // Position [mm], z within the layer; unit direction, uz > 0 is downward; weight.
  alignas(64) float x[max_lanes];
  alignas(64) float y[max_lanes];
  alignas(64) float z[max_lanes];
  alignas(64) float ux[max_lanes];
  alignas(64) float uy[max_lanes];
  alignas(64) float uz[max_lanes];
  alignas(64) float w[max_lanes];
  // The layer that the photon is in.
  alignas(64) std::int32_t layer[max_lanes];
  alignas(64) float mfp[max_lanes];
  alignas(64) float thickness[max_lanes];
  alignas(64) float albedo[max_lanes];
  alignas(64) float g[max_lanes];
  alignas(64) std::int32_t order[max_lanes];        ///< scattering events so far
  alignas(64) std::int32_t reflections[max_lanes];  ///< at boundaries inside, if needed
  alignas(64) float path[max_lanes];                ///< length so far [mm], if tallied
  alignas(64) std::uint32_t random[4][max_lanes];
  std::uint64_t birth[max_lanes];  ///< step of the group at which the photon started
  float entered[max_lanes];        ///< weight when the photon came into its layer
  float entered_path[max_lanes];   ///< its path then [mm]
  bool met_facets[max_lanes];      ///< has been at a rough boundary, which scatters too
  bool met_ground[max_lanes];      ///< has been thrown back by the ground
};

/// Follows one batch.
class Walker {
 public:
  Walker(const Scene& scene, const TallyPlan& plan, std::uint64_t first, std::uint64_t count,
         BatchSums& sums)
      : scene_(scene), plan_(plan), sums_(sums), next_(first), end_(first + count) {}

 protected:
  static std::int64_t fixed(float part) {
    return static_cast<std::int64_t>(std::lrint(part * 0x1p40f));
  }

  void add(std::size_t cell, float part) {
    sums_.cells[cell].first += fixed(part);
    sums_.cells[cell].second += fixed(part * part);
  }

  static std::uint32_t bits(PhotonLanes& p, std::size_t i) {
    std::uint32_t* s[4] = {&p.random[0][i], &p.random[1][i], &p.random[2][i], &p.random[3][i]};
    const std::uint32_t result = *s[0] + *s[3];
    const std::uint32_t t = *s[1] << 9;
    *s[2] ^= *s[0];
    *s[3] ^= *s[1];
    *s[1] ^= *s[2];
    *s[0] ^= *s[3];
    *s[2] ^= t;
    *s[3] = std::rotl(*s[3], 11);
    return result;
  }

  /// Uniform in (0, 1).
  static float uniform_lane(PhotonLanes& p, std::size_t i) {
    return static_cast<float>(bits(p, i) >> 8) * 0x1p-24f + 0x1p-25f;
  }

  void set_layer(PhotonLanes& p, std::size_t i, int layer) const {
    const auto k = static_cast<std::size_t>(layer);
    p.layer[i] = layer;
    p.mfp[i] = scene_.mfp[k];
    p.thickness[i] = scene_.thickness[k];
    p.albedo[i] = scene_.albedo[k];
    p.g[i] = scene_.g[k];
  }

  /// A lane without a photon: it stays in an endless clear void and meets nothing.
  static void retire(PhotonLanes& p, std::size_t i) {
    p.x[i] = p.y[i] = 0.0f;
    p.z[i] = 1e30f;
    p.ux[i] = p.uy[i] = 0.0f;
    p.uz[i] = 1.0f;
    p.w[i] = 1.0f;
    p.layer[i] = 0;
    p.mfp[i] = 1e-3f;
    p.thickness[i] = std::numeric_limits<float>::infinity();
    p.albedo[i] = 1.0f;
    p.g[i] = 0.0f;
    p.order[i] = 0;
    p.reflections[i] = 0;
    p.path[i] = 0.0f;
    for (auto& word : p.random) word[i] = 1;
    p.birth[i] = no_photon;
    p.entered[i] = 1.0f;
    p.entered_path[i] = 0.0f;
    p.met_facets[i] = false;
    p.met_ground[i] = false;
  }

  /// A boundary met by light in direction (ux, uy, uz), which it changes; whether it goes through.
  bool cross(PhotonLanes& p, std::size_t i, std::size_t boundary, float eta, float ux, float uy,
             float uz) {
    const Interface& interface = scene_.interfaces[boundary];
    const RoughInterface<double> rough = {.facets = {interface.roughness, interface.distribution},
                                          .eta = static_cast<double>(eta)};
    const double mu = std::max(static_cast<double>(std::abs(uz)), 1e-6);
    const Vec3 wi = normalize(Vec3{-static_cast<double>(ux), -static_cast<double>(uy), mu});
    const std::uint64_t high = bits(p, i), low = bits(p, i);
    Random random(high << 32 | low);
    const Vec3 wo = sample_multiple_scattering(rough, wi, random).wo;
    p.ux[i] = static_cast<float>(wo.x);
    p.uy[i] = static_cast<float>(wo.y);
    p.uz[i] = static_cast<float>(uz > 0.0f ? -wo.z : wo.z);
    p.met_facets[i] = true;
    return wo.z < 0.0;
  }

  /// Light on its way into the stack from outside meets the top; whether some enters.
  bool enter_at_random(PhotonLanes& p, std::size_t i) {
    float mu = static_cast<float>(std::cos(scene_.incidence.theta));
    float phi = 0.0f;
    if (scene_.incidence.is_diffuse) {
      mu = std::sqrt(uniform_lane(p, i));
      phi = 2.0f * std::numbers::pi_v<float> * uniform_lane(p, i);
    }
    const float sine = std::sqrt(std::max(0.0f, 1.0f - mu * mu));
    const float ux = sine * std::cos(phi), uy = sine * std::sin(phi);
    const float eta = scene_.eta[0];  // index beyond over index before
    if (scene_.is_rough[0] != 0) {
      if (cross(p, i, 0, eta, ux, uy, mu)) return true;
      add(PhotonLayout::specular, 1.0f);
      tally_bsdf(p, i, 0);
      return false;
    }
    const float reflected = fresnel(mu, eta);
    add(PhotonLayout::specular, reflected);
    p.ux[i] = ux / eta;
    p.uy[i] = uy / eta;
    p.uz[i] = cos_refracted(mu, eta);
    p.w[i] = 1.0f - reflected;
    return reflected < 1.0f;
  }

  void place_in_beam(PhotonLanes& p, std::size_t i) const {
    p.x[i] = p.y[i] = 0.0f;
    if (scene_.beam.shape == Beam::Shape::pencil) return;
    const float u = uniform_lane(p, i);
    const auto radius = static_cast<float>(scene_.beam.radius);
    const float r = scene_.beam.shape == Beam::Shape::flat
                        ? radius * std::sqrt(u)
                        : radius * std::sqrt(-0.5f * std::log(u));
    const float phi = 2.0f * std::numbers::pi_v<float> * uniform_lane(p, i);
    p.x[i] = r * std::cos(phi);
    p.y[i] = r * std::sin(phi);
  }

  /// Fills a lane with the next photon of the batch; false when there is none left.
  bool launch(PhotonLanes& p, std::size_t i) {
    while (next_ < end_) {
      std::uint64_t state = scene_.seed ^ (next_++ * 0xd1342543de82ef95u);
      const std::uint64_t a = Random::splitmix(state), b = Random::splitmix(state);
      p.random[0][i] = static_cast<std::uint32_t>(a);
      p.random[1][i] = static_cast<std::uint32_t>(a >> 32);
      p.random[2][i] = static_cast<std::uint32_t>(b);
      p.random[3][i] = static_cast<std::uint32_t>(b >> 32);
      p.ux[i] = scene_.ux;
      p.uy[i] = 0.0f;
      p.uz[i] = scene_.uz;
      p.w[i] = scene_.weight;
      place_in_beam(p, i);
      p.z[i] = 0.0f;
      set_layer(p, i, scene_.first_layer);
      p.order[i] = 0;
      p.reflections[i] = 0;
      p.path[i] = 0.0f;
      p.birth[i] = step_;
      p.met_facets[i] = false;
      p.met_ground[i] = false;
      if (scene_.enters_at_random && !enter_at_random(p, i)) continue;
      p.entered[i] = p.w[i];
      p.entered_path[i] = 0.0f;
      return true;
    }
    if (p.birth[i] != no_photon) --alive_;
    retire(p, i);
    return false;
  }

  /// Adds the weight that the photon leaves in its layer when it goes from there.
  void leave_layer(PhotonLanes& p, std::size_t group, std::size_t i, float weight) {
    const std::size_t layer = (group * max_lanes + i) * static_cast<std::size_t>(scene_.layers) +
                              static_cast<std::size_t>(p.layer[i]);
    absorbed_[layer] += p.entered[i] - weight;
    p.entered[i] = weight;
    if (!plan_.needs_flight) return;
    layer_path_[layer] += p.path[i] - p.entered_path[i];
    p.entered_path[i] = p.path[i];
  }

  /// Counts what the photon left in each layer and starts the next one.
  void finish(PhotonLanes& p, std::size_t group, std::size_t i) {
    const auto layers = static_cast<std::size_t>(scene_.layers);
    float* absorbed = &absorbed_[(group * max_lanes + i) * layers];
    for (std::size_t k = 0; k < layers; ++k) {
      add(PhotonLayout::first_layer + k, absorbed[k]);
      absorbed[k] = 0.0f;
    }
    if (plan_.needs_flight)
      std::fill_n(&layer_path_[(group * max_lanes + i) * layers], layers, 0.0f);
    for (std::size_t k = 0; k < scene_.views.size(); ++k) {
      float& seen = seen_[(group * max_lanes + i) * scene_.views.size() + k];
      add(plan_.layout.direction + k, std::ldexp(seen, -direction_scale));
      seen = 0.0f;
    }
    sums_.events += step_ - p.birth[i] + 1;
    launch(p, i);
  }

  /// Light under the last boundary meets the ground, may be thrown back and enter again.
  bool ground_returns(PhotonLanes& p, std::size_t group, std::size_t i) {
    const auto bottom = static_cast<std::size_t>(scene_.layers) - 1;
    const float eta = scene_.eta[2 * bottom + 1];  // from below: index of the layer over outside
    while (uniform_lane(p, i) < scene_.ground) {
      ++p.order[i];
      p.met_ground[i] = true;
      for (std::size_t k = 0; k < scene_.views.size(); ++k)
        seen_[(group * max_lanes + i) * scene_.views.size() + k] +=
            p.w[i] * scene_.views[k].from_ground;
      const float mu = std::sqrt(uniform_lane(p, i));
      const float phi = 2.0f * std::numbers::pi_v<float> * uniform_lane(p, i);
      const float sine = std::sqrt(std::max(0.0f, 1.0f - mu * mu));
      const float ux = sine * std::cos(phi), uy = sine * std::sin(phi);
      if (scene_.is_rough[2 * bottom + 1] != 0) {
        if (!cross(p, i, bottom + 1, eta, ux, uy, -mu)) continue;
      } else {
        if (uniform_lane(p, i) < fresnel(mu, eta)) continue;
        p.ux[i] = ux / eta;
        p.uy[i] = uy / eta;
        p.uz[i] = -cos_refracted(mu, eta);
      }
      set_layer(p, i, scene_.layers - 1);
      p.z[i] = p.thickness[i];
      return true;
    }
    return false;
  }

  /// The photon is outside, beyond the boundary that it went through; uz says on which side.
  void leave(PhotonLanes& p, std::size_t group, std::size_t i) {
    const bool is_below = p.uz[i] > 0.0f;
    leave_layer(p, group, i, p.w[i]);
    if (is_below && scene_.ground > 0.0f && ground_returns(p, group, i)) return;
    tally_exit(p, group, i, is_below);
    finish(p, group, i);
  }

  /// Phase function of a layer [1/sr].
  [[nodiscard]] float phase(std::size_t layer, float one_minus_cos) const {
    if (scene_.lobes == 0) return henyey_greenstein(scene_.g[layer], one_minus_cos);
    float sum = 0.0f, begin = 0.0f;
    for (std::size_t k = 0; k < static_cast<std::size_t>(scene_.lobes) && begin < 1.0f; ++k) {
      const std::size_t lobe = layer * static_cast<std::size_t>(scene_.lobes) + k;
      const float end = std::min(scene_.lobe_end[lobe], 1.0f), g = scene_.lobe_g[lobe];
      sum += (end - begin) *
             (g > 1.5f ? rayleigh(1.0f - one_minus_cos) : henyey_greenstein(g, one_minus_cos));
      begin = end;
    }
    return sum;
  }

  static float rayleigh(float cos_theta) {
    return 0.1875f * std::numbers::inv_pi_v<float> * (1.0f + cos_theta * cos_theta);
  }

  /// Next-event estimation: what an event sends to the exit directions. (ux, uy, uz) is the
  /// direction before it. Source: [CarterCashwell1975].
  void look_out(const PhotonLanes& p, std::size_t group, std::size_t i, float ux, float uy,
                float uz) {
    const auto layer = static_cast<std::size_t>(p.layer[i]);
    for (std::size_t k = 0; k < scene_.views.size(); ++k) {
      const ExitView& view = scene_.views[k];
      const auto towards = [&](float view_uz) {
        const float dx = view.ux[layer] - ux, dy = view.uy[layer] - uy, dz = view_uz - uz;
        return phase(layer, 0.5f * (dx * dx + dy * dy + dz * dz));
      };
      float seen = 0.0f;
      if (view.from_top[layer] > 0.0f)
        seen +=
            towards(-view.mu[layer]) * view.from_top[layer] * std::exp(-view.decay[layer] * p.z[i]);
      if (view.from_bottom[layer] > 0.0f)
        seen += towards(view.mu[layer]) * view.from_bottom[layer] *
                std::exp(-view.decay[layer] * (p.thickness[i] - p.z[i]));
      seen_[(group * max_lanes + i) * scene_.views.size() + k] += p.w[i] * seen;
    }
  }

  static int bin(float value, float inverse_width, int count) {
    return static_cast<int>(std::min(value * inverse_width, static_cast<float>(count - 1)));
  }

  /// arccos for [0, 1], to 1e-7. Polynomial as in minus_log.
  static float arccos(float x) {
    float p = 0.00261171855f;
    for (const float c :
         {-0.0120033895f, 0.0277629079f, -0.0491974344f, 0.0888358853f, -0.214591089f, 1.57079624f})
      p = p * x + c;
    return std::sqrt(std::max(0.0f, 1.0f - x)) * p;
  }

  void tally_exit(const PhotonLanes& p, std::size_t group, std::size_t i, bool is_below) {
    const PhotonLayout& layout = plan_.layout;
    const float w = p.w[i];
    add(is_below ? PhotonLayout::transmitted : PhotonLayout::reflected, w);
    if (is_unscattered(p, i))
      add(is_below ? PhotonLayout::unscattered_down : PhotonLayout::unscattered_up, w);
    const PhotonTallies& t = plan_.tallies;
    const std::size_t side = is_below ? 1 : 0;
    const float r = std::sqrt(p.x[i] * p.x[i] + p.y[i] * p.y[i]);
    const float mu = std::min(std::abs(p.uz[i]), 1.0f);
    const int angle = t.angles > 0 ? bin(arccos(mu), plan_.inverse_da, t.angles) : 0;
    if (layout.ra_size > 0) {
      const int k = t.r.count > 0 ? bin(r, plan_.inverse_dr, t.r.count) : 0;
      add(layout.ra + side * layout.ra_size +
              static_cast<std::size_t>(k * std::max(t.angles, 1) + angle),
          w);
    }
    if (plan_.has_rare_exits) tally_rare_exit(p, i, side, r, angle);
    if (plan_.needs_flight)
      tally_flight(&layer_path_[(group * max_lanes + i) * static_cast<std::size_t>(scene_.layers)],
                   w, side, r);
  }

  /// Light of a single direction, neither scattered inside nor at rough boundaries.
  static bool is_unscattered(const PhotonLanes& p, std::size_t i) {
    return p.order[i] == 0 && !p.met_facets[i];
  }

  /// Whether log_r leaves it out.
  static bool is_known(const PhotonLanes& p, std::size_t i, const KnownLight& known) {
    if (p.met_ground[i] || p.met_facets[i] || p.order[i] > 1) return false;
    return p.reflections[i] <= (p.order[i] == 0 ? known.unscattered : known.once);
  }

  void tally_bsdf(const PhotonLanes& p, std::size_t i, std::size_t side) {
    const PhotonLayout& layout = plan_.layout;
    const PhotonTallies& t = plan_.tallies;
    if (layout.bsdf_size == 0 || is_unscattered(p, i)) return;
    const float mu = std::min(std::abs(p.uz[i]), 1.0f);
    const int row = bin(mu, static_cast<float>(t.bsdf_cosines), t.bsdf_cosines);
    const int azimuths = std::max(t.bsdf_azimuths, 1);
    const float turn = std::atan2(p.uy[i], p.ux[i]) * (0.5f * std::numbers::inv_pi_v<float>);
    const int column =
        bin(turn < 0.0f ? turn + 1.0f : turn, static_cast<float>(azimuths), azimuths);
    const int plane = t.orders ? std::min(p.order[i], photon_orders - 1) : 0;
    add(layout.bsdf + side * layout.bsdf_size +
            static_cast<std::size_t>((plane * t.bsdf_cosines + row) * azimuths + column),
        p.w[i]);
  }

  void tally_rare_exit(const PhotonLanes& p, std::size_t i, std::size_t side, float r, int angle) {
    const PhotonLayout& layout = plan_.layout;
    const PhotonTallies& t = plan_.tallies;
    const float w = p.w[i];
    const int order = std::min(p.order[i], photon_orders - 1);
    if (layout.log_r_size > 0 && !is_known(p, i, side == 0 ? t.known_above : t.known_below)) {
      const float k = (std::log(std::max(r, 1e-30f)) - plan_.log_low) * plan_.inverse_dlog;
      add(layout.log_r + side * layout.log_r_size +
              static_cast<std::size_t>(bin(std::max(k + 1.0f, 0.0f), 1.0f, t.log_r.count + 2)),
          w);
    }
    tally_bsdf(p, i, side);
    if (layout.order_size > 0)
      add(layout.order + side * layout.order_size +
              static_cast<std::size_t>(order * std::max(t.angles, 1) + angle),
          w);
    if (plan_.needs_path) {
      const float path = w * p.path[i] * plan_.path_unit;
      add(side == 0 ? PhotonLayout::path_up : PhotonLayout::path_down, path);
      add(side == 0 ? PhotonLayout::weighted_path_up : PhotonLayout::weighted_path_down, w * path);
      if (layout.path_size > 0)
        add(layout.path + side * layout.path_size +
                static_cast<std::size_t>(bin(p.path[i], plan_.inverse_dl, t.path_length.count)),
            w);
    }
    for (std::size_t k = 0; k < t.detectors.size() && side == 0; ++k)
      if (is_in_detector(r, k)) add(layout.detector + k, w);
  }

  /// Tallies the paths in the layers [mm] of light that leaves.
  void tally_flight(const float* path, float w, std::size_t side, float r) {
    const PhotonLayout& layout = plan_.layout;
    const PhotonTallies& t = plan_.tallies;
    const auto layers = static_cast<std::size_t>(scene_.layers);
    float optical = 0.0f;
    for (std::size_t k = 0; k < layers; ++k) optical += scene_.ior[k] * path[k];
    const double time = static_cast<double>(optical) / speed_of_light;
    const std::size_t ring =
        t.r.count > 0 ? static_cast<std::size_t>(bin(r, plan_.inverse_dr, t.r.count)) : 0;
    const auto times = static_cast<std::size_t>(t.time.count);
    std::size_t time_bin = 0;
    if (times > 0) {
      for (std::size_t k = 0; k <= layers; ++k) {
        const float part = w * (k == 0 ? optical : path[k - 1]) * plan_.path_unit;
        const std::size_t cell = flight_cell(layout, side, k);
        add(cell, part);
        add(cell + 1, w * part);
      }
      time_bin =
          static_cast<std::size_t>(bin(static_cast<float>(time), plan_.inverse_dt, t.time.count));
      add(layout.time + side * layout.time_size + ring * times + time_bin, w);
    }
    const std::size_t parts = t.frequencies.size() * modulation_parts;
    tally_modulation(layout.modulation + side * layout.modulation_size + ring * parts, time, w);
    for (std::size_t k = 0; k < t.detectors.size() && side == 0; ++k) {
      if (!is_in_detector(r, k)) continue;
      if (times > 0) add(layout.detector_time + k * times + time_bin, w);
      tally_modulation(layout.detector_modulation + k * parts, time, w);
    }
  }

  void tally_modulation(std::size_t cell, double time, float w) {
    for (const double frequency : plan_.tallies.frequencies) {
      const double phase = 2e-6 * std::numbers::pi * frequency * time;  // MHz times ps
      const float c = w * static_cast<float>(std::cos(phase));
      const float s = w * static_cast<float>(std::sin(phase));
      add(cell, c);
      add(cell + 1, s);
      add(cell + 2, c * s);
      cell += modulation_parts;
    }
  }

  [[nodiscard]] bool is_in_detector(float r, std::size_t k) const {
    const PhotonTallies& t = plan_.tallies;
    return std::abs(r - static_cast<float>(t.detectors[k])) <
           0.5f * static_cast<float>(t.detector_width);
  }

  static constexpr std::uint64_t no_photon = ~std::uint64_t{0};

  const Scene& scene_;
  const TallyPlan& plan_;
  BatchSums& sums_;
  std::uint64_t next_, end_;       ///< photons to start
  std::uint64_t step_ = 0;         ///< of all groups together
  std::uint64_t alive_ = 0;        ///< lanes that hold a photon
  std::vector<float> absorbed_;    ///< [group][lane][layer] of the photon in flight
  std::vector<float> seen_;        ///< [group][lane][direction] of the photon in flight
  std::vector<float> layer_path_;  ///< [group][lane][layer] [mm] of the same, if needed
};

}  // namespace lamina::photon::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
