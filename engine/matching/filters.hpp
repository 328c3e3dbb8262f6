#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/matching/descriptor_index.hpp"
#include "engine/types/correspondence.hpp"

namespace landmarkdb {

// `matches` in the functions below is what DescriptorIndex::search() wrote: Q x k, row-major. All
// throw Error{kInvalidArgument} when it is no whole number of rows of k > 0, and are thread-safe.

// The nearest descriptor of each query that has one, unfiltered.
std::vector<Correspondence> nearest_pairs(std::span<const DescriptorMatch> matches, std::size_t k);

// Which neighbours the ratio filter holds the nearest against. Keypoints stand closer together than
// a descriptor's support is wide, so the second nearest is as a rule the same surface again, 10 cm
// along; Lowe (2004, section 7.1) compares with the nearest that is known to be of something else.
struct RatioRivals {
  std::span<const Eigen::Vector3f> target;  // positions; empty: every neighbour is a rival
  double apart_m = 0.0;                     // a rival stands further than this from the nearest
};

// Keeps a query's nearest descriptor when it is nearer than `ratio` times its nearest rival, by
// default the second nearest; an exact tie is dropped whatever the ratio. Where none of the k
// neighbours stands apart the last of them is taken, as a rival would be no nearer. All neighbours
// must be of one entry, so search each entry by itself. A query without a second neighbour has no
// rival and is kept. Also throws for k < 2, a ratio that is not in (0, 1], or a match outside
// `rivals.target`.
std::vector<Correspondence> filter_ratio(std::span<const DescriptorMatch> matches,
                                         std::size_t k,
                                         double ratio,
                                         const RatioRivals& rivals = {});

// Keeps the pairs that are each other's nearest: `matches` of queries in targets, `reverse` of
// targets in queries (T x k_reverse).
std::vector<Correspondence> filter_mutual(std::span<const DescriptorMatch> matches,
                                          std::size_t k,
                                          std::span<const DescriptorMatch> reverse,
                                          std::size_t k_reverse);

struct SlopeOptions {
  // A pair farther than this many standard deviations from the mean is dropped. Below sqrt(3) an
  // even spread of wrong slopes keeps shrinking, above it stays whole: its standard deviation is
  // half its width over sqrt(3).
  double max_sigma = 1.5;
  // The standard deviation is not taken for less, else the right pairs would be thinned out for the
  // noise of their keypoints: a tenth is keypoints 0.1 m apart on a translation of 1 m.
  double min_sigma_rad = 0.1;
  // The fit starts from the pairs within twice this, in both slopes, of where most lie within it.
  // When most pairs are wrong a fit to all of them is a fit to the wrong ones: of 1 % right pairs
  // none came through. The noise above: wider, and wrong pairs make the densest spot.
  double start_reach_rad = 0.1;
};

// The probabilistic slope filter (Cocias 2014, section 3): right pairs of two clouds *in one
// orientation* differ by one translation, so the slopes of the line from query to target point,
// m1 = dy / dx and m2 = dz / dx, agree. Starts where the slopes are densest, fits a Gaussian to
// each by maximum likelihood, drops the pairs out of its reach and repeats until nothing changes.
//
// `query` must have been turned into the target's orientation (rotation_from_frames, or a prior).
// Slopes are taken as angles, atan2(dy, dx) folded into (-pi/2, pi/2]: a line has no direction, and
// dx = 0 is no pole. Angles of lines repeat every pi, so their mean is half the mean direction of
// the doubled angles, moved by the mean of the deviations, which are folded into the same range. A
// pair without a line (no difference on two axes) takes no part in that slope's fit and is not
// dropped for it. Means little where the translation is no larger than the keypoints' noise.
//
// Keeps the order. Throws Error{kInvalidArgument} when a correspondence points outside its array.
std::vector<Correspondence> filter_slope(std::span<const Correspondence> correspondences,
                                         std::span<const Eigen::Vector3f> target,
                                         std::span<const Eigen::Vector3f> query,
                                         const SlopeOptions& options);

}  // namespace landmarkdb
