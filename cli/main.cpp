#include "cli/commands.h"
#include "cli/interrupt.h"

int main(int argc, char** argv) {
  strata::ExitOnInterrupt();
  strata::CommandLine commands;
  strata::AddAllCommands(commands);
  strata::Console console = strata::Console::ForProcess();
  return static_cast<int>(commands.Main(argc, argv, console));
}
