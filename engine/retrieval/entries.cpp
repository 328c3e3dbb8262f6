#include "engine/retrieval/entries.hpp"

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"

namespace landmarkdb {

Entries::Entries(std::span<const Entry> whole) {
  seen_.reserve(whole.size());
  for (const Entry& entry : whole) seen_.push_back(&entry);
}

Entries::Entries(EntryCache& cache) : cache_(&cache) {
  seen_.reserve(cache.size());
  for (std::size_t i = 0; i < cache.size(); ++i) seen_.push_back(cache.base(i).get());
}

const void* Entries::key(std::size_t i) const {
  return cache_ != nullptr ? cache_->base(i).get() : seen_[i];
}

bool Entries::is_damaged(std::size_t i) const {
  return cache_ != nullptr && !cache_->damage(i).empty();
}

void Entries::load(std::span<const std::size_t> which,
                   SceneParts parts,
                   const RunContext& context) {
  if (cache_ == nullptr) return;
  RunContext alone = context;
  alone.threads = 1;
  alone.progress = nullptr;
  std::vector<std::shared_ptr<const Entry>> loaded(which.size());
  parallel_each(which.size(), context.threads, [&](std::size_t i) {
    context.check("load");
    try {
      loaded[i] = cache_->get(which[i], parts, alone);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kDataLoss) throw;
    }
  });
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (!loaded[i]) continue;
    seen_[which[i]] = loaded[i].get();
    held_.push_back(std::move(loaded[i]));
  }
}

}  // namespace landmarkdb
