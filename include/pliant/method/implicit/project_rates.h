// Projection of filtered rates (implicit_part.h): corrects the rates so that their products with the rows of
// joints, of strings that pull and of limits that push are those from before the filter. The correction of
// the rates is the smallest correction in a metric: the inverse of the compliance for implicit parts, the
// mass matrix M for other parts.
#pragma once

#include <pliant/method/implicit/implicit_part.h>

namespace pliant {

/// Returns whether an island has an implicit part.
bool has_implicit(const Island& island, const ImplicitParts& parts);

/// Projects v_dot, the filtered rates of all parts. parts: after filter() of each implicit part. work: the
/// evaluation that gave the rates. filtered: scratch storage, kept from call to call; its contents are
/// ignored.
void project_rates(const Model& model, const ImplicitParts& parts, const Workspace<double>& work,
                   Workspace<double>& filtered, VecX<double>& v_dot);

}  // namespace pliant
