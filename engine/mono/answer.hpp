#pragma once

#include <span>
#include <vector>

#include "engine/mono/pose_check.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

// Turns settled candidates, best first, into hypotheses with margins and confidences, and says the
// status. A rival is a candidate that claims some of the same image points; one of another part of
// the image is another object. At most options.top are told.
void write_answer(std::span<const SearchModel> models,
                  const ImageView& image,
                  const EdgeGrid& edges,
                  std::span<const MonoCandidate> candidates,
                  const RecognizeOptions& options,
                  double scale,
                  RecognizeResult& result);

}  // namespace landmarkdb
