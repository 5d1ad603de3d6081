// Calls with all functions inlined, for formulas that a step evaluates at each point of a part.
#pragma once

namespace pliant {

/// Calls f. The compiler inlines all functions that f calls, however large they are.
template <class F>
[[gnu::flatten]] void inline_all(const F& f) {
  f();
}

/// Calls f, through inline_all() if All is true. For formulas of shapes and links (deform/link.h) on Pack,
/// All = true makes the program faster. For dual numbers, All = true makes the program hardly faster, and the
/// time to compile two to three times as long. To measure both times, compare step_bench and a build with All
/// false and true.
template <bool All, class F>
void inline_all_if(const F& f) {
  if constexpr (All)
    inline_all(f);
  else
    f();
}

}  // namespace pliant
