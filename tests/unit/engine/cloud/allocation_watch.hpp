#pragma once

#include <cstddef>

namespace landmarkdb::testing {

// The largest single request to operator new on this thread since the last reset. A program that
// links allocation_watch.cpp has its operator new replaced by one that counts.
std::size_t largest_allocation();
void reset_largest_allocation();

}  // namespace landmarkdb::testing
