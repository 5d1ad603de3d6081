// Checks of option values. The whole text of a value must be a valid number. The check does not depend on
// the locale.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <pliant/io/frame_range.h>

namespace pliant_cli {

/// A number > 0, finite.
CLI::Validator positive_number();
/// A number >= 0, finite.
CLI::Validator number_from_zero();
/// A number from min to max.
CLI::Validator number_between(double min, double max);
/// A finite number.
CLI::Validator any_number();
/// A whole number from 1 to max.
CLI::Validator count_up_to(int max);

/// "640x480": width and height in pixels, each from 1 to 8192.
struct PictureSize {
  int width = 0, height = 0;
};
CLI::Validator picture_size();
/// Returns the size; width and height are 0 if the text is no valid size.
PictureSize parse_picture_size(const std::string& text);

/// The selection of frames of a run: --frames and --shard.
struct FrameOptions {
  std::string frames = ":", shard;
};
/// Declares --frames and --shard.
void add_frame_options(CLI::App& command, FrameOptions& options);
/// Returns the selected frames. Throws std::invalid_argument if the options have a fault.
pliant::FrameRange parse_frames(const FrameOptions& options);

}  // namespace pliant_cli
