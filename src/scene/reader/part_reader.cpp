#include "part_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/scalar/formula_program.h>
#include <pliant/part/local/local_deformation.h>
#include <pliant/part/registry.h>

#include "direction_reader.h"
#include "local_reader.h"
#include "parameter_reader.h"
#include "scene/json/json_write.h"
#include "time_reader.h"

namespace pliant {

namespace {

MatX<double> matrix(const JsonValue& rows) {
  const auto n = static_cast<Eigen::Index>(rows.array().size());
  MatX<double> M(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      M(i, j) = rows.array()[static_cast<std::size_t>(i)].array()[static_cast<std::size_t>(j)].number();
  return M;
}

/// Returns whether a mass (kg) or moment of inertia (kg m^2) is far enough from overflow and underflow for
/// the products formed in a step.
bool is_workable(double x) {
  return x > 1e-100 && x < 1e100;
}

}  // namespace

std::unique_ptr<Part> PartReader::read() {
  if (!r_.given("shape") || r_.faulty("deformations")) return nullptr;
  std::vector<std::string> deformations;
  for (const JsonValue& d : r_.at("deformations").array()) deformations.push_back(d.string());
  const std::string name = r_.given("name") ? r_.text("name") : "?";
  const std::size_t before = faults_.errors();
  const double thickness = r_.given("thickness") ? r_.number("thickness") : 1;
  part_ = make_part(name, r_.text("shape"), deformations, property("density") * thickness);
  if (r_.boolean("shell"))
    part_->make_shell();
  else if (r_.given("thickness"))
    faults_.place(r_.at("thickness"),
                  "only a shell has a thickness; expected \"shell\": true, or no \"thickness\"");
  part_->damping(property("alpha"), property("beta"), property("drag"));
  if (r_.given("mass")) part_->mass(r_.number("mass"));
  if (r_.text("mass_matrix") == "diagonal") part_->use_diagonal_mass();
  if (r_.given("mass_distribution")) read_mass_distribution(r_.at("mass_distribution"));

  std::vector<std::string> in_matrix;
  const bool has_matrix = r_.given("stiffness_matrix");
  if (has_matrix)
    for (const JsonValue& n : r_.object("stiffness_matrix").at("parameters").array())
      in_matrix.push_back(n.string());
  try {
    ParameterReader(*part_, in_matrix, end_, faults_).read(r_);
    if (has_matrix) read_stiffness(r_.object("stiffness_matrix"));
  } catch (const std::invalid_argument& e) {
    report_at_parameters(e);
  }
  if (r_.given("inertia")) read_inertia(r_.object("inertia"));
  part_->place(r_.vector3("position"), read_orientation(r_.object("orientation"), faults_));
  part_->velocity(r_.vector3("velocity"), r_.vector3("angular_velocity"));
  if (r_.boolean("fixed")) part_->fix();
  if (r_.given("motion")) read_motion(r_.object("motion"));
  if (r_.given("local") || r_.faulty("local")) {
    const std::size_t faults = faults_.errors();
    read_local(r_.object("local"), body_.joint_solver.make_factor, faults_, *part_);
    if (faults_.errors() == faults) read_local_factor(r_.object("local"));
  }
  read_elasticity();
  check_rigid_keys();
  const bool known = !r_.faulty("parameters") && !r_.faulty("stiffness_matrix") && !r_.faulty("inertia");
  if (known && faults_.errors() == before) prepare();
  return std::move(part_);
}

/// Returns the number under a key of the part. If the part lacks the key, returns the number of its material,
/// or else the default.
double PartReader::property(const char* key) const {
  if (!r_.given(key) && r_.given("material")) {
    const auto material = materials_.find(r_.text("material"));
    if (material != materials_.end()) return material->second.number(key);
  }
  return r_.number(key);
}

void PartReader::read_mass_distribution(const JsonValue& value) {
  static const std::vector<std::string> names{"X", "Y", "Z", "u", "v", "w"};
  auto number_of = [](const std::string& owner, const std::string& quantity) {
    const auto found = quantity.empty() ? std::find(names.begin(), names.end(), owner) : names.end();
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  try {
    const Formula formula(value.string(), number_of);
    if (formula.reads_time()) return faults_.value(value, "expected a formula without t");
    part_->distribute_mass([formula](const std::vector<Material<double>>& at, const Eigen::Matrix3Xd& X) {
      Eigen::VectorXd multiples(X.cols());
      for (Eigen::Index k = 0; k < X.cols(); ++k) {
        const MaterialAngles m = angles(at[static_cast<std::size_t>(k)]);
        const double x[] = {X(0, k), X(1, k), X(2, k), m.u, m.v, m.w};
        multiples[k] = formula.value<double>(0.0, x);
      }
      return multiples;
    });
  } catch (const FormulaError& fault) {
    faults_.in_string(value, fault.offset(), fault.reason());
  }
}

/// Reads the factor of the stiffness of the local deformation.
void PartReader::read_local_factor(const Reader& local) {
  if (!local.given("stiffness_factor") || local.faulty("stiffness_factor")) return;
  const JsonValue& value = local.at("stiffness_factor");
  const std::optional<TimeFunction> factor = TimeReader(end_, faults_).function(value, Needs::value_and_rate);
  if (!factor) return;
  for (int k = 0; k <= TimeReader::kIntervals; ++k) {
    const double t = k * end_ / TimeReader::kIntervals, now = factor->value(t);
    if (now >= 0) continue;
    return faults_.value(value,
                         "it is " + shortest(now) + " at t = " + shortest(t) + " s; expected at least 0");
  }
  part_->scale_local(*factor);
}

/// Reads the key "elasticity" of the part, or of its material if the part has no such key.
void PartReader::read_elasticity() {
  const Reader* from = r_.given("elasticity") ? &r_ : nullptr;
  if (from == nullptr && r_.given("material")) {
    const auto material = materials_.find(r_.text("material"));
    if (material != materials_.end() && material->second.given("elasticity")) from = &material->second;
  }
  if (from == nullptr) return;
  const Reader law = from->object("elasticity");
  if (!law.complete()) return;
  ContinuumSettings settings{law.name(), law.number("E"), law.number("nu"), 0};
  if (law.record().find("thickness") != nullptr) settings.thickness = law.number("thickness");
  try {
    part_->elasticity(settings);
    part_->check_elasticity();
  } catch (const std::invalid_argument& e) {
    faults_.place(from == &r_ ? law.json() : r_.at("material"), without_name(e));
  }
}

void PartReader::read_stiffness(const Reader& r) {
  const JsonValue &names = r.at("parameters"), &K = r.at("K");
  const bool known = check_names(names);
  if (!check_square(K, names.array().size()) || !check_symmetric(K) || !known) return;
  const MatX<double> full = matrix(K);
  const double lowest = symmetric_eigenvalues(full).minCoeff();
  if (!(lowest >= -1e-12 * full.cwiseAbs().maxCoeff()))
    return faults_.value(K, "the matrix has the negative eigenvalue " + brief(lowest) +
                                ", so its energy has no minimum; expected no eigenvalue below 0");
  std::vector<std::string> all;
  for (const JsonValue& name : names.array()) all.push_back(name.string());
  part_->stiffness(all, full);
}

bool PartReader::check_names(const JsonValue& names) {
  const std::size_t before = faults_.errors();
  const Parameters& known = part_->parameters();
  std::vector<std::string> all;
  for (int i = 0; i < known.size(); ++i) all.push_back(known[i].name);
  for (std::size_t i = 0; i < names.array().size(); ++i) {
    const JsonValue& name = names.array()[i];
    if (known.find(name.string()) < 0) {
      faults_.unknown(name, "parameter", all);
      continue;
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (names.array()[k].string() != name.string()) continue;
      faults_.twice(names.array()[k], name);
      break;
    }
  }
  return faults_.errors() == before;
}

bool PartReader::check_square(const JsonValue& K, std::size_t n) {
  const std::string numbers = std::to_string(n) + (n == 1 ? " number" : " numbers");
  if (K.array().size() != n) {
    faults_.value(K, "expected " + std::to_string(n) + (n == 1 ? " row of " : " rows of ") + numbers +
                         ", one for each parameter");
    return false;
  }
  bool square = true;
  for (const JsonValue& row : K.array()) {
    if (row.array().size() == n) continue;
    faults_.value(row, "expected " + numbers + ", one for each parameter");
    square = false;
  }
  return square;
}

bool PartReader::check_symmetric(const JsonValue& rows) {
  const MatX<double> M = matrix(rows);
  const double rounding = 1e-12 * M.cwiseAbs().maxCoeff();
  bool symmetric = true;
  for (Eigen::Index i = 1; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (std::abs(M(i, j) - M(j, i)) <= rounding) continue;
      faults_.value(
          rows.array()[static_cast<std::size_t>(i)].array()[static_cast<std::size_t>(j)],
          "expected " + shortest(M(j, i)) + ", the value across the diagonal: the matrix must be symmetric");
      symmetric = false;
    }
  }
  return symmetric;
}

void PartReader::read_inertia(const Reader& r) {
  const JsonValue& moments = r.at("moments");
  if (!check_symmetric(moments)) return;
  const Mat3<double> about_origin = matrix(moments);
  const Vec3<double> c = r.vector3("centre");
  const Mat3<double> offset =
      r.number("mass") * (c.squaredNorm() * Mat3<double>::Identity() - c * c.transpose());
  const Vec3<double> I = symmetric_eigenvalues(about_origin - offset);
  if (!(I[0] > 0) || !(I[0] + I[1] >= I[2] * (1 - 1e-12)))
    return faults_.value(
        moments, "about the centre of mass its principal moments are " + brief(I[0]) + ", " + brief(I[1]) +
                     " and " + brief(I[2]) +
                     " kg m^2; expected each > 0 and none larger than the sum of the other two");
  part_->inertia(r.number("mass"), about_origin, c);
}

const JsonValue* PartReader::fixed_or_motion() const {
  if (r_.boolean("fixed")) return &r_.at("fixed");
  return r_.given("motion") ? &r_.at("motion") : nullptr;
}

void PartReader::read_motion(const Reader& r) {
  if (r.given("position") && r_.given("position"))
    faults_.place(r_.at("position"), "\"motion\" has a position too; expected only one of the two");
  if (!r.given("position") && !r.given("turn") && r.complete())
    return faults_.place(r.json(), "it prescribes no motion; expected \"position\", \"turn\" or both");
  const TimeReader times(end_, faults_);
  PrescribedMotion motion;
  motion.orientation = part_->R0();
  std::optional<TimeVector> position = TimeVector(part_->c0());
  if (r.given("position") || r.faulty("position"))
    position = times.vector(r, "position", Needs::value_and_rate);
  std::optional<TimeFunction> angle = TimeFunction(0);
  if (r.given("turn") || r.faulty("turn")) {
    const Reader turn = r.object("turn");
    if (turn.given("axis")) motion.axis = read_direction(turn.at("axis"), faults_);
    angle = turn.given("angle") ? times.function(turn.at("angle"), Needs::value_and_rate) : std::nullopt;
  }
  if (!position || !angle) return;
  motion.position = *std::move(position);
  motion.angle = *std::move(angle);
  part_->prescribe(std::move(motion));
}

/// Checks the keys that need a part without dynamic parameters or without local deformation. Warns of
/// velocities of a part that is fixed or has a prescribed motion.
void PartReader::check_rigid_keys() {
  const Parameters& all = part_->parameters();
  if (all.n_dynamic() > 0) {
    const std::string because = all.moving(0).name + " is dynamic; expected ";
    if (r_.boolean("fixed"))
      faults_.value(r_.at("fixed"), because + "only frozen parameters in a part that does not move");
    else if (r_.given("motion"))
      faults_.place(r_.at("motion"), because + "only frozen parameters in a part that moves as prescribed");
    if (r_.given("inertia"))
      faults_.place(r_.at("inertia"), because + "only frozen parameters in a part with a given inertia");
  }
  if (r_.given("local")) {
    if (fixed_or_motion() != nullptr)
      faults_.place(r_.at("local"),
                    std::string(r_.given("motion") ? "a part that moves as prescribed" : "a fixed part") +
                        " does not deform; expected no \"local\"");
    if (r_.given("inertia"))
      faults_.place(
          r_.at("inertia"),
          "the inertia of a part with local deformation follows from its density or mass; expected no "
          "\"inertia\"");
  }
  if (fixed_or_motion() == nullptr) return;
  for (const char* key : {"velocity", "angular_velocity"})
    if (!r_.vector3(key).isZero(0))
      faults_.warn(r_.at(key), r_.given("motion") ? "it has no effect, because \"motion\" prescribes it"
                                                  : "it has no effect, because the part is fixed");
}

/// Reports a fault that concerns all parameters together, for example too many dynamic parameters or a shape
/// that folds.
void PartReader::report_at_parameters(const std::invalid_argument& e) {
  faults_.place(r_.given("parameters") ? r_.at("parameters") : r_.json(), without_name(e));
}

void PartReader::report_local_fault(const LocalFault& e) {
  const Reader local = r_.object("local");
  const JsonValue& at =
      e.law < 0 ? local.json() : local.objects("laws")[static_cast<std::size_t>(e.law)].json();
  faults_.place(at, without_name(e));
}

/// Returns the message of an error without the name of the part. The JSON pointer of the fault shows the
/// part.
std::string PartReader::without_name(const std::invalid_argument& e) const {
  std::string message = e.what();
  const std::string who = "part '" + part_->name() + "': ";
  if (message.compare(0, who.size(), who) == 0) message.erase(0, who.size());
  return message;
}

void PartReader::prepare() {
  try {
    body_.prepare(*part_);
  } catch (const LocalFault& e) {
    return report_local_fault(e);
  } catch (const std::invalid_argument& e) {
    return report_at_parameters(e);
  }
  const Inertia<double>& inertia = part_->rest_inertia();
  for (int i = 0; i < 3; ++i) {
    const double moment = inertia.M(3 + i, 3 + i);
    if (is_workable(inertia.mass) && is_workable(moment)) continue;
    return faults_.place(r_.json(), "it has a mass of " + brief(inertia.mass) +
                                        " kg and a moment of inertia of " + brief(moment) +
                                        " kg m^2; expected both from 1e-100 to 1e100");
  }
  constexpr double large = 1e-6;
  if (const double error = part_->mass_points().relative_error;
      error > large && part_->mass_distribution() != nullptr)
    faults_.warn(r_.at("mass_distribution"), "its mass, centre and inertia have a relative error of about " +
                                                 brief(error) + ", because it varies fast or jumps");
  prepared_ = true;
}

}  // namespace pliant
