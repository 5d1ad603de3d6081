// The words of a text file, with the line and column of each word for messages. Numbers do not depend on the
// locale and are rounded correctly to double.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "raw_mesh.h"

namespace pliant {

class Words {
 public:
  /// file: must outlive this object.
  explicit Words(const MeshBytes& file, std::size_t begin = 0)
      : file_(file), text_(file.bytes), at_(begin), word_at_(begin) {}

  /// Returns the next word of the line; empty at the end of the line and at a comment (#). A backslash at the
  /// end of a line continues the line.
  std::string_view on_line();
  /// Moves to the next line. Returns false at the end of the text.
  bool next_line();
  /// Returns the next word of the text; empty at the end of the text.
  std::string_view next();
  /// Number of bytes that have not been read.
  std::size_t remaining() const { return text_.size() - at_; }
  /// Byte after the last word.
  std::size_t position() const { return at_; }

  /// Return a word as a finite number, or as an integer from `min` to `max`. The word must be the last one
  /// that was returned. meaning: noun for the number. number() and integer() throw the error of fail().
  double number(std::string_view word, const char* meaning) const;
  long long integer(std::string_view word, long long min, long long max, const char* meaning) const;
  /// Throws std::invalid_argument with file, line and column of the last word, the word, and `expected`.
  [[noreturn]] void fail(const std::string& expected) const;

 private:
  std::string_view word_from(std::size_t begin);

  const MeshBytes& file_;
  std::string_view text_;
  std::size_t at_, word_at_;
  std::size_t word_size_ = 0;
};

/// Throws std::invalid_argument with the place of a byte of a file: FILE: byte N: found ...; expected ...
[[noreturn]] void fail_at_byte(const MeshBytes& file, std::size_t byte, const std::string& found,
                               const std::string& expected);
/// Returns a word of a file in quotes, escaped and shortened, for a message.
std::string quoted_word(std::string_view word);

}  // namespace pliant
