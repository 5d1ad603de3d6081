// The energies of local deformation that scenes know, by name.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pliant/part/local/local_deformation.h>

namespace pliant {

struct LocalLawInfo {
  struct Number {
    const char* key;
    const char* unit;
    const char* meaning;
    double min;  ///< excluded where more than 0 is needed, see above
    bool above;  ///< min itself is not allowed
    std::optional<double> fallback = {};
    double max = std::numeric_limits<double>::infinity();  ///< allowed itself
  };
  const char* name;
  const char* meaning;
  bool shell;  ///< of shells; else of solids
  std::vector<Number> numbers;
  /// values: of the numbers, in order. Throws std::invalid_argument where they make no energy.
  std::unique_ptr<NodalEnergy> (*lay)(const LocalMesh& mesh, const double* values);
  bool quadratic = false;  ///< in d: modes know it
};

const std::vector<LocalLawInfo>& all_local_laws();

/// A law that is there, by name.
const LocalLawInfo& local_law_info(const std::string& name);

/// A law by name with the values of its numbers, in order. Throws std::invalid_argument, listing the laws for
/// an unknown one.
LocalSettings::Law local_law(const std::string& name, std::vector<double> values);

}  // namespace pliant
