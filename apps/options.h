// Checks of option values: the whole word must be understood, whatever the locale.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <pliant/io/frame_range.h>

namespace pliant_cli {

/// A number > 0, finite.
CLI::Validator positive_number();
/// A number >= 0, finite.
CLI::Validator number_from_zero();
/// A number from least to most.
CLI::Validator number_between(double least, double most);
/// A finite number.
CLI::Validator any_number();
/// A whole number from 1 to most.
CLI::Validator count_up_to(int most);

/// "640x480": width and height in pixels, each from 1 to 8192.
struct PictureSize {
  int width = 0, height = 0;
};
CLI::Validator picture_size();
PictureSize parse_picture_size(const std::string& text);

/// Which frames of a run: --frames and --shard.
struct FrameOptions {
  std::string frames = ":", shard;
};
/// Declares --frames and --shard.
void add_frame_options(CLI::App& command, FrameOptions& options);
pliant::FrameRange parse_frames(const FrameOptions& options);

}  // namespace pliant_cli
