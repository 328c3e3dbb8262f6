#include "cli/version.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "store/store.hpp"

namespace landmarkdb::cli {
namespace {

TEST(VersionText, NamesProgramDatabaseAndProtocol) {
  EXPECT_THAT(version_text("landmarkdb"),
              ::testing::MatchesRegex(
                  "landmarkdb [0-9]+\\.[0-9]+\\.[0-9]+ \\(database version [0-9]+, protocol "
                  "version [0-9]+\\)"));
}

TEST(VersionText, AgreesWithTheStore) { EXPECT_EQ(kDatabaseVersion, schema_version()); }

}  // namespace
}  // namespace landmarkdb::cli
