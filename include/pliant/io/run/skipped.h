// The computations that a model does not need, as texts for "skipped" in run.json.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/model.h>

namespace pliant {

/// Returns one text per computation that the model skips.
std::vector<std::string> skipped_work(const Model& model);

}  // namespace pliant
