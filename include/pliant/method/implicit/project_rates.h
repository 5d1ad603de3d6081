// Projection of filtered rates onto the rows of joints, strings and limits that push: these rows keep the
// values that they had before the filter. The forces act in the metric of the filter: S for implicit parts
// (implicit_part.h), M for others.
#pragma once

#include <memory>
#include <vector>

#include <pliant/method/implicit/implicit_part.h>

namespace pliant {

/// Returns whether an island has an implicit part.
bool has_implicit(const Island& island, const std::vector<std::unique_ptr<ImplicitPart>>& soft);

/// Projects v_dot after the filter. soft: the implicit parts, nullptr for explicit parts, as filter() left
/// them. work: the evaluation that gave the rates. filtered: storage, kept from call to call.
void project_rates(const Model& model, const std::vector<std::unique_ptr<ImplicitPart>>& soft,
                   const Workspace<double>& work, Workspace<double>& filtered, VecX<double>& v_dot);

}  // namespace pliant
