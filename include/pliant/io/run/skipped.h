// What a model does not need, in words for people (design section 2).
#pragma once

#include <string>
#include <vector>

#include <pliant/body/model.h>

namespace pliant {

std::vector<std::string> skipped_work(const Model& model);

}  // namespace pliant
