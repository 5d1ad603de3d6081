// The elastic laws of local deformation, by the names that scenes use.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pliant/part/local/local_settings.h>

namespace pliant {

struct LocalLawInfo {
  /// A constant of a law, as a key with a number in a scene.
  struct Number {
    const char* key;
    const char* unit;
    const char* meaning;
    double min;
    bool above;                           ///< true: the value must be > min; false: >= min
    std::optional<double> fallback = {};  ///< default value; if empty, a scene must give the number
    double max = std::numeric_limits<double>::infinity();  ///< largest allowed value
  };
  const char* name;
  const char* meaning;
  const char* formula;  ///< energy W for each unit of rest volume or area, or energy E of the whole mesh
  bool shell;           ///< whether the law is for shells; else it is for solids
  std::vector<Number> numbers;
  /// Returns the energy of a mesh. values: the values of `numbers`, in this order. Throws
  /// std::invalid_argument for impossible values.
  std::unique_ptr<NodalEnergy> (*make_energy)(const LocalMesh& mesh, const double* values);
  bool quadratic = false;  ///< whether the energy is quadratic in d, as modes require
};

/// Returns all laws, in the order of `pliant list` and of the schema.
const std::vector<LocalLawInfo>& all_local_laws();

/// Returns the law of this name. Throws std::logic_error if there is no law of this name.
const LocalLawInfo& local_law_info(const std::string& name);

/// Returns the law of this name with the given values of its `numbers`, in this order. Throws
/// std::invalid_argument for an unknown name, with a list of all laws, and for a wrong number of values.
LocalSettings::Law local_law(const std::string& name, std::vector<double> values);

}  // namespace pliant
