#include "engine/features/check_cloud.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;

std::string message_of(const PreparedCloud& cloud) {
  try {
    check_cloud(cloud, "describe");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "";
}

TEST(CheckCloud, SaysWhatIsWrongAndWhere) {
  PreparedCloud cloud = testing::corner_room(1);
  EXPECT_EQ(message_of(cloud), "");
  EXPECT_EQ(message_of({}), "");
  cloud.normals[12].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message_of(cloud), HasSubstr("point 12"));
  cloud.points[5].z() = -std::numeric_limits<float>::infinity();
  EXPECT_THAT(message_of(cloud), HasSubstr("describe: point 5"));
  cloud.normals.pop_back();
  EXPECT_THAT(message_of(cloud), HasSubstr("normals"));
}

TEST(CheckLength, TakesPositiveNumbersOnly) {
  EXPECT_NO_THROW(check_length(1e-9, "radius"));
  for (const double bad : {0.0, -0.1, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(check_length(bad, "radius"), Error);
  }
}

}  // namespace
}  // namespace landmarkdb
