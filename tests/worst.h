// The largest of many errors. An error that is not a number becomes infinite, so that a check fails.
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
