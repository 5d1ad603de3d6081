// Which program wrote a file: a run goes on only with the build that began it, since only that gives the same
// bits.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pliant {

/// Name and value: what may change the last bits of a result, from the version to the processor.
using BuildInfo = std::vector<std::pair<std::string, std::string>>;
BuildInfo build_info();

}  // namespace pliant
