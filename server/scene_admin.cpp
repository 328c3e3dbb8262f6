#include "server/scene_admin.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "engine/retrieval/scene_index.hpp"
#include "server/change_database.hpp"
#include "server/convert_scene.hpp"
#include "store/names.hpp"
#include "store/store.hpp"

namespace landmarkdb {

namespace {

std::string quarantine_reason(const Served* served, const SceneSummary& scene) {
  if (served == nullptr) return {};
  for (const DamagedScene& damaged : served->damaged()) {
    if (damaged.scene_id == scene.id && damaged.version == scene.active_version) {
      return damaged.what;
    }
  }
  return {};
}

void add_bounds(const Served* served, v1::SceneInfo& message) {
  if (served == nullptr) return;
  const auto& entries = served->localizer->catalog().entries;
  const auto entry = std::find_if(entries.begin(), entries.end(), [&](const CatalogEntry& e) {
    return e.scene_id == message.scene_id() && e.version == message.version();
  });
  if (entry == entries.end()) return;
  std::shared_ptr<const SceneRecord> record = entry->record;
  if (entry->source != nullptr) {
    try {
      record = entry->source->load(SceneParts::kSurface, {});
    } catch (const Error& error) {  // what is told of a damaged scene has no box
      if (error.code() != ErrorCode::kDataLoss) throw;
      return;
    }
  }
  const PreparedCloud& cloud = record->prepared;
  if (cloud.points.empty()) return;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : cloud.points) box.extend(point);
  *message.mutable_min_m() = to_proto(cloud.origin + box.min().cast<double>());
  *message.mutable_max_m() = to_proto(cloud.origin + box.max().cast<double>());
}

}  // namespace

v1::SceneListReply SceneAdmin::list() const {
  const std::shared_ptr<const Served> served = state_.served_or_null();
  const Store store = Store::open_read_only(state_.db_path());
  v1::SceneListReply reply;
  for (const SceneSummary& scene : store.list_scenes()) {
    *reply.add_scenes() = to_proto(scene, false, quarantine_reason(served.get(), scene));
  }
  reply.set_generation(store.generation());
  return reply;
}

v1::SceneReply SceneAdmin::show(const std::string& name) const {
  const std::shared_ptr<const Served> served = state_.served_or_null();
  const SceneSummary scene = Store::open_read_only(state_.db_path()).show(name);
  v1::SceneReply reply;
  *reply.mutable_scene() = to_proto(scene, true, quarantine_reason(served.get(), scene));
  add_bounds(served.get(), *reply.mutable_scene());
  return reply;
}

v1::SceneReply SceneAdmin::add(const v1::SceneAddRequest& request,
                               const RunContext& context) const {
  Store store = open_for_change(options_, state_);  // refused before an hour is spent on describing
  validate_name(request.name(), "scene name");
  PointAllowance allowance{options_.max_points, &memory_};
  SceneAddition addition = from_proto(request, allowance);
  const SceneRecord record = describe_scene(
      std::move(addition.name), std::move(addition.scans), addition.options, context);
  store.insert(record, context, {make_scene_index, scene_index_format()});
  put_in_service(options_, state_);
  return show(record.name);
}

v1::SceneRemoveReply SceneAdmin::remove(const v1::SceneRemoveRequest& request) const {
  open_for_change(options_, state_).remove(request.name());
  put_in_service(options_, state_);
  return {};
}

v1::SceneReply SceneAdmin::rename(const v1::SceneRenameRequest& request) const {
  open_for_change(options_, state_).rename(request.old_name(), request.new_name());
  put_in_service(options_, state_);
  return show(request.new_name());
}

v1::SceneReply SceneAdmin::rollback(const v1::SceneRollbackRequest& request) const {
  open_for_change(options_, state_).rollback(request.name());
  put_in_service(options_, state_);
  return show(request.name());
}

v1::SceneReply SceneAdmin::tag(const v1::SceneTagRequest& request) const {
  Store store = open_for_change(options_, state_);
  TagChanges changes;
  for (const auto& [key, value] : request.tags()) {
    changes[key] = value.empty() ? std::nullopt : std::optional<std::string>(value);
  }
  store.change_tags(request.name(), changes);
  put_in_service(options_, state_);
  return show(request.name());
}

v1::SceneReply SceneAdmin::add_landmark(const v1::LandmarkAddRequest& request) const {
  Store store = open_for_change(options_, state_);
  store.add_landmark(request.scene(), from_proto(request.landmark()));
  put_in_service(options_, state_);
  return show(request.scene());
}

v1::SceneReply SceneAdmin::remove_landmark(const v1::LandmarkRemoveRequest& request) const {
  open_for_change(options_, state_).remove_landmark(request.scene(), request.landmark());
  put_in_service(options_, state_);
  return show(request.scene());
}

}  // namespace landmarkdb
