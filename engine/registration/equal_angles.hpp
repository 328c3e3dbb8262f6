#pragma once

namespace landmarkdb {

// Where a tangent from -1 to 1 falls along the edge of a cube's face that is cut into equal angles,
// 0..1: arctan by its series (Abramowitz and Stegun 1964, 4.4.49), 1e-5 rad off at most. `T` is a
// float or a vector of them; the operations and their order are the same.
template <typename T>
[[gnu::always_inline]] inline T along_face(T tangent) {
  constexpr float kOfFace = 0.636619772F;  // 2 / pi: a face spans a right angle
  const T squared = tangent * tangent;
  T series = squared * 0.0208351F - 0.0851330F;
  series = series * squared + 0.1801410F;
  series = series * squared - 0.3302995F;
  series = series * squared + 0.9998660F;
  return tangent * series * kOfFace + 0.5F;
}

}  // namespace landmarkdb
