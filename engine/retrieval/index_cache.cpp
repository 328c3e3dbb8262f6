#include "engine/retrieval/index_cache.hpp"

#include <algorithm>
#include <utility>

namespace landmarkdb {

std::shared_ptr<const DescriptorIndex> make_index(std::span<const float> values,
                                                  Measure measure,
                                                  Search search) {
  return search == Search::kFlann ? make_flann_index(values, measure)
                                  : make_exact_index(values, measure);
}

std::shared_ptr<IndexCache::Slot> IndexCache::slot_of(const void* key,
                                                      std::size_t bytes,
                                                      Measure measure,
                                                      Search search) {
  const std::lock_guard lock(mutex_);
  const auto known = std::find_if(slots_.begin(), slots_.end(), [&](const auto& slot) {
    return slot->key == key && slot->measure == measure && slot->search == search;
  });
  if (known != slots_.end()) {
    slots_.splice(slots_.begin(), slots_, known);
    return slots_.front();
  }
  const auto slot = std::make_shared<Slot>();
  slot->key = key;
  slot->bytes = bytes;
  slot->measure = measure;
  slot->search = search;
  if (bytes > most_bytes_) return slot;  // made for this one asker
  slots_.push_front(slot);
  bytes_ += bytes;
  while (bytes_ > most_bytes_) {
    bytes_ -= slots_.back()->bytes;
    slots_.pop_back();
  }
  return slot;
}

std::shared_ptr<const DescriptorIndex> IndexCache::get(
    const void* key,
    std::size_t rows,
    Measure measure,
    Search search,
    const std::function<std::vector<float>()>& values) {
  const std::size_t bytes = rows * kShotLength * sizeof(float);
  const std::shared_ptr<Slot> slot = slot_of(key, bytes, measure, search);
  const std::lock_guard making(slot->making);
  if (!slot->index) {
    slot->index = make_index(values(), measure, search);
    const std::lock_guard lock(mutex_);
    ++made_;
  }
  return slot->index;
}

std::size_t IndexCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::size_t IndexCache::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

}  // namespace landmarkdb
