// A model from its file to an answer: indexer, server, client.
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "datasets/mono/render_model.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/visibility.hpp"
#include "engine/types/feature_names.hpp"
#include "tests/integration/site.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kBox = std::string(LANDMARKDB_SOURCE) + "/datasets/models/box.json";

class Recognition : public ::testing::Test {
 protected:
  Recognition() : model(read_model(kBox, {}).model) {
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = 600.0;
    camera.cx = 320.0;
    camera.cy = 240.0;
    camera.dist[0] = -0.15;
    camera_file = write("camera.json",
                        R"({"width": 640, "height": 480, "fx": 600, "fy": 600, "cx": 320,
                            "cy": 240, "dist": [-0.15, 0, 0, 0, 0]})");
    // The top with its circle and two sides are seen.
    T_camera_object.linear() =
        Eigen::AngleAxisd(-2.2, Eigen::Vector3d::UnitX()).toRotationMatrix() *
        Eigen::AngleAxisd(2.6, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T_camera_object.translation() = Eigen::Vector3d(0.0, 0.0, 0.42) -
                                    T_camera_object.linear() * Eigen::Vector3d(0.06, 0.04, 0.03);
    const Outcome added =
        run("landmarkdb-indexer", {"--db", db, "--json", "model", "add", "box", kBox});
    EXPECT_EQ(added.status, 0) << added.out << added.err;
  }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }

  // What a perfect detector would find: each seen point where it projects to.
  std::string points_file() const {
    json points = json::array();
    const ModelVisibility visibility(model);
    const std::vector<bool> seen = visibility.points_from(T_camera_object.inverse().translation());
    std::vector<int> place(model.points.size(), -1);
    for (std::size_t i = 0; i < model.points.size(); ++i) {
      if (!seen[i]) continue;
      const Eigen::Vector3d p = T_camera_object * model.points[i].xyz;
      const Eigen::Vector2d uv = distort(camera, {p.x() / p.z(), p.y() / p.z()});
      place[i] = static_cast<int>(points.size());
      points.push_back(
          {{"type", feature_type_name(model.points[i].type)}, {"uv", {uv.x(), uv.y()}}});
    }
    json links = json::array();
    for (const auto& [a, b] : model.edges) {
      if (place[a] >= 0 && place[b] >= 0) links.push_back({place[a], place[b]});
    }
    return write("points.json", json{{"points", points}, {"links", links}}.dump());
  }

  std::string image_file() const {
    const GreyImage image = datasets::render_model(model, camera, T_camera_object, {});
    std::string pgm = "P5\n640 480\n255\n";
    pgm.append(image.pixels.begin(), image.pixels.end());
    return write("image.pgm", pgm);
  }

  void expect_truth(const json& hypothesis, double metres, double radians) const {
    EXPECT_EQ(hypothesis["model"], "box");
    const Eigen::Matrix4d T = matrix(hypothesis["T_camera_object"]);
    EXPECT_LT((T.topRightCorner<3, 1>() - T_camera_object.translation()).norm(), metres);
    EXPECT_LT(rotation_angle_rad(T.topLeftCorner<3, 3>().transpose() * T_camera_object.linear()),
              radians);
  }

  TempFolder folder;
  std::string db = folder / "models.db";
  MonoModel model;
  Camera camera;
  std::string camera_file;
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
};

TEST_F(Recognition, FindsTheBoxByFeaturePoints) {
  ServerProcess server(db);
  const Outcome outcome =
      server.client({"--json", "recognize", "--points", points_file(), "--camera", camera_file});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const json answer = outcome.json();
  EXPECT_EQ(answer["status"], "recognized");
  const json& best = answer["hypotheses"][0];
  expect_truth(best, 1e-3, 5e-3);
  EXPECT_EQ(best["model_points"], 16);
  EXPECT_EQ(best["matched"], best["pairs"].size());
  EXPECT_GE(best["matched"].get<int>(), 8);
  EXPECT_EQ(best["symmetry"], "none");
  EXPECT_EQ(best["covariance"].size(), 36U);
  for (const char* key : {"features", "lookup", "verify", "refine", "total"}) {
    EXPECT_TRUE(answer["timing_ms"].contains(key)) << key;
  }
  const json stats = server.client({"--json", "stats"}).json();
  EXPECT_EQ(stats["models"], 1);
  EXPECT_EQ(stats["recognized"], 1);
}

