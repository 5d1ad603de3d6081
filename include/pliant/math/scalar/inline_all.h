// Calls with all functions inlined, for formulas that a step evaluates at each point of a part.
#pragma once

namespace pliant {

/// Calls f. The compiler inlines all functions that f calls, however large they are.
template <class F>
[[gnu::flatten]] void inline_all(const F& f) {
  f();
}

/// Calls f, through inline_all() if All is true. This makes formulas of shapes and links on Pack faster. On
/// dual numbers it makes them hardly faster, and it doubles or triples the time to compile. To measure both,
/// set All to false and true and compare step_bench and the time of a build.
template <bool All, class F>
void inline_all_if(const F& f) {
  if constexpr (All)
    inline_all(f);
  else
    f();
}

}  // namespace pliant
