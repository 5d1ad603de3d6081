// Reading a part of a scene: from its record to a Part.
#pragma once

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/body/multibody.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

class PartReader {
 public:
  /// materials: the materials of the scene by name. body: the MultiBody that prepares the part. Its joint
  /// solver makes the sparse factorisation for modes of a mesh. end: end of the run, s.
  PartReader(const Reader& part, const std::map<std::string, Reader>& materials, const MultiBody& body,
             double end, SceneFaults& faults)
      : r_(part), materials_(materials), body_(body), end_(end), faults_(faults) {}

  /// Returns the part, or null if its shape is missing or unknown, or if its deformations have a fault.
  /// Faults are reported.
  std::unique_ptr<Part> read();
  /// Returns whether the part is prepared without faults, so that points on it can be resolved.
  bool prepared() const { return prepared_; }

 private:
  double property(const char* key) const;
  void read_mass_distribution(const JsonValue& value);
  void read_local_factor(const Reader& local);
  void read_elasticity();
  void read_stiffness(const Reader& r);
  bool check_names(const JsonValue& names);
  bool check_square(const JsonValue& K, std::size_t n);
  /// Returns whether the matrix [[...], ...] is symmetric; differing numbers are reported.
  bool check_symmetric(const JsonValue& rows);
  void read_inertia(const Reader& r);
  /// Returns the value of "fixed" or "motion", or null if the part is neither fixed nor moved as prescribed.
  const JsonValue* fixed_or_motion() const;
  void read_motion(const Reader& r);
  void check_rigid_keys();
  void report_at_parameters(const std::invalid_argument& e);
  void report_local_fault(const LocalFault& e);
  std::string without_name(const std::invalid_argument& e) const;
  void prepare();

  const Reader& r_;
  const std::map<std::string, Reader>& materials_;
  const MultiBody& body_;
  double end_;
  SceneFaults& faults_;
  std::unique_ptr<Part> part_;
  bool prepared_ = false;
};

}  // namespace pliant
