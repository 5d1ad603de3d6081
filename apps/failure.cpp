// The exit code and the message of each exception, and messages about unknown commands, options and
// arguments.
#include "failure.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <typeinfo>
#include <vector>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/io/run/run_folder.h>
#include <pliant/math/nearest_name.h>
#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/text_file.h>
#include <pliant/simulate/simulation.h>

#include "exit_codes.h"
#include "stop_signal.h"

namespace pliant_cli {
namespace {

/// Returns a text in which each word of more than kLongestWord bytes, such as a path, is shortened in its
/// middle, so that the rest of a message is easy to find.
std::string with_short_words(const std::string& text) {
  constexpr std::size_t kLongestWord = 400, kKept = 150;
  auto is_continuation = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80; };
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size() - 1) + 1;
    std::size_t first = begin + kKept, last = end - std::min(end, kKept);
    if (end - begin > kLongestWord) {
      while (is_continuation(first)) ++first;
      while (is_continuation(last)) ++last;
      result += text.substr(begin, first - begin) + "..." + text.substr(last, end - last);
    } else {
      result += text.substr(begin, end - begin);
    }
    begin = end;
  }
  return result;
}

int report(const char* what, int code) {
  std::cerr << "pliant: error: " << with_short_words(what) << "\n";
  return code;
}

// Returns the names of the options of a command. A message suggests one of them for an option that does not
// exist.
std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

// Returns the messages about the words of the command line that CLI11 could not assign; empty if there are
// none. Every message except the first begins with a line break and "pliant: error: ".
std::string unexpected_words(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> words = app.remaining(true);
  if (&command == &app && words.size() > 1) words.resize(1);  // the first word should be a command
  std::string text;
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    text += (text.empty() ? "" : "\npliant: error: ");
    if (&command == &app && word.compare(0, 1, "-") != 0)
      text += "there is no command \"" + pliant::escaped(word) + "\"" +
              pliant::did_you_mean(name, command_names(app));
    else if (word.compare(0, 1, "-") == 0)
      text += "there is no option " + pliant::escaped(name) +
              (name.compare(0, 2, "--") == 0 ? pliant::did_you_mean(name, option_names(command)) : "");
    else
      text += "unexpected argument \"" + pliant::escaped(word) + "\"";
  }
  return text;
}

constexpr const char* kOutOfMemoryText = "out of memory; reduce the resolution or the number of parts";

/// Ends the program at once, without an allocation of memory. The user can then continue a run with --resume.
[[noreturn]] void end_without_memory() {
  std::fprintf(stderr, "pliant: error: %s\n", kOutOfMemoryText);
  std::_Exit(kResources);
}

/// The handler of std::terminate. Ends the program with a message if memory is exhausted; otherwise aborts.
[[noreturn]] void on_terminate() {
  bool out_of_memory = false;
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
    out_of_memory = true;
  } catch (const std::system_error& fault) {
    out_of_memory = fault.code() == std::errc::not_enough_memory;
  } catch (...) {
    // A fault of the program.
  }
  if (out_of_memory) end_without_memory();
  std::abort();
}

}  // namespace

// The linker option --wrap calls this function in place of __cxa_throw, which throws every exception. An
// exception std::bad_alloc must not unwind the stack: Eigen 3.4 frees the memory of a matrix before it
// allocates new memory, so that the destructor of the matrix would free the memory again.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier)
[[noreturn]] void __real___cxa_throw(void* exception, std::type_info* type, void (*destroy)(void*));
[[noreturn]] void __wrap___cxa_throw(void* exception, std::type_info* type, void (*destroy)(void*));
// NOLINTEND(bugprone-reserved-identifier)
void __wrap___cxa_throw(void* exception, std::type_info* type, void (*destroy)(void*)) {
  if (*type == typeid(std::bad_alloc)) end_without_memory();
  __real___cxa_throw(exception, type, destroy);
}
}

void end_if_memory_is_exhausted() {
  std::set_new_handler(end_without_memory);
  std::set_terminate(on_terminate);
}

int reporting_failures(const std::function<int()>& task) {
  try {
    return task();
  } catch (const pliant::SceneError& error) {
    std::cerr << with_short_words(error.what());
    return kInput;
  } catch (const pliant::FileError& error) {
    return report(error.what(), error.exit_code());
  } catch (const pliant::OutputRefused& error) {
    return report(error.what(), kWouldOverwrite);
  } catch (const pliant::RecordingMismatch& error) {
    return report(error.what(), kRecordingMismatch);
  } catch (const pliant::UnsatisfiableModel& error) {
    return report(error.what(), kUnsatisfiable);
  } catch (const pliant::NumericalFailure& error) {
    return report(error.what(), kNumerical);
  } catch (const pliant::Interrupted& error) {
    std::cerr << "pliant: " << error.what() << "\n";
    return kSignal + stop_signal();
  } catch (const ResourceFailure& error) {
    return report(error.what(), kResources);
  } catch (const pliant::OutOfMemory& error) {
    return report(error.what(), kResources);
  } catch (const std::bad_alloc&) {
    return report(kOutOfMemoryText, kResources);
  } catch (const std::filesystem::filesystem_error& error) {
    if (error.code() == std::errc::not_enough_memory) return report(kOutOfMemoryText, kResources);
    const std::string what = error.what(), label = "filesystem error: ";
    return report(what.compare(0, label.size(), label) == 0 ? what.c_str() + label.size() : what.c_str(),
                  kFileSystem);
  } catch (const std::system_error& error) {
    return report(error.what(), error.code() == std::errc::not_enough_memory ? kResources : kFileSystem);
  } catch (const std::invalid_argument& error) {
    return report(error.what(), kInput);
  } catch (const std::exception& error) {
    return report((std::string("internal error: ") + error.what()).c_str(), kInternal);
  }
}

int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {  // help or version
    app.exit(error, std::cout, std::cout);
    return kDone;
  }
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  const CLI::App& command = parsed.empty() ? app : *parsed.front();
  const std::string unexpected = unexpected_words(app, command);
  const std::string what = unexpected.empty() ? pliant::escaped(error.what()) : unexpected;
  std::cerr << "pliant: error: " << with_short_words(what) << "\nTry: pliant "
            << (parsed.empty() ? "" : command.get_name() + " ") << "--help\n";
  return kCommandLine;
}

}  // namespace pliant_cli
