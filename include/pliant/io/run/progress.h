// How a long task tells how far it is; what is shown of it is up to the program.
#pragma once

#include <stdexcept>
#include <string>

namespace pliant {

/// Thrown by Progress::advance() to end a task early; what is finished stays.
class Interrupted : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage begins: `total` of `unit` will be done ("s" of simulated time, "frames").
  virtual void begin(const std::string& /*stage*/, double /*total*/, const std::string& /*unit*/) {}
  /// So much is done; called often, must be cheap.
  virtual void advance(double /*done*/) {}
  virtual void end() {}
  /// Something the user should read.
  virtual void note(const std::string& /*text*/) {}
};

}  // namespace pliant
