#include "client/load_cloud.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

class LoadCloud : public ::testing::Test {
 protected:
  LoadCloud() { std::ofstream(path_) << "1000 2000 3000\n4000 5000 6000\n7000 8000 9500\n0 0 0\n"; }
  ~LoadCloud() override { std::filesystem::remove(path_); }
  std::string path_ = ::testing::TempDir() + "landmarkdb_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".xyz";
};

TEST_F(LoadCloud, ReadsInTheUnitsNamed) {
  const PointCloud cloud = load_cloud(path_, {.units = "mm", .camera = {}, .viewpoint = {}});
  ASSERT_EQ(cloud.size(), 4U);
  EXPECT_NEAR(cloud.points[0].z() + cloud.origin.z(), 3.0, 1e-6);
}

TEST_F(LoadCloud, TakesTheViewpointInTheCloudsFrameAndUnits) {
  const PointCloud cloud = load_cloud(
      path_, {.units = "mm", .camera = {}, .viewpoint = Eigen::Vector3d(1000, 2000, 500)});
  ASSERT_EQ(cloud.viewpoints.size(), 1U);
  EXPECT_EQ(cloud.viewpoints[0].cast<double>() + cloud.origin, Eigen::Vector3d(1, 2, 0.5));
}

TEST_F(LoadCloud, NamesTheFileThatIsNotThere) {
  EXPECT_THROW(load_cloud("/nowhere/x.ply", {}), Error);
  EXPECT_THROW(load_cloud(path_, {.units = "m", .camera = "/nowhere/camera.yaml", .viewpoint = {}}),
               Error);
}

TEST_F(LoadCloud, RefusesFewerThanFourUsablePoints) {
  std::ofstream(path_) << "1 2 3\n4 5 6\n7 8 9\nnan nan nan\n";
  try {
    load_cloud(path_, {});
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(std::string(error.what()).find("3 usable points of 4"), std::string::npos);
  }
}

TEST_F(LoadCloud, TakesNoUnitsForADepthImage) {
  EXPECT_THROW(load_cloud(path_, {.units = "mm", .camera = "camera.yaml", .viewpoint = {}}),
               cli::UsageError);
}

}  // namespace
}  // namespace landmarkdb::client
