#include "engine/matching/rotation_from_frames.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMaxCandidates = 2000;
constexpr int kMaxRefinements = 10;       // it settles in two or three
constexpr double kSettled = 1.0 - 1e-12;  // cosine of half the turn of a round, some 3e-6 rad

using Quaternions = std::vector<Eigen::Vector4d>;  // unit length, sign without meaning

Quaternions proposals(std::span<const Correspondence> correspondences,
                      std::span<const Eigen::Matrix3f> target_frames,
                      std::span<const Eigen::Matrix3f> query_frames) {
  Quaternions result;
  result.reserve(correspondences.size());
  for (const Correspondence& pair : correspondences) {
    if (pair.target >= target_frames.size() || pair.query >= query_frames.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "correspondence of query " + std::to_string(pair.query) + " and target " +
                      std::to_string(pair.target) + " for " + std::to_string(query_frames.size()) +
                      " and " + std::to_string(target_frames.size()) + " frames");
    }
    const Eigen::Matrix3d R =
        (target_frames[pair.target] * query_frames[pair.query].transpose()).cast<double>();
    result.push_back(Eigen::Quaterniond(R).normalized().coeffs());
  }
  return result;
}

bool agree(const Eigen::Vector4d& a, const Eigen::Vector4d& b, double min_cosine) {
  return std::abs(a.dot(b)) > min_cosine;
}

// The mean rotation of those that agree with `centre` (Markley 2007): the quaternion that is
// closest to all of them, signs left aside.
Eigen::Vector4d mean_of_agreeing(const Quaternions& all,
                                 const Eigen::Vector4d& centre,
                                 double min_cosine) {
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const Eigen::Vector4d& q : all) {
    if (agree(q, centre, min_cosine)) scatter += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(scatter);
  return solver.eigenvectors().col(3);
}

std::size_t support_of(const Quaternions& all, const Eigen::Vector4d& centre, double min_cosine) {
  return static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [&](const Eigen::Vector4d& q) {
        return agree(q, centre, min_cosine);
      }));
}

struct Candidate {
  std::size_t support = 0;
  std::size_t index = 0;
};

// Up to kMaxCandidates proposals, evenly picked, best supported first.
std::vector<Candidate> candidates_of(const Quaternions& all, double min_cosine) {
  const std::size_t count = std::min(all.size(), kMaxCandidates);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = i * all.size() / count;
    candidates.push_back({support_of(all, all[index], min_cosine), index});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.support != b.support ? a.support > b.support : a.index < b.index;
  });
  return candidates;
}

// A mean may agree with a straggler less than the proposal it grew from and is still the better
// estimate, so it is taken whatever its support.
Eigen::Vector4d refined(const Quaternions& all, Eigen::Vector4d centre, double min_cosine) {
  for (int round = 0; round < kMaxRefinements; ++round) {
    const Eigen::Vector4d mean = mean_of_agreeing(all, centre, min_cosine);
    const bool settled = agree(mean, centre, kSettled);
    centre = mean;
    if (settled) break;
  }
  return centre;
}

}  // namespace

std::vector<RotationVote> rotations_from_frames(std::span<const Correspondence> correspondences,
                                                std::span<const Eigen::Matrix3f> target_frames,
                                                std::span<const Eigen::Matrix3f> query_frames,
                                                std::size_t most,
                                                const RotationVoteOptions& options) {
  const Quaternions all = proposals(correspondences, target_frames, query_frames);
  // The inner product of two unit quaternions is the cosine of half the angle between them.
  const double min_cosine = std::cos(options.agreement_rad / 2.0);
  std::vector<RotationVote> votes;
  Quaternions found;
  const auto known = [&](const Eigen::Vector4d& q) {
    return std::any_of(found.begin(), found.end(), [&](const Eigen::Vector4d& other) {
      return agree(q, other, min_cosine);
    });
  };
  for (const Candidate& candidate : candidates_of(all, min_cosine)) {
    if (votes.size() >= most) break;
    if (known(all[candidate.index])) continue;
    const Eigen::Vector4d q = refined(all, all[candidate.index], min_cosine);
    const std::size_t support = support_of(all, q, min_cosine);
    if (known(q) || support < std::max<std::size_t>(options.min_support, 1)) continue;
    found.push_back(q);
    votes.push_back({Eigen::Quaterniond(q).normalized().toRotationMatrix(), support});
  }
  return votes;
}

std::optional<RotationVote> rotation_from_frames(std::span<const Correspondence> correspondences,
                                                 std::span<const Eigen::Matrix3f> target_frames,
                                                 std::span<const Eigen::Matrix3f> query_frames,
                                                 const RotationVoteOptions& options) {
  const std::vector<RotationVote> votes =
      rotations_from_frames(correspondences, target_frames, query_frames, 1, options);
  if (votes.empty()) return std::nullopt;
  return votes.front();
}

}  // namespace landmarkdb
