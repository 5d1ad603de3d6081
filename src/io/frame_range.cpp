#include <pliant/io/frame_range.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace pliant {
namespace {

// Returns the integer >= 0 that the whole text denotes, or std::nullopt.
std::optional<std::int64_t> number(const std::string& text) {
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> pieces{""};
  for (const char c : text) {
    if (c == at)
      pieces.emplace_back();
    else
      pieces.back() += c;
  }
  return pieces;
}

}  // namespace

FrameRange FrameRange::parse(const std::string& text) {
  const auto refuse = [&]() -> std::int64_t {
    throw std::invalid_argument("frames \"" + text +
                                "\" must be FIRST:END:STRIDE (END not included) or one number");
  };
  const std::vector<std::string> pieces = split(text, ':');
  if (pieces.size() > 3) refuse();
  const auto piece = [&](std::size_t i, std::int64_t otherwise) {
    if (i >= pieces.size() || pieces[i].empty()) return otherwise;
    const std::optional<std::int64_t> value = number(pieces[i]);
    return value ? *value : refuse();
  };
  FrameRange range;
  if (pieces.size() == 1) {
    if (pieces[0].empty()) refuse();
    range.first = piece(0, 0);
    range.end = range.first + 1;
    return range;
  }
  range.first = piece(0, 0);
  if (!pieces[1].empty()) range.end = piece(1, 0);
  range.stride = piece(2, 1);
  if (range.stride < 1) refuse();
  if (range.end && *range.end <= range.first)
    throw std::invalid_argument("frames \"" + text + "\" select no frame: END must be above FIRST");
  return range;
}

void FrameRange::parse_shard(const std::string& text) {
  const std::vector<std::string> pieces = split(text, '/');
  const std::optional<std::int64_t> i = number(pieces[0]),
                                    n = pieces.size() == 2 ? number(pieces[1]) : std::nullopt;
  if (!i || !n || *i < 1 || *i > *n)
    throw std::invalid_argument("shard \"" + text + "\" must be i/n with 1 <= i <= n");
  if (*n > kMaxFrames)
    throw std::invalid_argument("shard \"" + text + "\" has more shards than a recording has frames; " +
                                "expected at most " + std::to_string(kMaxFrames));
  shard = *i - 1;
  shards = *n;
}

std::int64_t FrameRange::size(std::int64_t count) const {
  if (first > 0 && first >= count)
    throw std::invalid_argument("there is no frame " + std::to_string(first) + ": the recording has " +
                                std::to_string(count) + " frames");
  if (end && *end > count)
    throw std::invalid_argument("there is no frame " + std::to_string(*end - 1) + ": the recording has " +
                                std::to_string(count) + " frames");
  const std::int64_t chosen = std::max<std::int64_t>(0, end.value_or(count) - first);
  const std::int64_t strided = chosen > 0 ? (chosen - 1) / stride + 1 : 0;
  const std::int64_t selected = shard < strided ? (strided - 1 - shard) / shards + 1 : 0;
  if (selected > kMaxFrames)
    throw std::invalid_argument(std::to_string(selected) + " frames are requested as files; at most " +
                                std::to_string(kMaxFrames) + " can be written at once");
  return selected;
}

std::vector<std::int64_t> FrameRange::frames(std::int64_t count) const {
  std::vector<std::int64_t> numbers;
  numbers.reserve(static_cast<std::size_t>(size(count)));
  std::int64_t position = 0;
  const std::int64_t beyond = end.value_or(count);
  for (std::int64_t frame = first; frame < beyond; frame += std::min(stride, beyond))
    if (position++ % shards == shard) numbers.push_back(frame);
  return numbers;
}

}  // namespace pliant
