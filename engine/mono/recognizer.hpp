#pragma once

#include <memory>

#include "engine/base/run_context.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/types/grey_image.hpp"
#include "engine/types/mono_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

// Finds the models of a catalogue in one image: the whole of `recognize`.
//
// Built once a catalogue (the quad index over all views of all models); const methods are
// thread-safe, and the same input gives the same answer: no choice is left to chance, and so none
// to the seed.
class Recognizer {
 public:
  // On `context.threads` threads. Models whose index (MonoModelRecord) is missing or of another
  // making have it made, some 10 ms each. Throws what `context.check` does.
  explicit Recognizer(std::shared_ptr<const MonoCatalog> catalog, const RunContext& context = {});
  ~Recognizer();

  // Throws Error{kInvalidArgument} for a camera that does not fit the image's size, an unknown
  // model name, or a coordinate that is not finite; Error{kCancelled} and kDeadlineExceeded when
  // stopped.
  RecognizeResult recognize(const GreyImage& image,
                            const Camera& camera,
                            const RecognizeOptions& options,
                            const RunContext& run) const;
  RecognizeResult recognize(const ImageFeatures& features,
                            const Camera& camera,
                            const RecognizeOptions& options,
                            const RunContext& run) const;

 private:
  class Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace landmarkdb