TEST_F(Recognition, FindsTheBoxInAnImageAndDrawsIt) {
  ServerProcess server(db);
  const std::string overlay = folder / "seen.png";
  const Outcome outcome = server.client(
      {"--json", "recognize", image_file(), "--camera", camera_file, "--overlay", overlay});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  expect_truth(outcome.json()["hypotheses"][0], 5e-3, 0.03);
  std::ifstream png(overlay, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(png), {}};
  EXPECT_TRUE(bytes.starts_with("\x89PNG"));
  EXPECT_GT(bytes.size(), 10'000U);
}

TEST_F(Recognition, ModelsAreChangedOverTheSocketAndServedAtOnce) {
  ServerProcess server(db);
  const std::string points = points_file();
  EXPECT_EQ(server.client({"--json", "model", "list"}).json()["models"].size(), 1U);
  EXPECT_EQ(server.client({"--json", "model", "show", "box"}).json()["model"]["points"].size(),
            16U);
  EXPECT_EQ(server.client({"model", "remove", "box"}).status, 0);
  const Outcome gone =
      server.client({"--json", "recognize", "--points", points, "--camera", camera_file});
  EXPECT_EQ(gone.status, 3) << gone.out;
  EXPECT_EQ(gone.json()["status"], "not_found");
  EXPECT_FALSE(gone.json()["reason"].get<std::string>().empty());
  EXPECT_EQ(server.client({"--json", "model", "add", "parcel", kBox}).json()["name"], "parcel");
  EXPECT_EQ(server.client({"--json", "model", "add", "parcel", kBox}).json()["replaced"], true);
  EXPECT_EQ(server.client({"--json", "model", "rename", "parcel", "box"}).json()["name"], "box");
  EXPECT_EQ(server.client({"recognize", "--points", points, "--camera", camera_file}).status, 0);
}

TEST_F(Recognition, BadInputIsToldAndHarmsNothing) {
  ServerProcess server(db);
  const std::string small = write(
      "small.json", R"({"width": 320, "height": 240, "fx": 300, "fy": 300, "cx": 160, "cy": 120})");
  const std::string image = image_file();
  const Outcome misfit = server.client({"recognize", image, "--camera", small});
  EXPECT_NE(misfit.status, 0);
  EXPECT_THAT(misfit.err, ::testing::AnyOf(HasSubstr("320 x 240"), HasSubstr("pixels")));
  const std::string black = write("black.pgm", "P5\n640 480\n255\n" + std::string(640 * 480, '\0'));
  EXPECT_EQ(server.client({"recognize", black, "--camera", camera_file}).status, 3);
  const std::string vast = write("vast.pgm", "P5\n12000 9000\n255\n");
  const Outcome promised = server.client({"recognize", vast, "--camera", camera_file});
  EXPECT_EQ(promised.status, 7);
  EXPECT_THAT(promised.err, HasSubstr("vast.pgm: "));
  const std::string wide =
      write("wide.json",
            R"({"width": 12000, "height": 9000, "fx": 600, "fy": 600, "cx": 6000, "cy": 4500})");
  const Outcome over = server.client({"recognize", vast, "--camera", wide});
  EXPECT_EQ(over.status, 7);  // asked again it would be no other
  EXPECT_THAT(over.err, HasSubstr("the server takes at most"));
  const std::string few = write("few.json", R"({"points": [{"uv": [1, 2]}]})");
  EXPECT_EQ(server.client({"recognize", "--points", few, "--camera", camera_file}).status, 3);
  const std::string none = write("none.json", R"({"points": []})");
  EXPECT_EQ(server.client({"recognize", "--points", none, "--camera", camera_file}).status, 3);
  const std::string line = write("line.json", R"({"points": [
      {"uv": [50, 240]}, {"uv": [150, 240]}, {"uv": [250, 240]}, {"uv": [350, 240]},
      {"uv": [450, 240]}, {"uv": [50, 240]}, {"uv": [50, 240]}]})");
  EXPECT_EQ(server.client({"recognize", "--points", line, "--camera", camera_file}).status, 3);
  const std::string outside = write("outside.json", R"({"points": [
      {"uv": [-9e5, 0]}, {"uv": [9e5, 7]}, {"uv": [0, -8e5]}, {"uv": [1, 8e5]}, {"uv": [1, 1]}]})");
  const Outcome far = server.client({"recognize", "--points", outside, "--camera", camera_file});
  EXPECT_EQ(far.status, 3);
  EXPECT_THAT(far.out, HasSubstr("outside_lens_model"));
  for (const char* text : {"{",
                           "{}",
                           R"({"points": [{"uv": [1]}]})",
                           R"({"points": [{"uv": [1, null]}]})",
                           R"({"points": [{"type": "edge", "uv": [1, 2]}]})"}) {
    const std::string bad = write("bad.json", text);
    EXPECT_EQ(server.client({"recognize", "--points", bad, "--camera", camera_file}).status, 7)
        << text;
  }
  EXPECT_EQ(server.client({"recognize", image, "--camera", camera_file, "--model", "cup"}).status,
            3);
  EXPECT_EQ(server.client({"recognize", "--camera", camera_file}).status, 2);
  EXPECT_EQ(server.client({"model", "add", "x", few}).status, 7);
  EXPECT_EQ(server.client({"recognize", image, "--camera", camera_file}).status, 0);
}

}  // namespace
}  // namespace landmarkdb::testing
