#include "datasets/picture/storey_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace landmarkdb::datasets {
namespace {

constexpr float kBin_m = 0.05F;
constexpr float kReach_m = 8.0F;  // points further off in plan may belong to another room

constexpr double kAlmost = 0.7;  // of the densest height: as likely a floor or a ceiling

enum class Of { kFloor, kCeiling };

// The height in (low, high) around which most points near the sensor lie; of heights about as dense
// (the ceiling of the storey below, the floor of the one above) the one next to the sensor.
float densest(Of side,
              std::span<const Eigen::Vector3f> points,
              const Eigen::Vector3f& sensor,
              float low,
              float high,
              float otherwise) {
  std::vector<int> bins(static_cast<std::size_t>((high - low) / kBin_m) + 1, 0);
  for (const Eigen::Vector3f& p : points) {
    if (!(p.z() > low && p.z() < high)) continue;
    if ((p - sensor).head<2>().norm() > kReach_m) continue;
    ++bins[static_cast<std::size_t>((p.z() - low) / kBin_m)];
  }
  const int most = *std::max_element(bins.begin(), bins.end());
  if (most == 0) return otherwise;
  const auto dense = [&](int count) { return count >= kAlmost * most; };
  const auto at = side == Of::kCeiling
                      ? std::find_if(bins.begin(), bins.end(), dense) - bins.begin()
                      : bins.rend() - std::find_if(bins.rbegin(), bins.rend(), dense) - 1;
  return low + kBin_m * (static_cast<float>(at) + 0.5F);
}

}  // namespace

StoreyCut find_storey(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& sensor) {
  constexpr float kMargin_m = 0.15F;
  constexpr float kPlanHeight_m = 2.3F;  // a cut above heads and doors, below most lamps
  const float floor =
      densest(Of::kFloor, points, sensor, sensor.z() - 2.6F, sensor.z() - 0.3F, sensor.z() - 1.5F);
  const float ceiling = densest(
      Of::kCeiling, points, sensor, floor + 2.0F, floor + 3.6F, floor + kPlanHeight_m + kMargin_m);
  return {floor - kMargin_m, std::min(floor + kPlanHeight_m, ceiling - kMargin_m)};
}

double straighten_rad(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kSample = 20'000;
  constexpr int kAngles = 180;
  if (points.empty()) return 0.0;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSample);
  double best_rad = 0.0;
  double best_area = -1.0;
  std::vector<float> xs, ys;
  for (int i = 0; i < kAngles; ++i) {
    const double angle = std::numbers::pi * (static_cast<double>(i) / kAngles - 0.5);
    const auto c = static_cast<float>(std::cos(angle));
    const auto s = static_cast<float>(std::sin(angle));
    xs.clear();
    ys.clear();
    for (std::size_t k = 0; k < points.size(); k += step) {
      xs.push_back(c * points[k].x() - s * points[k].y());
      ys.push_back(s * points[k].x() + c * points[k].y());
    }
    const auto spread = [](std::vector<float>& v) {  // between the first and last half per cent
      const auto low = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 200);
      const auto high = v.end() - 1 - static_cast<std::ptrdiff_t>(v.size() / 200);
      std::nth_element(v.begin(), low, v.end());
      const float a = *low;
      std::nth_element(v.begin(), high, v.end());
      return *high - a;
    };
    const double width = spread(xs);
    const double depth = spread(ys);
    if (width < depth) continue;  // the other half turn has it the right way round
    if (best_area < 0.0 || width * depth < best_area) {
      best_area = width * depth;
      best_rad = angle;
    }
  }
  return best_rad;
}

void drop_strays(std::vector<Eigen::Vector3f>& points) {
  constexpr float kCell_m = 0.12F;
  constexpr double kDense = 12.0;    // points a cell on the mean; below this nothing is dropped
  constexpr std::uint32_t kFew = 8;  // in a cell and the 26 around it: this is air
  const auto key_of = [](const std::array<std::int64_t, 3>& cell) {
    // 21 bits an axis: 250 km of cells; beyond, cells may share a key, which does no harm here.
    std::uint64_t key = 0;
    for (const std::int64_t i : cell) {
      key = (key << 21U) | (static_cast<std::uint64_t>(i + (1 << 20)) & 0x1fffffU);
    }
    return key;
  };
  const auto cell_of = [](const Eigen::Vector3f& p) {
    std::array<std::int64_t, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float at = std::floor(p[static_cast<int>(k)] / kCell_m);
      cell[k] = static_cast<std::int64_t>(std::clamp(at, -1e9F, 1e9F));
    }
    return cell;
  };
  std::unordered_map<std::uint64_t, std::uint32_t> counts;
  for (const Eigen::Vector3f& p : points) ++counts[key_of(cell_of(p))];
  if (static_cast<double>(points.size()) < kDense * static_cast<double>(counts.size())) return;
  std::erase_if(points, [&](const Eigen::Vector3f& p) {
    const std::array<std::int64_t, 3> cell = cell_of(p);
    std::uint32_t around = 0;
    for (int i = 0; i < 27 && around <= kFew; ++i) {
      const auto found =
          counts.find(key_of({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1}));
      if (found != counts.end()) around += found->second;
    }
    return around <= kFew;
  });
}

}  // namespace landmarkdb::datasets
