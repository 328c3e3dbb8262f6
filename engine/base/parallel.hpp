#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace landmarkdb {

// Splits [0, n) into at most `threads` equal, contiguous chunks and runs `body(begin, end)` on
// each, one on the calling thread. The result is the same for any thread count as long as `body`
// writes only to places that belong to its own indices. Rethrows the exception of the lowest chunk
// that threw.
template <typename Body>
void parallel_chunks(std::size_t n, int threads, const Body& body) {
  const std::size_t workers = std::clamp<std::size_t>(
      static_cast<std::size_t>(std::max(threads, 1)), 1, std::max<std::size_t>(n, 1));
  if (workers == 1) {
    body(std::size_t{0}, n);
    return;
  }
  std::vector<std::exception_ptr> errors(workers);
  auto run = [&](std::size_t worker) {
    try {
      body(n * worker / workers, n * (worker + 1) / workers);
    } catch (...) {
      errors[worker] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> pool;
    pool.reserve(workers - 1);
    for (std::size_t worker = 1; worker < workers; ++worker) pool.emplace_back(run, worker);
    run(0);
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

// Runs `body(i)` for each of [0, n), the next one on whichever of the threads is free: for work of
// which some takes longer. Otherwise as parallel_chunks.
template <typename Body>
void parallel_each(std::size_t n, int threads, const Body& body) {
  std::atomic<std::size_t> next{0};
  parallel_chunks(n, threads, [&](std::size_t, std::size_t) {
    for (std::size_t i = next++; i < n; i = next++) body(i);
  });
}

// The same in runs of `step`: `body(begin, end)`.
template <typename Body>
void parallel_runs(std::size_t n, std::size_t step, int threads, const Body& body) {
  parallel_each((n + step - 1) / step, threads, [&](std::size_t run) {
    body(run * step, std::min(n, (run + 1) * step));
  });
}

}  // namespace landmarkdb
