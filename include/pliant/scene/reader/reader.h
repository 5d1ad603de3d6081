// Reading validated values by key: what the file says, else the default that the record declares; a value in
// which a fault was found counts as absent. Nothing is checked again; asking for a key that the record does
// not declare, or that has neither value nor default, is an error of the program and throws std::logic_error.
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

/// An object of the scene beside the record that it was validated against. All must outlive it.
class Reader {
 public:
  Reader(const JsonValue& object, const schema::Record& record, const FaultyValues* faulty = nullptr)
      : object_(&object), record_(&record), faulty_(faulty) {}

  const JsonValue& json() const { return *object_; }
  const schema::Record& record() const { return *record_; }
  /// The name of the record: for an object with a tag, the value of the tag.
  const std::string& name() const { return record_->name; }

  /// The scene itself has the key, with a sound value.
  bool given(std::string_view key) const;
  /// The scene has the key, with a fault in its value.
  bool faulty(std::string_view key) const;
  /// There is a fault in a value inside this object.
  bool is_faulty(const JsonValue& value) const;
  /// Every key that the record requires is given.
  bool complete() const;
  /// The value of the key or its default; null when it has neither.
  const JsonValue* find(const std::string& key) const;
  const JsonValue& at(const std::string& key) const;

  double number(const std::string& key) const;
  std::int64_t integer(const std::string& key) const;
  bool boolean(const std::string& key) const;
  const std::string& text(const std::string& key) const;
  Vec3<double> vector3(const std::string& key) const;
  std::vector<double> numbers(const std::string& key) const;
  TimeFunction time_function(const std::string& key) const;
  TimeVector time_vector(const std::string& key) const;

  // Objects are entered even when there are faults in them: their own keys know which.

  /// The object under a key, with the record that its type names (the chosen one where there are several). An
  /// absent key whose type is one record gives that record's defaults.
  Reader object(const std::string& key) const;
  /// The objects of an array under a key; empty for an absent key.
  std::vector<Reader> objects(const std::string& key) const;
  /// The objects of a map under a key, with their names; empty for an absent key.
  std::vector<std::pair<std::string, Reader>> entries(const std::string& key) const;

 private:
  const schema::Field& field(const std::string& key) const;

  const JsonValue* object_;
  const schema::Record* record_;
  const FaultyValues* faulty_;
};

/// The record of a type that an object was validated against; null for a type without records.
const schema::Record* chosen_record(const schema::Type& type, const JsonValue& object);

Vec3<double> read_vector3(const JsonValue& value);

/// The name that an object has, or one of its kind and its number (from 0) among those of its list.
std::string name_of(const Reader& r, const char* kind, std::size_t number);

}  // namespace pliant
