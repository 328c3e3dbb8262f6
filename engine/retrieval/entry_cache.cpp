#include "engine/retrieval/entry_cache.hpp"

#include <utility>

namespace landmarkdb {

namespace {

bool has(SceneParts held, SceneParts wanted) {
  return static_cast<int>(held) >= static_cast<int>(wanted);
}

template <typename Value>
std::size_t bytes_of(const std::vector<Value>& values) {
  return values.size() * sizeof(Value);
}

}  // namespace

bool is_damage(const Error& error) {
  return error.code() == ErrorCode::kDataLoss || error.code() == ErrorCode::kUnimplemented ||
         error.code() == ErrorCode::kInvalidArgument;
}

std::size_t memory_bytes(const Entry& entry) {
  const SceneRecord& record = entry.record();
  const PreparedCloud& cloud = record.prepared;
  const DescriptorSet& set = record.descriptors;
  return bytes_of(cloud.points) + bytes_of(cloud.normals) + bytes_of(cloud.viewpoint_index) +
         bytes_of(set.keypoints) + bytes_of(set.normals) + bytes_of(set.frames) +
         bytes_of(set.values) + entry.grid.memory_bytes() + entry.wide.memory_bytes() +
         entry.wide_sight.memory_bytes() +
         SightSurface::most_bytes(cloud.points.size(), cloud.normals_from_viewpoint) +
         entry.scanned.memory_bytes() + bytes_of(entry.frames);
}

EntryCache::EntryCache(std::vector<std::shared_ptr<const Entry>> base,
                       std::size_t most_bytes,
                       OnDamaged on_damaged)
    : base_(std::move(base)), most_bytes_(most_bytes), on_damaged_(std::move(on_damaged)) {
  for (std::size_t i = 0; i < base_.size(); ++i) slots_.push_back(std::make_unique<Slot>());
}

std::shared_ptr<const Entry> EntryCache::find(std::size_t i, SceneParts parts) {
  const std::lock_guard lock(mutex_);
  Slot& slot = *slots_[i];
  if (!slot.damage.empty()) throw Error(ErrorCode::kDataLoss, slot.damage);
  if (!slot.entry || !has(slot.parts, parts)) return nullptr;
  used_.splice(used_.begin(), used_, slot.used);
  return slot.entry;
}

void EntryCache::keep(std::size_t i, SceneParts parts, const std::shared_ptr<const Entry>& entry) {
  std::vector<std::shared_ptr<const Entry>> gone;  // freed after the mutex is
  const std::size_t bytes = memory_bytes(*entry);
  const std::lock_guard lock(mutex_);
  ++loads_;
  const auto drop = [&](std::size_t index) {
    Slot& slot = *slots_[index];
    gone.push_back(std::move(slot.entry));
    slot.entry = nullptr;
    bytes_ -= slot.bytes;
    used_.erase(slot.used);
  };
  if (slots_[i]->entry) drop(i);    // it had fewer parts
  if (bytes > most_bytes_) return;  // for this one asker
  while (bytes_ + bytes > most_bytes_) {
    drop(used_.back());
    ++let_go_;
  }
  Slot& slot = *slots_[i];
  used_.push_front(i);
  slot.entry = entry;
  slot.parts = parts;
  slot.bytes = bytes;
  slot.used = used_.begin();
  bytes_ += bytes;
}

std::shared_ptr<const Entry> EntryCache::get(std::size_t i,
                                             SceneParts parts,
                                             const RunContext& context) {
  const std::shared_ptr<const Entry>& base = base_[i];
  if (base->stored.source == nullptr) return base;
  if (auto known = find(i, parts)) return known;
  const std::lock_guard loading(slots_[i]->loading);
  if (auto known = find(i, parts)) return known;
  try {
    CatalogEntry stored = base->stored;
    stored.record = stored.source->load(parts, context);
    auto entry = std::make_shared<const Entry>(make_entry(std::move(stored), context));
    keep(i, parts, entry);
    return entry;
  } catch (const Error& error) {
    if (!is_damage(error)) throw;
    set_aside(i, error.what());
    throw Error(ErrorCode::kDataLoss, error.what());
  }
}

std::string EntryCache::damage(std::size_t i) const {
  const std::lock_guard lock(mutex_);
  return slots_[i]->damage;
}

void EntryCache::set_aside(std::size_t i, const std::string& what) {
  {
    const std::lock_guard lock(mutex_);
    if (!slots_[i]->damage.empty()) return;
    slots_[i]->damage = what;
  }
  if (on_damaged_) on_damaged_(base_[i]->stored, what);
}

std::size_t EntryCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::uint64_t EntryCache::loads() const {
  const std::lock_guard lock(mutex_);
  return loads_;
}

std::uint64_t EntryCache::let_go() const {
  const std::lock_guard lock(mutex_);
  return let_go_;
}

}  // namespace landmarkdb
