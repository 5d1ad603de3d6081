#include <pliant/scene/json/json_document.h>

#include <algorithm>
#include <charconv>

#include <pliant/math/nearest_name.h>

#include "json_parse.h"
#include "json_tokens.h"
#include "json_write.h"
#include "utf8.h"

namespace pliant {

namespace {

/// Splits a JSON pointer into its keys. Returns false if the text is not a JSON pointer.
bool split(std::string_view pointer, std::vector<std::string>* keys) {
  if (pointer.empty()) return true;
  if (pointer[0] != '/') return false;
  keys->emplace_back();
  for (std::size_t i = 1; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      keys->emplace_back();
    } else if (pointer[i] == '~') {
      if (i + 1 >= pointer.size() || (pointer[i + 1] != '0' && pointer[i + 1] != '1')) return false;
      keys->back() += pointer[++i] == '0' ? '~' : '/';
    } else {
      keys->back() += pointer[i];
    }
  }
  return true;
}

/// Converts a key of a pointer to an array index. Returns false if the key is not an index.
bool index_of(const std::string& key, std::size_t* index) {
  const bool leading_zero = key.size() > 1 && key[0] == '0';
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), *index);
  return !leading_zero && error == std::errc() && end == key.data() + key.size();
}

/// Returns the value of a key of an object or of an index of an array, or null if `parent` has no such value.
const JsonValue* child(const JsonValue& parent, const std::string& key) {
  if (parent.is_object()) return parent.find(key);
  std::size_t index = 0;
  if (!parent.is_array() || !index_of(key, &index) || index >= parent.array().size()) return nullptr;
  return &parent.array()[index];
}

/// Extends `pointer` by the path from the value `from` to the value with address `wanted`. Returns false and
/// leaves `pointer` unchanged if `from` does not contain this address.
bool find_address(const JsonValue& from, const JsonValue* wanted, std::string* pointer) {
  if (&from == wanted) return true;
  const std::size_t length = pointer->size();
  if (from.is_object()) {
    for (const JsonValue::Member& member : from.members()) {
      *pointer = pointer_join(*pointer, member.key);
      if (find_address(member.value, wanted, pointer)) return true;
      pointer->resize(length);
    }
  } else if (from.is_array()) {
    for (std::size_t i = 0; i < from.array().size(); ++i) {
      *pointer = pointer_join(*pointer, i);
      if (find_address(from.array()[i], wanted, pointer)) return true;
      pointer->resize(length);
    }
  }
  return false;
}

std::string counted(std::size_t n, const char* noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

/// Returns whether the value of an override is a string without quotes instead of JSON, for example in
/// --set /name=arm or --set /force=2*t.
bool is_bare_text(std::string_view text) {
  if (text.empty() || text == "true" || text == "false" || text == "null") return false;
  if (std::string_view("{[\"").find(text[0]) != std::string_view::npos) return false;
  const std::string_view size = text[0] == '-' || text[0] == '+' ? text.substr(1) : text;
  for (const std::string_view word : {"nan", "NaN", "inf", "Inf", "infinity", "Infinity"}) {
    if (size == word) return false;
  }
  const char c = text[0];
  const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  return letter || text.find_first_not_of("0123456789+-.eE \t\r\n") != std::string_view::npos;
}

/// Returns the message that `parent`, the value at `pointer`, has no child `key`.
std::string dead_end(const JsonValue& parent, const std::string& pointer, const std::string& key) {
  const std::string here = pointer.empty() ? "the document" : pointer;
  if (parent.is_array()) {
    return here + " has " + counted(parent.array().size(), "element") + "; there is no element \"" + key +
           "\"";
  }
  if (!parent.is_object()) return here + " is neither an object nor an array; it has no \"" + key + "\"";
  std::vector<std::string> keys;
  for (const JsonValue::Member& member : parent.members()) keys.push_back(member.key);
  const std::string nearest = nearest_name(key, keys);
  return here + " has no key \"" + key + "\"" +
         (nearest.empty() ? "" : "; did you mean " + pointer_join(pointer, nearest) + "?");
}

}  // namespace

