// The interface by which a long task reports its progress; the program decides what to display.
#pragma once

#include <stdexcept>
#include <string>

namespace pliant {

/// Thrown by Progress::advance() to end a task early. Files that are already finished remain.
class Interrupted : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Progress {
 public:
  virtual ~Progress() = default;
  /// Called when a stage begins. total: amount of work of the stage, in `unit`: "s" (simulated time),
  /// "frames" or "states".
  virtual void begin(const std::string& /*stage*/, double /*total*/, const std::string& /*unit*/) {}
  /// Called with the amount of work done since begin(). It is called often and must be cheap.
  virtual void advance(double /*done*/) {}
  virtual void end() {}
  /// Called with a text that the user should read.
  virtual void note(const std::string& /*text*/) {}
};

}  // namespace pliant
