#pragma once

#include <string>

#include "engine/geometry/camera.hpp"
#include "engine/types/grey_image.hpp"
#include "server/memory_budget.hpp"

namespace landmarkdb {

// Memory for an image of the camera's size and for what is sought in it. Throws
// Error{kResourceExhausted} when `memory` has not that much left.
MemoryBudget::Lease reserve_image(const Camera& camera, MemoryBudget& memory);

// The image of a request: the bytes of a PNG, JPEG, PGM or PPM file. Throws
// Error{kInvalidArgument} for one that cannot be read or has another size than the camera.
GreyImage decode_image(const std::string& bytes, const Camera& camera);

}  // namespace landmarkdb
