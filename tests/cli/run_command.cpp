#include "tests/cli/run_command.h"

#include <fcntl.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <regex>
#include <utility>

#include "cli/commands.h"
#include "tests/cli/scene_folder.h"

extern char** environ;

namespace strata::test {
namespace {

/// Both ends are closed in processes that are started later.
std::pair<int, int> Pipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) std::abort();
  return {ends[0], ends[1]};
}

/// A terminal of this width: the end to read from and the end a process writes to.
std::pair<int, int> Terminal(int columns) {
  winsize size{};
  size.ws_row = 24;
  size.ws_col = static_cast<unsigned short>(columns);
  int reader = -1, writer = -1;
  if (openpty(&reader, &writer, nullptr, nullptr, &size) != 0) std::abort();
  fcntl(reader, F_SETFD, FD_CLOEXEC);
  fcntl(writer, F_SETFD, FD_CLOEXEC);
  return {reader, writer};
}

std::vector<std::string> Environment(const std::map<std::string, std::string>& changes) {
  std::vector<std::string> result;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (!changes.contains(text.substr(0, text.find('=')))) result.push_back(text);
  }
  for (const auto& [name, value] : changes) result.push_back(name + "=" + value);
  return result;
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

RunningCommand::RunningCommand(const std::vector<std::string>& words, const RunOptions& options) {
  const auto [out_reader, out_writer] = Pipe();
  const auto [err_reader, err_writer] =
      options.terminal_columns > 0 ? Terminal(options.terminal_columns) : Pipe();
  out_.descriptor = out_reader;
  err_.descriptor = err_reader;

  // All memory is taken before the fork: the child of a threaded process may not allocate.
  const std::string binary = std::string(STRATA_BIN_DIR) + "/" + words.front();
  std::vector<std::string> arguments = words, environment = Environment(options.environment);
  const std::vector<char*> argv = Pointers(arguments), envp = Pointers(environment);
  pid_ = fork();
  if (pid_ < 0) std::abort();
  if (pid_ == 0) {
    dup2(out_writer, STDOUT_FILENO);
    dup2(err_writer, STDERR_FILENO);
    if (!options.directory.empty() && chdir(options.directory.c_str()) != 0) _exit(126);
    execve(binary.c_str(), argv.data(), envp.data());
    _exit(127);
  }
  close(out_writer);
  close(err_writer);
  out_.reader = std::thread([this] { Read(out_); });
  err_.reader = std::thread([this] { Read(err_); });
}

RunningCommand::~RunningCommand() {
  if (waited_) return;
  Signal(SIGKILL);
  Wait();
}

void RunningCommand::Read(Stream& stream) {
  char block[4096];
  // A terminal whose last writer left gives an error instead of an end.
  for (ssize_t n; (n = read(stream.descriptor, block, sizeof block)) > 0;) {
    MutexLock lock(mutex_);
    stream.text.append(block, static_cast<size_t>(n));
    grown_.NotifyAll();
  }
  MutexLock lock(mutex_);
  stream.ended = true;
  grown_.NotifyAll();
}

bool RunningCommand::WaitFor(Stream& stream, const std::string& pattern) {
  const std::regex expected(pattern);
  MutexLock lock(mutex_);
  while (!std::regex_search(stream.text, expected)) {
    if (stream.ended) return false;
    grown_.Wait(mutex_);
  }
  return true;
}

void RunningCommand::Signal(int signal) { kill(pid_, signal); }

bool RunningCommand::WaitForHandlerOf(int signal) {
  const std::filesystem::path status = absl::StrCat("/proc/", pid_, "/status");
  const std::regex caught("SigCgt:\\s*([0-9a-f]+)");
  while (true) {
    const std::string text = ReadFile(status);
    std::smatch mask;
    // A process that has ended and not been waited for has the line no longer.
    if (!std::regex_search(text, mask, caught) || text.find("State:\tZ") != std::string::npos) {
      return false;
    }
    if (std::stoull(mask[1], nullptr, 16) >> (signal - 1) & 1) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

CommandResult RunningCommand::Wait() {
  out_.reader.join();
  err_.reader.join();
  close(out_.descriptor);
  close(err_.descriptor);
  int status = 0;
  waitpid(pid_, &status, 0);
  waited_ = true;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), out_.text, err_.text};
}

CommandResult RunStrata(const std::vector<std::string>& arguments, const RunOptions& options) {
  std::vector<std::string> words = {"strata"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return RunningCommand(words, options).Wait();
}

namespace {

/// What is written to a stream, as a text.
class CapturedStream {
 public:
  CapturedStream() : file_(open_memstream(&text_, &size_)) {}
  ~CapturedStream() {
    std::fclose(file_);
    std::free(text_);
  }
  CapturedStream(const CapturedStream&) = delete;
  CapturedStream& operator=(const CapturedStream&) = delete;

  std::FILE* file() { return file_; }
  std::string Text() {
    std::fflush(file_);
    return std::string(text_, size_);
  }

 private:
  char* text_ = nullptr;
  size_t size_ = 0;
  std::FILE* file_;
};

}  // namespace

CommandResult RunInProcess(const std::vector<std::string>& arguments) {
  std::vector<const char*> words = {"strata"};
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  CapturedStream out, err;
  Console console({}, out.file(), err.file());
  CommandLine commands;
  AddAllCommands(commands);
  const ExitStatus exit = commands.Main(static_cast<int>(words.size()), words.data(), console);
  return {static_cast<int>(exit), out.Text(), err.Text()};
}

}  // namespace strata::test
