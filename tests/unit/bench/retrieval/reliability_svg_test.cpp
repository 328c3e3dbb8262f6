#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/retrieval/calibration.hpp"

namespace landmarkdb::bench {

namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::vector<ReliabilityBin> some_bins() {
  Eigen::VectorXd confidences(6);
  Eigen::VectorXd right(6);
  confidences << 0.05, 0.06, 0.55, 0.95, 0.97, 0.99;
  right << 0, 0, 1, 1, 1, 0;
  return reliability(confidences, right);
}

TEST(ReliabilitySvg, HasAPointForEachBinThatIsNotEmpty) {
  const std::string svg = reliability_svg(some_bins());
  EXPECT_THAT(svg, StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(occurrences(svg, "<circle "), 3U);
}

TEST(ReliabilitySvg, PutsAPointWhereItsConfidenceAndShareAre) {
  // The square begins at 64, 24 and is 400 wide; 1 of 1 is right at 0.55.
  EXPECT_THAT(reliability_svg(some_bins()), HasSubstr("<circle cx=\"284.00\" cy=\"24.00\""));
}

TEST(ReliabilitySvg, WritesTheCountOfEachBin) {
  const std::string svg = reliability_svg(some_bins());
  EXPECT_EQ(occurrences(svg, ">0</text>"), 7U);
  EXPECT_EQ(occurrences(svg, ">3</text>"), 1U);
}

TEST(ReliabilitySvg, IsTheSameForTheSameBins) {
  EXPECT_EQ(reliability_svg(some_bins()), reliability_svg(some_bins()));
}

TEST(ReliabilitySvg, DrawsAxesWithoutAnyRows) {
  const std::string svg = reliability_svg(reliability(Eigen::VectorXd(), Eigen::VectorXd()));
  EXPECT_EQ(occurrences(svg, "<circle "), 0U);
  EXPECT_EQ(occurrences(svg, "nan"), 0U);
}

}  // namespace

}  // namespace landmarkdb::bench
