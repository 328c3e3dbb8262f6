#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// The points around a keypoint, itself and its duplicates left out, as arrays of `count` elements
// (the vectors are longer).
struct Neighbourhood {
  std::vector<float> x, y, z;     // offsets from the keypoint, cloud axes, metres
  std::vector<float> nx, ny, nz;  // unit normals
  std::vector<float> squared_m2;  // squared length of the offset
  std::size_t count = 0;

  // Grows the arrays to at least `size` elements, rounded up to what the kernels read at once.
  void reserve(std::size_t size);
};

// The local reference frame of SHOT (Tombari 2010, section 3.1): eigenvectors of the scatter
// weighted by radius - distance, signs towards the greater number of points. The columns of
// `R_cloud_lrf` are its axes, an exact rotation. False where it is not defined: fewer than five
// points, or numbers that are not finite.
//
// Decides as PCL 1.13 does, ties of the signs included (by the five points of middle distance).
bool shot_frame(const Neighbourhood& points, float radius_m, Eigen::Matrix3f& R_cloud_lrf);

// The signature of histograms of SHOT (Tombari 2010, section 3.2): 8 azimuths x 2 radii x 2
// elevations of 11 bins of the cosine between a point's normal and the z axis, each point shared
// between its bin and the nearest one along each of the four. Unit length. Writes kShotLength
// values; false where they are not finite.
//
// Shares as PCL 1.13 does, which differs from the paper: a point's own bin gets the *sum* of its
// four weights, and past the middle of the last but one cosine bin the neighbour is bin 0 and not
// 10. The same bytes on every machine.
bool shot_histogram(const Neighbourhood& points,
                    const Eigen::Matrix3f& R_cloud_lrf,
                    float radius_m,
                    float* values);

}  // namespace landmarkdb
