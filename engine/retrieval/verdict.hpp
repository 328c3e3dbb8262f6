#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/retrieval/assess.hpp"
#include "engine/retrieval/entries.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// A pose that answers, with its confidence and its lead.
struct Judged {
  Assessed pose;
  double confidence = 0.0;
  double margin = 0.0;  // 1 - (best different pose's score) / (this one's)
  bool rival = false;   // it explains the query about as well as the best, which is none itself
};

struct Verdict {
  QueryStatus status = QueryStatus::kNotFound;
  std::string reason;  // for kNotFound
  std::string lacks;   // what the best pose was asked and does not reach, if there is one
  std::vector<Judged>
      judged;  // best first; all that explain the query about equally well come first
};

struct VerdictOptions {
  double min_confidence = 0.5;
  // A rival whose score reaches this share of the best one's explains the query about as well.
  double rival_share = 0.93;
  // What would be localized without the rivals that reach this share is ambiguous.
  double close_share = 0.85;
  // Of a place that has rivals: what an area of the view contradicts by more than this share is
  // another place, and so is what puts more than this share of the view where the scanner looked
  // through. Without rivals both are in the confidence.
  double most_contradicted = 0.05;
  double most_refuted = 0.005;
  // Of an object, from this confidence on the rest is not asked, being in it.
  double sure_confidence = 0.8;
  // Of an object, below that confidence. A rival against which hardly more of the points that tell
  // the two apart speak for the best is one too, and one in reach (of this share) against which
  // less than two thirds do (0.3 = 0.65 - 0.35).
  double least_contrast = 0.1;
  double reach_share = 0.65;
  double least_contrast_in_reach = 0.3;
  // Below this the surface leaves a freedom open (a slide along a wall, a turn of a bottle), and
  // any pose along it is a rival.
  double least_observability = 0.01;
  // Of a place: a lone wall measures half of this at the most. Of 1,300 frames of generated places
  // ten right poses and no wrong one lay between 0.004 and 0.01.
  double least_observability_of_place = 0.006;
  // An object that is 8 % longer than the one asked for looks much like it, so that more is asked
  // of an answer than the half: this confidence, this score, and that no more than these shares of
  // the outline and of the view speak against it.
  double least_confidence_of_object = 0.7;
  double least_score_of_object = 0.78;
  double most_continued = 0.25;
  double most_contradicted_of_object = 0.25;
  // An object's pose, below that confidence, that is not this believable by its own evidence
  // answers nothing, however far the others are behind. The threshold of the log-odds -1: 1 / (1 +
  // e).
  double least_alone = 0.27;
  // Two poses are different places when they are further apart than these (in cells: 0.5 m in a
  // room described at 5 cm, and no more than that in coarser ones), or in different entries.
  double different_translation_cells = 10.0;
  double different_translation_most_m = 0.5;
  double different_rotation_rad = 0.175;
};

// How far apart two poses in the entry are different places.
double place_radius_m(const Entry& entry, const VerdictOptions& options);

// Judges the assessed poses of all entries against one another. `entries` says what each pose's
// `entry` is; `centre` (sensor frame) is where two poses are compared.
Verdict judge(std::vector<Assessed> assessed,
              const Entries& entries,
              const Eigen::Vector3d& centre,
              const VerdictOptions& options);

}  // namespace landmarkdb
