// Function bodies of state.h.
#pragma once

#include <algorithm>
#include <cstddef>

#include <pliant/body/state.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// The hash FNV-1a of bytes.
class BitHash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) value_ = (value_ ^ byte[i]) * 0x100000001b3u;
  }
  template <class T>
  void add_each(const T& numbers) {
    add(numbers.data(), static_cast<std::size_t>(numbers.size()) * sizeof(*numbers.data()));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace detail

PLIANT_INLINE bool same_sleepers(const std::vector<double>& one, const std::vector<double>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](double a, double b) { return (a < 0) == (b < 0); });
}

PLIANT_INLINE void wake(State& state, int part) {
  if (!sleeps(state, part)) return;
  const double number = state.at_rest[static_cast<std::size_t>(part)];
  std::replace(state.at_rest.begin(), state.at_rest.end(), number, 0.0);
}

PLIANT_INLINE std::uint64_t hash(const State& state) {
  detail::BitHash hash;
  hash.add(&state.start, sizeof state.start);
  hash.add(&state.h, sizeof state.h);
  hash.add(&state.step, sizeof state.step);
  hash.add(&state.error, sizeof state.error);
  hash.add(&state.contact_residual, sizeof state.contact_residual);
  hash.add_each(state.q);
  hash.add_each(state.v);
  hash.add_each(state.work);
  hash.add_each(state.inputs);
  hash.add_each(state.at_limit);
  hash.add_each(state.joints);
  hash.add_each(state.at_rest);
  hash.add(&state.contact_cache_age, sizeof state.contact_cache_age);
  for (const CachedContact& contact : state.contact_cache) {
    hash.add_each(contact.between);
    hash.add_each(contact.x);
    hash.add_each(contact.force);
    hash.add(&contact.lasting, sizeof contact.lasting);
  }
  for (const StepMemory& memory : state.step_memory) {
    hash.add(&memory.h, sizeof memory.h);
    hash.add(&memory.error, sizeof memory.error);
    hash.add(&memory.contact_residual, sizeof memory.contact_residual);
    hash.add(&memory.contact_cache_age, sizeof memory.contact_cache_age);
  }
  return hash.value();
}

}  // namespace pliant
