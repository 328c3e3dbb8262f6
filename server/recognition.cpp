#include "server/recognition.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/stage_timings.hpp"
#include "engine/mono/draw_overlay.hpp"
#include "engine/mono/find_features.hpp"
#include "server/convert_recognition.hpp"
#include "server/decode_image.hpp"

namespace landmarkdb {
namespace {

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
  const MemoryBudget::Lease lease = reserve_image(camera, memory);
  StageTimings::Duration features_time{};
  GreyImage image;
  ImageFeatures features;
  {
    const StageTimer timer(features_time);
    image = decode_image(request.image(), camera);
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
