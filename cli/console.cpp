#include "cli/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

#include "cli/format.h"
#include "common/text.h"

namespace strata {
namespace {

void Write(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

}  // namespace

Console Console::ForProcess() {
  const bool live = isatty(STDERR_FILENO) != 0;
  const char* no_color = std::getenv("NO_COLOR");
  return Console({.live = live, .colour = live && (no_color == nullptr || *no_color == '\0')});
}

void Console::Result(std::string_view line) {
  Clear();
  Write(results_, std::string(line) + "\n");
}

void Console::Line(std::string_view line) {
  Clear();
  Write(others_, std::string(line) + "\n");
}

void Console::Note(std::string_view line) { Line(line); }

void Console::Warning(std::string_view line) { Line(Yellow(Printable(line))); }

void Console::Error(std::string_view message) { Line(Red(Printable(message))); }

int Console::Width() const {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

void Console::Redraw(std::string_view line) {
  // Back to the first column, the line, and whatever the old line had beyond it erased.
  Write(others_, StrCat("\r", line, "\x1b[K"));
  drawn_ = true;
}

void Console::Clear() {
  if (drawn_) Write(others_, "\r\x1b[K");
  drawn_ = false;
}

std::string Console::Styled(std::string_view code, std::string_view text) const {
  if (!terminal_.colour) return std::string(text);
  return "\x1b[" + std::string(code) + "m" + std::string(text) + "\x1b[0m";
}

}  // namespace strata
