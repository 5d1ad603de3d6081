// Calls with all functions inlined, for formulas that a step evaluates at each point of a part.
#pragma once

namespace pliant {

/// Calls f. The compiler inlines all functions that f calls, however large they are.
template <class F>
[[gnu::flatten]] void inline_all(const F& f) {
  f();
}

/// Calls f, through inline_all() if All is true. Inlining everything makes formulas of shapes and links with
/// their derivatives 20 to 30 % faster (step_bench, parts with 11 parameters), and two to three times slower
/// to compile.
template <bool All, class F>
void inline_all_if(const F& f) {
  if constexpr (All)
    inline_all(f);
  else
    f();
}

}  // namespace pliant
