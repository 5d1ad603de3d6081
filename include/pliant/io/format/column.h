// The description of a table column, as written to layout.json.
#pragma once

#include <string>

namespace pliant {

struct Column {
  std::string name;
  std::string unit;     ///< "1" for a dimensionless number
  std::string meaning;  ///< empty if the name is sufficient
};

}  // namespace pliant
