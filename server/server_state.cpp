#include "server/server_state.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/error.hpp"
#include "server/process_memory.hpp"
#include "store/store.hpp"

namespace landmarkdb {

namespace {

// The same generation of the same records. The generation alone would not do: another file put in
// the place of the first may have counted as far.
bool same_content(const Catalog& a, const Catalog& b) {
  return a.generation == b.generation &&
         std::equal(a.entries.begin(),
                    a.entries.end(),
                    b.entries.begin(),
                    b.entries.end(),
                    [](const CatalogEntry& x, const CatalogEntry& y) {
                      return x.scene_id == y.scene_id && x.record == y.record;
                    });
}

bool same_models(const MonoCatalog& a, const MonoCatalog& b) {
  return std::equal(a.entries.begin(),
                    a.entries.end(),
                    b.entries.begin(),
                    b.entries.end(),
                    [](const MonoCatalogEntry& x, const MonoCatalogEntry& y) {
                      return x.model_id == y.model_id && x.record == y.record;
                    });
}

// The models; those of `previous`, and its recogniser, where nothing has changed.
void build_models(const Store& store,
                  const Served* previous,
                  const RunContext& context,
                  Served& served) {
  std::shared_ptr<const MonoCatalog> models = store.load_models(
      context,
      [&](const DamagedModel& model) { served.damaged_models.push_back(model); },
      previous != nullptr ? previous->models.get() : nullptr);
  if (previous != nullptr && same_models(*models, *previous->models)) {
    served.models = previous->models;
    served.recognizer = previous->recognizer;
    return;
  }
  context.check("models");
  served.models = models;
  served.recognizer = std::make_shared<const Recognizer>(std::move(models), context);
}

// What is in the database now; `previous` itself when nothing has changed since.
std::shared_ptr<const Served> build(const std::string& db_path,
                                    const LocalizerOptions& options,
                                    const std::shared_ptr<const Served>& previous,
                                    const RunContext& context) {
  auto served = std::make_shared<Served>();
  std::shared_ptr<const Catalog> catalog;
  {
    const Store store = Store::open_read_only(db_path);
    catalog = store.load_outlines(
        context,
        [&](const DamagedScene& scene) { served->unreadable.push_back(scene); },
        previous ? &previous->localizer->catalog() : nullptr);
    build_models(store, previous.get(), context, *served);
  }
  const bool whole = served->unreadable.empty() && served->damaged_models.empty();
  const bool same_scenes = previous && same_content(*catalog, previous->localizer->catalog());
  if (whole && same_scenes && previous->damaged().empty() && previous->damaged_models.empty() &&
      served->recognizer == previous->recognizer) {
    return previous;
  }
  served->localizer = std::make_shared<const Localizer>(catalog, context, options);
  release_free_memory();
  served->generation = catalog->generation;
  served->scenes = catalog->entries.size() - served->localizer->damaged().size();
  for (const CatalogEntry& entry : catalog->entries) {
    served->points += entry.points;
    served->keypoints += entry.keypoints;
  }
  return served;
}

}  // namespace

std::vector<DamagedScene> Served::damaged() const {
  std::vector<DamagedScene> all = unreadable;
  for (const auto& [index, what] : localizer->damaged()) {
    const CatalogEntry& entry = localizer->catalog().entries[index];
    all.push_back({entry.scene_id, entry.record->name, entry.version, what});
  }
  return all;
}

std::shared_ptr<const Served> ServerState::served_or_null() const {
  const std::lock_guard lock(mutex_);
  return served_;
}

std::shared_ptr<const Served> ServerState::served() const {
  const std::lock_guard lock(mutex_);
  if (served_) return served_;
  if (!failure_.empty()) {
    throw Error(ErrorCode::kUnavailable, "the database could not be loaded: " + failure_);
  }
  throw Error(ErrorCode::kUnavailable, "the database is still being loaded; try again shortly");
}

std::shared_ptr<const Served> ServerState::reload(const RunContext& context) {
  const std::lock_guard one_at_a_time(reload_mutex_);
  try {
    const std::shared_ptr<const Served> previous = served_or_null();
    std::shared_ptr<const Served> next = build(db_path_, localizer_options_, previous, context);
    const std::lock_guard lock(mutex_);
    served_ = next;
    failure_.clear();
    return next;
  } catch (const std::exception& error) {
    const auto* reason = dynamic_cast<const Error*>(&error);
    const bool stopped = reason != nullptr && (reason->code() == ErrorCode::kCancelled ||
                                               reason->code() == ErrorCode::kDeadlineExceeded);
    const std::lock_guard lock(mutex_);
    if (!stopped) failure_ = error.what();
    throw;
  }
}

Health ServerState::health() const {
  const std::lock_guard lock(mutex_);
  Health health;
  if (served_) {
    health.phase = Phase::kServing;
    for (const DamagedScene& scene : served_->damaged()) {
      health.quarantined.push_back(scene.name);
      health.problems.push_back("scene '" + scene.name + "' version " +
                                std::to_string(scene.version) + " is damaged and not served (" +
                                scene.what +
                                "); see `landmarkdb-indexer check`, then `rollback` or"
                                " `add` it again");
    }
    for (const DamagedModel& model : served_->damaged_models) {
      health.quarantined.push_back(model.name);
      health.problems.push_back("model '" + model.name + "' is damaged and not served (" +
                                model.what +
                                "); see `landmarkdb-indexer check`, then `repair` or add it again");
    }
    if (!failure_.empty()) {
      health.problems.push_back("the last reload failed, the catalogue before it is served: " +
                                failure_);
    }
  } else if (!failure_.empty()) {
    health.phase = Phase::kFailed;
    health.problems.push_back("the database could not be loaded: " + failure_);
  }
  if (stopping_) health.phase = Phase::kStopping;
  return health;
}

void ServerState::set_stopping() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_source_.request_stop();
}

}  // namespace landmarkdb
