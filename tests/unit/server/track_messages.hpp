#pragma once

#include "proto/landmarkdb.pb.h"
#include "tests/support/moving_box.hpp"

namespace landmarkdb::testing {

inline v1::TrackOpenRequest open_request(const MovingBox& box) {
  v1::TrackOpenRequest request;
  request.set_model("box");
  v1::Camera& camera = *request.mutable_camera();
  camera.set_width(box.camera.width);
  camera.set_height(box.camera.height);
  camera.set_fx(box.camera.fx);
  camera.set_fy(box.camera.fy);
  camera.set_cx(box.camera.cx);
  camera.set_cy(box.camera.cy);
  for (const double k : box.camera.dist) camera.add_dist(k);
  return request;
}

inline v1::TrackFrameRequest frame_request(const MovingBox& box, std::uint32_t track, int frame) {
  v1::TrackFrameRequest request;
  request.set_track(track);
  const ImageFeatures features = box.features(frame);
  for (const ImageFeature& feature : features.points) {
    v1::ImagePoint& point = *request.mutable_points()->add_points();
    point.set_type(static_cast<v1::FeatureType>(static_cast<int>(feature.type) + 1));
    point.set_u(feature.uv.x());
    point.set_v(feature.uv.y());
  }
  for (const auto& [a, b] : features.links) {
    request.mutable_points()->add_links(a);
    request.mutable_points()->add_links(b);
  }
  return request;
}

inline v1::TrackFrameRequest empty_frame(std::uint32_t track) {
  v1::TrackFrameRequest request;
  request.set_track(track);
  request.mutable_points();
  return request;
}

}  // namespace landmarkdb::testing
