#include "tests/unit/store/store_support.hpp"

#include <cstdlib>

#include <Eigen/Geometry>

namespace landmarkdb::testing {
namespace {

Eigen::Vector3f random_vector(Random& random, double reach) {
  return Eigen::Vector3f(static_cast<float>(random.uniform(-reach, reach)),
                         static_cast<float>(random.uniform(-reach, reach)),
                         static_cast<float>(random.uniform(-reach, reach)));
}

void fill_cloud(PreparedCloud& cloud, std::size_t count, Random& random) {
  cloud.viewpoints = {Eigen::Vector3f(0.0F, 0.0F, 1.5F), Eigen::Vector3f(2.0F, 1.0F, 1.5F)};
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points.push_back(random_vector(random, 5.0));
    cloud.normals.push_back(random_vector(random, 1.0).normalized());
    cloud.viewpoint_index.push_back(static_cast<std::uint16_t>(random.below(2)));
  }
  cloud.origin = Eigen::Vector3d(4'512'345.678'901, 512'345.123'456'789, 0.1);
  cloud.resolution_m = 0.05;
  cloud.normals_from_viewpoint = true;
  cloud.counts = {count + 30, 10, 15, 5, count};
}

void fill_descriptors(DescriptorSet& set, std::size_t count, Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    set.keypoints.push_back(random_vector(random, 5.0));
    set.normals.push_back(random_vector(random, 1.0).normalized());
    const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
    set.frames.emplace_back(q.normalized().toRotationMatrix().cast<float>());
    Eigen::VectorXf row(static_cast<Eigen::Index>(kShotLength));
    for (float& value : row) value = static_cast<float>(random.uniform());
    row.normalize();
    set.values.insert(set.values.end(), row.begin(), row.end());
  }
  set.dropped = 3;
}

}  // namespace

SceneRecord make_record(const std::string& name, std::uint64_t seed, RecordSize size) {
  Random random(seed);
  SceneRecord record;
  record.name = name;
  record.kind = seed % 2 == 0 ? EntryKind::kObject : EntryKind::kPlace;
  record.options = {0.05, 0.15, 0.4, 0.2, KeypointMethod::kIss};
  fill_cloud(record.prepared, size.points, random);
  fill_descriptors(record.descriptors, size.keypoints, random);
  record.up = Eigen::Vector3d::UnitZ();
  record.sources = {"station 1.pcd", "Größe.ply"};
  record.warnings = {"units_suspect"};
  return record;
}

void expect_same_record(const SceneRecord& seen, const SceneRecord& wanted) {
  EXPECT_EQ(seen.name, wanted.name);
  EXPECT_EQ(seen.kind, wanted.kind);
  EXPECT_EQ(seen.options, wanted.options);
  EXPECT_EQ(seen.up, wanted.up);
  EXPECT_EQ(seen.sources, wanted.sources);
  EXPECT_EQ(seen.warnings, wanted.warnings);
  EXPECT_EQ(seen.prepared.points, wanted.prepared.points);
  EXPECT_EQ(seen.prepared.normals, wanted.prepared.normals);
  EXPECT_EQ(seen.prepared.origin, wanted.prepared.origin);
  EXPECT_EQ(seen.prepared.viewpoints, wanted.prepared.viewpoints);
  EXPECT_EQ(seen.prepared.viewpoint_index, wanted.prepared.viewpoint_index);
  EXPECT_EQ(seen.prepared.resolution_m, wanted.prepared.resolution_m);
  EXPECT_EQ(seen.prepared.normals_from_viewpoint, wanted.prepared.normals_from_viewpoint);
  EXPECT_EQ(seen.prepared.counts.points, wanted.prepared.counts.points);
  EXPECT_EQ(seen.prepared.counts.not_finite, wanted.prepared.counts.not_finite);
  EXPECT_EQ(seen.prepared.counts.duplicates, wanted.prepared.counts.duplicates);
  EXPECT_EQ(seen.prepared.counts.out_of_range, wanted.prepared.counts.out_of_range);
  EXPECT_EQ(seen.prepared.counts.used, wanted.prepared.counts.used);
  EXPECT_EQ(seen.descriptors.keypoints, wanted.descriptors.keypoints);
  EXPECT_EQ(seen.descriptors.normals, wanted.descriptors.normals);
  EXPECT_EQ(seen.descriptors.dropped, wanted.descriptors.dropped);
  ASSERT_EQ(seen.descriptors.frames.size(), wanted.descriptors.frames.size());
  for (std::size_t i = 0; i < seen.descriptors.frames.size(); ++i) {
    EXPECT_TRUE(seen.descriptors.frames[i].isApprox(wanted.descriptors.frames[i], 1e-6F)) << i;
  }
  ASSERT_EQ(seen.descriptors.values.size(), wanted.descriptors.values.size());
  for (std::size_t i = 0; i < seen.descriptors.values.size(); ++i) {
    ASSERT_NEAR(seen.descriptors.values[i], wanted.descriptors.values[i], 2e-4F) << i;
  }
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace landmarkdb::testing
