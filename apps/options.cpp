// Validators of option values.
#include "options.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>

#include <pliant/io/format/number_text.h>

namespace pliant_cli {
namespace {

// Returns a validator that accepts a text if `parse` does not throw std::invalid_argument. Otherwise the
// program shows the message of the exception.
CLI::Validator parsed_by(const std::function<void(const std::string&)>& parse) {
  return {[parse](std::string& text) -> std::string {
            try {
              parse(text);
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
            return {};
          },
          ""};
}

constexpr int kMaxPixels = 8192;

template <class Number>
std::optional<Number> parse(const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || at != end) return std::nullopt;
  return number;
}

CLI::Validator number_that(const std::string& expected, const std::function<bool(double)>& good) {
  return {[expected, good](std::string& text) -> std::string {
            const std::optional<double> number = parse<double>(text);
            if (number && std::isfinite(*number) && good(*number)) return {};
            return "\"" + text + "\" is not " + expected;
          },
          ""};
}

}  // namespace

CLI::Validator positive_number() {
  return number_that("a number > 0", [](double x) { return x > 0; });
}

CLI::Validator number_from_zero() {
  return number_that("a number >= 0", [](double x) { return x >= 0; });
}

CLI::Validator number_between(double min, double max) {
  return number_that("a number from " + pliant::number_text(min) + " to " + pliant::number_text(max),
                     [min, max](double x) { return x >= min && x <= max; });
}

CLI::Validator any_number() {
  return number_that("a finite number", [](double) { return true; });
}

CLI::Validator count_up_to(int max) {
  return {[max](std::string& text) -> std::string {
            const std::optional<int> number = parse<int>(text);
            if (number && *number >= 1 && *number <= max) return {};
            return "\"" + text + "\" is not a whole number from 1 to " + std::to_string(max);
          },
          ""};
}

PictureSize parse_picture_size(const std::string& text) {
  const std::size_t by = text.find('x');
  if (by == std::string::npos) return {};
  const std::optional<int> width = parse<int>(text.substr(0, by)), height = parse<int>(text.substr(by + 1));
  const auto good = [](const std::optional<int>& n) { return n && *n >= 1 && *n <= kMaxPixels; };
  if (!good(width) || !good(height)) return {};
  return {*width, *height};
}

CLI::Validator picture_size() {
  return {[](std::string& text) -> std::string {
            if (parse_picture_size(text).width > 0) return {};
            return "\"" + text + "\" is not a size like 640x480 (each side from 1 to " +
                   std::to_string(kMaxPixels) + ")";
          },
          ""};
}

void add_frame_options(CLI::App& command, FrameOptions& options) {
  command
      .add_option("--frames", options.frames,
                  "Frames: FIRST:END:STRIDE (END not included), or one number [all]")
      ->check(parsed_by([](const std::string& text) { pliant::FrameRange::parse(text); }))
      ->type_name("A:B:S");
  command
      .add_option("--shard", options.shard,
                  "Only every N-th of these frames, from the I-th on, so that N processes can share the work")
      ->check(parsed_by([](const std::string& text) { pliant::FrameRange().parse_shard(text); }))
      ->type_name("I/N");
}

pliant::FrameRange parse_frames(const FrameOptions& options) {
  pliant::FrameRange range = pliant::FrameRange::parse(options.frames);
  if (!options.shard.empty()) range.parse_shard(options.shard);
  return range;
}

}  // namespace pliant_cli
