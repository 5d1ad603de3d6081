// Function bodies of partial_state.h.
#pragma once

#include <pliant/simulate/partial_state.h>

#include <algorithm>
#include <limits>

#include <pliant/contact/contact_pairs.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace partial_state {

/// Copies the cached contacts of the parts `numbers` (increasing) to `part`, without contacts with other
/// parts. The copies contain the numbers that the parts have in the model of these parts.
inline void extract_cache(const std::vector<CachedContact>& cache, const std::vector<int>& numbers,
                          std::vector<CachedContact>& part) {
  part.clear();
  if (cache.empty()) return;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    constexpr int kFirst = std::numeric_limits<int>::min();
    auto cached =
        std::lower_bound(cache.begin(), cache.end(), PairKey{numbers[i], kFirst, kFirst, kFirst},
                         [](const CachedContact& c, const PairKey& key) { return c.between < key; });
    for (; cached != cache.end() && cached->between[0] == numbers[i]; ++cached) {
      int other = cached->between[1];
      if (other >= 0) {
        const auto found = std::lower_bound(numbers.begin(), numbers.end(), other);
        if (found == numbers.end() || *found != other) continue;
        other = static_cast<int>(found - numbers.begin());
      }
      part.push_back(*cached);
      part.back().between[0] = static_cast<int>(i);
      part.back().between[1] = other;
    }
  }
}

}  // namespace partial_state

PLIANT_INLINE void extract_state(const Model& whole, const State& state, const Model& some, State& part) {
  const std::vector<int>& numbers = some.part_numbers();
  part.start = state.start;
  part.step = state.step;
  StepMemory memory{std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const PartModel &to = some.parts()[i], &from = whole.parts()[at(numbers[i])];
    if (to.q0 < 0) continue;
    part.q.segment(to.q0, to.n_q()) = state.q.segment(from.q0, to.n_q());
    part.v.segment(to.v0, to.n_v()) = state.v.segment(from.v0, to.n_v());
    std::copy_n(state.at_limit.begin() + from.limit0, to.n_s, part.at_limit.begin() + to.limit0);
    const StepMemory& of_part = state.step_memory[at(numbers[i])];
    memory.h = std::min(memory.h, of_part.h);
    memory.error = std::max(memory.error, of_part.error);
    memory.contact_residual = std::max(memory.contact_residual, of_part.contact_residual);
    memory.contact_cache_age = std::max(memory.contact_cache_age, of_part.contact_cache_age);
    if (state.at_rest.empty()) continue;
    const double rest = state.at_rest[at(numbers[i])];
    part.at_rest[i] = rest;
    if (!(rest < 0)) continue;
    // Parts that sleep together get one negative number, which follows from the first of these parts.
    std::size_t first = 0;
    while (state.at_rest[at(numbers[first])] != rest) ++first;
    part.at_rest[i] = -1.0 - static_cast<double>(first);
  }
  part.h = memory.h;
  part.error = memory.error;
  part.contact_residual = memory.contact_residual;
  part.contact_cache_age = memory.contact_cache_age;
  part.work.setZero();
  part.inputs = state.inputs;
  for (std::size_t j = 0; j < some.joints().size(); ++j)
    part.joints[j] = state.joints[at(some.joint_numbers()[j])];
  partial_state::extract_cache(state.contact_cache, numbers, part.contact_cache);
}

PLIANT_INLINE void insert_state(const Model& some, const State& part, const Model& whole, State& state) {
  const std::vector<int>& numbers = some.part_numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const PartModel &from = some.parts()[i], &to = whole.parts()[at(numbers[i])];
    if (from.q0 < 0) continue;
    state.q.segment(to.q0, to.n_q()) = part.q.segment(from.q0, to.n_q());
    state.v.segment(to.v0, to.n_v()) = part.v.segment(from.v0, to.n_v());
    std::copy_n(part.at_limit.begin() + from.limit0, to.n_s, state.at_limit.begin() + to.limit0);
    state.step_memory[at(numbers[i])] = {part.h, part.error, part.contact_residual, part.contact_cache_age};
    if (state.at_rest.empty()) continue;
    const double rest = part.at_rest[i];
    state.at_rest[at(numbers[i])] = rest < 0 ? -1.0 - numbers[at(static_cast<int>(-1 - rest))] : rest;
  }
  state.work += part.work;
  for (std::size_t j = 0; j < some.joints().size(); ++j)
    state.joints[at(some.joint_numbers()[j])] = part.joints[j];
  for (CachedContact cached : part.contact_cache) {
    for (const std::size_t side : {0, 1})
      if (cached.between[side] >= 0) cached.between[side] = numbers[at(cached.between[side])];
    state.contact_cache.push_back(std::move(cached));
  }
}

}  // namespace pliant
