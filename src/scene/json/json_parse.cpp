#include "json_parse.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/scene/json/json_document.h>

#include "json_tokens.h"

namespace pliant::json {

namespace {

using nlohmann::json;

/// Largest number of keys of an object that are reported as given twice.
constexpr std::size_t kMaxDuplicates = 100;

bool is_comment(std::string_view key) {
  return key == "//";
}

/// Builds the tree of values from the parser's events. A callback throws Fault to end the parsing.
class Builder final : public nlohmann::json_sax<json> {
 public:
  Builder(std::string_view text, const ParseOptions& options) : text_(text), options_(options) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;
  }

  JsonValue release_root() { return std::move(root_); }
  /// Throws Fault if the text continues after the value.
  void require_end() const {
    if (skip_space(text_, at_) < text_.size()) stop();
  }

  bool null() override { return add(word_token(), std::monostate()); }
  bool boolean(bool value) override { return add(word_token(), value); }
  bool number_integer(number_integer_t) override { return number(true); }
  bool number_unsigned(number_unsigned_t) override { return number(true); }
  bool number_float(number_float_t, const string_t& text) override {
    return number(text.find_first_of(".eE") == std::string::npos);
  }
  bool string(string_t& value) override {
    const std::size_t begin = string_token();
    refuse_nul(begin, value);
    return add(begin, std::move(value));
  }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(true); }
  bool key(string_t& value) override {
    const std::size_t begin = string_token();
    refuse_nul(begin, value);
    open_.back().key = std::move(value);
    open_.back().key_place = place(begin);
    after_ = After::kKey;
    return true;
  }
  bool end_object() override {
    at_ = next() + 1;
    Container closed = close();
    report_duplicates(closed.members);
    return add(closed.opening, std::move(closed.members));
  }
  bool start_array(std::size_t) override { return open(false); }
  bool end_array() override {
    at_ = next() + 1;
    Container closed = close();
    return add(closed.opening, std::move(closed.elements));
  }

  bool parse_error(std::size_t, const std::string&, const json::exception&) override { stop(); }

 private:
  [[noreturn]] void stop() const {
    const bool inside = !open_.empty();
    throw explain({text_, at_, after_, inside ? open_.back().opening : 0, inside, options_.place});
  }

  struct Container {
    bool object;
    std::size_t opening;
    JsonValue::Array elements;
    JsonValue::Object members;
    std::string key;
    JsonPlace key_place;
  };

  JsonPlace place(std::size_t offset) const { return {options_.source, static_cast<std::uint32_t>(offset)}; }

  /// Returns the offset of the next token, after white space and a comma or colon.
  std::size_t next() const {
    std::size_t at = skip_space(text_, at_);
    if (at < text_.size() && (text_[at] == ',' || text_[at] == ':')) at = skip_space(text_, at + 1);
    return at;
  }
  /// Moves the cursor past the next token, a string. Returns the offset of the token.
  std::size_t string_token() {
    const std::size_t begin = next();
    at_ = string_end(text_, begin);
    return begin;
  }
  /// Moves the cursor past the next token, a number or a literal. Returns the offset of the token. The event
  /// parser reads "truex" and "1.5m" as a value followed by other text. This function then throws a Fault,
  /// so that the message shows the whole word.
  std::size_t word_token() {
    const std::size_t begin = next();
    const std::size_t end = word_end(text_, begin);
    if (scalar_end(text_, begin) != end) stop();
    at_ = end;
    return begin;
  }

  /// Returns the pointer of the value that is being read.
  std::string pointer() const {
    std::string result;
    for (const Container& c : open_) {
      result = c.object ? pointer_join(result, c.key) : pointer_join(result, c.elements.size());
    }
    return result;
  }

  bool number(bool integer) {
    const std::size_t begin = word_token();
    double value = 0;
    const auto error = std::from_chars(text_.data() + begin, text_.data() + at_, value).ec;
    if (error == std::errc::result_out_of_range) {
      const std::string written(text_.substr(begin, std::min<std::size_t>(at_ - begin, 60)));
      options_.report(
          {begin, pointer(),
           written +
               "; too small for a number, it would become 0; expected 0 or at least 4.95e-324 in magnitude"});
      value = 0;
    }
    return add(begin, JsonValue::Number{value, integer});
  }

  void refuse_nul(std::size_t begin, const std::string& value) const {
    const std::size_t nul = value.find('\0');
    if (nul == std::string::npos) return;
    options_.report({string_byte(text_, begin, nul), pointer(), "\\u0000; a text cannot contain a NUL"});
  }

  bool open(bool object) {
    const std::size_t begin = next();
    if (static_cast<int>(open_.size()) + options_.depth >= JsonDocument::kMaxDepth) {
      throw Fault{begin, "", "nested deeper than " + std::to_string(JsonDocument::kMaxDepth) + " levels"};
    }
    at_ = begin + 1;
    open_.push_back({object, begin, {}, {}, {}, {}});
    after_ = object ? After::kObjectStart : After::kArrayStart;
    return true;
  }

  Container close() {
    Container closed = std::move(open_.back());
    open_.pop_back();
    return closed;
  }

  bool add(std::size_t begin, JsonValue::Content content) {
    if (++count_ > JsonDocument::kMaxValues) {
      throw Fault{
          begin, "",
          "more than " + std::to_string(JsonDocument::kMaxValues) + " values, which is the limit of a scene"};
    }
    JsonValue value(place(begin), std::move(content));
    if (open_.empty()) {
      root_ = std::move(value);
      after_ = After::kDocument;
    } else if (open_.back().object) {
      Container& c = open_.back();
      c.members.push_back({c.key, c.key_place, std::move(value)});
      after_ = After::kMember;
    } else {
      open_.back().elements.push_back(std::move(value));
      after_ = After::kElement;
    }
    return true;
  }

  /// Reports the keys of an object that are given twice, at most kMaxDuplicates of them.
  void report_duplicates(const JsonValue::Object& members) const {
    std::vector<std::size_t> order(members.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return members[a].key < members[b].key; });
    std::size_t first = 0, reported = 0;
    for (std::size_t i = 1; i < order.size() && reported < kMaxDuplicates; ++i) {
      const JsonValue::Member& member = members[order[i]];
      if (member.key != members[order[first]].key) {
        first = i;
      } else if (!is_comment(member.key)) {
        const std::size_t before = members[order[first]].key_place.offset;
        options_.report({member.key_place.offset, pointer_join(pointer(), member.key),
                         "key given twice; the first is at " + options_.place(before)});
        ++reported;
      }
    }
  }

  std::string_view text_;
  const ParseOptions& options_;
  std::size_t at_ = 0;
  After after_ = After::kNothing;
  std::vector<Container> open_;
  std::size_t count_ = 0;
  JsonValue root_;
};

}  // namespace

JsonValue parse(std::string_view text, const ParseOptions& options) {
  Fault foreign;
  if (is_foreign(text, &foreign)) throw foreign;
  Builder builder(text, options);
  json::sax_parse(text.begin(), text.end(), &builder);
  builder.require_end();  // the event parser ends at a zero byte
  return builder.release_root();
}

}  // namespace pliant::json
