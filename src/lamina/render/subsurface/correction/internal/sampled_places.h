// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/render/subsurface/correction/internal/correction_fit.h"
#include "lamina/render/subsurface/correction/internal/place_graph.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/render/subsurface/surface_cells.h"

namespace lamina {

/// Places on the surface of a material, and samples of the light that leaves around them: by a
/// method of walks and by a planar one. For eyes the places are those that they see, and some
/// around them, and the samples are of the light that leaves towards them; else places are
/// all over the surface and samples in all directions.
///
/// A place follows from where it is on the mesh, and the random numbers of its samples from the
/// place: of a camera that has turned by a little most places are the same, and their walks nearly.
template <int N>
class SampledPlaces {
 public:
  struct Methods {
    const SubsurfaceMethod<N>&planar, &walk;
    BandValues<N> walk_scale;  ///< of what the walks find
    float ior;                 ///< inside over outside, mean of the bands
    int bands;                 ///< that count
  };

  /// @param scene, methods, with  must outlive this
  /// @param spacing  of the places [mm], > 0
  /// @param eyes     that the places are for; none: for all
  SampledPlaces(const RenderScene& scene, std::uint32_t material, float spacing,
                const Methods& methods, const Preparation<N>& with, std::vector<Vec3f> eyes);

  /// Samples until there are about so many at a place that is seen: fewer in the dark and more
  /// where it is bright, as the root of the light. So what is wrong is nearly even over the
  /// picture, and hardly more of the light in the dark. A third of them where nobody looks.
  /// @param mean      >= 2
  /// @param progress  told how far it is
  /// @return          false if progress asked to stop: then some places have what they had before
  [[nodiscard]] bool sample(double mean, const Progress& progress);

  /// Time of all samples so far [CPU s].
  [[nodiscard]] double seconds() const { return seconds_; }
  /// About how many there are at a place, as `mean` of sample(), in the mean of places.
  [[nodiscard]] double samples_of_mean() const;

  /// About what is by chance in samples of walks over the mean light, where places are seen: root
  /// mean square over area and bands. 0 where there is no light.
  [[nodiscard]] double noise() const;

  /// The exitance that is this fraction of the planar method's mean; 0 if there is no light.
  [[nodiscard]] float exitance_of_mean(float fraction) const;

  [[nodiscard]] const std::vector<PlaceGraph::Place>& places() const { return places_; }
  /// A number of each place, which follows from where it is on its mesh.
  [[nodiscard]] const std::vector<std::uint32_t>& keys() const { return keys_; }
  /// Area of each place [mm²]; 0 of one that is not seen.
  [[nodiscard]] const std::vector<float>& areas() const { return areas_; }
  [[nodiscard]] std::size_t sample_count() const;
  /// [place], for fit_correction. Light of the planar method counts as this exitance more.
  [[nodiscard]] std::vector<std::vector<WalkedSample<N>>> samples(float exitance) const;

  /// Cross-validation of a fit to samples(exitance), over the light that is seen.
  struct Assessment {
    double change = 0.0;  ///< from that of the planar method: root mean square over the mean light
    /// Squares that each half leaves of the other's samples, less those that no fit changes, over
    /// the square of the mean light: in the mean of bands.
    double left = 0.0;
    std::vector<double> left_at;  ///< [place], of which that is the sum

    /// At which places it leaves less than another, by a standard error of what is around: [place].
    [[nodiscard]] std::vector<bool> is_better_than(const Assessment& other,
                                                   const PlaceGraph& graph) const;
  };
  [[nodiscard]] Assessment assess(const CorrectionFit<N>& fit, float exitance) const;

 private:
  /// Sets the samples of places by the root of the light that is seen there.
  [[nodiscard]] bool find_shares();
  /// Along the normal at the middle of a place by the planar method: sum of the bands.
  [[nodiscard]] float planar_light(std::size_t place) const;
  /// Adds one, as if it stood for all of the place.
  void add_sample(std::size_t place);
  /// Towards an eye that sees the point, or in any direction if there are no eyes.
  [[nodiscard]] Vec3f direction_of_sample(const SurfacePoint& point, std::size_t number,
                                          PixelSamples& random) const;

  const RenderScene& scene_;
  const Methods& methods_;
  const Preparation<N>& with_;
  std::vector<Vec3f> eyes_;
  SurfaceCells surface_;
  std::vector<PlaceGraph::Place> places_;
  std::vector<float> areas_;
  std::vector<const SurfaceCell*> cells_;              ///< [place]
  std::vector<std::uint32_t> keys_;                    ///< [place]
  std::vector<double> shares_;                         ///< [place], of samples over their mean
  std::atomic<double> seconds_ = 0.0;
  std::vector<std::vector<WalkedSample<N>>> samples_;  ///< [place]
  std::vector<std::vector<float>> exitances_;  ///< that leaves as 1 of exitance: of each sample
};

}  // namespace lamina
