#include <pliant/io/work_row.h>

#include <array>

namespace pliant {
namespace {

/// A count of RunWork::steps or of RunWork::parts; the other pointer is nullptr.
struct Count {
  const char* name;
  long StepCounters::*of_steps;
  long Counters::*of_parts;
  const char* meaning;
  bool repeats = false;  ///< whether a resumed run repeats computations; the count then has no column

  long& in(RunWork& work) const { return of_steps != nullptr ? work.steps.*of_steps : work.parts.*of_parts; }
  long in(const RunWork& work) const {
    return of_steps != nullptr ? work.steps.*of_steps : work.parts.*of_parts;
  }
};

constexpr std::array<Count, 18> kCounts{{
    {"steps", &StepCounters::steps, nullptr, "accepted steps"},
    {"evaluations", &StepCounters::evaluations, nullptr, "evaluations of the accelerations"},
    {"rejected", &StepCounters::rejected, nullptr, "steps repeated with a shorter length"},
    {"uncontrolled", &StepCounters::uncontrolled, nullptr, "steps whose contact error is not controlled"},
    {"limit_impulses", &StepCounters::limit_impulses, nullptr, "impulses at limits and on strings"},
    {"factorisations", &StepCounters::factorisations, nullptr, "factorisations of implicit methods", true},
    {"impacts", &StepCounters::impacts, nullptr, "impacts whose time was located"},
    {"sequential_impacts", &StepCounters::sequential_impacts, nullptr, "impacts in sequences"},
    {"contact_sweeps", &StepCounters::contact_sweeps, nullptr, "sweeps over contacts"},
    {"contact_fallbacks", &StepCounters::contact_fallbacks, nullptr,
     "searches for contact impulses repeated with compliant contacts"},
    {"contact_cutoffs", &StepCounters::contact_cutoffs, nullptr,
     "steps that reached a limit of contact rounds or of located impacts"},
    {"jacobian_points", nullptr, &Counters::jacobian_points, "points whose Jacobian was evaluated"},
    {"rate_points", nullptr, &Counters::rate_points, "points whose Jdot qs_dot was evaluated"},
    {"mass_matrices", nullptr, &Counters::mass_matrices, "mass matrices"},
    {"inertial_forces", nullptr, &Counters::inertial_forces, "vectors of inertial forces"},
    {"point_jets", nullptr, &Counters::point_jets, "material points evaluated"},
    {"surfaces", nullptr, &Counters::surfaces, "surfaces evaluated for output"},
    {"strain_points", nullptr, &Counters::strain_points, "points whose strain was evaluated"},
}};

void add_violation(std::vector<double>& row, const ContactViolation& violation) {
  row.insert(row.end(), {violation.value, violation.tolerance, violation.time});
}

}  // namespace

std::vector<Column> work_columns() {
  std::vector<Column> columns;
  for (const Count& count : kCounts)
    if (!count.repeats) columns.push_back({count.name, "1", count.meaning});
  columns.push_back({"max_contact_residual", "m/s", "largest residual of a contact solution"});
  columns.push_back({"max_contact_overlap", "m", "largest overlap after a separation"});
  for (const auto& [name, unit] : {std::pair<std::string, const char*>{"worst_contact_residual", "m/s"},
                                   {"worst_contact_overlap", "m"}}) {
    columns.push_back({name, unit, "violation that is largest in units of its tolerance"});
    columns.push_back({name + ".tolerance", unit, ""});
    columns.push_back({name + ".time", "s", "end of its step"});
  }
  return columns;
}

std::vector<double> work_row(const RunWork& work) {
  std::vector<double> row;
  for (const Count& count : kCounts)
    if (!count.repeats) row.push_back(static_cast<double>(count.in(work)));
  row.push_back(work.steps.contact_residual);
  row.push_back(work.steps.contact_overlap);
  add_violation(row, work.steps.worst_residual);
  add_violation(row, work.steps.worst_overlap);
  return row;
}

RunWork read_work_row(const double* row) {
  RunWork work;
  for (const Count& count : kCounts)
    if (!count.repeats) count.in(work) = static_cast<long>(*row++);
  work.steps.contact_residual = *row++;
  work.steps.contact_overlap = *row++;
  work.steps.worst_residual = {row[0], row[1], row[2]};
  work.steps.worst_overlap = {row[3], row[4], row[5]};
  return work;
}

std::vector<std::pair<std::string, long>> counts_of(const RunWork& work) {
  std::vector<std::pair<std::string, long>> counts;
  for (const Count& count : kCounts) counts.emplace_back(count.name, count.in(work));
  return counts;
}

void set_count(RunWork& work, const std::string& name, long value) {
  for (const Count& count : kCounts)
    if (name == count.name) count.in(work) = value;
}

RunWork continued(const RunWork& before, const RunWork& session, const RunWork& at_start) {
  RunWork sum = before;
  sum.steps += session.steps;
  sum.parts += session.parts;
  for (const Count& count : kCounts) count.in(sum) -= count.in(at_start);
  return sum;
}

}  // namespace pliant
