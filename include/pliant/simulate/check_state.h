// Checks of a state that a program sets: whether it fits a model, and whether its numbers are valid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <pliant/body/model.h>
#include <pliant/contact/contact_pairs.h>

namespace pliant::simulation {

/// Throws std::invalid_argument if the sizes of the vectors of a state do not fit the model.
inline void check_sizes(const State& state, const Model& model) {
  if (state.q.size() != model.n_q() || state.v.size() != model.n_v() ||
      static_cast<int>(state.at_limit.size()) != model.n_limits() ||
      state.inputs.size() != static_cast<Eigen::Index>(model.body().inputs().size()) ||
      state.joints.size() != model.joints().size() || state.at_rest.size() != model.n_resting() ||
      (!state.step_memory.empty() && state.step_memory.size() != model.parts().size()))
    throw std::invalid_argument("this state belongs to another model");
}

/// Throws std::invalid_argument if the contact cache of a state contains numbers that are not finite, has a
/// negative age, does not fit the model or is not sorted by pairs of bodies.
inline void check_contact_cache(const State& state, const Model& model) {
  if (state.contact_cache_age < 0)
    throw std::invalid_argument("the contact cache of this state has a negative age");
  const ContactSettings& contact = model.body().contact;
  const std::array<std::size_t, 4> counts{model.parts().size(), model.parts().size(), contact.planes.size(),
                                          contact.obstacles.size()};
  for (const CachedContact& cached : state.contact_cache) {
    bool fits = cached.between[0] >= 0;
    for (std::size_t i = 0; i < counts.size(); ++i)
      fits = fits && cached.between[i] >= -1 && cached.between[i] < static_cast<int>(counts[i]);
    if (!fits) throw std::invalid_argument("a cached contact of this state belongs to another model");
    if (!cached.x.allFinite() || !cached.force.allFinite())
      throw std::invalid_argument("a cached contact of this state is not finite");
  }
  if (!std::is_sorted(state.contact_cache.begin(), state.contact_cache.end(), ByPair{}))
    throw std::invalid_argument("the contact cache of this state is not sorted by the pairs of bodies");
}

/// Throws std::invalid_argument if a StepMemory of a state is out of range.
inline void check_step_memory(const State& state) {
  for (const StepMemory& memory : state.step_memory)
    if (!(memory.h >= 0 && memory.error >= 0 && memory.contact_residual >= 0 &&
          memory.contact_cache_age >= 0) ||
        !std::isfinite(memory.h + memory.error + memory.contact_residual))
      throw std::invalid_argument(
          "a step length or another number of the clusters of this state is negative or "
          "not finite");
}

}  // namespace pliant::simulation
