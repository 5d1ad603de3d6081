// Displays of progress: a bar, lines of text, or nothing.
#include "show_progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include <unistd.h>

#include <pliant/io/run/wall_clock.h>

#include "stop_signal.h"

namespace pliant_cli {
namespace {

// Returns a duration as text, for example "42 s", "3 min 5 s" or "2 h 10 min".
std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 100) return std::to_string(whole) + " s";
  if (whole < 6000) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

std::string printed(const char* format, double a, double b = 0) {
  char text[64];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// Keeps the name of a stage, its amount of work and the amount done. Derived classes decide when and how they
// are shown.
class StageProgress : public pliant::Progress {
 public:
  void begin(const std::string& stage, double total, const std::string& unit) override {
    stage_ = stage;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    start_ = shown_ = pliant::WallClock::now();
  }
  void advance(double done) override {
    done_ = done;
    const pliant::WallClock::time_point now = pliant::WallClock::now();
    if (due(now)) {
      shown_ = now;
      show();
    }
    if (stage_ != "simulate" && stop_signal() != 0) {
      clear();
      throw pliant::Interrupted("stopped by a signal");
    }
  }
  void note(const std::string& text) override {
    clear();
    std::fprintf(stderr, "pliant: %s\n", text.c_str());
  }

 protected:
  virtual bool due(pliant::WallClock::time_point now) = 0;
  virtual void show() = 0;
  virtual void clear() {}

  double elapsed() const { return pliant::seconds_since(start_); }
  double fraction() const { return total_ > 0 ? std::min(1.0, done_ / total_) : 1; }
  // Returns the progress as text, for example "45 %, 1.8 of 4 s, 0.18 times real time, 12 s left".
  std::string numbers() const {
    const double wall = elapsed();
    std::string text =
        printed("%3.0f %%, ", 100 * fraction()) + printed("%.6g of %.6g ", done_, total_) + unit_;
    if (wall > 0 && unit_ == "s") text += printed(", %.3g times real time", done_ / wall);
    if (fraction() > 0 && fraction() < 1) text += ", " + duration(wall * (1 / fraction() - 1)) + " left";
    return text;
  }

  std::string stage_, unit_;
  double total_ = 0, done_ = 0;
  pliant::WallClock::time_point start_, shown_;
};

class Bar final : public StageProgress {
 public:
  void end() override {
    if (drawn_) {
      show();
      std::fputc('\n', stderr);
    }
    drawn_ = false;
  }

 private:
  bool due(pliant::WallClock::time_point now) override {
    return now - shown_ > std::chrono::milliseconds(100);
  }
  void show() override {
    constexpr int width = 30;
    const int full = static_cast<int>(fraction() * width);
    std::string bar(static_cast<std::size_t>(width), '.');
    std::fill(bar.begin(), bar.begin() + full, '#');
    std::fprintf(stderr, "\r%-10s [%s] %s\x1b[K", stage_.c_str(), bar.c_str(), numbers().c_str());
    std::fflush(stderr);
    drawn_ = true;
  }
  void clear() override {
    if (drawn_) std::fputs("\r\x1b[K", stderr);
    drawn_ = false;
  }

  bool drawn_ = false;
};

class Lines final : public StageProgress {
 public:
  void begin(const std::string& stage, double total, const std::string& unit) override {
    StageProgress::begin(stage, total, unit);
    tenth_ = 0;
  }
  void end() override {
    std::fprintf(stderr, "%s: done, %.6g %s in %s\n", stage_.c_str(), done_, unit_.c_str(),
                 printed("%.3g s", elapsed()).c_str());
  }

 private:
  bool due(pliant::WallClock::time_point now) override {
    const int tenth = static_cast<int>(10 * fraction());
    const bool long_stage = now - start_ > std::chrono::seconds(2);  // short stages report their end only
    if (!(long_stage && tenth > tenth_ && tenth < 10) && now - shown_ < std::chrono::seconds(60))
      return false;
    tenth_ = tenth;
    return true;
  }
  void show() override { std::fprintf(stderr, "%s: %s\n", stage_.c_str(), numbers().c_str()); }

  int tenth_ = 0;
};

class Quiet final : public pliant::Progress {
 public:
  void begin(const std::string& stage, double, const std::string&) override {
    simulating_ = stage == "simulate";
  }
  void advance(double) override {
    if (!simulating_ && stop_signal() != 0) throw pliant::Interrupted("stopped by a signal");
  }

 private:
  bool simulating_ = false;
};

}  // namespace

std::unique_ptr<pliant::Progress> make_progress(bool quiet) {
  if (quiet) return std::make_unique<Quiet>();
  if (isatty(STDERR_FILENO) != 0) return std::make_unique<Bar>();
  return std::make_unique<Lines>();
}

}  // namespace pliant_cli
