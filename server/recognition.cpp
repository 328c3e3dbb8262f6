#include "server/recognition.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/stage_timings.hpp"
#include "engine/mono/draw_overlay.hpp"
#include "engine/mono/find_features.hpp"
#include "engine/mono/read_image.hpp"
#include "server/convert_recognition.hpp"

namespace landmarkdb {
namespace {

// What a pixel costs while features are sought: the image, its gradients and its edges.
constexpr std::size_t kBytesPerPixel = 16;

void require_models(const RecognizeOptions& options, const MonoCatalog& catalog) {
  for (const std::string& name : options.models) {
    const bool there = std::any_of(
        catalog.entries.begin(), catalog.entries.end(), [&](const MonoCatalogEntry& entry) {
          return entry.record->model.name == name;
        });
    if (!there) {
      throw Error(ErrorCode::kNotFound, "there is no model '" + name + "'", "options.models");
    }
  }
}

GreyImage decode(const v1::RecognizeRequest& request, const Camera& camera) {
  // No more pixels than the camera has: a file that promises more is refused before it is decoded.
  ReadImageOptions options;
  options.max_pixels =
      std::min<std::uint64_t>(options.max_pixels, std::uint64_t{camera.width} * camera.height);
  GreyImage image;
  try {
    image = parse_image(std::as_bytes(std::span(request.image())), "image", options);
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

}  // namespace

v1::RecognizeResult recognize(const v1::RecognizeRequest& request,
                              const Served& served,
                              MemoryBudget& memory,
                              const RunContext& context) {
  const Camera camera = from_proto(request.camera());
  const RecognizeOptions options = from_proto(request.options());
  require_models(options, *served.models);
  if (request.input_case() == v1::RecognizeRequest::INPUT_NOT_SET) {
    throw Error(ErrorCode::kInvalidArgument, "there is neither an image nor points", "image");
  }
  if (!request.has_image()) {
    if (request.options().want_overlay()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "an overlay is drawn on an image, but there are only points",
                  "options.want_overlay");
    }
    return to_proto(served.recognizer->recognize(
        from_proto(request.points(), camera), camera, options, context));
  }
  const std::size_t bytes = kBytesPerPixel * camera.width * camera.height;
  const MemoryBudget::Lease lease = memory.reserve(bytes);
  if (!lease) {
    throw Error(ErrorCode::kResourceExhausted,
                "the server has no memory left for an image of " + std::to_string(camera.width) +
                    " x " + std::to_string(camera.height) + " pixels",
                "image");
  }
  StageTimings::Duration features_time{};
  GreyImage image;
  ImageFeatures features;
  {
    const StageTimer timer(features_time);
    image = decode(request, camera);
    features = find_image_features(image, {.camera = camera}, context);
  }
  RecognizeResult result = served.recognizer->recognize(features, camera, options, context);
  result.timings.features += features_time;
  result.timings.total += features_time;
  v1::RecognizeResult reply = to_proto(result);
  if (request.options().want_overlay()) {
    std::vector<OverlayModel> models;
    for (const MonoHypothesis& hypothesis : result.hypotheses) {
      for (const MonoCatalogEntry& entry : served.models->entries) {
        if (entry.record->model.name == hypothesis.model) {
          models.push_back({&entry.record->model, &hypothesis});
        }
      }
    }
    reply.set_overlay_png(draw_overlay(image, features, camera, models));
  }
  return reply;
}

}  // namespace landmarkdb
