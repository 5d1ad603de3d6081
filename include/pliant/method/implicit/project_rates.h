// Rates that a filter has changed are brought back onto the rows of what holds the parts: joints, strings and
// limits that push give the changed rates what they gave those before. The forces act in the metric of the
// filter, which is that of S (implicit_part.h) for parts that deform locally and M for others.
#pragma once

#include <memory>
#include <vector>

#include <pliant/method/implicit/implicit_part.h>

namespace pliant {

/// Whether a part of an island is stepped implicitly.
bool has_implicit(const Island& island, const std::vector<std::unique_ptr<ImplicitPart>>& soft);

/// soft: of each part, none where rates are not changed; each as its filter left it. work: of the evaluation
/// that gave the rates. filtered: any, kept from call to call.
void project_rates(const Model& model, const std::vector<std::unique_ptr<ImplicitPart>>& soft,
                   const Workspace<double>& work, Workspace<double>& filtered, VecX<double>& v_dot);

}  // namespace pliant
