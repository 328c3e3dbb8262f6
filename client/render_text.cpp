#include "client/render_text.hpp"

#include <algorithm>
#include <numbers>
#include <string_view>
#include <utility>

#include "cli/table.hpp"
#include "client/render_explanation.hpp"
#include "client/render_json.hpp"
#include "engine/base/print.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string pose_text(const Eigen::Matrix4d& T) {
  const Eigen::Vector3d t = T.topRightCorner<3, 1>();
  const Eigen::Vector3d rpy =
      roll_pitch_yaw_rad(nearest_rotation(T.topLeftCorner<3, 3>())) * kDegrees;
  return print("x %.3f  y %.3f  z %.3f m   roll %.2f  pitch %.2f  yaw %.2f deg",
               t.x(),
               t.y(),
               t.z(),
               rpy.x(),
               rpy.y(),
               rpy.z());
}

std::string place_text(const Hypothesis& h) {
  std::string out = "scene " + cli::printable(h.scene);
  if (h.scene_version > 0) out += print(" (version %lld)", static_cast<long long>(h.scene_version));
  if (h.landmark) out += ", landmark " + cli::printable(*h.landmark);
  return out + print(", confidence %.2f%s", h.confidence, h.rival ? ", a rival of the first" : "");
}

std::string details_text(const Hypothesis& h) {
  std::string out = "  pose        " + pose_text(h.T_scene_sensor) + "\n";
  out += "  chain       sensor -> landmark   " + pose_text(h.chain.T_landmark_sensor) + "\n";
  out += "              landmark -> scene    " + pose_text(h.chain.T_scene_landmark) +
         print("   scale %.4f\n", h.chain.scale);
  out += "              refinement           " + pose_text(h.chain.T_icp) + "\n";
  out += print(
      "  pairs       %u putative, %u after ratio, %u after slope, %u consistent, %u inliers\n",
      h.counts.putative,
      h.counts.after_ratio,
      h.counts.after_slope,
      h.counts.after_consistency,
      h.counts.inliers);
  out += print("  fit         overlap %.2f, rmse %.4f m, free space violated %.2f, margin %.2f\n",
               h.fit.overlap,
               h.fit.rmse_m,
               h.fit.free_space_violation,
               h.fit.margin);
  return out;
}

std::string footer_text(const QueryResult& result) {
  std::string out =
      print("  query       %llu points, %llu used, %llu invalid, %llu keypoints, seed %llu\n",
            static_cast<unsigned long long>(result.query.points),
            static_cast<unsigned long long>(result.query.points_used),
            static_cast<unsigned long long>(result.query.invalid),
            static_cast<unsigned long long>(result.query.keypoints),
            static_cast<unsigned long long>(result.seed));
  const StageTimings& t = result.timings;
  out += print(
      "  time        %.0f ms: load %.0f, preprocess %.0f, keypoints %.0f, describe %.0f, match "
      "%.0f, "
      "filter %.0f, pose %.0f, icp %.0f, verify %.0f\n",
      t.total.count(),
      t.load.count(),
      t.preprocess.count(),
      t.keypoints.count(),
      t.describe.count(),
      t.match.count(),
      t.filter.count(),
      t.pose.count(),
      t.icp.count(),
      t.verify.count());
  for (const std::string& warning : result.warnings) {
    out += "  warning     " + cli::printable(warning);
    if (const std::string_view meaning = warning_meaning(warning); !meaning.empty()) {
      out += ": " + std::string(meaning);
    }
    out += "\n";
  }
  return out;
}

}  // namespace

std::string_view warning_meaning(std::string_view warning) {
  constexpr std::pair<std::string_view, std::string_view> kMeanings[] = {
      {"units_suspect", "the cloud's size is unusual for metres; check --units"},
      {"low_overlap", "only a part of the cloud lies on the scene"},
      {"planar_scene", "mostly one plane: the pose can slide along it"},
      {"density_mismatch", "much coarser than what the scene was described at"},
      {"correspondences_cut", "too many pairs to send; each keypoint's farthest are left out"},
      {"gravity_unknown", "the scene was indexed without --up, so this one says nothing"},
      {"normals_unoriented", "no viewpoint known; normals may point either way"},
  };
  for (const auto& [name, meaning] : kMeanings) {
    if (name == warning) return meaning;
  }
  return {};
}

std::string ambiguity_text(std::span<const Hypothesis> hypotheses) {
  const auto rivals = std::count_if(
      hypotheses.begin(), hypotheses.end(), [](const Hypothesis& h) { return h.rival; });
  if (rivals > 0) {
    return print("%lld poses explain the cloud about equally well",
                 static_cast<long long>(rivals) + 1);
  }
  return "the pose cannot be told from others (--explain says from which)";
}

std::string query_text(const QueryResult& result) {
  std::string out(status_name(result.status));
  if (result.status == QueryStatus::kNotFound) {
    out += ": " + cli::printable(result.reason) + "\n";
    out +=
        "  hint        is the place indexed (landmarkdb scene list), are the units right "
        "(--units),\n";
    out +=
        "              does the cloud see more than a wall? --explain says what was missing, and "
        "what would do\n";
  } else if (result.status == QueryStatus::kAmbiguous) {
    out += ": " + ambiguity_text(result.hypotheses) + "\n";
  } else if (!result.hypotheses.empty()) {
    out += ": " + place_text(result.hypotheses.front()) + "\n";
    out += details_text(result.hypotheses.front());
  }
  // Beside a localized answer the others are only mentioned; otherwise they are all there is.
  const bool localized = result.status == QueryStatus::kLocalized;
  for (std::size_t i = localized ? 1 : 0; i < result.hypotheses.size(); ++i) {
    const Hypothesis& h = result.hypotheses[i];
    out += print("  %zu. %s\n", i + 1, place_text(h).c_str());
    out += localized ? "  pose        " + pose_text(h.T_scene_sensor) + "\n" : details_text(h);
  }
  out += footer_text(result);
  if (result.explanation) out += explanation_text(*result.explanation);
  return out;
}

}  // namespace landmarkdb::client
