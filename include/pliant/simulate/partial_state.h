// The state of some parts of a model, as a state of a model of these parts (Model::part_numbers()).
#pragma once

#include <pliant/body/model.h>

namespace pliant {

/// Copies the state of the parts of `some`, State::start and State::step from a state of the whole model. h
/// is the smallest h in the StepMemory of the parts; error, contact_residual and contact_cache_age are the
/// largest values in the StepMemory of the parts. The works become 0.
void extract_state(const Model& whole, const State& state, const Model& some, State& part);

/// Copies the state of the parts of `some` back to a state of the whole model, and adds the works. Each of
/// the parts receives a StepMemory. The cached contacts are appended; the caller sorts them by pairs.
void insert_state(const Model& some, const State& part, const Model& whole, State& state);

}  // namespace pliant
