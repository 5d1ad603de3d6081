// Calls with all functions inlined, for formulas that a step evaluates at each point of a part.
#pragma once

namespace pliant {

/// Calls f. The compiler inlines all functions that f calls, however large they are.
template <class F>
[[gnu::flatten]] void inline_all(const F& f) {
  f();
}

/// Calls f, through inline_all() if All is true. For formulas of shapes and links on Pack, inlining
/// everything saves 20 to 25 % of the time of a step (step_bench, parts with 11 parameters). On dual numbers
/// it saves no time of steps with implicit methods, and it doubles or triples the time to compile.
template <bool All, class F>
void inline_all_if(const F& f) {
  if constexpr (All)
    inline_all(f);
  else
    f();
}

}  // namespace pliant
