// A column of a table that a run writes: what layout.json says of it.
#pragma once

#include <string>

namespace pliant {

struct Column {
  std::string name;
  std::string unit;     ///< "1" for none
  std::string meaning;  ///< empty where name and unit say it
};

}  // namespace pliant
