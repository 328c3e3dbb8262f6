#include "server/decode_image.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/error.hpp"
#include "engine/mono/read_image.hpp"

namespace landmarkdb {
namespace {

// What a pixel costs while features are sought: the image, its gradients and its edges.
constexpr std::size_t kBytesPerPixel = 16;

}  // namespace

MemoryBudget::Lease reserve_image(const Camera& camera, MemoryBudget& memory) {
  const std::size_t bytes = kBytesPerPixel * camera.width * camera.height;
  if (bytes > memory.bytes()) {
    throw Error(ErrorCode::kInvalidArgument,
                "an image of " + std::to_string(camera.width) + " x " +
                    std::to_string(camera.height) + " pixels, the server takes at most " +
                    std::to_string(memory.bytes() / kBytesPerPixel / 1'000'000) + " million pixels",
                "image");
  }
  MemoryBudget::Lease lease = memory.reserve(bytes);
  if (!lease) {
    throw Error(ErrorCode::kResourceExhausted,
                "the server has no memory left for an image of " + std::to_string(camera.width) +
                    " x " + std::to_string(camera.height) + " pixels",
                "image");
  }
  return lease;
}

GreyImage decode_image(const std::string& bytes, const Camera& camera) {
  // No more pixels than the camera has: a file that promises more is refused before it is decoded.
  ReadImageOptions options;
  options.max_pixels =
      std::min<std::uint64_t>(options.max_pixels, std::uint64_t{camera.width} * camera.height);
  GreyImage image;
  try {
    image = parse_image(std::as_bytes(std::span(bytes)), "image", options);
  } catch (const Error& error) {
    throw Error(error.code(), error.what(), "image");
  }
  if (image.width != camera.width || image.height != camera.height) {
    throw Error(ErrorCode::kInvalidArgument,
                "the camera file is for images of " + std::to_string(camera.width) + " x " +
                    std::to_string(camera.height) + " pixels, but the image has " +
                    std::to_string(image.width) + " x " + std::to_string(image.height),
                "camera");
  }
  return image;
}

}  // namespace landmarkdb
