#include "bench/retrieval/calibration_samples.hpp"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace landmarkdb::bench {

namespace {

using testing::ElementsAre;

const std::string kHeader =
    "place,right,overlap,explained,crossed,margin,observability,inliers,colour\n";

CsvTable table_of(const std::string& text, const std::string& file = "a.csv") {
  std::istringstream in(text);
  return read_csv(in, file);
}

Samples samples_of(const std::vector<CsvTable>& tables, const std::vector<std::string>& names) {
  return make_samples(tables, choose_features(tables, names));
}

std::string complaint(const std::string& text, const std::vector<std::string>& names = {}) {
  try {
    samples_of({table_of(text)}, names);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "none";
}

std::vector<std::string> names_of(const std::vector<Feature>& features) {
  std::vector<std::string> names;
  for (const Feature& feature : features) names.emplace_back(feature.name);
  return names;
}

TEST(MakeSamples, MakesTheFeaturesOfARow) {
  const Samples samples = samples_of({table_of(kHeader + "p,1,0.8,0.9,0.01,0.7,0.02,9,red\n"
                                                         "q,0,0.5,0.6,0.2,0.1,0.3,0,blue\n")},
                                     {});
  EXPECT_THAT(
      samples.names,
      ElementsAre(
          "constant", "margin", "observability", "explained", "overlap", "crossed", "log_inliers"));
  Eigen::MatrixXd expected(2, 7);
  expected << 1, 0.4, 0.4, 0.9, 0.8, 0.01, std::log(10.0), 1, 0.1, 1.0, 0.6, 0.5, 0.2, 0;
  EXPECT_LT((samples.features - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(samples.right, Eigen::Vector2d(1, 0));
}

TEST(MakeSamples, TellsPlacesOfOneNameInTwoFilesApart) {
  const std::string rows = "p,1,1,1,0,1,1,9,x\nq,0,1,1,0,1,1,9,x\np,1,1,1,0,1,1,9,x\n";
  const Samples samples =
      samples_of({table_of(kHeader + rows, "a.csv"), table_of(kHeader + rows, "b.csv")}, {});
  EXPECT_THAT(samples.place_names, ElementsAre("a.csv p", "a.csv q", "b.csv p", "b.csv q"));
  EXPECT_THAT(samples.places, ElementsAre(0U, 1U, 0U, 2U, 3U, 2U));
}

TEST(MakeSamples, TellsPlacesOfTwoCataloguesOfOneFileApart) {
  const Samples samples = samples_of(
      {table_of("place,right,margin,catalog\np,1,1,0\np,0,1,1\nq,0,1,1\np,1,1,0\n")}, {"margin"});
  EXPECT_THAT(samples.place_names, ElementsAre("a.csv 0 p", "a.csv 1 p", "a.csv 1 q"));
  EXPECT_THAT(samples.places, ElementsAre(0U, 1U, 2U, 0U));
}

TEST(MakeSamples, CountsQueriesWithoutAPoseApart) {
  const Samples samples =
      samples_of({table_of(kHeader + "p,1,1,1,0,1,1,9,x\nq,0,1,1,0,0,1,9,x\nq,0,0,0,0,0,0,0,x\n")},
                 {"margin"});
  EXPECT_EQ(samples.size(), 2U);  // a margin of zero is no reason to leave a row out
  EXPECT_EQ(samples.without_pose, 1U);
}

TEST(ChooseFeatures, TakesContrastWhereAllFilesHaveIt) {
  const CsvTable without = table_of("place,right,margin\n");
  const CsvTable with = table_of("place,right,contrast\n");
  EXPECT_THAT(names_of(choose_features(std::vector{with, with}, {})),
              testing::Contains("contrast"));
  EXPECT_THAT(names_of(choose_features(std::vector{with, without}, {})),
              testing::Not(testing::Contains("contrast")));
}

TEST(ChooseFeatures, TakesThoseNamedAlone) {
  const std::vector<CsvTable> tables;
  const std::vector<std::string> names = {"quality", "margin"};
  EXPECT_THAT(names_of(choose_features(tables, names)), ElementsAre("margin", "quality"));
}

TEST(ChooseFeatures, RefusesNamesThatAreNoneOrComeTwice) {
  EXPECT_THAT(complaint(kHeader, {"margins"}),
              testing::StartsWith("feature 'margins' is unknown, want some of margin, "));
  EXPECT_EQ(complaint(kHeader, {"margin", "margin"}),
            "feature 'margin' comes twice, want each once");
}

TEST(MakeSamples, NamesAMissingColumn) {
  EXPECT_EQ(complaint("place,right,margin\np,1,0.5\n"),
            "a.csv: has no column 'observability', want the output of landmarkdb-bench-retrieval");
  EXPECT_EQ(complaint("right,margin\n1,0.5\n", {"margin"}),
            "a.csv: has no column 'place', want the output of landmarkdb-bench-retrieval");
  EXPECT_EQ(complaint(kHeader, {"contrast"}),
            "a.csv: has no column 'contrast', want the output of landmarkdb-bench-retrieval");
}

TEST(MakeSamples, NamesTheLineOfANumberThatIsNone) {
  EXPECT_EQ(complaint(kHeader + "#\np,1,0.8,0.9,0.01,0.7,much,9,x\n"),
            "a.csv:3: observability is 'much', want a finite number");
  EXPECT_EQ(complaint(kHeader + "p,2,0.8,0.9,0.01,0.7,0.1,9,x\n"),
            "a.csv:2: right is '2', want 0 or 1");
}

TEST(MakeSamples, RefusesRowsThatNothingCanBeLearntFrom) {
  const std::string right = "p,1,1,1,0,1,1,9,x\n";
  const std::string wrong = "p,0,1,1,0,1,1,9,x\n";
  EXPECT_EQ(complaint(kHeader), "no rows with a pose, want right and wrong ones of several places");
  EXPECT_EQ(complaint(kHeader + right + right), "all rows are right, want wrong ones too");
  EXPECT_EQ(complaint(kHeader + wrong + wrong), "all rows are wrong, want right ones too");
  EXPECT_EQ(complaint(kHeader + right + wrong),
            "all rows are of one place, 'a.csv p', want two or more");
}

}  // namespace

}  // namespace landmarkdb::bench
