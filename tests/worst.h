// The largest of the noted errors, 0 without errors. An error that is not a number is treated as infinite, so
// that a check of the largest error fails.
#pragma once

#include <limits>

namespace pliant::test {

class Worst {
 public:
  template <class T>
  void note(T error) {
    if (!(error <= largest_))
      largest_ = error == error ? static_cast<double>(error) : std::numeric_limits<double>::infinity();
  }
  operator double() const { return largest_; }  // NOLINT(google-explicit-constructor): used as a number

 private:
  double largest_ = 0;
};

}  // namespace pliant::test
