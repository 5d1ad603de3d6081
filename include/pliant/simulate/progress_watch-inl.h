// Function bodies of progress_watch.h.
#pragma once

#include <pliant/simulate/progress_watch.h>

#include <utility>

#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE std::optional<SlowProgress> ProgressWatch::add(double start, double end, double interval,
                                                             const StepCounters& work) {
  if (start != window_.time) window_ = {};
  window_.time = end;
  window_.advance += end - start;
  ++window_.steps;
  window_.rejected += work.rejected;
  window_.impacts += work.impacts;
  window_.evaluations += work.evaluations;
  const bool laborious = work.evaluations > kMaxEvaluations;
  if (window_.steps < kWindow && !laborious) return std::nullopt;
  const SlowProgress window = std::exchange(window_, SlowProgress{});
  window_.time = end;
  if (laborious || window.advance <= kSlowShare * interval) return window;
  return std::nullopt;
}

}  // namespace pliant
