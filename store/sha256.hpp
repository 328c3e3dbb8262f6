#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace landmarkdb {

// SHA-256 (FIPS 180-4) over bytes given in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(std::span<const std::byte> bytes);
  // 64 lower-case hexadecimal digits. Nothing may be added after.
  std::string finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

std::string sha256_of(std::span<const std::byte> bytes);
std::string sha256_of(const std::string& text);

}  // namespace landmarkdb
