// Contacts by what touches what.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <pliant/contact/contact.h>

namespace pliant {

class Pairs {
 public:
  /// The contacts must outlive it.
  explicit Pairs(const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) all_.emplace_back(key(contact), &contact);
    std::sort(all_.begin(), all_.end());
  }
  bool has(const Contact& contact) const {
    const auto [first, last] = range(contact);
    return first != last;
  }
  /// Whether some contact of the same pair is one that `is` says it is.
  template <class F>
  bool has(const Contact& contact, F&& is) const {
    const auto [first, last] = range(contact);
    return std::any_of(first, last, [&](const Entry& entry) { return is(*entry.second); });
  }

 private:
  using Key = std::array<int, 4>;
  using Entry = std::pair<Key, const Contact*>;
  static Key key(const Contact& contact) {
    return {contact.a.part, contact.b.part, contact.plane, contact.obstacle};
  }
  std::pair<std::vector<Entry>::const_iterator, std::vector<Entry>::const_iterator> range(
      const Contact& contact) const {
    struct Before {
      bool operator()(const Entry& entry, const Key& k) const { return entry.first < k; }
      bool operator()(const Key& k, const Entry& entry) const { return k < entry.first; }
    };
    return std::equal_range(all_.begin(), all_.end(), key(contact), Before{});
  }
  std::vector<Entry> all_;
};

}  // namespace pliant
