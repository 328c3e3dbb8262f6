#pragma once

#include <span>
#include <vector>

#include "engine/types/query.hpp"

namespace landmarkdb {

// Similarity of two histograms, as the paper's Table 1 gives it:
//
//   correlation     1 exact .. -1 miss     chi2            0 exact .. 2 miss
//   intersection    1 exact ..  0 miss     l1              0 exact .. 1 miss
//   l2              0 exact ..  1 miss     bhattacharyya   0 exact .. 1 miss
//
// Histograms hold no negative numbers; they are normalised first, to unit length for l2 and
// correlation (after taking the mean off), to sum 1 for the others. A histogram without content
// (all zero; for correlation: all equal) is the zero vector in these formulas. Both of one length;
// throws Error{kInvalidArgument} otherwise. Cost: linear. Thread-safe.
double measure(Measure which, std::span<const float> a, std::span<const float> b);

// The same as a dissimilarity, 0 exact and larger for less similar, whichever way the measure's own
// scale runs: 1 - value for correlation (0..2) and intersection (0..1), the value itself for the
// others. Single precision: what the indexes rank by and return.
float dissimilarity(Measure which, std::span<const float> a, std::span<const float> b);

// Turns a dissimilarity into the measure's own value.
double measure_of_dissimilarity(Measure which, double dissimilarity);

// True for the measures which are Euclidean distances of normalised vectors: l2, correlation and
// bhattacharyya.
bool is_euclidean(Measure which);

// Writes `histogram`, normalised for `which`, to `out` (same length). For Euclidean measures the
// squared distance of two normalised vectors is 2 d^2 (l2, bhattacharyya) or 2 d (correlation),
// where d is the dissimilarity.
void normalise_histogram(Measure which, std::span<const float> histogram, std::span<float> out);

// The dissimilarity of two vectors that normalise_histogram made. The same bytes on every machine.
float normalised_dissimilarity(Measure which, std::span<const float> a, std::span<const float> b);

}  // namespace landmarkdb
