// The pair of bodies at a contact, contacts sorted by their pairs, and contacts at nodes.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <pliant/body/state.h>
#include <pliant/collision/contact.h>

namespace pliant {

/// Returns whether one of the sides of a contact is at nodes of a mesh.
inline bool is_at_nodes(const Contact& contact) {
  return contact.a.at_nodes() || contact.b.at_nodes();
}

/// Numbers of part a, part b, plane and obstacle; -1: none.
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

/// Compares contacts, cached contacts and entries of Pairs by their pairs.
struct ByPair {
  template <class A, class B>
  bool operator()(const A& a, const B& b) const {
    return key_of(a) < key_of(b);
  }
};

/// Some contacts, sorted by their pairs.
class Pairs {
 public:
  /// The contacts must outlive this object.
  explicit Pairs(const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) sorted_.emplace_back(key_of(contact), &contact);
    std::sort(sorted_.begin(), sorted_.end());
  }
  /// Returns whether one of the contacts belongs to the pair of this contact.
  bool has(const Contact& contact) const {
    const auto [first, last] = range(contact);
    return first != last;
  }
  /// Returns whether condition(c) is true for a contact c that belongs to the pair of this contact.
  template <class F>
  bool has(const Contact& contact, F&& condition) const {
    const auto [first, last] = range(contact);
    return std::any_of(first, last, [&](const Entry& entry) { return condition(*entry.second); });
  }

 private:
  using Entry = std::pair<PairKey, const Contact*>;
  std::pair<std::vector<Entry>::const_iterator, std::vector<Entry>::const_iterator> range(
      const Contact& contact) const {
    return std::equal_range(sorted_.begin(), sorted_.end(), contact, ByPair{});
  }
  std::vector<Entry> sorted_;
};

}  // namespace pliant
