#include "engine/registration/propose_from_planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

namespace landmarkdb {

namespace {

constexpr std::size_t kMostShifts = 14;  // along one direction, where planes fix it
constexpr std::size_t kMostSwept = 48;   // where they do not
constexpr float kOfBest = 0.4F;          // a shift that lays less of the best one's onto planes
constexpr float kFewOnPlanes = 0.04F;    // of the source: planes along a direction that fix it
constexpr float kSweepStepBins = 3.0F;   // what testing on the wide grid can be off by

struct Shift {
  float metres = 0.0F;  // from the source's offset (its sign turned) to the target's
  float score = 0.0F;
};

// A side of the target along one direction, with what lies one bin beside: planes fall across two.
std::vector<float> widened(const std::vector<float>& count) {
  std::vector<float> wide(count.size());
  for (std::size_t i = 0; i < count.size(); ++i) {
    wide[i] =
        count[i] + (i > 0 ? count[i - 1] : 0.0F) + (i + 1 < count.size() ? count[i + 1] : 0.0F);
  }
  return wide;
}

// Turned end for end, as a direction taken the other way has it.
PlaneLayout::Offsets reversed(const PlaneLayout::Offsets& offsets, float bin_m) {
  PlaneLayout::Offsets turned;
  turned.count = {offsets.count[1], offsets.count[0]};
  for (std::vector<float>& side : turned.count) std::reverse(side.begin(), side.end());
  turned.first_m = -(offsets.first_m + bin_m * static_cast<float>(offsets.count[0].size()));
  return turned;
}

// How much of the source meets planes when its first bin falls on the target's bin `at`.
float met(const std::array<std::vector<float>, 2>& target,
          const PlaneLayout::Offsets& source,
          std::ptrdiff_t at) {
  float sum = 0.0F;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto size = static_cast<std::ptrdiff_t>(target[side].size());
    const auto count = static_cast<std::ptrdiff_t>(source.count[side].size());
    const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -at);
    const std::ptrdiff_t end = std::min(count, size - at);
    const float* there = target[side].data() + at;
    const float* here = source.count[side].data();
    for (std::ptrdiff_t i = begin; i < end; ++i) sum += std::min(here[i], there[i]);
  }
  return sum;
}

// The best shifts, none beside a better one.
std::vector<Shift> best_of(std::vector<Shift> all, float bin_m) {
  std::stable_sort(
      all.begin(), all.end(), [](const Shift& a, const Shift& b) { return a.score > b.score; });
  std::vector<Shift> kept;
  for (const Shift& shift : all) {
    if (kept.size() >= kMostShifts || shift.score < kOfBest * all.front().score) break;
    const bool beside = std::any_of(kept.begin(), kept.end(), [&](const Shift& other) {
      return std::abs(other.metres - shift.metres) < 1.5F * bin_m;
    });
    if (!beside) kept.push_back(shift);
  }
  return kept;
}

std::vector<Shift> swept(float low_m, float high_m, float bin_m) {
  const float step =
      std::max(kSweepStepBins * bin_m, (high_m - low_m) / static_cast<float>(kMostSwept));
  std::vector<Shift> shifts;
  for (std::size_t i = 0; i < kMostSwept; ++i) {
    const float at = low_m + step * static_cast<float>(i);
    if (at > high_m) break;
    shifts.push_back({at, 0.0F});
  }
  return shifts;
}

// Whether enough of the source lies on planes along a direction to fix it there.
bool fixes(const PlaneLayout::Offsets& offsets, float source_points) {
  return offsets.total() >= kFewOnPlanes * source_points;
}

// Shifts along the target's direction `k` of the source's `offsets`, `centre_m` along them.
std::vector<Shift> shifts_along(const PlaneLayout& target,
                                std::size_t k,
                                const PlaneLayout::Offsets& offsets,
                                float source_points,
                                float centre_m) {
  const float bin_m = target.bin_m;
  const float low_m = target.low_m[k] - centre_m;
  const float high_m = target.high_m[k] - centre_m;
  if (!fixes(offsets, source_points)) return swept(low_m, high_m, bin_m);
  const std::array<std::vector<float>, 2> wide{widened(target.offsets[k].count[0]),
                                               widened(target.offsets[k].count[1])};
  std::vector<Shift> all;
  const std::size_t steps = target.offsets[k].count[0].size();  // what the target spans, in bins
  for (std::size_t i = 0; i <= steps; ++i) {
    const float metres = low_m + bin_m * static_cast<float>(i);
    const float at = (offsets.first_m + metres - target.offsets[k].first_m) / bin_m;
    const auto bin = static_cast<std::ptrdiff_t>(std::lround(at));
    all.push_back({metres, met(wide, offsets, bin)});
  }
  return best_of(std::move(all), bin_m);
}

