#include "traced_process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>

#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

namespace faults {
namespace {

#if defined(__x86_64__)

/// The signal of a stop at a system call, with the option PTRACE_O_TRACESYSGOOD.
constexpr int kStopAtCall = SIGTRAP | 0x80;

/// How a kind of call names its file.
enum class File { none, descriptor, path, path_at };

/// Returns how a system call (SYS_write, ...) names its file.
File file_of(long what) {
  switch (what) {
    case SYS_read:
    case SYS_write:
    case SYS_pread64:
    case SYS_pwrite64:
    case SYS_fsync:
    case SYS_fdatasync:
    case SYS_ftruncate:
    case SYS_flock:
    case SYS_close:
    case SYS_fstat:
    case SYS_getdents64:
      return File::descriptor;
    case SYS_open:
    case SYS_stat:
    case SYS_lstat:
    case SYS_mkdir:
    case SYS_rmdir:
    case SYS_unlink:
    case SYS_rename:
      return File::path;
    case SYS_openat:
    case SYS_newfstatat:
    case SYS_statx:
    case SYS_unlinkat:
    case SYS_mkdirat:
      return File::path_at;
    default:
      return File::none;
  }
}

/// Returns the text at an address of another process, at most 4 kB.
std::string text_at(pid_t process, unsigned long long address) {
  std::string text;
  std::array<char, 256> block{};
  while (text.size() < 4096) {
    // A block ends at the end of its page, because the next page may not exist.
    const std::size_t size = std::min<std::size_t>(block.size(), 4096 - (address & 4095));
    iovec here{block.data(), size}, there{reinterpret_cast<void*>(address), size};
    const ssize_t count = ::process_vm_readv(process, &here, 1, &there, 1, 0);
    if (count <= 0) return text;
    const auto length = static_cast<std::size_t>(count);
    const std::size_t end = ::strnlen(block.data(), length);
    text.append(block.data(), end);
    if (end < length) return text;
    address += length;
  }
  return text;
}

/// Returns the path of the file of a system call, or an empty text if the call has no file.
std::string path_of(pid_t thread, const user_regs_struct& registers, long what) {
  switch (file_of(what)) {
    case File::descriptor: {
      std::error_code none;
      return std::filesystem::read_symlink(
                 "/proc/" + std::to_string(thread) + "/fd/" + std::to_string(registers.rdi), none)
          .string();
    }
    case File::path:
      return text_at(thread, registers.rdi);
    case File::path_at:
      return text_at(thread, registers.rsi);
    case File::none:
      break;
  }
  return {};
}

/// Starts a command that waits until it is traced. Returns its process number.
pid_t start(const std::vector<std::string>& command, const std::string& folder, const std::string& output) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int file = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0 || ::dup2(file, 1) < 0 || ::dup2(file, 2) < 0 || ::chdir(folder.c_str()) != 0) ::_exit(98);
  ::close(file);
  if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) ::_exit(97);
  ::raise(SIGSTOP);
  ::execv(words[0], words.data());
  ::_exit(99);
}

/// The calls of one traced process.
class Tracer {
 public:
  Tracer(pid_t process, bool with_paths, const std::function<Action(const Call&)>& at_call)
      : process_(process), with_paths_(with_paths), at_call_(&at_call) {}

  Ended run() {
    Ended ended;
    ended.traced = true;
    for (;;) {
      int status = 0;
      const pid_t thread = ::waitpid(-1, &status, __WALL);
      if (thread < 0 && errno == EINTR) continue;
      if (thread < 0) break;
      if (WIFEXITED(status) || WIFSIGNALED(status)) {
        threads_.erase(thread);
        if (thread == process_) ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        continue;
      }
      stopped(thread, WSTOPSIG(status), status >> 16);
    }
    ended.calls = calls_;
    return ended;
  }

 private:
  struct Thread {
    bool in_call = false;
    int error = 0;  // value of errno with which the call fails; 0: the call is made
  };

  void stopped(pid_t thread, int signal, int event) {
    const bool is_new = threads_.find(thread) == threads_.end();
    Thread& now = threads_[thread];
    int passed_on = 0;
    if (signal == kStopAtCall)
      now.in_call ? end_call(thread, now) : begin_call(thread, now);
    else if (event == 0 && !(is_new && signal == SIGSTOP))
      passed_on = signal;
    ::ptrace(PTRACE_SYSCALL, thread, nullptr, reinterpret_cast<void*>(static_cast<long>(passed_on)));
  }

  void begin_call(pid_t thread, Thread& now) {
    now.in_call = true;
    user_regs_struct registers{};
    if (::ptrace(PTRACE_GETREGS, thread, nullptr, &registers) != 0) return;
    Call call;
    call.number = ++calls_;
    call.what = static_cast<long>(registers.orig_rax);
    if (with_paths_) call.path = path_of(thread, registers, call.what);
    const Action action = (*at_call_)(call);
    if (action.kill) ::kill(process_, SIGKILL);
    if (action.error == 0) return;
    now.error = action.error;
    registers.orig_rax = static_cast<unsigned long long>(-1);  // the kernel makes no call
    ::ptrace(PTRACE_SETREGS, thread, nullptr, &registers);
  }

  static void end_call(pid_t thread, Thread& now) {
    now.in_call = false;
    if (now.error == 0) return;
    user_regs_struct registers{};
    if (::ptrace(PTRACE_GETREGS, thread, nullptr, &registers) != 0) return;
    registers.rax = static_cast<unsigned long long>(-now.error);
    ::ptrace(PTRACE_SETREGS, thread, nullptr, &registers);
    now.error = 0;
  }

  pid_t process_;
  bool with_paths_;
  const std::function<Action(const Call&)>* at_call_;
  std::map<pid_t, Thread> threads_;
  long calls_ = 0;
};

#endif

}  // namespace

#if defined(__x86_64__)

Ended run_traced(const std::vector<std::string>& command, const std::string& folder,
                 const std::string& output, bool with_paths,
                 const std::function<Action(const Call&)>& at_call) {
  const pid_t child = start(command, folder, output);
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, __WALL) != child || !WIFSTOPPED(status)) return {};
  const long options = PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK |
                       PTRACE_O_TRACEVFORK | PTRACE_O_TRACEEXEC | PTRACE_O_EXITKILL;
  Tracer tracer(child, with_paths, at_call);
  if (::ptrace(PTRACE_SETOPTIONS, child, nullptr, reinterpret_cast<void*>(options)) != 0 ||
      ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr) != 0) {
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, __WALL);
    return {};
  }
  return tracer.run();
}

bool can_trace() {
  const Ended ended =
      run_traced({"/bin/true"}, ".", "/dev/null", false, [](const Call&) { return Action{}; });
  return ended.traced && ended.calls > 0;
}

#else

Ended run_traced(const std::vector<std::string>&, const std::string&, const std::string&, bool,
                 const std::function<Action(const Call&)>&) {
  return {};
}

bool can_trace() {
  return false;
}

#endif

}  // namespace faults
