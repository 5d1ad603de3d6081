// Access to the validated values of a JSON object by key. A value comes from the file, or else it is the
// default that the record declares. A faulty value is treated as absent. The reader repeats no checks. A key
// that the record does not declare, or that has neither value nor default, is a programming error and throws
// std::logic_error.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pliant/math/time_function.h>
#include <pliant/math/types.h>
#include <pliant/scene/faulty_values.h>
#include <pliant/scene/json/json_value.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

/// An object of the scene with the record that it was validated against. Object, record and faulty values
/// must outlive the reader.
class Reader {
 public:
  Reader(const JsonValue& object, const schema::Record& record, const FaultyValues* faulty = nullptr)
      : object_(&object), record_(&record), faulty_(faulty) {}

  const JsonValue& json() const { return *object_; }
  const schema::Record& record() const { return *record_; }
  /// Returns the name of the record; for a tagged record this is the value of the tag ("hinge", "taper").
  const std::string& name() const { return record_->name; }

  /// Returns whether the object itself has the key with a value free of faults.
  bool given(std::string_view key) const;
  /// Returns whether the object has the key with a faulty value.
  bool faulty(std::string_view key) const;
  /// Returns whether a value inside this object is faulty or contains a faulty value.
  bool is_faulty(const JsonValue& value) const;
  /// Returns whether all required keys of the record are given.
  bool complete() const;
  /// Returns the value of the key or its default, or null if there is neither value nor default.
  const JsonValue* find(const std::string& key) const;
  /// Returns the value of the key or its default. Throws std::logic_error if there is neither.
  const JsonValue& at(const std::string& key) const;

  double number(const std::string& key) const;
  std::int64_t integer(const std::string& key) const;
  bool boolean(const std::string& key) const;
  const std::string& text(const std::string& key) const;
  Vec3<double> vector3(const std::string& key) const;
  std::vector<double> numbers(const std::string& key) const;
  TimeFunction time_function(const std::string& key) const;
  TimeVector time_vector(const std::string& key) const;

  // The following members also return faulty objects, so that the valid values inside them can be read.

  /// Returns a reader of the object under a key, or else of the default of the key. If the type has several
  /// records, the reader uses the record that the object was validated against. If there is neither object
  /// nor default and the type is a single record, the values of the reader are the defaults of this record;
  /// for other types std::logic_error is thrown.
  Reader object(const std::string& key) const;
  /// Returns the objects of the array under a key; empty for an absent key.
  std::vector<Reader> objects(const std::string& key) const;
  /// Returns the objects of the map under a key with their names; empty for an absent key.
  std::vector<std::pair<std::string, Reader>> entries(const std::string& key) const;

 private:
  const schema::Field& field(const std::string& key) const;

  const JsonValue* object_;
  const schema::Record* record_;
  const FaultyValues* faulty_;
};

/// Returns the record of a type that an object was validated against, or null if no record of the type fits
/// the object.
const schema::Record* chosen_record(const schema::Type& type, const JsonValue& object);

Vec3<double> read_vector3(const JsonValue& value);

/// Returns the name given in the object, or else a name made of `kind` and `number` + 1, for example "hinge1"
/// for number 0. number: index of the object in its list.
std::string name_of(const Reader& r, const char* kind, std::size_t number);

}  // namespace pliant
