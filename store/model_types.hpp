#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/model_summary.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

struct InsertModelResult {
  std::int64_t model_id = 0;
  bool replaced = false;         // a model of that name was there
  std::uint64_t generation = 0;  // of the database, after the insert
};

// A model left out of a catalogue because it cannot be read.
struct DamagedModel {
  std::int64_t model_id = 0;
  std::string name;
  std::string what;
};
using OnDamagedModel = std::function<void(const DamagedModel&)>;

// How what is derived from a model is made; the store keeps it but does not know how.
struct ModelDeriver {
  std::function<std::vector<ModelTriple>(const MonoModel&, const RunContext&)> triples{};
  std::function<ModelIndexBlob(const MonoModel&, const RunContext&)> index{};
  ModelIndexBlob index_format{};  // version and params of what `index` makes
};

}  // namespace landmarkdb
