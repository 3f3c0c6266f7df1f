#pragma once

#include "cli/command_line.h"

// Each command of `strata` in a file of its own, or with its near relatives.

namespace strata {

void AddAllCommands(CommandLine& commands);  ///< These, in the order in which they are listed.

void AddRenderCommand(CommandLine& commands);  ///< A whole farm in one process.
void AddSubmitCommand(CommandLine& commands);
void AddWatchCommand(CommandLine& commands);
void AddListCommands(CommandLine& commands);  ///< jobs, workers, logs.
void AddFetchCommand(CommandLine& commands);
void AddControlCommands(CommandLine& commands);  ///< cancel, pause, resume, retry, delete, set.
void AddCheckCommand(CommandLine& commands);
void AddDiffCommand(CommandLine& commands);
void AddReplayCommand(CommandLine& commands);
void AddHealthCommand(CommandLine& commands);
void AddLabCommand(CommandLine& commands);  ///< Experiments: cli/lab/.

}  // namespace strata
