#include <pliant/scene/reader/reader.h>

#include <algorithm>
#include <stdexcept>

#include <pliant/scene/time_value.h>

namespace pliant {

namespace {

const JsonValue& empty_object() {
  static const JsonValue object({}, JsonValue::Object());
  return object;
}

}  // namespace

const schema::Record* chosen_record(const schema::Type& type, const JsonValue& object) {
  using Kind = schema::Type::Kind;
  if (type.kind == Kind::kRecord) return type.records[0].get();
  if (type.kind == Kind::kTagged) {
    const JsonValue* tag = object.find(type.tag);
    for (const schema::RecordPtr& record : type.records) {
      if (tag != nullptr && tag->is_string() && tag->string() == record->name) return record.get();
    }
    return nullptr;
  }
  const schema::Type* chosen = type.kind == Kind::kOneOf ? schema::chosen_alternative(type, object) : nullptr;
  return chosen == nullptr ? nullptr : chosen_record(*chosen, object);
}

const schema::Field& Reader::field(const std::string& key) const {
  const schema::Field* f = record_->find(key);
  if (f == nullptr)
    throw std::logic_error("record \"" + record_->name + "\" declares no key \"" + key + "\"");
  return *f;
}

bool Reader::is_faulty(const JsonValue& value) const {
  return faulty_ != nullptr && faulty_->count(&value) > 0;
}

bool Reader::given(std::string_view key) const {
  const JsonValue* value = object_->find(key);
  return value != nullptr && !is_faulty(*value);
}

bool Reader::faulty(std::string_view key) const {
  const JsonValue* value = object_->find(key);
  return value != nullptr && is_faulty(*value);
}

bool Reader::complete() const {
  return std::all_of(record_->fields.begin(), record_->fields.end(),
                     [&](const schema::Field& f) { return !f.required || given(f.key); });
}

const JsonValue* Reader::find(const std::string& key) const {
  const schema::Field& f = field(key);
  return given(key) ? object_->find(key) : f.default_value.get();
}

const JsonValue& Reader::at(const std::string& key) const {
  const JsonValue* value = find(key);
  if (value == nullptr) {
    throw std::logic_error("key \"" + key + "\" of record \"" + record_->name +
                           "\" has neither value nor default");
  }
  return *value;
}

double Reader::number(const std::string& key) const {
  return at(key).number();
}
std::int64_t Reader::integer(const std::string& key) const {
  return static_cast<std::int64_t>(at(key).number());
}
bool Reader::boolean(const std::string& key) const {
  return at(key).boolean();
}
const std::string& Reader::text(const std::string& key) const {
  return at(key).string();
}
Vec3<double> Reader::vector3(const std::string& key) const {
  return read_vector3(at(key));
}
TimeFunction Reader::time_function(const std::string& key) const {
  return read_time_function(at(key));
}
TimeVector Reader::time_vector(const std::string& key) const {
  return read_time_vector(at(key));
}

std::vector<double> Reader::numbers(const std::string& key) const {
  std::vector<double> x;
  for (const JsonValue& element : at(key).array()) x.push_back(element.number());
  return x;
}

Reader Reader::object(const std::string& key) const {
  const schema::Type& type = field(key).type;
  for (const JsonValue* value : {object_->find(key), field(key).default_value.get()}) {
    if (value == nullptr || !value->is_object()) continue;
    if (const schema::Record* record = chosen_record(type, *value)) return {*value, *record, faulty_};
  }
  if (type.kind == schema::Type::Kind::kRecord) return {empty_object(), *type.records[0], faulty_};
  throw std::logic_error("key \"" + key + "\" of \"" + record_->name + "\" contains no record");
}

std::vector<Reader> Reader::objects(const std::string& key) const {
  const schema::Type& type = field(key).type;
  std::vector<Reader> all;
  const JsonValue* value = object_->find(key);
  if (value == nullptr || !value->is_array()) return all;
  for (const JsonValue& element : value->array()) {
    if (!element.is_object()) continue;
    if (const schema::Record* record = chosen_record(type.inner[0], element))
      all.emplace_back(element, *record, faulty_);
  }
  return all;
}

std::vector<std::pair<std::string, Reader>> Reader::entries(const std::string& key) const {
  const schema::Type& type = field(key).type;
  std::vector<std::pair<std::string, Reader>> all;
  const JsonValue* value = object_->find(key);
  if (value == nullptr || !value->is_object()) return all;
  for (const JsonValue::Member& member : value->members()) {
    if (schema::is_ignored_key(member.key) || !member.value.is_object()) continue;
    if (const schema::Record* record = chosen_record(type.inner[0], member.value))
      all.emplace_back(member.key, Reader(member.value, *record, faulty_));
  }
  return all;
}

std::string name_of(const Reader& r, const char* kind, std::size_t number) {
  return r.given("name") ? r.text("name") : kind + std::to_string(number + 1);
}

Vec3<double> read_vector3(const JsonValue& value) {
  const JsonValue::Array& x = value.array();
  return {x[0].number(), x[1].number(), x[2].number()};
}

}  // namespace pliant
