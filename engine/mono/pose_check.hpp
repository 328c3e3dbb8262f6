#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/edge_evidence.hpp"
#include "engine/mono/edge_grid.hpp"
#include "engine/mono/image_view.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

// A model's point and the image point (by its number in the ImageView) that it is held for.
struct Match {
  std::uint16_t model = 0;
  std::uint16_t image = 0;
  float distance_px = 0.0F;
};

// One model at one pose with what speaks for it.
struct MonoCandidate {
  std::uint32_t model = 0;  // index into the search models
  RigidPose pose;
  std::vector<Match> matches{};
  std::size_t visible = 0;
  bool unlike = false;  // its matches hold only where things may differ from their models
  double rms_px = 0.0;
  double log10_nfa = 0.0;  // of points, links and directions together
  double edge_share = 0.0;
  double edge_odds = 0.0;  // log10, negative for the model: see score_edges
  EdgeEvidence edges{};
  double shape_odds = 0.0;  // log10, positive for the model: see stretched_rival
  double face_odds = 0.0;   // the same: see face_rival
  bool ambiguous = false;   // `twin`, the other tilt of a plane, fits about as well
  RigidPose twin{};
  double twin_odds = 0.0;  // of the twin against the pose
  // How much better it explains the image than the mirror image of its model does; none: the mirror
  // image does not explain it at all.
  std::optional<double> mirror_margin{};
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  // Lower is better: edges decide where the points do not.
  double rank() const { return log10_nfa + edge_odds; }
};

struct CheckOptions {
  double min_depth_m = 0.05, max_depth_m = 20.0;
  double log10_tests = 5.0;  // how many hypotheses there could have been (1e5: method B)
  double scale = 1.0;        // of the pixel tolerances, which are those of a 640 pixels wide image
};

// Puts hypotheses to the test: how many of the model's visible points meet an image feature of
// their type (Huttenlocher and Ullman 1990), and how likely that many are by chance (Moisan and
// Stival 2004). One a search: it keeps marks between calls. Not thread-safe.
class PoseCheck {
 public:
  PoseCheck(std::span<const SearchModel> models,
            const ImageView& image,
            const EdgeGrid& edges,
            const Camera& camera,
            const CheckOptions& options);

  // The quick look: matches within 8 px, enough of them to go on with. Empty: not enough.
  std::span<const Match> look(std::uint32_t model, const RigidPose& pose);

  // How many visible points lie within 8 px of a feature, a part of them by chance; 0 where that is
  // too few for the quick look and for growing.
  std::size_t count_near(std::uint32_t model, const RigidPose& pose);

  // Where the quick look fails but seven points agree: refines the pose on them and looks again, as
  // long as their number grows. A pose from a small part of a large model is not good enough yet at
  // its far end.
  std::span<const Match> grow(std::uint32_t model, RigidPose& pose);

  // Refines a pose that passed the quick look, counting again at 5 and 3.5 px, and says what speaks
  // for it. Where the image's edges are known, also with what things differ from their models added
  // to that: the better of the two is given. nullopt where too little is left.
  std::optional<MonoCandidate> settle(std::uint32_t model,
                                      const RigidPose& pose,
                                      std::span<const Match> start);

  // Refinement with the edges of the image too, and their share; `rank` counts it from there.
  void settle_on_edges(MonoCandidate& candidate) const;

  // What the model's own proportions and the run of its edges say; for `write_answer`.
  void judge_shape(MonoCandidate& candidate) const;

  bool has_edges() const { return !edges_.empty(); }

  std::size_t looks() const { return looks_; }

 private:
  const std::vector<std::uint16_t>* seen_at(std::uint32_t model, const RigidPose& pose) const;
  std::size_t collect(std::uint32_t model,
                      const RigidPose& pose,
                      std::span<const std::uint16_t> seen,
                      double reach_px,
                      std::size_t need);
  std::vector<PosePoint> matched_points(const MonoCandidate& candidate) const;
  double reach_px(std::uint32_t model, const RigidPose& pose, double image_px, double unlike) const;
  // With things that may be `unlike` (of the diameter) their models.
  std::optional<MonoCandidate> settle_within(std::uint32_t model,
                                             const RigidPose& pose,
                                             std::span<const Match> start,
                                             double unlike);
  bool refine(std::uint32_t model, RigidPose& pose, MonoCandidate* result) const;
  // How much likelier this share of its edges is where the model stands than where something else
  // has made it fit: log10, negative for the model. Samples are `step_px` apart in an image 640
  // pixels wide.
  double score_edges(std::size_t samples, double step_px, double share) const;

  std::span<const SearchModel> models_;
  const ImageView& image_;
  const EdgeGrid& edges_;
  const Camera& camera_;
  CheckOptions options_;
  std::vector<std::uint32_t> marks_;  // by image point: the call that has used it
  std::vector<float> marks_distance_;
  std::uint32_t call_ = 0;
  std::size_t looks_ = 0;
  std::vector<Match> matches_;
};

}  // namespace landmarkdb
