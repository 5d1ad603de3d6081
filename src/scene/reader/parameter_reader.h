// Reading the global parameters of a part: rest values, limits and initial values. Each value is checked
// against the range of the parameter, and a fault is reported at the value.
#pragma once

#include <string>
#include <vector>

#include <pliant/part/part.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"
#include "time_reader.h"

namespace pliant {

class ParameterReader {
 public:
  /// in_matrix: the parameters in the stiffness matrix of the part; these parameters are dynamic. end: end of
  /// the run, s.
  ParameterReader(Part& part, const std::vector<std::string>& in_matrix, double end, SceneFaults& faults)
      : part_(part), in_matrix_(in_matrix), times_(end, faults), faults_(faults) {}

  /// Reads the key "parameters" of a part. Faulty values are skipped.
  void read(const Reader& part);

 private:
  /// A parameter with the values of its keys; null for an absent key.
  struct Entry {
    const Parameter& parameter;
    const JsonValue& value;
    const JsonValue *rest, *initial, *stiffness, *min, *max, *flag;  ///< flag: the key "dynamic"
    bool in_matrix, dynamic;
  };

  Entry entry(const std::string& name, const JsonValue& value) const;
  void unknown(const JsonValue& parameters, const std::string& name);
  void read(const Entry& e);
  bool contradicts(const Entry& e);
  bool read_rest(const Entry& e);
  /// Reads the limits and checks that rest value and initial value of a dynamic parameter are within them.
  void read_limits(const Entry& e);
  bool admissible(const Entry& e, const Range& allowed);

  Part& part_;
  const std::vector<std::string>& in_matrix_;
  TimeReader times_;
  SceneFaults& faults_;
};

}  // namespace pliant
