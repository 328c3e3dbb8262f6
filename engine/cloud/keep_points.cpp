#include "engine/cloud/keep_points.hpp"

#include <cstddef>

namespace landmarkdb {
namespace {

template <typename T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty() || values.size() == kept.size()) return;
  for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
  values.resize(kept.size());
}

}  // namespace

void keep_points(PointCloud& cloud, const std::vector<std::uint32_t>& kept) {
  keep(cloud.points, kept);
  keep(cloud.normals, kept);
  keep(cloud.colours, kept);
  keep(cloud.weights, kept);
  keep(cloud.viewpoint_index, kept);
}

}  // namespace landmarkdb
