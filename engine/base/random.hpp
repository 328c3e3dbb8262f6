#pragma once

#include <cstdint>

namespace landmarkdb {

// A small random generator (SplitMix64, Steele, Lea, Flood 2014) whose draws are the same on every
// platform: the standard library's distributions are not. Not for secrets. Not thread-safe; give
// each job its own, seeded from the request.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }

  // Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }
  // Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Uniform in [0, n); n > 0. The bias is below n / 2^64.
  std::uint64_t below(std::uint64_t n) { return next() % n; }
  // Standard normal, by Box and Muller (1958).
  double normal();

 private:
  std::uint64_t state_;
};

}  // namespace landmarkdb
