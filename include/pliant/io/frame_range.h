// Which frames of a run are wanted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// Frames first, first + stride, ... below `end`; of these, for shard i of n, every n-th from the i-th.
struct FrameRange {
  /// Frames are files with six digits in their names.
  static constexpr std::int64_t kMaxFrames = 1000000;

  std::int64_t first = 0;
  std::optional<std::int64_t> end;  ///< one past the last; all when not given
  std::int64_t stride = 1;
  std::int64_t shard = 0, shards = 1;  ///< 0 <= shard < shards

  /// From "first:end:stride" with any part left out ("10:", ":50:5", "7" for one frame). Throws
  /// std::invalid_argument.
  static FrameRange parse(const std::string& text);
  /// Takes "i/n" with 1 <= i <= n. Throws std::invalid_argument.
  void parse_shard(const std::string& text);

  /// How many are chosen of `count` frames that there are. Throws std::invalid_argument when the range asks
  /// for others, or for more than kMaxFrames.
  std::int64_t size(std::int64_t count) const;
  /// Their numbers. Throws as size().
  std::vector<std::int64_t> frames(std::int64_t count) const;
};

}  // namespace pliant
