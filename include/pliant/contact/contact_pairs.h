// Lookup of contacts by the pair of bodies.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <pliant/body/state.h>
#include <pliant/collision/contact.h>

namespace pliant {

/// The pair of bodies of a contact: part a, part b, plane, obstacle; -1 for none.
using PairKey = std::array<int, 4>;
inline PairKey key_of(const Contact& contact) {
  return {contact.a.part, contact.b.part, contact.plane, contact.obstacle};
}
inline const PairKey& key_of(const CachedContact& cached) {
  return cached.between;
}
inline const PairKey& key_of(const std::pair<PairKey, const Contact*>& entry) {
  return entry.first;
}

/// The order of contacts, cached contacts and entries by their pairs.
struct ByPair {
  template <class A, class B>
  bool operator()(const A& a, const B& b) const {
    return key_of(a) < key_of(b);
  }
};

class Pairs {
 public:
  /// The contacts must outlive the object.
  explicit Pairs(const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) all_.emplace_back(key_of(contact), &contact);
    std::sort(all_.begin(), all_.end());
  }
  bool has(const Contact& contact) const {
    const auto [first, last] = range(contact);
    return first != last;
  }
  /// Returns whether `is` holds for some contact of the same pair.
  template <class F>
  bool has(const Contact& contact, F&& is) const {
    const auto [first, last] = range(contact);
    return std::any_of(first, last, [&](const Entry& entry) { return is(*entry.second); });
  }

 private:
  using Entry = std::pair<PairKey, const Contact*>;
  std::pair<std::vector<Entry>::const_iterator, std::vector<Entry>::const_iterator> range(
      const Contact& contact) const {
    return std::equal_range(all_.begin(), all_.end(), contact, ByPair{});
  }
  std::vector<Entry> all_;
};

}  // namespace pliant
