// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Photons on SIMD lanes. A group of photons fills the lanes of one vector; several groups take
// steps in turn, so that their long chains of arithmetic overlap. A step is either a scattering
// event or a meeting with a boundary; both are computed for all lanes and chosen by mask. A lane
// whose photon has ended takes the next photon at once.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/solve/scattering/monte_carlo/photon_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
//
#include "lamina/solve/scattering/monte_carlo/internal/photon_lanes-inl.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_math-inl.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_scene.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::photon::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

class GroupWalker : public Walker {
 public:
  using Walker::Walker;

  void run() {
    absorbed_.assign(groups * max_lanes * static_cast<std::size_t>(scene_.layers), 0.0f);
    seen_.assign(groups * max_lanes * scene_.views.size(), 0.0f);
    if (plan_.needs_flight) layer_path_.assign(absorbed_.size(), 0.0f);
    const std::size_t n = hn::Lanes(F());
    for (auto& group : lanes_)
      for (std::size_t i = 0; i < n; ++i) {
        group.birth[i] = 0;
        ++alive_;
        launch(group, i);
      }
    while (alive_ > 0) {
      for (std::size_t group = 0; group < groups; ++group) step(group);
      ++step_;
      if (step_ % 1024 == 0) give_up_old_photons();
    }
  }

 private:
  using F = hn::CappedTag<float, max_lanes>;
  using I = hn::RebindToSigned<F>;
  using U = hn::RebindToUnsigned<F>;
  using VF = hn::Vec<F>;
  using VI = hn::Vec<I>;
  using VU = hn::Vec<U>;
  using Mask = hn::Mask<F>;
  static constexpr std::size_t groups = 4;

  static std::uint32_t mask_bits(Mask mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(F(), mask, bytes);
    std::uint32_t bits;
    std::memcpy(&bits, bytes, 4);
    return bits;
  }

  /// Photons that have met too many events are counted as unfinished.
  void give_up_old_photons() {
    for (std::size_t group = 0; group < groups; ++group)
      for (std::size_t i = 0; i < hn::Lanes(F()); ++i) {
        PhotonLanes& p = lanes_[group];
        if (p.birth[i] == no_photon || step_ - p.birth[i] < scene_.max_events) continue;
        add(PhotonLayout::unfinished, p.w[i]);
        leave_layer(p, group, i, p.w[i]);
        finish(p, group, i);
      }
  }

