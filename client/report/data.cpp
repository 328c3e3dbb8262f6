#include "client/report/data.hpp"

#include <nlohmann/json.hpp>

#include "client/pose_values.hpp"
#include "client/report/html.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/geometry/quantise.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

Json points_json(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& origin) {
  const QuantisedPoints quantised = quantise(points);
  return {{"offset", vector_json(origin + quantised.offset_m)},
          {"scale", quantised.scale_m},
          {"xyz", base64(quantised.bytes)}};
}

Json candidate_json(const DrawnCandidate& candidate) {
  Json out;
  out["T_scene_sensor"] = to_row_major(candidate.T_scene_sensor);
  out["T_scene_landmark"] = to_row_major(candidate.chain.T_scene_landmark);
  out["T_icp"] = to_row_major(candidate.chain.T_icp);
  out["up"] = vector_json(candidate.up);
  out["above_right"] = vector_json(candidate.above_right);
  out["side_right"] = vector_json(candidate.side_right);
  out["spacing_m"] = candidate.place->spacing_m;
  out["cut_m"] = candidate.cut_m ? Json(*candidate.cut_m) : Json(nullptr);
  out["place"] = points_json(candidate.place->points, candidate.place->origin);
  out["pairs"] = {{"inliers", candidate.inliers}, {"rejected", candidate.rejected}};
  return out;
}

}  // namespace

Json drawing_json(const Drawing& drawing) {
  Json out;
  out["query"] = points_json(drawing.query, drawing.origin);
  out["viewpoint"] = vector_json(drawing.viewpoint);
  out["up"] = vector_json(drawing.up);
  out["above_right"] = vector_json(drawing.above_right);
  out["side_right"] = vector_json(drawing.side_right);
  out["frustum"] = Json::array();
  for (const std::vector<Eigen::Vector3d>& line : drawing.frustum) {
    Json points = Json::array();
    for (const Eigen::Vector3d& point : line) points.push_back(vector_json(point));
    out["frustum"].push_back(std::move(points));
  }
  out["candidates"] = Json::array();
  for (const DrawnCandidate& candidate : drawing.candidates) {
    out["candidates"].push_back(candidate_json(candidate));
  }
  return out;
}

}  // namespace landmarkdb::client