// The 24 ways to lay one frame of right angles onto another: direction j of the source becomes
// direction of[j] of the target, turned round where sign[j] is -1.
struct Turn {
  std::array<std::size_t, 3> of;
  std::array<int, 3> sign;
};

std::vector<Turn> all_turns() {
  std::vector<Turn> turns;
  std::array<std::size_t, 3> of{0, 1, 2};
  do {
    const bool even = (of[1] + 3 - of[0]) % 3 == 1;
    for (int signs = 0; signs < 8; ++signs) {
      const std::array<int, 3> sign{
          (signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -1 : 1, (signs & 4) != 0 ? -1 : 1};
      if (sign[0] * sign[1] * sign[2] == (even ? 1 : -1)) turns.push_back({of, sign});
    }
  } while (std::next_permutation(of.begin(), of.end()));
  return turns;
}

Eigen::Matrix3f rotation_of(const Turn& turn,
                            const PlaneLayout& target,
                            const PlaneLayout& source) {
  Eigen::Matrix3f R = Eigen::Matrix3f::Zero();
  for (std::size_t j = 0; j < 3; ++j) {
    R += static_cast<float>(turn.sign[j]) * target.axes.col(static_cast<Eigen::Index>(turn.of[j])) *
         source.axes.col(static_cast<Eigen::Index>(j)).transpose();
  }
  return R;
}

// Shifts for each direction of the target, of the source and each sign; most serve many turns.
class ShiftTable {
 public:
  ShiftTable(const PlaneLayout& target, const PlaneLayout& source, const Eigen::Vector3f& centre) {
    const auto points = static_cast<float>(source.points);
    for (std::size_t j = 0; j < 3; ++j) {
      const float along = source.axes.col(static_cast<Eigen::Index>(j)).dot(centre);
      const PlaneLayout::Offsets turned = reversed(source.offsets[j], source.bin_m);
      for (std::size_t k = 0; k < 3; ++k) {
        shifts_[j][k][0] = shifts_along(target, k, source.offsets[j], points, along);
        shifts_[j][k][1] = shifts_along(target, k, turned, points, -along);
      }
    }
  }
  const std::vector<Shift>& of(std::size_t j, const Turn& turn) const {
    return shifts_[j][turn.of[j]][turn.sign[j] < 0 ? 1 : 0];
  }

 private:
  std::array<std::array<std::array<std::vector<Shift>, 2>, 3>, 3> shifts_;
};

}  // namespace

std::vector<Proposal> propose_from_planes(const PlaneLayout& target,
                                          const PlaneLayout& source,
                                          const Eigen::Vector3f& centre,
                                          const std::optional<Gravity>& gravity,
                                          const std::optional<PositionPrior>& prior) {
  std::vector<Proposal> proposals;
  const auto fixed = std::count_if(
      source.offsets.begin(), source.offsets.end(), [&](const PlaneLayout::Offsets& offsets) {
        return fixes(offsets, static_cast<float>(source.points));
      });
  if (fixed < 2) return proposals;  // a floor alone: any place on any floor
  const ShiftTable table(target, source, centre);
  for (const Turn& turn : all_turns()) {
    const Eigen::Matrix3f R = rotation_of(turn, target, source);
    const std::optional<Eigen::Matrix3f> upright = gravity ? made_upright(R, *gravity) : R;
    if (!upright) continue;
    const auto direction = [&](std::size_t j) {
      return target.axes.col(static_cast<Eigen::Index>(turn.of[j]));
    };
    for (const Shift& a : table.of(0, turn)) {
      for (const Shift& b : table.of(1, turn)) {
        for (const Shift& c : table.of(2, turn)) {
          const Eigen::Vector3f t =
              a.metres * direction(0) + b.metres * direction(1) + c.metres * direction(2);
          Proposal proposal;
          proposal.R_target_source = *upright;
          proposal.t_target_source = R * centre + t - *upright * centre;
          proposal.correspondence = kNoCorrespondence;
          if (!prior || is_within(*prior, proposal)) proposals.push_back(proposal);
        }
      }
    }
  }
  return proposals;
}

}  // namespace landmarkdb
