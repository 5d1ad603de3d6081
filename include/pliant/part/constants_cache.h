// ConstantsCache: the constants of prepared parts, found by the description from which they follow. The
// search for mass points takes most of the time of Part::prepare(); parts with equal descriptions need one
// search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <pliant/part/part_constants.h>

namespace pliant {

/// The bits of all settings of a part that its constants depend on (PartDescription::constants_key()).
using ConstantsKey = std::vector<std::uint64_t>;

class ConstantsCache {
 public:
  /// Returns the stored constants of parts with this key; nullptr if there are none.
  std::shared_ptr<const PartConstants> find(const ConstantsKey& key) const;
  /// Stores constants. Removes those that no part uses any more, whenever the number of keys has doubled.
  void store(ConstantsKey key, std::shared_ptr<const PartConstants> constants);

  /// Number of calls of store(): how often constants were computed.
  std::size_t computed() const { return computed_; }
  /// Number of keys with stored constants.
  std::size_t size() const { return known_.size(); }

 private:
  std::map<ConstantsKey, std::shared_ptr<const PartConstants>> known_;
  std::size_t computed_ = 0, max_size_ = 16;
};

}  // namespace pliant
