// The selection of frames of a run, as given on the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// The frames first, first + stride, ... below `end`. Shard i of n contains every n-th of these frames,
/// beginning with the i-th frame, so that n processes can share the work.
struct FrameRange {
  /// Largest number of frames in a selection: the number of frames whose file names have six digits.
  static constexpr std::int64_t kMaxFrames = 1000000;

  std::int64_t first = 0;
  std::optional<std::int64_t> end;  ///< one past the last frame; without a value, the end of the recording
  std::int64_t stride = 1;
  std::int64_t shard = 0, shards = 1;  ///< index of the shard, and number of shards; 0 <= shard < shards

  /// Parses "first:end:stride", whose numbers may each be omitted ("10:", ":50:5"), or "7" for one frame.
  /// Throws std::invalid_argument.
  static FrameRange parse(const std::string& text);
  /// Parses a shard "i/n" with 1 <= i <= n. Throws std::invalid_argument.
  void parse_shard(const std::string& text);

  /// Returns the number of frames that the range and its shard select from a recording with `count` frames.
  /// Throws std::invalid_argument if the range exceeds the recording or selects more than kMaxFrames.
  std::int64_t size(std::int64_t count) const;
  /// Returns the numbers of the selected frames. Throws what size() throws.
  std::vector<std::int64_t> frames(std::int64_t count) const;
};

}  // namespace pliant
