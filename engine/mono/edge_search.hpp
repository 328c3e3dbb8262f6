#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mono/image_features.hpp"
#include "engine/mono/track_samples.hpp"
#include "engine/types/grey_image.hpp"

namespace landmarkdb {

// An image edge that a sample may belong to.
struct EdgeCandidate {
  float offset_px = 0.0F;  // from the sample's place, along its normal
  float strength = 0.0F;   // grey levels a pixel across the edge; negative: darker along the normal
  float cosine = 1.0F;     // between the edge's gradient and the sample's normal, without sign
  float unlike_px = 0.0F;  // how little it looks like what was here before, as if it lay so far off
};

// What a sample looked like when it was last found: grey values across its edge, a pixel apart.
inline constexpr int kLookHalf_px = 5;
using EdgeLook = std::array<float, 2 * kLookHalf_px + 1>;

// The looks of a model's edges in the last image, by curve and place on it.
class EdgeMemory {
 public:
  explicit EdgeMemory(std::size_t curves = 0) : curves_(curves) {}

  void clear();
  void remember(const TrackSample& sample, const EdgeLook& look);
  // Of the nearest place on the sample's curve, if one lies within `reach` (a share of the curve).
  const EdgeLook* recall(const TrackSample& sample, double reach) const;

 private:
  struct Entry {
    double share;
    EdgeLook look;
  };
  std::vector<std::vector<Entry>> curves_;
};

// The look of the edge that lies `offset_px` from a sample along its normal.
EdgeLook look_at_edge(const GreyImage& image, const TrackSample& sample, double offset_px);

// The candidates of many samples: those of sample i are at starts[i] to starts[i + 1].
struct EdgeCandidates {
  std::vector<std::uint32_t> starts{0};
  std::vector<EdgeCandidate> list{};

  std::span<const EdgeCandidate> of(std::size_t sample) const {
    return {list.data() + starts[sample], list.data() + starts[sample + 1]};
  }
};

struct EdgeSearchOptions {
  double reach_px = 20.0;
  double min_contrast =
      4.0;                   // grey levels a pixel: over the noise of an 8-bit camera (2, averaged)
  double min_cosine = 0.85;  // of the angle to the normal: some 30 degrees
};

// Looks along each sample's normal for edges: extrema of the derivative across the edge, averaged
// over three pixels along it, to a fraction of a pixel. Samples near the image's border are cut
// there. Where the memory knows a sample, what looks quite different is left out. Cost: some 120
// interpolations a sample at 20 px.
EdgeCandidates search_image_edges(const GreyImage& image,
                                  std::span<const TrackSample> samples,
                                  const EdgeMemory& memory,
                                  const EdgeSearchOptions& options);

// The same among edge points that were found before (strength is +-1).
EdgeCandidates search_edge_points(std::span<const EdgePoint> edges,
                                  std::span<const TrackSample> samples,
                                  const EdgeSearchOptions& options);

}  // namespace landmarkdb
