// Key frames: with h = t_{i+1} - t_i, a = (t_{i+1} - t)/h and b = (t - t_i)/h, the cubic between the keys i
// and i+1 is
//   y = a y_i + b y_{i+1} + ((a^3 - a) m_i + (b^3 - b) m_{i+1}) h^2/6,  m the second derivatives at the keys.
// The slopes on both sides of each inner key are equal, which gives a tridiagonal system for m. The two ends
// are either both natural (m = 0) or both have given rates.
#pragma once

#include <pliant/math/time_function.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>

#include <pliant/math/formula.h>
#include <pliant/math/header_only.h>
#include <pliant/math/time/key_frames.h>

namespace pliant {

namespace detail {

/// Relative difference up to which two values or two rates are treated as equal. An end rate of a spline is
/// compared with the steepest mean slope between two neighbouring keys.
inline constexpr double kKinkRounding = 1e-12;

struct SplineEndRates {
  double first, last;
};

/// A cubic spline, constant beyond its ends.
class SplineFunction final : public TimeFunction::Impl {
 public:
  SplineFunction(std::vector<double> t, std::vector<double> y, const std::optional<SplineEndRates>& rates)
      : t_(std::move(t)), y_(std::move(y)), m_(second_derivatives(rates)) {
    double steepest = 0;
    for (std::size_t i = 0; i + 1 < t_.size(); ++i)
      steepest = std::max(steepest, std::abs((y_[i + 1] - y_[i]) / (t_[i + 1] - t_[i])));
    for (const double end : {t_.front(), t_.back()})
      if (std::abs(at(end).d) > kKinkRounding * steepest) kinks_.push_back(end);
  }

  Taylor2<double> at(double t) const override {
    if (t < t_.front()) return y_.front();
    if (t > t_.back()) return y_.back();
    const auto above = std::upper_bound(t_.begin() + 1, t_.end() - 1, t);
    const std::size_t i = static_cast<std::size_t>(above - t_.begin()) - 1;
    const double h = t_[i + 1] - t_[i];
    const double a = (t_[i + 1] - t) / h, b = (t - t_[i]) / h;
    const double m0 = m_[i], m1 = m_[i + 1];
    return {a * y_[i] + b * y_[i + 1] + (a * (a * a - 1) * m0 + b * (b * b - 1) * m1) * (h * h / 6),
            (y_[i + 1] - y_[i]) / h + ((3 * b * b - 1) * m1 - (3 * a * a - 1) * m0) * (h / 6),
            a * m0 + b * m1};
  }

  Kink first_kink(double after, double until) const override {
    const auto next = std::upper_bound(kinks_.begin(), kinks_.end(), after);
    return next == kinks_.end() || *next > until ? Kink() : Kink{*next, false};
  }

 private:
  /// Solves the tridiagonal system for the second derivatives at the keys.
  std::vector<double> second_derivatives(const std::optional<SplineEndRates>& rates) const {
    const std::size_t n = t_.size();
    std::vector<double> diagonal(n, 1.0), above(n, 0.0), m(n, 0.0);
    const auto h = [&](std::size_t i) { return t_[i + 1] - t_[i]; };
    const auto slope = [&](std::size_t i) { return (y_[i + 1] - y_[i]) / h(i); };
    if (rates) {
      diagonal[0] = 2 * h(0);
      above[0] = h(0);
      m[0] = 6 * (slope(0) - rates->first);
    }
    for (std::size_t i = 1; i < n; ++i) {
      const bool last = i + 1 == n;
      if (last && !rates) break;
      const double below = h(i - 1);
      const double factor = below / diagonal[i - 1];
      diagonal[i] = (last ? 2 * below : 2 * (below + h(i))) - factor * above[i - 1];
      above[i] = last ? 0 : h(i);
      m[i] = 6 * ((last ? rates->last : slope(i)) - slope(i - 1)) - factor * m[i - 1];
    }
    m[n - 1] = rates ? m[n - 1] / diagonal[n - 1] : 0;
    for (std::size_t i = n - 1; i-- > 0;) m[i] = (m[i] - above[i] * m[i + 1]) / diagonal[i];
    return m;
  }

