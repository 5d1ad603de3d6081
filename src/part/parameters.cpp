// The list of the parameters of a part.
#include <pliant/part/parameters.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace pliant {

namespace {
Parameter make_parameter(std::string name, const ParameterSpec& spec) {
  Parameter p;
  p.name = std::move(name);
  p.spec = &spec;
  p.rest = TimeFunction(spec.standard);
  p.initial = spec.standard;
  p.limits = spec.dynamic;
  return p;
}
}  // namespace

Parameters::Parameters(const ShapeInterface& shape, const std::vector<LinkInfo>& links)
    : links_(links), n_shape_(shape.n_parameters()) {
  for (int i = 0; i < n_shape_; ++i)
    all_.push_back(make_parameter(shape.parameters()[i].name, shape.parameters()[i]));
  std::map<std::string, int> seen;
  for (const LinkInfo& link : links) {
    std::string type = link.type;
    const int number = ++seen[type];
    if (number > 1) type += std::to_string(number);
    for (int i = 0; i < link.n_parameters; ++i)
      all_.push_back(make_parameter(type + "." + link.parameters[i].name, link.parameters[i]));
  }
  if (size() > kMaxParameters)
    throw std::invalid_argument("a part may have at most " + std::to_string(kMaxParameters) +
                                " parameters; this shape with its chain of deformations has " +
                                std::to_string(size()));
  update();
}

int Parameters::find(const std::string& name) const {
  for (int i = 0; i < size(); ++i)
    if ((*this)[i].name == name) return i;
  return -1;
}

int Parameters::dynamic_number(const std::string& name) const {
  for (int k = 0; k < n_dynamic(); ++k)
    if (moving(k).name == name) return k;
  return -1;
}

std::string Parameters::names() const {
  std::string all;
  for (const Parameter& p : all_) all += (all.empty() ? "" : " ") + p.name;
  return all;
}

void Parameters::update() {
  dynamic_.clear();
  flags_.resize(size());
  frozen_.resize(size());
  for (int i = 0; i < size(); ++i) {
    Parameter& p = (*this)[i];
    flags_[i] = p.dynamic;
    frozen_[i] = p.rest_value();
    if (p.dynamic) dynamic_.push_back(i);
    if (!p.initial_given) p.initial = p.rest_value();
    if (!p.limits_given) {
      const double scale = p.spec->relative ? p.rest_value() : 1.0;
      p.limits = {p.spec->dynamic.min * scale, p.spec->dynamic.max * scale};
    }
  }
  acting_.clear();
  int first = n_shape_;
  for (const LinkInfo& link : links_) {
    bool acts = false;
    for (int k = 0; k < link.n_parameters; ++k) {
      const Parameter& p = (*this)[first + k];
      acts = acts || p.dynamic || (k < link.amplitudes && p.rest_value() != p.spec->standard);
    }
    if (acts) acting_.push_back(link);
    first += link.n_parameters;
  }
  if (n_dynamic() > kMaxGlobal)
    throw std::invalid_argument("a part may have at most " + std::to_string(kMaxGlobal) +
                                " dynamic parameters; this one has " + std::to_string(n_dynamic()));
}

ParameterValues<double> Parameters::rest() const {
  ParameterValues<double> values;
  for (int i = 0; i < size(); ++i) {
    values.b[static_cast<std::size_t>(i)] = (*this)[i].rest_value();
    values.b_dot[static_cast<std::size_t>(i)] = 0;
  }
  return values;
}

}  // namespace pliant
