// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/base/core/lazy_values.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/subsurface/media/walk_layers.h"
#include "lamina/render/subsurface/random_walk/interior/manifold_next_event.h"
#include "lamina/render/subsurface/random_walk/radiance/field_radiance.h"

namespace lamina {

/// The events of a path, to learn from.
template <int N>
struct WalkRecord {
  struct Event {
    DepthLayers::Place place;
    Vec3f direction;               ///< in which it went on
    bool is_even;                  ///< through layers with even scattering
    BandValues<N> throughput;      ///< with which it did
    BandValues<N> radiance_found;  ///< until then
  };
  std::vector<Event> events;
};

/// Radiance inside layered bodies, as a control variate of random walks where no radiance field is
/// solved: the light that enters at the nearest point of the surface, times what a table over depth
/// says; of light that comes straight from lights, what the layers there leave of it. The table
/// holds least squares to what some walks found, and how far single ones were from them.
///
/// Paths have the same mean with any table. Safe to use from any thread once it has learned.
template <int N>
class DepthRadiance {
 public:
  using Bands = BandValues<N>;

  DepthRadiance(const BodyInterior<N>& interior, const ManifoldNextEvent<N>& next_event,
                const WalkLayers<N>& layers, const Box& region);

  /// Sums over what paths found after events, for least squares.
  class Lessons;
  [[nodiscard]] Lessons make_lessons() const;
  /// Adds a path.
  /// @param found  radiance, in all
  void add(const WalkRecord<N>& record, const Bands& found, const LightGatherer<N>& light,
           Lessons& lessons) const;
  /// Renews the table.
  void learn(const Lessons& lessons);
  [[nodiscard]] bool has_learned() const { return !table_.empty(); }

  /// At an event; nothing where the nearest point of the surface is not known.
  /// @param onward   layers through which the path goes on,
  /// @param is_even  with even scattering
  [[nodiscard]] FieldRadiance<N> at(const DepthLayers::Place& place, const WalkLayers<N>& onward,
                                    bool is_even, const LightGatherer<N>& light) const;

  /// Multiplies all that was learned, to show that paths have the same mean with any table.
  void scale(float factor);

 private:
  /// Light that enters the surface around a node of a lattice, the mean of some estimates.
  struct Entering {
    Bands irradiance;
    Bands fluence;           ///< straight from lights, right below the surface
    Vec3f to_light;          ///< inside, mean direction, length at most 1
    float weight = 0.0f;     ///< 0: no surface is near
    float deviation = 0.0f;  ///< of `fluence`
  };
  [[nodiscard]] Entering compute_node(std::size_t node, const LightGatherer<N>& light) const;
  /// At the surface nearest to a place.
  [[nodiscard]] Entering entering_around(const DepthLayers::Place& place,
                                         const LightGatherer<N>& light) const;

  /// The rows of the table around a depth.
  struct Between {
    std::size_t row;
    float fraction;  ///< towards the next
  };
  [[nodiscard]] Between between(float depth, bool is_even) const;
  /// Radiance over the irradiance that enters: `mean` + `slope` times the cosine between the
  /// direction from where it comes and that to the surface.
  struct Row {
    Bands mean, slope;
    Bands deviation;  ///< root mean square of what paths found from that
  };

  const BodyInterior<N>& interior_;
  const ManifoldNextEvent<N>& next_event_;
  const WalkLayers<N>& layers_;
  NodeLattice lattice_;
  mutable LazyValues<Entering> nodes_;
  float unit_depth_;        ///< [mm]
  std::vector<Row> table_;  ///< [is_even] over log2(1 + depth / unit_depth_)
};

template <int N>
class DepthRadiance<N>::Lessons {
 public:
  void add(const Lessons& other);

 private:
  friend class DepthRadiance<N>;
  /// Over events, weighted as rows are: of throughput times irradiance, t, of what was found
  /// after, v, and the cosine c between direction and the outward normal.
  struct Sums {
    std::array<double, N> vv{}, vt{}, vtc{}, tt{}, ttc{}, ttcc{};
  };
  std::vector<Sums> rows_;
};

}  // namespace lamina
