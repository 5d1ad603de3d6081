// The global parameters q_s of a part, Eq. (4): of its shape, then of its links; each frozen or dynamic.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <pliant/deform/chain.h>
#include <pliant/math/time_function.h>
#include <pliant/part/shape_face.h>

namespace pliant {

/// Most parameters of a part, frozen ones included.
inline constexpr int kMaxParameters = 64;

struct Parameter {
  std::string name;  ///< "a1", "taper.tx"
  const ParameterSpec* spec;
  TimeFunction rest;        ///< rest value; of a frozen parameter its value (at time 0)
  double initial;           ///< value at time 0
  double initial_rate = 0;  ///< rate at time 0, per second
  bool dynamic = false;
  Range limits;  ///< one-sided limits of a dynamic parameter
  bool initial_given = false, limits_given = false;

  double rest_value() const { return rest.value(0); }
};

/// All parameters of a part at one scalar: values and rates.
template <class P>
struct ParameterValues {
  std::array<P, kMaxParameters> b, b_dot;
};

class Parameters {
 public:
  /// The parameters of a shape and a chain, at their defaults, all frozen. Links of the same type are called
  /// by their type, type2, type3 …
  Parameters(const ShapeFace& shape, const std::vector<LinkInfo>& links);

  int size() const { return static_cast<int>(all_.size()); }
  int n_shape() const { return n_shape_; }
  int n_dynamic() const { return static_cast<int>(dynamic_.size()); }
  /// The links of the chain that act, in order: those with a dynamic parameter, and those that are not frozen
  /// as the identity. The kernels pass by the others, and nothing has to be laid out for them.
  const std::vector<LinkInfo>& links() const { return acting_; }
  /// Every link of the chain, in order.
  const std::vector<LinkInfo>& all_links() const { return links_; }
  const Parameter& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  Parameter& operator[](int i) { return all_[static_cast<std::size_t>(i)]; }
  /// The k-th dynamic parameter, in the order of q_s.
  const Parameter& moving(int k) const {
    return all_[static_cast<std::size_t>(dynamic_[static_cast<std::size_t>(k)])];
  }
  /// Number of the parameter called name, or -1.
  int find(const std::string& name) const;
  /// All names, separated by blanks.
  std::string names() const;

  /// Numbers of the dynamic parameters, in the order of q_s. Call update() after changing which are dynamic,
  /// or rest values.
  const std::vector<int>& dynamic() const { return dynamic_; }
  const bool* dynamic_flags() const { return flags_.data(); }
  void update();

  /// All values from the dynamic ones; frozen ones at their rest values.
  template <class P, class Q>
  ParameterValues<P> expand(const Q& q_s, const Q& q_s_dot) const {
    ParameterValues<P> values;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      values.b[i] = P(frozen_[i]);
      values.b_dot[i] = P(0.0);
    }
    for (std::size_t k = 0; k < dynamic_.size(); ++k) {
      const auto i = static_cast<std::size_t>(dynamic_[k]);
      values.b[i] = q_s[static_cast<Eigen::Index>(k)];
      values.b_dot[i] = q_s_dot[static_cast<Eigen::Index>(k)];
    }
    return values;
  }
  /// All at their rest values (time 0).
  ParameterValues<double> rest() const;

 private:
  std::vector<Parameter> all_;
  std::vector<LinkInfo> links_, acting_;
  std::vector<int> dynamic_;
  std::array<bool, kMaxParameters> flags_{};
  std::array<double, kMaxParameters> frozen_{};
  int n_shape_;
};

}  // namespace pliant
