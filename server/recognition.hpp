#pragma once

#include "engine/base/run_context.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/memory_budget.hpp"
#include "server/server_state.hpp"

namespace landmarkdb {

// The answer to a recognize request by the models of `served`. A decoded image takes its memory
// from `memory`. Throws Error: kInvalidArgument for a camera, image or option that cannot be used,
// kNotFound for a model that is not there, kResourceExhausted, what `context.check` throws.
// Thread-safe.
v1::RecognizeResult recognize(const v1::RecognizeRequest& request,
                              const Served& served,
                              MemoryBudget& memory,
                              const RunContext& context);

}  // namespace landmarkdb