  std::vector<double> t_, y_, m_, kinks_;
};

/// A formula. A change of its branches is located by bisection. This change is a kink if the value or the
/// rate jumps there.
class FormulaFunction final : public TimeFunction::Impl {
 public:
  explicit FormulaFunction(Formula formula) : formula_(std::move(formula)) {}
  Taylor2<double> at(double t) const override { return formula_.at(t); }

  Kink first_kink(double after, double until) const override {
    constexpr int samples = 4;       // number of samples in the interval
    constexpr int max_changes = 64;  // maximum number of changes of branches between two samples
    if (!formula_.has_branches()) return {};
    double low = after;
    std::uint64_t branches = formula_.branches(low);
    for (int i = 1; i <= samples; ++i) {
      const double end = i == samples ? until : after + (until - after) * i / samples;
      const std::uint64_t at_end = formula_.branches(end);
      for (int n = 0; n < max_changes && branches != at_end; ++n) {
        double high = end;
        for (double middle = low + (high - low) / 2; middle > low && middle < high;
             middle = low + (high - low) / 2)
          (formula_.branches(middle) == branches ? low : high) = middle;
        const Kink kink = between(low, high);
        if (kink.time <= until) return kink;
        low = high;
        branches = formula_.branches(high);
      }
      low = end;
      branches = at_end;
    }
    return {};
  }

 private:
  /// Returns the kink between two adjacent floating-point times, or a Kink of infinite time if there is none.
  Kink between(double low, double high) const {
    constexpr double smooth = 8;  // tolerance, in units of the change that the slope predicts
    const Taylor2<double> a = at(low), b = at(high);
    auto apart = [&](double x, double y, double slope) {
      return std::abs(y - x) > smooth * slope * (high - low) + kKinkRounding * (std::abs(x) + std::abs(y));
    };
    const bool jumps = apart(a.v, b.v, std::abs(a.d) + std::abs(b.d));
    if (!jumps && !apart(a.d, b.d, std::abs(a.dd) + std::abs(b.dd))) return {};
    return {high, jumps};
  }

  Formula formula_;
};

/// Returns the spline through the keys; throws std::invalid_argument if they are not valid.
inline TimeFunction make_spline(std::vector<double> t, std::vector<double> y,
                                const std::optional<SplineEndRates>& rates) {
  require_keys(t, y);
  if (rates && !(std::isfinite(rates->first) && std::isfinite(rates->last))) {
    throw std::invalid_argument("key frames: an end rate is not finite");
  }
  if (t.size() == 1) return y[0];
  return TimeFunction(std::make_shared<SplineFunction>(std::move(t), std::move(y), rates));
}

}  // namespace detail

PLIANT_INLINE TimeFunction TimeFunction::key_frames(std::vector<double> t, std::vector<double> y) {
  return detail::make_spline(std::move(t), std::move(y), std::nullopt);
}

PLIANT_INLINE TimeFunction TimeFunction::key_frames(std::vector<double> t, std::vector<double> y,
                                                    double first_rate, double last_rate) {
  return detail::make_spline(std::move(t), std::move(y), detail::SplineEndRates{first_rate, last_rate});
}

PLIANT_INLINE TimeFunction TimeFunction::formula(const std::string& text) {
  Formula formula(text);
  if (formula.is_constant()) return formula.at(0).v;
  return TimeFunction(std::make_shared<detail::FormulaFunction>(std::move(formula)));
}

PLIANT_INLINE TimeVector::MeanRate TimeVector::over(double t, double h) const {
  MeanRate mean{Vec3<double>::Zero(), 0};
  if (is_constant()) return mean;
  mean.rate = (value(t + h) - value(t)) / h;
  for (const double share : kMoments) {
    const Vec3<Taylor2<double>> x = at(t + share * h);
    mean.max_deviation =
        std::max(mean.max_deviation, (Vec3<double>(x[0].d, x[1].d, x[2].d) - mean.rate).norm());
  }
  return mean;
}

}  // namespace pliant
