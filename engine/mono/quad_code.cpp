#include "engine/mono/quad_code.hpp"

#include <cmath>
#include <utility>

namespace landmarkdb {

bool code_quad(const std::array<Eigen::Vector2d, 4>& points, QuadCode& quad) {
  std::size_t a = 0, b = 1;
  double longest = -1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double length = (points[i] - points[j]).squaredNorm();
      if (length > longest) {
        longest = length;
        a = i;
        b = j;
      }
    }
  }
  if (!(longest > 0.0)) return false;
  std::size_t c = 0;
  while (c == a || c == b) ++c;
  std::size_t d = c + 1;
  while (d == a || d == b) ++d;
  const QuadFrame frame(points[a], points[b]);
  Eigen::Vector2d C = frame(points[c]), D = frame(points[d]);
  if (!in_circle(C) || !in_circle(D) || !is_roomy(C, D)) return false;
  if (C.x() + D.x() > 1.0) {  // from B's side both are mirrored through the middle
    std::swap(a, b);
    C = Eigen::Vector2d::Ones() - C;
    D = Eigen::Vector2d::Ones() - D;
  }
  if (C.x() > D.x()) {
    std::swap(c, d);
    std::swap(C, D);
  }
  quad.order = {static_cast<std::uint8_t>(a),
                static_cast<std::uint8_t>(b),
                static_cast<std::uint8_t>(c),
                static_cast<std::uint8_t>(d)};
  quad.code = {static_cast<float>(C.x()),
               static_cast<float>(C.y()),
               static_cast<float>(D.x()),
               static_cast<float>(D.y())};
  return true;
}

}  // namespace landmarkdb
