// pliant list: prints the shapes, deformations, laws, joints, methods and functions of the library.
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>

#include <pliant/body/joints/joint_registry.h>
#include <pliant/math/formula.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/registry.h>
#include <pliant/simulate/choose_integrator.h>

#include "command.h"
#include "exit_codes.h"

namespace pliant_cli {
namespace {

std::string text_of(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

std::string range_text(const pliant::Range& range, bool relative) {
  return "[" + text_of(range.min) + ", " + text_of(range.max) + "]" +
         (relative ? " times the rest value" : "");
}

void print_parameters(const pliant::ParameterSpec* specs, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const pliant::ParameterSpec& p = specs[i];
    std::cout << "    " << std::left << std::setw(7) << p.name << " default " << std::setw(5)
              << text_of(p.standard) << " " << std::setw(4) << (p.unit()[0] == '1' ? "" : p.unit())
              << " frozen " << range_text(p.frozen, false) << ", dynamic "
              << range_text(p.dynamic, p.relative) << "\n            " << p.meaning << "\n";
  }
}

void list_shapes() {
  for (const auto& shape : pliant::all_shapes()) {
    std::cout << shape->name() << "\n  " << shape->formula() << "\n";
    print_parameters(shape->parameters(), static_cast<std::size_t>(shape->n_parameters()));
  }
}

void list_deformations() {
  for (const pliant::DeformationInfo& link : pliant::all_deformations()) {
    std::cout << link.name << "\n  " << link.formula << "\n";
    print_parameters(link.parameters.data(), link.parameters.size());
  }
}

void list_laws() {
  for (const pliant::LocalLawInfo& law : pliant::all_local_laws()) {
    std::cout << law.name << "\n  for " << (law.shell ? "shells" : "solids") << ": " << law.meaning << "\n  "
              << law.formula << "\n";
    for (const pliant::LocalLawInfo::Number& n : law.numbers) {
      const bool bounded = std::isfinite(n.min) || std::isfinite(n.max);
      std::cout << "    " << std::left << std::setw(9) << n.key << " " << std::setw(5)
                << (n.unit[0] == '1' ? "" : n.unit) << " "
                << (n.fallback ? "default " + text_of(*n.fallback) + ", " : "");
      if (bounded)
        std::cout << (n.above ? "above " : "from ") << text_of(n.min)
                  << (std::isfinite(n.max) ? " to " + text_of(n.max) : "") << "; ";
      std::cout << n.meaning << "\n";
    }
  }
}

void list_joints() {
  for (const pliant::JointInfo& joint : pliant::all_joints())
    std::cout << joint.name << "\n  " << joint.formula << "\n";
}

void list_integrators() {
  std::cout << pliant::kAutomatic
            << "\n  chooses the method of this list that advances farthest at equal cost in a trial; always "
               "uses a tolerance\n";
  for (const pliant::IntegratorInfo& method : pliant::all_integrators())
    std::cout << method.name << "\n  order " << method.order << ": " << method.description << "\n";
}

void list_functions() {
  std::cout << "Formulas, for example \"0.2 * sin(2 * pi * t)\", may contain t, pi, + - * / ^ and\n";
  for (const pliant::Formula::Function& function : pliant::Formula::functions())
    std::cout << "  " << std::left << std::setw(8) << function.name << " " << function.meaning << "\n";
}

struct Kind {
  const char* name;
  const char* meaning;
  void (*print)();
};
constexpr Kind kKinds[] = {
    {"shapes", "solid primitives, with their parameters, ranges and formulas", list_shapes},
    {"deformations", "global deformations, with their parameters, ranges and formulas", list_deformations},
    {"laws", "energies of local deformation, with their parameters", list_laws},
    {"joints", "constraints between points of parts and of the world", list_joints},
    {"integrators", "methods of time integration", list_integrators},
    {"functions", "functions for formulas", list_functions},
};

}  // namespace

void add_list(CLI::App& app, Action& action) {
  const auto kind = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("list", "List shapes, deformations, laws, joints, integrators or functions");
  std::vector<std::string> names;
  std::string footer = "Kinds:\n";
  for (const Kind& k : kKinds) {
    names.push_back(k.name);
    footer += std::string("  ") + k.name + ": " + k.meaning + "\n";
  }
  command->add_option("kind", *kind, "Kind of things to list")
      ->required()
      ->check(CLI::IsMember(names))
      ->option_text("KIND REQUIRED");
  command->footer(footer);
  command->callback([kind, &action] {
    action = [kind] {
      for (const Kind& k : kKinds)
        if (*kind == k.name) k.print();
      return kDone;
    };
  });
}

}  // namespace pliant_cli
