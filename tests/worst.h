// The largest of many errors; one that is not a number counts as infinite, so that it fails.
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
  operator double() const { return largest_; }  // NOLINT(google-explicit-constructor): it is the number

 private:
  double largest_ = 0;
};

}  // namespace pliant::test
