// Function bodies of formula.h for formulas of time.
#pragma once

#include <algorithm>

#include <pliant/math/header_only.h>
#include <pliant/math/scalar/formula_program.h>

namespace pliant {

PLIANT_INLINE Taylor2<double> Formula::at(double t) const {
  return value<Taylor2<double>>({t, 1.0, 0.0}, nullptr);
}

PLIANT_INLINE std::uint64_t Formula::branches(double t) const {
  constexpr std::uint64_t prime = 1099511628211U;  // of the hash FNV-1a
  std::uint64_t all = 14695981039346656037U;
  detail::formula_program::run<detail::formula_program::kLargeStack, Taylor2<double>>(
      program_, Taylor2<double>(t, 1.0, 0.0), nullptr,
      [&](const Instruction& instruction, const Taylor2<double>* x) {
        if (detail::formula_program::has_branches(instruction.code))
          all = (all ^ (detail::formula_program::branch(instruction, x) ? 1U : 2U)) * prime;
      });
  return all;
}

PLIANT_INLINE bool Formula::reads_time() const {
  return std::any_of(program_.begin(), program_.end(),
                     [](const Instruction& each) { return each.code == Code::kTime; });
}

PLIANT_INLINE bool Formula::is_constant() const {
  return program_.size() == 1 && program_[0].code == Code::kNumber;
}

}  // namespace pliant