  HWY_INLINE void step(std::size_t group) {
    const F df;
    const I di;
    const U du;
    PhotonLanes& p = lanes_[group];
    RandomLanes<VU> random = {hn::Load(du, p.random[0]), hn::Load(du, p.random[1]),
                              hn::Load(du, p.random[2]), hn::Load(du, p.random[3])};
    const VF u_step = uniform(df, draw(random));
    const VU bits_angle = draw(random);
    const VU bits_azimuth = draw(random);
    VU bits_lobe = bits_angle;
    if (scene_.lobes > 0) bits_lobe = draw(random);

    // To the next event, if no boundary is nearer.
    const VF x = hn::Load(df, p.x), y = hn::Load(df, p.y), z = hn::Load(df, p.z);
    const VF ux = hn::Load(df, p.ux), uy = hn::Load(df, p.uy), uz = hn::Load(df, p.uz);
    const VF w = hn::Load(df, p.w);
    const VF thickness = hn::Load(df, p.thickness);
    const VF free_path = hn::Mul(minus_log(df, u_step), hn::Load(df, p.mfp));
    const VF z_next = hn::MulAdd(uz, free_path, z);
    const Mask hits = hn::Or(hn::Lt(z_next, hn::Zero(df)), hn::Gt(z_next, thickness));
    const VF u_angle = uniform(df, bits_angle);

    // Scattering by Henyey and Greenstein's law: m = 1 - cos(theta) without cancellation.
    VF g = hn::Load(df, p.g);
    Mask rayleigh = hn::MaskFromVec(hn::Zero(df));
    if (scene_.lobes > 0) g = choose_lobe(p, uniform(df, bits_lobe), rayleigh);
    const VF one = hn::Set(df, 1.0f);
    const VF v = hn::Add(u_angle, u_angle);
    const VF h = hn::Add(one, g);
    const VF gv = hn::Mul(g, v);
    const VF back = hn::Sub(one, g);
    const VF den = hn::Sub(h, gv);
    const VF den2 = hn::Mul(den, den);
    const VF side = hn::CopySign(one, uz);
    const VF foot = hn::Add(side, uz);
    const VF inverse = hn::Div(one, hn::Mul(den2, foot));  // of both at once
    VF m = hn::Mul(hn::Mul(hn::Mul(back, back), v),
                   hn::Mul(hn::NegMulAdd(hn::Set(df, 0.5f), gv, h), hn::Mul(inverse, foot)));
    if (scene_.lobes > 0) m = hn::IfThenElse(rayleigh, rayleigh_turn(u_angle), m);
    const VF sin_theta = hn::Sqrt(hn::Max(hn::Zero(df), hn::Mul(m, hn::Sub(hn::Set(df, 2.0f), m))));
    const VF cos_theta = hn::Sub(one, m);
    VF sin_phi, cos_phi;
    sincos_2pi(df, bits_azimuth, sin_phi, cos_phi);
    // Into the frame of the old direction, which needs no case for light along the normal.
    // Source: [Duff2017].
    const VF a = hn::Mul(sin_theta, cos_phi), b = hn::Mul(sin_theta, sin_phi);
    const VF q = hn::Mul(side, hn::MulAdd(ux, a, hn::Mul(uy, b)));
    const VF along = hn::NegMulAdd(hn::Mul(inverse, den2), q, cos_theta);
    VF new_ux = hn::MulAdd(ux, along, a);
    VF new_uy = hn::MulAdd(uy, along, b);
    VF new_uz = hn::NegMulAdd(hn::Set(df, 1.0f), q, hn::Mul(cos_theta, uz));
    // One Newton step keeps the length at 1 through thousands of events.
    const VF norm2 =
        hn::MulAdd(new_ux, new_ux, hn::MulAdd(new_uy, new_uy, hn::Mul(new_uz, new_uz)));
    const VF scale = hn::NegMulAdd(hn::Set(df, 0.5f), norm2, hn::Set(df, 1.5f));
    new_ux = hn::Mul(new_ux, scale);
    new_uy = hn::Mul(new_uy, scale);
    new_uz = hn::Mul(new_uz, scale);
    const VF new_w = hn::Mul(w, hn::Load(df, p.albedo));
    const VI order = hn::Load(di, p.order);

    hn::Store(random.s0, du, p.random[0]);
    hn::Store(random.s1, du, p.random[1]);
    hn::Store(random.s2, du, p.random[2]);
    hn::Store(random.s3, du, p.random[3]);
    // Light of little weight plays Russian roulette where it has scattered.
    const Mask light = hn::AndNot(hits, hn::Lt(new_w, hn::Set(df, scene_.roulette_weight)));
    std::uint32_t through_bits = 0, rough_bits = 0;
    if (HWY_LIKELY(hn::AllFalse(df, hits))) {
      hn::Store(hn::MulAdd(ux, free_path, x), df, p.x);
      hn::Store(hn::MulAdd(uy, free_path, y), df, p.y);
      hn::Store(z_next, df, p.z);
      hn::Store(new_ux, df, p.ux);
      hn::Store(new_uy, df, p.uy);
      hn::Store(new_uz, df, p.uz);
      hn::Store(new_w, df, p.w);
      hn::Store(hn::Add(order, hn::Set(di, 1)), di, p.order);
      if (plan_.needs_path) hn::Store(hn::Add(hn::Load(df, p.path), free_path), df, p.path);
    } else {
      // The boundary: above if uz < 0, else below.
      const Mask up = hn::Lt(uz, hn::Zero(df));
      const VF target = hn::IfThenZeroElse(up, thickness);
      const VF to_boundary = hn::Div(hn::Sub(target, z), uz);
      const VF distance = hn::IfThenElse(hits, to_boundary, free_path);
      hn::Store(hn::MulAdd(ux, distance, x), df, p.x);
      hn::Store(hn::MulAdd(uy, distance, y), df, p.y);
      if (plan_.needs_path) hn::Store(hn::Add(hn::Load(df, p.path), distance), df, p.path);
      hn::Store(hn::IfThenElse(hits, w, new_w), df, p.w);
      hn::Store(
          hn::Add(order, hn::IfThenElseZero(hn::Not(hn::RebindMask(di, hits)), hn::Set(di, 1))), di,
          p.order);
      // Fresnel's law for ratio k of the index here to that beyond, cosines ci and ct.
      const VI layer = hn::Load(di, p.layer);
      const VI down1 = hn::IfThenElseZero(hn::Not(hn::RebindMask(di, up)), hn::Set(di, 1));
      const VI boundary = hn::Add(hn::Add(layer, layer), down1);
      const VF k = hn::GatherIndex(df, scene_.eta.data(), boundary);
      const VF k2 = hn::Mul(k, k);
      const VF ci = hn::Abs(uz);
      const VF ct =
          hn::Sqrt(hn::Max(hn::Zero(df), hn::MulAdd(k2, hn::Mul(ci, ci), hn::Sub(one, k2))));
      const VF s1 = hn::NegMulAdd(hn::Set(df, 1.0f), ct, hn::Mul(k, ci));
      const VF s2 = hn::MulAdd(k, ci, ct);
      const VF p1 = hn::NegMulAdd(k, ct, ci), p2 = hn::MulAdd(k, ct, ci);
      const VF t1 = hn::Mul(s1, p2), t2 = hn::Mul(p1, s2), t3 = hn::Mul(s2, p2);
      const VF numerator = hn::Mul(hn::Set(df, 0.5f), hn::MulAdd(t1, t1, hn::Mul(t2, t2)));
      // Total reflection makes both sides equal; then u < 1 keeps the light in.
      Mask through = hn::And(hits, hn::Gt(hn::Mul(u_angle, hn::Mul(t3, t3)), numerator));
      Mask smooth = hits;
      if (scene_.has_rough) {
        const Mask rough = hn::RebindMask(
            df, hn::Gt(hn::GatherIndex(di, scene_.is_rough.data(), boundary), hn::Zero(di)));
        smooth = hn::AndNot(rough, hits);
        through = hn::AndNot(rough, through);
      }
      if (plan_.needs_reflections)
        hn::Store(hn::Add(hn::Load(di, p.reflections),
                          hn::IfThenElseZero(hn::RebindMask(di, hn::AndNot(through, smooth)),
                                             hn::Set(di, 1))),
                  di, p.reflections);
      const VF turned_uz = hn::IfThenElse(through, hn::CopySign(ct, uz), hn::Neg(uz));
      const VF bend = hn::IfThenElse(through, k, one);
      // Rough boundaries keep their direction for now.
      const VF kept_ux = hn::IfThenElse(smooth, hn::Mul(bend, ux), ux);
      const VF kept_uy = hn::IfThenElse(smooth, hn::Mul(bend, uy), uy);
      const VF kept_uz = hn::IfThenElse(smooth, turned_uz, uz);
      hn::Store(hn::IfThenElse(hits, kept_ux, new_ux), df, p.ux);
      hn::Store(hn::IfThenElse(hits, kept_uy, new_uy), df, p.uy);
      hn::Store(hn::IfThenElse(hits, kept_uz, new_uz), df, p.uz);
      hn::Store(hn::IfThenElse(hits, target, z_next), df, p.z);
      if (!hn::AllFalse(df, through)) through_bits = mask_bits(through);
      if (scene_.has_rough) rough_bits = mask_bits(hn::AndNot(smooth, hits));
    }

    // What happens to single photons, in memory.
    if (plan_.layout.volume_cells > 0) deposit(p, hn::Not(hits), hn::Sub(w, new_w), w);
    if (!scene_.views.empty()) look_out_from_events(group, mask_bits(hn::Not(hits)), ux, uy, uz);
    if (!hn::AllFalse(df, light)) play_roulette(group, mask_bits(light));
    for (; through_bits != 0; through_bits &= through_bits - 1)
      go_through(group, static_cast<std::size_t>(std::countr_zero(through_bits)));
    for (; rough_bits != 0; rough_bits &= rough_bits - 1)
      meet_rough(group, static_cast<std::size_t>(std::countr_zero(rough_bits)));
  }

