// ConstantsCache stores the constants of prepared parts, each under a key computed from the description of
// the part. The search for mass points takes most of the time of Part::prepare(); parts with equal
// descriptions need only one search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <pliant/part/part_constants.h>

namespace pliant {

/// The bits of all settings on which the constants of a part depend (PartDescription::constants_key()).
using ConstantsKey = std::vector<std::uint64_t>;

class ConstantsCache {
 public:
  /// Returns the stored constants of parts with this key; nullptr if there are none.
  std::shared_ptr<const PartConstants> find(const ConstantsKey& key) const;
  /// Stores constants. If the number of keys has reached a limit, first removes the constants that no part
  /// uses any more. The limit is then at least twice the number of the remaining keys.
  void store(ConstantsKey key, std::shared_ptr<const PartConstants> constants);

  /// Number of calls of store(): how often constants that can be shared were computed.
  std::size_t computed() const { return computed_; }
  /// Number of keys with stored constants.
  std::size_t size() const { return known_.size(); }

 private:
  std::map<ConstantsKey, std::shared_ptr<const PartConstants>> known_;
  std::size_t computed_ = 0, max_size_ = 16;
};

}  // namespace pliant
