#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// The numbers of four points, ascending.
using PointFour = std::array<std::uint16_t, 4>;

// Appends the four of these points, unless two of them are one.
inline void add_four(
    std::size_t a, std::size_t b, std::size_t c, std::size_t d, std::vector<PointFour>& fours) {
  PointFour four{static_cast<std::uint16_t>(a),
                 static_cast<std::uint16_t>(b),
                 static_cast<std::uint16_t>(c),
                 static_cast<std::uint16_t>(d)};
  std::sort(four.begin(), four.end());
  if (std::adjacent_find(four.begin(), four.end()) == four.end()) fours.push_back(four);
}

// Which of the six pairs of four points `linked(a, b)` joins: AB, AC, AD, BC, BD, CD, AB lowest.
template <typename Ids, typename Linked>
std::uint8_t link_mask(const Ids& ids, const Linked& linked) {
  unsigned mask = 0, bit = 1;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b, bit <<= 1U) mask |= linked(ids[a], ids[b]) ? bit : 0U;
  }
  return static_cast<std::uint8_t>(mask);
}

// What four image points look like, whatever their shift, turn and scale (Lang et al. 2010 for
// stars): the two furthest apart, A and B, are put at (0,0) and (1,1), and the code is where C and
// D then lie. A and B are ordered so that Cx + Dx <= 1, then C and D so that Cx <= Dx.
struct QuadCode {
  std::array<std::uint8_t, 4> order{};  // which of the four points are A, B, C, D
  std::array<float, 4> code{};          // Cx, Cy, Dx, Dy
};

// The code's coordinates lie in this range: inside the circle over AB.
inline constexpr double kCodeLow = -0.2072, kCodeHigh = 1.2072;

// C and D in the frame of A and B.
struct QuadFrame {
  QuadFrame(const Eigen::Vector2d& A, const Eigen::Vector2d& B) : origin(A) {
    // (1 + i) / (B - A) as a complex factor.
    const Eigen::Vector2d d = B - A;
    const double k = 1.0 / d.squaredNorm();
    cosine = (d.x() + d.y()) * k;
    sine = (d.x() - d.y()) * k;
  }
  Eigen::Vector2d operator()(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = p - origin;
    return {cosine * q.x() - sine * q.y(), sine * q.x() + cosine * q.y()};
  }
  Eigen::Vector2d origin;
  double cosine, sine;
};

// Whether a point lies in the circle over AB, in code coordinates.
inline bool in_circle(const Eigen::Vector2d& c) {
  return (c - Eigen::Vector2d(0.5, 0.5)).squaredNorm() <= 0.5;
}

// Whether C and D are far enough from AB and from each other for the code to say something.
inline bool is_roomy(const Eigen::Vector2d& C, const Eigen::Vector2d& D) {
  constexpr double kOffLine = 0.25, kApart = 0.2;  // cyclope prototype's choice, in code units
  return std::abs(C.x() - C.y()) + std::abs(D.x() - D.y()) >= kOffLine &&
         (C - D).squaredNorm() >= kApart * kApart;
}

// Puts four points into order. False where two of them lie outside the circle over the furthest
// pair, or all are cramped.
bool code_quad(const std::array<Eigen::Vector2d, 4>& points, QuadCode& quad);

}  // namespace landmarkdb
