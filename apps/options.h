// Validators of option values, and parsers of sizes and frames. A validator accepts a text only if the whole
// text is valid. The locale has no influence.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <pliant/io/frame_range.h>

namespace pliant_cli {

/// Returns a validator that accepts finite numbers > 0.
CLI::Validator positive_number();
/// Returns a validator that accepts finite numbers >= 0.
CLI::Validator number_from_zero();
/// Returns a validator that accepts numbers from min to max, both included.
CLI::Validator number_between(double min, double max);
/// Returns a validator that accepts finite numbers.
CLI::Validator any_number();
/// Returns a validator that accepts whole numbers from 1 to max.
CLI::Validator count_up_to(int max);

/// The size of a picture in pixels.
struct PictureSize {
  int width = 0, height = 0;
};
/// Returns a validator that accepts sizes like "640x480", with width and height from 1 to 8192.
CLI::Validator picture_size();
/// Returns the size of a text like "640x480"; width and height are 0 if the text is not a valid size.
PictureSize parse_picture_size(const std::string& text);

/// The texts of --frames (default: all frames) and --shard (empty: no shard); FrameRange explains them.
struct FrameOptions {
  std::string frames = ":", shard;
};
/// Declares --frames and --shard.
void add_frame_options(CLI::App& command, FrameOptions& options);
/// Returns the frames that both options select. Throws std::invalid_argument if one of the texts is not
/// valid.
pliant::FrameRange parse_frames(const FrameOptions& options);

}  // namespace pliant_cli
