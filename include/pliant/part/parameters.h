// The global parameters of a part, Eq. (4): the parameters of its shape, then the parameters of the links of
// its chain of deformations. Each parameter is frozen (a constant) or dynamic (a degree of freedom). q_s
// contains the dynamic parameters.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <pliant/deform/chain.h>
#include <pliant/math/time_function.h>
#include <pliant/part/shape_interface.h>

namespace pliant {

/// Maximum number of parameters of a part, including frozen parameters.
inline constexpr int kMaxParameters = 64;

struct Parameter {
  std::string name;           ///< "a1", "taper.tx"
  const ParameterSpec* spec;  ///< name, unit, default and ranges in its shape or deformation
  TimeFunction rest;          ///< rest value, a function of time; a frozen parameter has this value
  double initial;             ///< value at time 0
  double initial_rate = 0;    ///< rate at time 0, per second
  bool dynamic = false;
  Range limits;  ///< lower and upper limit of a dynamic parameter; each limit is a one-sided constraint
  bool initial_given = false, limits_given = false;  ///< whether the user set `initial`, and `limits`

  /// The rest value at time 0.
  double rest_value() const { return rest.first_value(); }
};

/// Values and rates of all parameters of a part, with scalar P.
template <class P>
struct ParameterValues {
  std::array<P, kMaxParameters> b, b_dot;
};

class Parameters {
 public:
  /// Lists the parameters of a shape and a chain. All parameters are frozen and have their default values. A
  /// parameter of a link is named type.name; several links of one type are named type, type2, type3, ...
  /// Throws std::invalid_argument for more than kMaxParameters parameters.
  Parameters(const ShapeInterface& shape, const std::vector<LinkInfo>& links);

  int size() const { return static_cast<int>(all_.size()); }
  int n_shape() const { return n_shape_; }
  int n_dynamic() const { return static_cast<int>(dynamic_.size()); }
  /// The links of the chain that act, in order. A link acts if one of its parameters is dynamic, or if the
  /// rest value of one of its amplitudes (LinkInfo) is not the default. The kernels skip all other links.
  const std::vector<LinkInfo>& links() const { return acting_; }
  /// Every link of the chain, in order.
  const std::vector<LinkInfo>& all_links() const { return links_; }
  const Parameter& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  Parameter& operator[](int i) { return all_[static_cast<std::size_t>(i)]; }
  /// The k-th dynamic parameter, in the order of q_s.
  const Parameter& moving(int k) const {
    return all_[static_cast<std::size_t>(dynamic_[static_cast<std::size_t>(k)])];
  }
  /// Returns the number of the parameter of this name; -1 if there is no such parameter.
  int find(const std::string& name) const;
  /// Returns the place in q_s of the dynamic parameter of this name; -1 if there is no such parameter.
  int dynamic_number(const std::string& name) const;
  /// Returns all names, separated by blanks.
  std::string names() const;

  /// The numbers of the dynamic parameters, in the order of q_s.
  const std::vector<int>& dynamic() const { return dynamic_; }
  /// Whether each parameter is dynamic.
  const bool* dynamic_flags() const { return flags_.data(); }
  /// Updates the lists of dynamic parameters, acting links and frozen values. An initial value that the user
  /// did not set becomes the rest value; limits that the user did not set become the dynamic range of the
  /// ParameterSpec. Must be called after `dynamic` or `rest` of a parameter has changed. Throws
  /// std::invalid_argument for more than kMaxGlobal dynamic parameters.
  void update();

  /// Returns the values and rates of all parameters. Dynamic parameters have the values and rates in q_s and
  /// q_s_dot; frozen parameters have their rest values and zero rates.
  template <class P, class Q>
  ParameterValues<P> expand(const Q& q_s, const Q& q_s_dot) const {
    ParameterValues<P> values;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      values.b[i] = P(frozen_[static_cast<Eigen::Index>(i)]);
      values.b_dot[i] = P(0.0);
    }
    for (std::size_t k = 0; k < dynamic_.size(); ++k) {
      const auto i = static_cast<std::size_t>(dynamic_[k]);
      values.b[i] = q_s[static_cast<Eigen::Index>(k)];
      values.b_dot[i] = q_s_dot[static_cast<Eigen::Index>(k)];
    }
    return values;
  }
  /// Returns the rest values of all parameters at time 0, with zero rates.
  ParameterValues<double> rest() const;

 private:
  std::vector<Parameter> all_;
  std::vector<LinkInfo> links_, acting_;
  std::vector<int> dynamic_;
  VecX<bool> flags_;     // of all parameters: whether each is dynamic
  VecX<double> frozen_;  // of all parameters: rest values at time 0
  int n_shape_;
};

}  // namespace pliant
