// The computations that the engine skips because a model does not need them, as texts for "skipped" in
// run.json.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/model.h>

namespace pliant {

/// Returns one text per skipped computation.
std::vector<std::string> skipped_work(const Model& model);

}  // namespace pliant