  /// The photon has passed a boundary: into the next layer, or out of the stack.
  void go_through(std::size_t group, std::size_t i) {
    PhotonLanes& p = lanes_[group];
    const bool down = p.uz[i] > 0.0f;
    const int next = p.layer[i] + (down ? 1 : -1);
    if (next < 0 || next >= scene_.layers) {
      leave(p, group, i);
      return;
    }
    leave_layer(p, group, i, p.w[i]);
    set_layer(p, i, next);
    p.z[i] = down ? 0.0f : p.thickness[i];
  }

  void meet_rough(std::size_t group, std::size_t i) {
    PhotonLanes& p = lanes_[group];
    const std::size_t down = p.uz[i] > 0.0f ? 1 : 0;
    const auto layer = static_cast<std::size_t>(p.layer[i]);
    const float eta = 1.0f / scene_.eta[2 * layer + down];
    if (cross(p, i, layer + down, eta, p.ux[i], p.uy[i], p.uz[i])) go_through(group, i);
  }

  void look_out_from_events(std::size_t group, std::uint32_t bits, VF ux, VF uy, VF uz) {
    const F df;
    const PhotonLanes& p = lanes_[group];
    alignas(64) float before[3][max_lanes];
    hn::Store(ux, df, before[0]);
    hn::Store(uy, df, before[1]);
    hn::Store(uz, df, before[2]);
    for (; bits != 0; bits &= bits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(bits));
      if (i < hn::Lanes(df) && p.birth[i] != no_photon)
        look_out(p, group, i, before[0][i], before[1][i], before[2][i]);
    }
  }

  void play_roulette(std::size_t group, std::uint32_t bits) {
    PhotonLanes& p = lanes_[group];
    const float survivor = 2.0f * scene_.roulette_weight;
    for (; bits != 0; bits &= bits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(bits));
      // What roulette gives to one photon it takes from the absorption of its layer, so that the
      // fractions of all kinds sum to 1 photon by photon.
      if (uniform_lane(p, i) * survivor < p.w[i]) {
        p.w[i] = survivor;
      } else {
        leave_layer(p, group, i, 0.0f);
        finish(p, group, i);
      }
    }
  }

  /// Absorbed weight and weight at events, where they happened.
  HWY_INLINE void deposit(const PhotonLanes& p, Mask events, VF absorbed, VF arriving) {
    const F df;
    const I di;
    alignas(64) float weights[max_lanes];
    alignas(64) std::int32_t cells[max_lanes];
    const PhotonTallies& t = plan_.tallies;
    const VF x = hn::Load(df, p.x), y = hn::Load(df, p.y);
    const VF r = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
    const VF depth =
        hn::Add(hn::Load(df, p.z), hn::GatherIndex(df, scene_.top.data(), hn::Load(di, p.layer)));
    const VF last_r = hn::Set(df, static_cast<float>(t.r.count - 1));
    const VF last_z = hn::Set(df, static_cast<float>(t.depth.count - 1));
    const VI ir = hn::ConvertTo(di, hn::Min(hn::Mul(r, hn::Set(df, plan_.inverse_dr)), last_r));
    const VI iz = hn::ConvertTo(
        di, hn::Max(hn::Zero(df), hn::Min(hn::Mul(depth, hn::Set(df, plan_.inverse_dz)), last_z)));
    hn::Store(hn::Add(hn::Mul(ir, hn::Set(di, t.depth.count)), iz), di, cells);
    hn::Store(hn::IfThenElseZero(events, absorbed), df, weights);
    std::int64_t* volume = sums_.volume.data();
    const std::size_t n = hn::Lanes(df);
    for (std::size_t i = 0; i < n; ++i)
      volume[cells[i]] += static_cast<std::int64_t>(std::lrint(weights[i] * 0x1p44f));
    if (!t.fluence) return;
    // Each event stands for the length of a mean free path; clear layers have no events.
    const VF length = hn::Mul(arriving, hn::Load(df, p.mfp));
    hn::Store(hn::IfThenElseZero(events, length), df, weights);
    for (std::size_t i = 0; i < n; ++i)
      if (p.birth[i] != no_photon)
        volume[plan_.layout.rz_size + static_cast<std::size_t>(cells[i])] +=
            static_cast<std::int64_t>(std::lrint(weights[i] * plan_.fluence_unit));
  }

  /// Draws the lobe of a mixed phase function: its g, or whether it is Rayleigh's.
  HWY_INLINE VF choose_lobe(const PhotonLanes& p, VF u, Mask& rayleigh) const {
    const F df;
    const I di;
    VI lobe = hn::Mul(hn::Load(di, p.layer), hn::Set(di, scene_.lobes));
    for (int k = 0; k + 1 < scene_.lobes; ++k) {
      // The ends ascend, so that the index stops at the first one above u.
      const Mask beyond = hn::Ge(u, hn::GatherIndex(df, scene_.lobe_end.data(), lobe));
      lobe = hn::Add(lobe, hn::IfThenElseZero(hn::RebindMask(di, beyond), hn::Set(di, 1)));
    }
    const VF g = hn::GatherIndex(df, scene_.lobe_g.data(), lobe);
    rayleigh = hn::Gt(g, hn::Set(df, 1.5f));
    return hn::IfThenZeroElse(rayleigh, g);
  }

  /// 1 - cos(theta) of Rayleigh's law: 3 parts in 4 are isotropic; the density of the rest is
  /// cos^2(theta), whose inverse is a cube root.
  HWY_INLINE VF rayleigh_turn(VF u) const {
    const F df;
    const I di;
    const VF one = hn::Set(df, 1.0f);
    const VF part = hn::Mul(u, hn::Set(df, 4.0f));
    const VF isotropic = hn::NegMulAdd(part, hn::Set(df, 2.0f / 3.0f), one);
    const VF s = hn::MulSub(hn::Sub(part, hn::Set(df, 3.0f)), hn::Set(df, 2.0f), one);
    // A guess from the exponent, good to 6 %, then Newton's method three times.
    const VF s_abs = hn::Max(hn::Abs(s), hn::Set(df, 1e-12f));
    const VF third = hn::Mul(hn::ConvertTo(df, hn::BitCast(di, s_abs)), hn::Set(df, 1.0f / 3.0f));
    VF root = hn::BitCast(df, hn::Add(hn::ConvertTo(di, third), hn::Set(di, 0x2a514067)));
    for (int k = 0; k < 3; ++k)
      root = hn::Mul(hn::Set(df, 1.0f / 3.0f),
                     hn::MulAdd(hn::Set(df, 2.0f), root, hn::Div(s_abs, hn::Mul(root, root))));
    const VF cos_theta =
        hn::IfThenElse(hn::Lt(part, hn::Set(df, 3.0f)), isotropic, hn::CopySign(root, s));
    return hn::Sub(one, cos_theta);
  }

  PhotonLanes lanes_[groups];
};

void TraceBatch(const Scene& scene, const TallyPlan& plan, std::uint64_t first, std::uint64_t count,
                BatchSums& sums) {
  GroupWalker(scene, plan, first, count, sums).run();
}

}  // namespace lamina::photon::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {
namespace photon {

HWY_EXPORT(TraceBatch);

void trace_batch(const Scene& scene, const TallyPlan& plan, std::uint64_t first,
                 std::uint64_t count, BatchSums& sums) {
  HWY_DYNAMIC_DISPATCH(TraceBatch)(scene, plan, first, count, sums);
}

}  // namespace photon

std::vector<const char*> photon_targets() {
  std::vector<const char*> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    names.push_back(hwy::TargetName(target));
  return names;
}

}  // namespace lamina
#endif
