#include <pliant/part/constants_cache.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace pliant {

std::shared_ptr<const PartConstants> ConstantsCache::find(const ConstantsKey& key) const {
  const auto known = known_.find(key);
  return known == known_.end() ? nullptr : known->second;
}

void ConstantsCache::store(ConstantsKey key, std::shared_ptr<const PartConstants> constants) {
  ++computed_;
  if (known_.size() >= max_size_) {
    for (auto at = known_.begin(); at != known_.end();)
      at = at->second.use_count() == 1 ? known_.erase(at) : std::next(at);
    max_size_ = std::max(max_size_, 2 * known_.size());
  }
  known_.emplace(std::move(key), std::move(constants));
}

}  // namespace pliant
