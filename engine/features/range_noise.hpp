#pragma once

#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// How far a sensor's points scatter along its rays, by their range, as the cloud itself shows it. A
// depth camera's noise grows with the square of the range: millimetres at arm's length, a decimetre
// across a hall (Nguyen, Izadi, Lovell 2012), more than a voxel. What lies along the rays, a floor
// far away, scatters within itself and stays thin. About surface that bends (SurfaceShape::kBent)
// the scatter is along the normal.
struct RangeNoise {
  double first_range_m = 0.0;  // where the first bin begins; each is `kStep` times as far
  std::vector<float> sigma_m;  // by bin; never falls with the range

  static constexpr double kStep = 1.2;
  float at(float range_m) const;
};

// What the surface around a point is taken for where its noise is measured. Walls and floors are
// flat; what is described at millimetres bends, and the bend of a figurine is no noise.
enum class SurfaceShape { kFlat, kBent };

// Measures it on a cloud with normals: in each bin of range the fits of the flattest quarter of the
// points leave the noise; the rest have structure of their own.
RangeNoise measure_range_noise(const PreparedCloud& cloud,
                               double radius_m,
                               const RunContext& context,
                               SurfaceShape shape = SurfaceShape::kFlat);

// Where the noise is a good part of the resolution, lays each point onto the plane of a
// neighbourhood as much wider as the noise asks, unless that neighbourhood is no noisy plane, and
// thins again: walls seen from afar become thin, with normals that hold. Points nearer than that
// stay as they are. `radius_m` is that of the cloud's normals. The same for any number of threads.
void flatten_range_noise(PreparedCloud& cloud,
                         const RangeNoise& noise,
                         double radius_m,
                         const RunContext& context);

// How much each point can be relied on, 0..1: 1 where the error along its normal is nothing against
// the cloud's resolution, and little where it is as large. The error is the noise where the cloud
// is as it was measured, and the share `left` of it where that was laid flat.
std::vector<float> range_weights(const PreparedCloud& cloud, const RangeNoise& noise, float left);

}  // namespace landmarkdb
