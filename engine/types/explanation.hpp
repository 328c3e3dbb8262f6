#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// How much was left after a step of the search, in the order of the steps: "points", "used",
// "keypoints", "putative", what each filter that was used left, "proposals", "survivors",
// "refined", "verified", "expected", "places", "confident".
struct FunnelStep {
  std::string name;
  std::uint64_t count = 0;
};

// The same steps for one entry, from the pairs on.
struct SceneFunnel {
  std::string scene;
  std::vector<FunnelStep> steps;
  double best_quality = 0.0;  // of its verified poses; 0 where there is none
};

// One figure that the confidence is made from, in log-odds of the confidence, all other figures as
// they are: `worth` is by how much they would fall if this one were as bad as it gets, `cost` by
// how much they would rise if it were `ideal`.
struct ConfidenceTerm {
  std::string name;
  double value = 0.0;
  double ideal = 0.0;
  double worth = 0.0;
  double cost = 0.0;
};

enum class CandidateRole {
  kBest,
  kRival,   // explains the query about as well as the best: the two make the answer ambiguous
  kBehind,  // does not
};

// A place that was weighed for the answer, with what spoke for and against it. Shares are 0..1 and
// mean what they mean in Fit.
struct ExplainedCandidate {
  std::string scene;
  CandidateRole role = CandidateRole::kBest;
  Eigen::Matrix4d T_scene_sensor = Eigen::Matrix4d::Identity();
  double confidence = 0.0;
  double quality = 0.0;
  double overlap = 0.0;
  double explained = 0.0;
  double crossed = 0.0;  // free_space_violation
  double coverage = 0.0;
  double observability = 0.0;
  double margin = 0.0;
  // Standard deviations along and about the scene's axes: x, y, z in metres, then radians.
  Eigen::Matrix<double, 6, 1> deviation = Eigen::Matrix<double, 6, 1>::Zero();
  // From the best one, where both are in one scene: between the sensors, and between their turns.
  std::optional<double> distance_m;
  std::optional<double> turn_rad;
  std::vector<ConfidenceTerm> terms;  // costliest first
};

// A parameter that would have changed the answer: found by deciding again with it, on what the
// search had found.
struct Remedy {
  std::string option;  // as the command line calls it: "--min-confidence"
  std::string value;   // "0.41"; empty where the value is the asker's to know
  std::string effect;  // "localized", "ambiguous", or what else it would have left
};

// Why the answer is what it is.
struct Explanation {
  std::vector<FunnelStep> funnel;   // of all entries together
  std::vector<SceneFunnel> scenes;  // those that came furthest first, at most kMostExplainedScenes
  std::vector<ExplainedCandidate> candidates;  // best first, at most kMostExplainedCandidates
  std::string lost_at;           // the stage that lost the query; empty where it was localized
  std::string why;               // that, as a sentence
  std::vector<Remedy> remedies;  // the nearest first
};

inline constexpr std::size_t kMostExplainedScenes = 20;
inline constexpr std::size_t kMostExplainedCandidates = 6;

}  // namespace landmarkdb
