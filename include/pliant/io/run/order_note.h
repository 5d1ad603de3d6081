// The note at the end of a run with a method of first order, which states its error.
#pragma once

#include <string>

#include <pliant/io/run/run_record.h>

namespace pliant {

/// Returns the text about the error of a run with fixed steps by a method of first order: the largest error
/// of the energy balance, relative to the largest kinetic energy, and the step for which it would be 1 %.
/// Returns an empty text for other methods, and if nothing has moved.
std::string order_note(const RunRecord& record, int order);

}  // namespace pliant
