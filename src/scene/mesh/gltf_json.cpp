#include "gltf_json.h"

#include <stdexcept>
#include <utility>

namespace pliant::gltf {

Value Value::operator[](const std::string& key) const {
  const std::string pointer = pointer_ + "/" + key;
  if (json_ == nullptr) return {*file_, nullptr, pointer};
  if (!json_->is_object()) fail("a value that is not an object", "an object");
  return {*file_, json_->find(key), pointer};
}

std::size_t Value::size() const {
  if (json_ == nullptr) return 0;
  if (!json_->is_array()) fail("a value that is not an array", "an array");
  return json_->array().size();
}

Value Value::operator[](std::size_t index) const {
  return {*file_, &json_->array()[index], pointer_ + "/" + std::to_string(index)};
}

std::size_t Value::integer(std::size_t max, std::size_t absent) const {
  return json_ == nullptr ? absent : integer(max);
}

std::size_t Value::integer(std::size_t max) const {
  const std::string expected = "an integer from 0 to " + std::to_string(max);
  if (json_ == nullptr) fail("no value", expected);
  if (!json_->is_number()) fail("a value that is not a number", expected);
  const double value = json_->number();
  if (!(value >= 0 && value <= static_cast<double>(max)) ||
      value != static_cast<double>(static_cast<std::size_t>(value)))
    fail(std::to_string(value), expected);
  return static_cast<std::size_t>(value);
}

double Value::number() const {
  if (json_ == nullptr || !json_->is_number()) fail("a value that is not a number", "a number");
  return json_->number();
}

bool Value::boolean() const {
  if (json_ == nullptr || !json_->is_boolean()) fail("a value that is not true or false", "true or false");
  return json_->boolean();
}

const std::string& Value::text() const {
  if (json_ == nullptr || !json_->is_string()) fail("a value that is not a text", "a text");
  return json_->string();
}

void Value::fail(const std::string& found, const std::string& expected) const {
  throw std::invalid_argument(*file_ + ": " + (pointer_.empty() ? "the document" : pointer_) + ": found " +
                              found + "; expected " + expected);
}

JsonDocument parse_json(const std::string& name, std::string text) {
  if (text.size() > JsonDocument::kMaxBytes)
    throw std::invalid_argument(name + ": the JSON text has " + std::to_string(text.size()) +
                                " bytes; expected at most " + std::to_string(JsonDocument::kMaxBytes) +
                                "; store the buffers in a file .bin or .glb");
  Diagnostics faults;
  try {
    JsonDocument document = JsonDocument::parse(name, std::move(text), faults);
    if (faults.errors() > 0) throw std::invalid_argument(faults.text(1));
    return document;
  } catch (const SceneError& error) {
    throw std::invalid_argument(error.diagnostics().text(1));
  }
}

}  // namespace pliant::gltf
