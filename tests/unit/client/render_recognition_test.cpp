#include "client/render_recognition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/model_view.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::HasSubstr;

RecognizeResult recognized() {
  RecognizeResult result;
  result.status = RecognizeStatus::kRecognized;
  result.image_points = 20;
  MonoHypothesis hypothesis;
  hypothesis.model = "box";
  hypothesis.confidence = 0.97;
  hypothesis.T_camera_object.translation() = Eigen::Vector3d(0.1, 0.2, 0.6);
  hypothesis.T_camera_object.linear() =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  hypothesis.model_points = 16;
  hypothesis.visible_points = 12;
  hypothesis.rms_px = 0.4;
  hypothesis.margin = 5.0;
  hypothesis.pairs = {{0, 3, 0.1}, {1, 4, 0.2}};
  result.hypotheses = {hypothesis};
  return result;
}

TEST(RenderRecognition, HasTheDocumentedKeysInTheirOrder) {
  const auto json = recognition_json(recognized());
  EXPECT_EQ(json["status"], "recognized");
  EXPECT_FALSE(json.contains("reason"));
  const std::string text = json["hypotheses"][0].dump();
  std::size_t last = 0;
  for (const char* key : {"model",
                          "confidence",
                          "T_camera_object",
                          "euler_zyx_deg",
                          "translation_m",
                          "matched",
                          "model_points",
                          "image_points",
                          "rms_px",
                          "symmetry",
                          "pairs"}) {
    const std::size_t at = text.find('"' + std::string(key) + "\":");
    EXPECT_NE(at, std::string::npos) << key;
    EXPECT_GE(at, last) << key;
    last = at;
  }
  EXPECT_NEAR(json["hypotheses"][0]["euler_zyx_deg"][0].get<double>(), 28.6479, 1e-3);
  EXPECT_NEAR(json["hypotheses"][0]["euler_zyx_deg"][2].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(json["hypotheses"][0]["matched"], 2);
  EXPECT_EQ(json["seed"], 1);
  EXPECT_EQ(json["hypotheses"][0]["T_camera_object"][11], 0.6);
}

TEST(RenderRecognition, SaysWhyNothingWasFound) {
  RecognizeResult result;
  result.reason = "verify: no pose had enough points";
  EXPECT_EQ(recognition_json(result)["reason"], result.reason);
  EXPECT_THAT(recognition_text(result), HasSubstr("not found: verify"));
  EXPECT_EQ(recognize_exit_status(result), 3);
}

TEST(RenderRecognition, ExitsWith4WhereARivalCannotBeToldApart) {
  RecognizeResult result = recognized();
  EXPECT_EQ(recognize_exit_status(result), 0);
  result.hypotheses[0].ambiguous = true;
  EXPECT_EQ(recognize_exit_status(result), 4);
  EXPECT_THAT(recognition_text(result), HasSubstr("ambiguous"));
  result = recognized();
  result.hypotheses.push_back(result.hypotheses[0]);
  EXPECT_EQ(recognize_exit_status(result), 0);
  result.hypotheses[0].margin = 0.1;
  EXPECT_EQ(recognize_exit_status(result), 4);
}

TEST(RenderRecognition, TextHasThePoseAndTheFigures) {
  const std::string text = recognition_text(recognized());
  EXPECT_THAT(text, HasSubstr("recognized: model box, confidence 0.97"));
  EXPECT_THAT(text, HasSubstr("x 0.1000  y 0.2000  z 0.6000 m"));
  EXPECT_THAT(text, HasSubstr("2 of 12 visible points (16 in all)"));
}

TEST(RenderRecognition, ModelsAreListed) {
  ModelInfo model;
  model.summary.name = "box";
  model.summary.points = 16;
  model.summary.points_of_type = {8, 2, 6, 0};
  model.summary.symmetry = "none";
  model.json = R"({"name":"box"})";
  EXPECT_EQ(model_json(model)["points"], 16);
  EXPECT_EQ(model_json(model)["state"], "active");
  EXPECT_EQ(model_json(model)["model"]["name"], "box");
  EXPECT_EQ(models_json({model.summary})["models"][0]["points_of_type"]["centroid"], 6);
  EXPECT_THAT(cli::models_text({model.summary}), HasSubstr("box"));
  EXPECT_EQ(cli::models_text({}), "no models\n");
  model.summary.damage = "its triples are damaged";
  EXPECT_EQ(model_json(model)["state"], "quarantined");
  EXPECT_THAT(cli::model_text(model.summary), HasSubstr("damaged, not served"));
}

}  // namespace
}  // namespace landmarkdb::client
