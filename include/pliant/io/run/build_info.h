// The identity of the program that wrote a run. Only the build that began a run can resume it, because the
// results of another build may differ in their last bits.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pliant {

/// Names and values of all properties that may change the last bits of a result: version, compiler,
/// processor, ...
using BuildInfo = std::vector<std::pair<std::string, std::string>>;
/// Returns the properties of this program.
BuildInfo build_info();

}  // namespace pliant
