// The counters of a run up to a state (steps, evaluations, ..., and the largest errors of contact): a row of
// work.npy, and values of run.json. A resumed run continues these counters from the state from which the run
// continues.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/step_counters.h>
#include <pliant/io/format/column.h>
#include <pliant/part/counters.h>

namespace pliant {

/// Counters of the steps of a run, and of the evaluations of its parts.
struct RunWork {
  StepCounters steps;
  Counters parts;
};

/// Returns the columns of work.npy, in order. The count of factorisations has no column, because a resumed
/// run repeats some factorisations.
std::vector<Column> work_columns();
/// Returns the row of work.npy for the counters up to a state.
std::vector<double> work_row(const RunWork& work);
/// Returns the counters of a row of work.npy, which has one number per column. The count of factorisations
/// is 0.
RunWork read_work_row(const double* row);

/// Returns the names and values of all counts, without the errors of contact.
std::vector<std::pair<std::string, long>> counts_of(const RunWork& work);
/// Sets the count with a name; a name that is unknown is ignored.
void set_count(RunWork& work, const std::string& name, long value);
/// Returns the counters of a resumed run: the counters before the session, plus the counts of the session
/// since `at_start`. The larger errors of contact are kept.
RunWork continued(const RunWork& before, const RunWork& session, const RunWork& at_start);

}  // namespace pliant
