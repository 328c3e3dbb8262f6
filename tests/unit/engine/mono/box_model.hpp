#pragma once

#include <memory>
#include <span>
#include <string>

#include "engine/geometry/camera.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb::testing {

// A box of 0.12 x 0.10 x 0.08 m with a wedge cut off one edge, so that no turn maps it onto
// itself; everything derived and its triples made.
inline std::shared_ptr<const MonoModelRecord> box_record() {
  static const std::shared_ptr<const MonoModelRecord> record = [] {
    const std::string text = R"({"name": "box", "units": "m",
      "points": [[-0.06,-0.05,-0.04],[0.06,-0.05,-0.04],[0.06,0.05,-0.04],[-0.06,0.05,-0.04],
                 [-0.06,-0.05,0.04],[0.02,-0.05,0.04],[0.02,0.05,0.04],[-0.06,0.05,0.04],
                 [0.06,-0.05,0.00],[0.06,0.05,0.00]],
      "faces": [[0,3,2,1],[4,5,6,7],[0,1,8,5,4],[2,3,7,6,9],[0,4,7,3],[1,2,9,8],[5,8,9,6]]})";
    auto made = std::make_shared<MonoModelRecord>();
    made->model = parse_model(std::as_bytes(std::span(text)), "box.json", {}).model;
    made->triples = make_triples(made->model);
    return made;
  }();
  return record;
}

// 640 x 480, f 600 px, with a barrel distortion.
inline Camera bent_camera() {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.fx = c.fy = 600.0;
  c.cx = 319.5;
  c.cy = 239.5;
  c.dist[0] = -0.25;
  return c;
}

}  // namespace landmarkdb::testing
