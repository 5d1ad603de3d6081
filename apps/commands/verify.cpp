// pliant verify: checks that no file of a run is missing or damaged.
#include <iostream>
#include <memory>
#include <new>

#include <pliant/io/run/run_files.h>
#include <pliant/io/run/run_folder.h>
#include <pliant/io/run/verify_run.h>

#include "command.h"
#include "exit_codes.h"
#include "open_run.h"
#include "show_progress.h"
#include "stop_signal.h"

namespace pliant_cli {
namespace {

namespace fs = std::filesystem;

const char* status_text(const pliant::RunRecord& record) {
  switch (record.status) {
    case pliant::RunRecord::Status::running:
      return "still running, or killed; pliant run --resume continues a killed run";
    case pliant::RunRecord::Status::complete:
      return "complete";
    case pliant::RunRecord::Status::stopped:
      return "stopped: continue with pliant run --resume";
    case pliant::RunRecord::Status::failed:
      break;
  }
  return "failed";
}

int verify(const fs::path& folder, bool quiet) {
  catch_stop_signals();
  const std::unique_ptr<pliant::Progress> progress = make_progress(quiet);
  const fs::path record_file = pliant::find_run_file(folder);
  if (!record_file.empty() &&
      record_file.parent_path() != (folder / pliant::kRunFile).lexically_normal().parent_path())
    throw pliant::RecordingMismatch("the run in " + folder.string() +
                                    " was killed at its beginning; pliant run --resume continues it");
  const pliant::RunRecord record = pliant::read_run_record(folder / pliant::kRunFile);
  pliant::Verification result;
  pliant::verify_whole_files(folder, record, result);
  try {
    const OpenRun run = open_run(folder);
    const pliant::VerifiedRun verified{folder, record, *run.scene, *run.model, *run.recording, run.frames()};
    pliant::verify_tables(verified, result);
    if (result.faults.empty())
      pliant::verify_frames(verified, *progress, result);
    else
      result.checked.emplace_back("no frames, because of the faults above");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const pliant::Interrupted&) {
    throw;
  } catch (const std::exception& fault) {
    result.faults.emplace_back(fault.what());
  }
  for (const std::string& fault : result.faults) std::cerr << "pliant: error: " << fault << "\n";
  if (quiet) return result.faults.empty() ? kDone : kRecordingMismatch;
  std::cout << folder.string() << ": " << status_text(record) << "; t = " << record.time
            << " s, trajectory hash " << record.trajectory_hash() << "\n";
  for (const std::string& checked : result.checked) std::cout << "  checked: " << checked << "\n";
  std::cout << (result.faults.empty() ? "  no fault found\n"
                                      : "  faults found: " + std::to_string(result.faults.size()) + "\n");
  return result.faults.empty() ? kDone : kRecordingMismatch;
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  struct Options {
    std::string run;
    bool quiet = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("verify", "Check that no file of a run is missing or damaged");
  command->add_option("run", options->run, "Folder of the run")->required()->type_name("RUN");
  command->add_flag("--quiet", options->quiet, "Print faults only");
  command->footer(
      "The numbers of all tables and the bytes of the other files are compared with their checksums, mesh\n"
      "files with the recording, and the checksums inside pictures with their contents. A fault gives exit\n"
      "code 10.\n"
      "Example:\n"
      "  pliant verify out/pull");
  command->callback(
      [options, &action] { action = [options] { return verify(options->run, options->quiet); }; });
}

}  // namespace pliant_cli