std::string pointer_join(const std::string& pointer, std::string_view key) {
  std::string result = pointer + "/";
  for (const char c : key) {
    if (c == '~') {
      result += "~0";
    } else if (c == '/') {
      result += "~1";
    } else {
      result += c;
    }
  }
  return result;
}

std::string pointer_join(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

JsonDocument JsonDocument::read(const std::string& path, Diagnostics& faults) {
  return parse(path == "-" ? "standard input" : path, read_text_file(path, kMaxBytes), faults);
}

JsonDocument JsonDocument::parse(std::string name, std::string text, Diagnostics& faults) {
  if (text.size() > kMaxBytes) {
    throw FileError(FileError::Reason::kTooLarge, name + ": " + std::to_string(text.size()) +
                                                      " bytes; the limit is " + std::to_string(kMaxBytes));
  }
  JsonDocument document;
  document.sources_.push_back(make_source(std::move(name), std::move(text)));
  json::ParseOptions options;
  options.place = [&](std::size_t offset) {
    const Diagnostic d = document.fault_at({0, static_cast<std::uint32_t>(offset)}, "", "");
    return "line " + std::to_string(d.line) + ", column " + std::to_string(d.column);
  };
  options.report = [&](const json::Fault& f) {
    faults.add(document.fault_at({0, static_cast<std::uint32_t>(f.offset)}, f.pointer, f.message));
  };
  try {
    document.root_ = json::parse(document.text(), options);
  } catch (const json::Fault& f) {
    options.report(f);
    throw SceneError(faults);
  }
  return document;
}

JsonDocument::Source JsonDocument::make_source(std::string name, std::string text) {
  Source source{std::move(name), std::move(text), {0}};
  for (std::size_t i = 0; i < source.text.size(); ++i) {
    if (source.text[i] == '\n') source.lines.push_back(static_cast<std::uint32_t>(i + 1));
  }
  return source;
}

void JsonDocument::set(const std::string& assignment, Diagnostics& faults) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    faults.add({"--set " + assignment, 0, 0, "", "expected /json/pointer=value", Severity::kError});
    return;
  }
  set(assignment.substr(0, equals), assignment.substr(equals + 1), faults);
}

void JsonDocument::set(const std::string& pointer, const std::string& text, Diagnostics& faults) {
  const std::string option = "--set " + pointer;
  const auto refuse = [&](std::string message) {
    faults.add({option, 0, 0, pointer, std::move(message), Severity::kError});
  };
  std::vector<std::string> keys;
  if (!split(pointer, &keys) || keys.empty()) {
    faults.add({option, 0, 0, "",
                "expected a JSON pointer to a value, for example /parts/0/name; in a key, ~ is written ~0 "
                "and / is written ~1",
                Severity::kError});
    return;
  }
  const JsonValue* parent = &root_;
  std::string reached;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    const JsonValue* next = child(*parent, keys[i]);
    if (next == nullptr) return refuse(dead_end(*parent, reached, keys[i]));
    parent = next;
    reached = pointer_join(reached, keys[i]);
  }
  const std::string& last = keys.back();
  const JsonValue* old = child(*parent, last);
  std::size_t index = 0;
  const bool append =
      parent->is_array() && (last == "-" || (index_of(last, &index) && index == parent->array().size()));
  if (old == nullptr && !parent->is_object() && !append) return refuse(dead_end(*parent, reached, last));

  const auto number = static_cast<std::uint32_t>(sources_.size());
  json::ParseOptions options;
  options.source = number;
  options.depth = static_cast<int>(keys.size());
  options.place = [](std::size_t offset) { return "character " + std::to_string(offset + 1); };
  bool sound = true;
  options.report = [&](const json::Fault& f) {
    sound = false;
    faults.add({option, 0, 0, pointer + f.pointer, f.message, Severity::kError});
  };
  std::string written = text;
  JsonValue value;
  try {
    if (is_bare_text(text)) written = json_string(text);
    value = json::parse(written, options);
  } catch (const json::Fault& f) {
    return refuse(text + "; at character " + std::to_string(f.offset + 1) + ": " + f.message);
  }
  if (!sound) return;
  sources_.push_back(make_source(option, std::move(written)));

  // The document owns these values, so the const_cast is safe.
  if (old != nullptr) {
    *const_cast<JsonValue*>(old) = std::move(value);
    return;
  }
  JsonValue& owner = *const_cast<JsonValue*>(parent);
  if (append) {
    std::get<JsonValue::Array>(owner.content_).push_back(std::move(value));
  } else {
    std::get<JsonValue::Object>(owner.content_).push_back({last, value.place(), std::move(value)});
  }
}

