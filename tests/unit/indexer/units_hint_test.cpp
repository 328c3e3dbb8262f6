#include "indexer/units_hint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/usage_error.hpp"

namespace landmarkdb::indexer {
namespace {

using ::testing::HasSubstr;

TEST(ParseUnits, ReadsWhatUnitsNameWrites) {
  for (const Units units :
       {Units::kMetres, Units::kMillimetres, Units::kCentimetres, Units::kInches}) {
    EXPECT_EQ(parse_units(units_name(units)), units);
  }
  EXPECT_THROW(parse_units("M"), cli::UsageError);
  EXPECT_THROW(parse_units(""), cli::UsageError);
}

TEST(GuessUnits, FindsMillimetresThatWereReadAsMetres) {
  EXPECT_EQ(guess_units(5200.0, Units::kMetres, EntryKind::kPlace), Units::kMillimetres);
}

TEST(GuessUnits, FindsMetresThatWereReadAsMillimetres) {
  EXPECT_EQ(guess_units(0.0052, Units::kMillimetres, EntryKind::kPlace), Units::kMetres);
}

TEST(GuessUnits, GivesUpOnTheAbsurd) {
  EXPECT_EQ(guess_units(1e12, Units::kMetres, EntryKind::kPlace), std::nullopt);
}

TEST(UnitsHint, NamesSizeUnitAndFactor) {
  EXPECT_THAT(units_hint(5200.0, Units::kMetres, EntryKind::kPlace),
              AllOf(HasSubstr("units_suspect"),
                    HasSubstr("5200 m"),
                    HasSubstr("--units mm"),
                    HasSubstr("factor of 0.001"),
                    HasSubstr("5.2 m")));
}

TEST(ExtentOf, IsTheBoxesDiagonal) {
  EXPECT_DOUBLE_EQ(extent_of({}), 0.0);
  const std::vector<Eigen::Vector3f> points = {{0, 0, 0}, {3, 4, 0}, {1, 1, 0}};
  EXPECT_DOUBLE_EQ(extent_of(points), 5.0);
}

}  // namespace
}  // namespace landmarkdb::indexer
