// Which program wrote a file: a run goes on only with the build that began it, since only that gives the same bits.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pliant {

/// Name and value: version, compiler, build type, native, Eigen, processor family.
using BuildInfo = std::vector<std::pair<std::string, std::string>>;
BuildInfo build_info();

}  // namespace pliant