const JsonValue* JsonDocument::at(std::string_view pointer) const {
  std::vector<std::string> keys;
  if (!split(pointer, &keys)) return nullptr;
  const JsonValue* value = &root_;
  for (const std::string& key : keys) {
    value = child(*value, key);
    if (value == nullptr) return nullptr;
  }
  return value;
}

std::string JsonDocument::pointer_to(const JsonValue& value) const {
  std::string pointer;
  find_address(root_, &value, &pointer);
  return pointer;
}

std::string JsonDocument::shown(const JsonValue& value) const {
  constexpr std::size_t kMaxShown = 60;  // bytes
  if (value.is_array()) {
    std::string list;
    for (const JsonValue& element : value.array()) {
      if (!element.is_object()) list += (list.empty() ? "" : ", ") + shown(element);
      if (element.is_object() || list.size() > kMaxShown)
        return "an array of " + counted(value.array().size(), "value");
    }
    return "[" + list + "]";
  }
  if (value.is_object()) {
    std::string keys;
    for (const JsonValue::Member& member : value.members()) {
      if (member.key == "//") continue;
      keys += (keys.empty() ? "\"" : ", \"") + member.key + "\"";
      if (keys.size() > kMaxShown) return "an object";
    }
    return keys.empty() ? "an empty object" : "an object with " + keys;
  }
  const std::string_view text = sources_[value.place().source].text;
  const std::size_t begin = value.place().offset;
  std::size_t end = value.is_string() ? json::string_end(text, begin) : json::word_end(text, begin);
  if (end - begin <= kMaxShown) return std::string(text.substr(begin, end - begin));
  end = begin + kMaxShown;
  while ((static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return std::string(text.substr(begin, end - begin)) + "...";
}

Diagnostic JsonDocument::fault_at(JsonPlace place, std::string pointer, std::string message,
                                  Severity severity) const {
  const Source& source = sources_[place.source];
  Diagnostic d{source.name, 0, 0, std::move(pointer), std::move(message), severity};
  if (place.source > 0) return d;
  const auto line = std::upper_bound(source.lines.begin(), source.lines.end(), place.offset);
  d.line = static_cast<int>(line - source.lines.begin());
  d.column = 1;
  std::size_t at = *(line - 1);
  if (at == 0 && std::string_view(source.text).substr(0, 3) == "\xEF\xBB\xBF") at = 3;
  for (; at < place.offset; at += std::max<std::size_t>(utf8::length(source.text, at), 1)) ++d.column;
  return d;
}

Diagnostic JsonDocument::fault(const JsonValue& value, std::string message, Severity severity) const {
  return fault_at(value.place(), pointer_to(value), std::move(message), severity);
}

Diagnostic JsonDocument::fault_at_key(const JsonValue& object, std::string_view key, std::string message,
                                      Severity severity) const {
  JsonPlace place = object.place();
  for (const JsonValue::Member& member : object.members()) {
    if (member.key == key) {
      place = member.key_place;
      break;
    }
  }
  return fault_at(place, pointer_join(pointer_to(object), key), std::move(message), severity);
}

Diagnostic JsonDocument::fault_in_string(const JsonValue& string, std::size_t byte, std::string message,
                                         Severity severity) const {
  return fault_at(place_in_string(string, byte), pointer_to(string), std::move(message), severity);
}

JsonPlace JsonDocument::place_in_string(const JsonValue& string, std::size_t byte) const {
  const JsonPlace place = string.place();
  const std::size_t at = json::string_byte(sources_[place.source].text, place.offset, byte);
  return {place.source, static_cast<std::uint32_t>(at)};
}

}  // namespace pliant
