#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/retrieval/object_catalog.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::bench {

// An object pose is right when its centre is within a tenth of the object's extent (0.10 m at most)
// and it is turned by no more than kRightDegrees.
inline constexpr double kRightShareOfExtent = 0.1;
// An instance that shows this much is to be found; less may be.
inline constexpr double kLeastUnhidden = 0.3;
inline constexpr std::size_t kLeastPixels = 600;

// What a hypothesis turned out to be.
struct JudgedHypothesis {
  bool right = false;            // the pose of an instance
  bool right_symmetric = false;  // up to a motion of the object onto itself
  double metres = 99.0;          // of the nearest instance of that object; far where there is none
  double degrees = 180.0;
  double unhidden = 0.0;  // of that instance
  std::size_t pixels = 0;
  std::size_t thing = 0;  // its index among the scene's things
};
JudgedHypothesis judge_hypothesis(const Hypothesis& hypothesis, const AskedScene& asked);

// Counts over scenes, and over instances and claims (hypotheses of confidence 0.5 and more).
struct ObjectTally {
  std::size_t shown = 0;  // scenes with an instance to be found
  std::size_t shown_first = 0, shown_right = 0, shown_wrong = 0, shown_ambiguous = 0;
  std::size_t part = 0, part_right = 0, part_wrong = 0;  // what they have is mostly hidden
  std::size_t none = 0, none_wrong = 0, none_ambiguous = 0;
  std::size_t instances = 0, listed = 0, claimed = 0;  // to be found; at any rank; confidently
  std::size_t claims = 0, false_claims = 0;
  std::vector<double> milliseconds, metres, degrees;  // the last two: of right answers

  void add(const QueryResult& answer, const AskedScene& asked);
};
std::string object_tally_text(const ObjectTally& tally);

}  // namespace landmarkdb::bench
