// landmarkdb-bench-shot: our SHOT beside pcl::SHOTEstimationOMP, on the same keypoints in one run.
//
// An argument is the radius in millimetres. Counters: `neighbours`, the mean number of points in
// reach; `us`, processor microseconds a descriptor with both threads at work; `ratio`, PCL's time
// of this run over this one; `equal`, the share of rows within 1e-4 of PCL's; `difference`, the
// largest of them that are.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <map>
#include <string>

#include <benchmark/benchmark.h>
#include <pcl/console/print.h>
#include <pcl/features/shot_omp.h>
#include <pcl/point_types.h>

#include "bench/micro/shot_cloud.hpp"
#include "engine/cloud/cell_grid.hpp"
#include "engine/features/describe_shot.hpp"

namespace {

using namespace landmarkdb;
using Shots = pcl::PointCloud<pcl::SHOT352>;

constexpr std::uint64_t kSeed = 10'000;
constexpr std::size_t kScanPoints = 600'000;
constexpr std::size_t kKeypoints = 0;  // all there are, some 15,000: as when a place is indexed
constexpr int kThreads = 2;
constexpr double kEqual = 1e-4;

const bench::ShotCloud& cloud() {
  static const bench::ShotCloud made = bench::make_shot_cloud(kScanPoints, kKeypoints, kSeed);
  return made;
}

// What PCL's run at a radius left for those after it.
struct PclRun {
  Shots shots;
  double seconds = 0.0;
};
std::map<std::int64_t, PclRun>& pcl_runs() {
  static std::map<std::int64_t, PclRun> runs;
  return runs;
}

double mean_neighbours(float radius_m) {
  const CellGrid grid(cloud().cloud.points, static_cast<double>(radius_m) / 2.0);
  std::vector<CellGrid::Found> found;
  double total = 0.0;
  for (const std::uint32_t index : cloud().keypoints.index) {
    grid.within(cloud().cloud.points[index], radius_m, found);
    total += static_cast<double>(found.size());
  }
  return total / static_cast<double>(cloud().keypoints.size());
}

// Processor seconds of the fastest iteration, of all threads over their number: others share the
// machine.
class Fastest {
 public:
  template <typename Work>
  void time(benchmark::State& state, const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    work();
    const double used = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / kThreads;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    state.SetIterationTime(took.count());
    seconds_ = std::min(seconds_, used);
  }
  double seconds() const { return seconds_; }

 private:
  double seconds_ = 1e9;
};

void report_time(benchmark::State& state, double seconds) {
  const auto radius_m = static_cast<float>(state.range(0)) / 1000.0F;
  state.counters["neighbours"] = mean_neighbours(radius_m);
  state.counters["us"] = 1e6 * seconds / static_cast<double>(cloud().keypoints.size());
  const PclRun& pcl = pcl_runs()[state.range(0)];
  if (pcl.seconds > 0.0) state.counters["ratio"] = pcl.seconds / seconds;
}

void run_pcl(benchmark::State& state) {
  const pcl::PointCloud<pcl::PointXYZ>::Ptr surface(new pcl::PointCloud<pcl::PointXYZ>);
  const pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
  const pcl::PointCloud<pcl::PointXYZ>::Ptr keypoints(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < cloud().cloud.size(); ++i) {
    const Eigen::Vector3f& p = cloud().cloud.points[i];
    const Eigen::Vector3f& n = cloud().cloud.normals[i];
    surface->push_back({p.x(), p.y(), p.z()});
    normals->push_back({n.x(), n.y(), n.z()});
  }
  for (const std::uint32_t index : cloud().keypoints.index) keypoints->push_back((*surface)[index]);
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(surface);  // not timed; our grid is
  PclRun& run = pcl_runs()[state.range(0)];
  Fastest fastest;
  for (auto _ : state) {
    fastest.time(state, [&] {
      pcl::SHOTEstimationOMP<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> shot;
      shot.setNumberOfThreads(kThreads);
      shot.setInputCloud(keypoints);
      shot.setSearchSurface(surface);
      shot.setSearchMethod(tree);
      shot.setInputNormals(normals);
      shot.setRadiusSearch(static_cast<double>(state.range(0)) / 1000.0);
      shot.compute(run.shots);
    });
  }
  run.seconds = fastest.seconds();
  report_time(state, run.seconds);
}

// Rows that equal PCL's, and the largest difference among these.
void compare(benchmark::State& state, const DescriptorSet& ours, const Shots& theirs) {
  std::size_t valid = 0;
  std::size_t equal = 0;
  std::size_t row = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const Eigen::Vector3f& p = cloud().cloud.points[cloud().keypoints.index[i]];
    const bool described = row < ours.size() && ours.keypoints[row] == p;
    const bool finite = std::isfinite(theirs[i].descriptor[0]);
    valid += described || finite ? 1U : 0U;
    if (described && finite) {
      double most = 0.0;
      for (std::size_t j = 0; j < kShotLength; ++j) {
        most = std::max(most,
                        std::abs(static_cast<double>(ours.row(row)[j] - theirs[i].descriptor[j])));
      }
      if (most < kEqual) {
        ++equal;
        largest = std::max(largest, most);
      }
    }
    row += described ? 1U : 0U;
  }
  state.counters["equal"] =
      static_cast<double>(equal) / static_cast<double>(std::max<std::size_t>(valid, 1));
  state.counters["difference"] = largest;
}

void run_ours(benchmark::State& state) {
  RunContext context;
  context.threads = kThreads;
  DescriptorSet set;
  cloud();  // not timed
  Fastest fastest;
  for (auto _ : state) {
    fastest.time(state, [&] {
      set = describe_shot(
          cloud().cloud, cloud().keypoints, static_cast<double>(state.range(0)) / 1000.0, context);
    });
  }
  report_time(state, fastest.seconds());
  const PclRun& pcl = pcl_runs()[state.range(0)];
  if (!pcl.shots.empty()) compare(state, set, pcl.shots);
}

}  // namespace

int main(int argc, char** argv) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  for (const std::int64_t radius_mm :
       {420, 620, 925, 1330}) {  // about 160, 350, 800, 1700 in reach
    for (auto* bench : {benchmark::RegisterBenchmark("pcl::SHOTEstimationOMP", run_pcl),
                        benchmark::RegisterBenchmark("landmarkdb", run_ours)}) {
      bench->Arg(radius_mm)->UseManualTime()->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("seed", std::to_string(kSeed));
  benchmark::AddCustomContext("threads", std::to_string(kThreads));
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
